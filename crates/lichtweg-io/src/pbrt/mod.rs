//! Scenes of pbrt-v4 (`.pbrt`), as pbrt.org/fileformat-v4 and pbrt's own source describe them.
//!
//! Reading goes in two steps. The parser obeys the directives and collects what they state, with its place in the
//! source; files are then loaded in parallel, and the builder turns the statements into a [`Description`]. Both report
//! what they do not know, all of it in one run.
//!
//! **Conventions.** pbrt's camera looks along +z with +x to the *right* of the image, the description's has +x to the
//! left: the camera's transform is followed by a mirror. World coordinates are taken over as they are. pbrt flips
//! the normal of a shape under a mirroring transform because it takes cross products in the world; the description
//! keeps the outside, so `ReverseOrientation` alone flips.
//!
//! **Light.** pbrt divides each emission by its own luminance (for `rgb`, by that of the illuminant of its colour
//! space) and its default sensor multiplies by exposure time x ISO / 100. So `rgb` values are radiances as they stand,
//! black bodies and sampled spectra have the luminance `scale`.
//!
//! Limits: see the messages; no media, no hair, no subdivision.

mod blocks;
mod build;
mod camera;
mod color_space;
mod directives;
mod files;
mod film;
mod light;
mod material;
mod named_spectra;
mod octahedral;
mod params;
mod parser;
mod report;
mod sampling;
mod settings;
mod shape;
mod source_file;
mod spectrum;
mod state;
mod texture;
mod token;
mod transform;
mod values;
mod winding;

use std::path::Path;
use std::time::Instant;

use lichtweg::scene::description::{Description, Diagnostic, Diagnostics, SourceMap};

use crate::options::{LoadReport, ReadOptions};
use parser::Parser;
use report::Report;

/// Reads a scene file and all that it includes.
///
/// Returns `None` where `diagnostics` gained an error. pbrt files have no variables, so that a definition among the
/// `options` is itself reported.
pub fn read(
    path: &Path,
    options: &ReadOptions,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
    load: &mut LoadReport,
) -> Option<Description> {
    let directory = path.parent().unwrap_or(Path::new(""));
    let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let name = name.strip_suffix(".pbrt").unwrap_or(name);
    run(name, directory, options, sources, diagnostics, load, |parser| parser.parse_path(path, None))
}

/// Reads a scene from text. Files that it names are looked for relative to `directory`; `name` stands for its path in
/// messages, and names the scene.
pub fn read_str(
    text: &str,
    name: &str,
    directory: &Path,
    options: &ReadOptions,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
    load: &mut LoadReport,
) -> Option<Description> {
    let scene = name.strip_suffix(".pbrt").unwrap_or(name);
    run(scene, directory, options, sources, diagnostics, load, |parser| {
        let file = parser.sources.add(name, text);
        parser.parse_source(file);
    })
}

fn run(
    name: &str,
    directory: &Path,
    options: &ReadOptions,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
    load: &mut LoadReport,
    parse: impl FnOnce(&mut Parser),
) -> Option<Description> {
    let start = Instant::now();
    let before = diagnostics.list.len();
    let mut report = Report::new(diagnostics);
    for (key, _) in &options.defines {
        let text = format!("pbrt scenes have no variables, so \"{key}\" cannot be defined");
        report.push(Diagnostic::error("unknown-definition", text));
    }
    let directory = directory.to_owned();
    let mut parser = Parser::new(sources, report, directory.clone());
    parse(&mut parser);
    let (statements, report) = parser.finish();
    let files_start = Instant::now();
    let files = build::load_files(&statements, &directory, load);
    let files_seconds = files_start.elapsed().as_secs_f64();
    let scene = build::build(statements, name.to_owned(), directory, files, report);
    load.total_seconds = start.elapsed().as_secs_f64();
    load.parse_seconds = load.total_seconds - files_seconds;
    let failed = diagnostics.list[before..]
        .iter()
        .any(|d| d.severity == lichtweg::scene::description::Severity::Error);
    (!failed).then_some(scene)
}
