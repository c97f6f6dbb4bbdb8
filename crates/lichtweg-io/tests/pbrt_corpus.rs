//! What the pbrt reader says about bad files, one snapshot a file, and that it reads real scenes in silence.
//!
//! The files are in `tests/bad/pbrt`.

use std::path::{Path, PathBuf};

use lichtweg::scene::description::{Description, Diagnostics, Severity, SourceMap};
use lichtweg_io::diagnostics::render;
use lichtweg_io::options::{LoadReport, ReadOptions};
use lichtweg_io::pbrt;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn corpus() -> Vec<PathBuf> {
    let directory = repository().join("crates/lichtweg-io/tests/bad/pbrt");
    let mut files: Vec<PathBuf> = std::fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "pbrt"))
        .collect();
    files.sort();
    files
}

fn read(path: &Path, lenient: bool) -> (Option<Description>, Diagnostics, SourceMap) {
    let mut sources = SourceMap::default();
    let mut diagnostics = Diagnostics::new(lenient);
    let scene =
        pbrt::read(path, &ReadOptions::default(), &mut sources, &mut diagnostics, &mut LoadReport::default());
    (scene, diagnostics, sources)
}

/// The findings as the user sees them, without the place of the checkout.
fn rendered(path: &Path, lenient: bool) -> String {
    let (_, diagnostics, sources) = read(path, lenient);
    let directory = path.parent().unwrap().display().to_string();
    render(&diagnostics, &sources, false).replace(&format!("{directory}/"), "")
}

#[test]
fn findings_of_bad_files() {
    let files = corpus();
    assert!(files.len() >= 20);
    for path in files {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        insta::assert_snapshot!(format!("pbrt_{name}"), rendered(&path, false));
    }
}

#[test]
fn lenient_reading_names_the_substitutes() {
    let path = repository().join("crates/lichtweg-io/tests/bad/pbrt/unsupported.pbrt");
    insta::assert_snapshot!("pbrt_unsupported_lenient", rendered(&path, true));
    let (scene, diagnostics, _) = read(&path, true);
    assert!(scene.is_some_and(|s| s.shapes.len() == 2));
    assert!(!diagnostics.has_errors());
}

/// In lenient mode only what leaves no scene stays an error.
#[test]
fn lenient_reading_replaces_what_it_can() {
    let lost = ["missing-directive", "unreadable-file"];
    for path in corpus() {
        let (_, strict, _) = read(&path, false);
        let (_, lenient, _) = read(&path, true);
        assert_eq!(strict.list.len(), lenient.list.len(), "{}", path.display());
        for diagnostic in lenient.list.iter().filter(|d| d.severity == Severity::Error) {
            assert!(lost.contains(&diagnostic.code), "{}: {}", path.display(), diagnostic.message);
        }
    }
}

#[test]
fn a_scene_is_returned_exactly_without_errors() {
    for path in corpus() {
        for lenient in [false, true] {
            let (scene, diagnostics, _) = read(&path, lenient);
            assert_eq!(scene.is_some(), !diagnostics.has_errors(), "{}", path.display());
            assert!(!diagnostics.list.is_empty(), "{}", path.display());
        }
    }
}

#[test]
fn every_finding_has_a_place_in_its_file() {
    for path in corpus() {
        let (_, diagnostics, sources) = read(&path, false);
        for diagnostic in &diagnostics.list {
            let Some((span, _)) = &diagnostic.label else {
                assert!(
                    ["missing-directive", "unreadable-file"].contains(&diagnostic.code),
                    "{}: {}",
                    path.display(),
                    diagnostic.message
                );
                continue;
            };
            let text = &sources.file(span.file).text;
            assert!(text.get(span.start as usize..span.end as usize).is_some(), "{}", path.display());
        }
    }
}

/// The scenes are not part of the repository.
#[test]
fn real_scenes_have_no_findings() {
    for (scene, shapes) in [("cornell-box", 10), ("house", 270)] {
        let path = repository().join(format!("../shared/scenes/{scene}/scene-v4.pbrt"));
        if !path.exists() {
            eprintln!("skipped: {} is absent", path.display());
            continue;
        }
        let (description, diagnostics, sources) = read(&path, false);
        assert!(diagnostics.list.is_empty(), "{}", render(&diagnostics, &sources, false));
        assert!(diagnostics.list.iter().all(|d| d.severity != Severity::Error));
        assert_eq!(description.unwrap().shapes.len(), shapes);
    }
}
