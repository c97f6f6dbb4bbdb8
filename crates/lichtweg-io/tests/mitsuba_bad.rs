//! What is said about bad Mitsuba scenes: every file in `tests/bad/mitsuba` has its findings in `tests/snapshots`.
//!
//! After a change that is meant, run with `INSTA_UPDATE=always` and look at every snapshot that differs.

use std::path::{Path, PathBuf};

use lichtweg::scene::description::{Diagnostics, SourceMap};
use lichtweg_io::diagnostics::{render, summary};
use lichtweg_io::mitsuba::read;
use lichtweg_io::options::{LoadReport, ReadOptions};

const FOLDER: &str = "tests/bad/mitsuba";

/// The findings, and then what becomes of the scene when unsupported things are replaced.
fn findings(path: &Path, options: &ReadOptions) -> String {
    let mut sources = SourceMap::default();
    let mut strict = Diagnostics::new(false);
    let scene = read(path, options, &mut sources, &mut strict, &mut LoadReport::default());
    assert_eq!(scene.is_none(), strict.has_errors(), "{}", path.display());
    let mut lenient = Diagnostics::new(true);
    let scene = read(path, options, &mut SourceMap::default(), &mut lenient, &mut LoadReport::default());
    assert_eq!(scene.is_none(), lenient.has_errors(), "{}", path.display());
    let outcome = if scene.is_some() { "a scene" } else { "no scene" };
    format!("{}with --lenient: {outcome}, {}\n", render(&strict, &sources, false), summary(&lenient))
}

#[test]
fn every_bad_scene_gets_its_findings() {
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(FOLDER).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_file()).collect();
    paths.sort();
    assert!(paths.len() >= 40);
    for path in paths {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let text = findings(&path, &ReadOptions::default());
        insta::assert_snapshot!(name, text);
    }
}

#[test]
fn unused_defines_are_named_with_what_the_scene_declares() {
    let define = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    let options =
        ReadOptions { defines: vec![define("radios", "3"), define("width", "5"), define("kind", "disk")] };
    let path = Path::new(FOLDER).join("define_undefined.xml");
    insta::assert_snapshot!("defines_unused", findings(&path, &options));
}

#[test]
fn a_missing_scene_is_a_finding() {
    insta::assert_snapshot!(
        "scene_missing",
        findings(Path::new("tests/nowhere.xml"), &ReadOptions::default())
    );
}
