//! Reading pbrt scenes that are written in tests.

use std::path::Path;

use lichtweg::scene::description::{Description, Diagnostics, Severity, SourceMap};
use lichtweg_io::diagnostics::render;
use lichtweg_io::options::{LoadReport, ReadOptions};
use lichtweg_io::pbrt;

/// Reads options and a world whose files are in a directory; panics where there are errors.
pub fn read_any(directory: &Path, options: &str, world: &str) -> (Description, Diagnostics) {
    let mut sources = SourceMap::default();
    let mut diagnostics = Diagnostics::new(false);
    let scene = pbrt::read_str(
        &format!("{options}\nWorldBegin\n{world}"),
        "a.pbrt",
        directory,
        &ReadOptions::default(),
        &mut sources,
        &mut diagnostics,
        &mut LoadReport::default(),
    );
    let scene = scene.unwrap_or_else(|| panic!("{}", render(&diagnostics, &sources, false)));
    (scene, diagnostics)
}

/// The same; panics where there are findings other than notes.
pub fn read_silently(directory: &Path, options: &str, world: &str) -> Description {
    let (scene, diagnostics) = read_any(directory, options, world);
    let silent = diagnostics.list.iter().all(|d| d.severity == Severity::Note);
    assert!(silent, "{:#?}", diagnostics.list);
    scene
}
