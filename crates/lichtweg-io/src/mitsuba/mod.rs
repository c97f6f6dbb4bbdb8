//! Mitsuba's XML scenes: version 3, and the spellings of 0.4 to 0.6.
//!
//! Three steps, each in small files: XML to objects with typed parameters (`walk`, `include`, `transform`, `color`),
//! references to what they refer to (`resolve`), and every family of objects into its part of the neutral
//! [`Description`] (`scene`, `sensor`, `shape`, `material`, ...). Meshes and images are only noted on the way, and read at
//! the end in parallel, each file once (`assets`).
//!
//! The language and all default values are those of Mitsuba 3.9 (<https://mitsuba.readthedocs.io>, and its sources, where
//! every plugin is one file). What is unknown or unsupported is a finding with its place in the file; all of them are
//! gathered in one run.
//!
//! Limits: participating media, animated emitters, and textures on spot lights are not supported.

mod assets;
mod color;
mod curve;
mod definitions;
mod element;
mod emitter;
mod film;
mod include;
mod integrator;
mod ior;
mod legacy;
mod material;
mod mesh_shape;
mod microfacet;
mod number;
mod quadric;
mod query;
mod resolve;
mod sampler;
mod scene;
mod sensor;
mod shape;
mod spectrum;
mod suggest;
mod texture;
mod transform;
mod translate;
mod tree;
mod walk;

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use lichtweg::scene::description::{Description, Diagnostic, Diagnostics, Severity, SourceMap, Span};

use crate::options::{LoadReport, ReadOptions};
use definitions::Definitions;
use translate::Translator;
use tree::{Class, ObjectId, Tree};
use walk::Walk;

/// Reads a scene file and all files it refers to.
///
/// Findings go to `diagnostics`, their places into `sources`. `None` where any of them is an error; with
/// [`Diagnostics::lenient`], unsupported things are replaced and are no errors.
pub fn read(
    path: &Path,
    options: &ReadOptions,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
    report: &mut LoadReport,
) -> Option<Description> {
    load(path, |walk| walk.read_file(path, None, ObjectId::SCENE, 0), options, sources, diagnostics, report)
}

/// Reads a scene from its text. `name` stands for the file's path in messages, and files are looked for in its folder.
///
/// Otherwise as [`read`].
pub fn read_str(
    name: &Path,
    text: &str,
    options: &ReadOptions,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
    report: &mut LoadReport,
) -> Option<Description> {
    let walk = |walk: &mut Walk<'_>| walk.read_text(name, text.to_owned(), ObjectId::SCENE, 0);
    load(name, walk, options, sources, diagnostics, report)
}

fn load(
    path: &Path,
    read: impl FnOnce(&mut Walk<'_>),
    options: &ReadOptions,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
    report: &mut LoadReport,
) -> Option<Description> {
    let start = Instant::now();
    let findings_before = diagnostics.list.len();
    let Some(tree) = read_tree(read, options, sources, diagnostics) else {
        report.parse_seconds = start.elapsed().as_secs_f64();
        report.total_seconds = report.parse_seconds;
        return None;
    };
    let mut translator = Translator::new(&tree, diagnostics);
    translator.scene();
    let (mut description, assets) = translator.finish();
    description.name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    report.parse_seconds = start.elapsed().as_secs_f64();
    assets.load(&mut description, diagnostics, report);
    report.total_seconds = start.elapsed().as_secs_f64();
    // Findings come from several passes; readers go through their file from top to bottom.
    diagnostics.list[findings_before..]
        .sort_by_key(|d| d.label.as_ref().map(|(span, _)| (span.file, span.start, span.end)));
    let failed = diagnostics.list[findings_before..].iter().any(|d| d.severity == Severity::Error);
    (!failed).then_some(description)
}

/// The objects of a scene; `None` where a file of it cannot be read or is no XML, so that nothing said about the rest would
/// be to the point.
fn read_tree(
    read: impl FnOnce(&mut Walk<'_>),
    options: &ReadOptions,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
) -> Option<Tree> {
    let mut walk = Walk {
        sources,
        diagnostics,
        definitions: Definitions::new(&options.defines),
        tree: Tree::default(),
        aliases: Vec::new(),
        broken: false,
        open_files: Vec::new(),
        files_read: 0,
        file: 0,
        legacy: false,
        search: Arc::default(),
    };
    walk.add_object(Class::Scene, "scene".to_owned(), Span::default(), Span::default(), None);
    read(&mut walk);
    if !walk.broken {
        walk.report_unused_definitions();
        walk.resolve();
    }
    let Walk { tree, broken, .. } = walk;
    (!broken).then_some(tree)
}

impl Walk<'_> {
    /// A value given for a parameter that nothing uses is most likely a misspelt name.
    fn report_unused_definitions(&mut self) {
        let declared = self.definitions.declared();
        let report = |d: &definitions::Definition| {
            if let Some(span) = d.declared {
                let message = format!("the parameter \"{}\" is declared, but nothing uses it", d.name);
                return Diagnostic::error("unused-define", message).at(span, "given by -D");
            }
            let message = format!("-D {}={}: the scene has no such parameter", d.name, d.value);
            let mut diagnostic = Diagnostic::error("unused-define", message);
            let hint = suggest::hint(&d.name, "it declares", &declared);
            diagnostic.help.push(hint.unwrap_or_else(|| "it declares none".to_owned()));
            diagnostic
        };
        let found: Vec<Diagnostic> = self.definitions.unused().map(report).collect();
        self.diagnostics.list.extend(found);
    }
}
