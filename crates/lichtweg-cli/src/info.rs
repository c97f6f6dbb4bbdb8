//! `lichtweg info`: what is in a scene, and what is not supported of it.

mod inventory;

use std::io::Write;

use clap::Args;
use lichtweg::render::{Job, LayerSelection};
use lichtweg::scene::Scene;
use lichtweg::scene::description::{Description, Severity};
use lichtweg_io::scene_file::SceneLocation;
use serde_json::{Value, json};

use crate::console::Console;
use crate::failure::Failure;
use crate::load::{Loader, ReadArgs, location_parser};
use inventory::Inventory;

const EXAMPLES: &str = "\
Examples:
  lichtweg info scene.xml                what is in it, and all that is not supported
  lichtweg info scene.pbrt --json        for programs
  lichtweg info builtin:cornell-box";

/// Tell what is in a scene, and what is not supported
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct InfoArgs {
    /// Scene file (.xml, .pbrt, .pbrt.gz) or builtin:NAME
    #[arg(value_parser = location_parser())]
    scene: SceneLocation,

    #[command(flatten)]
    read: ReadArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Tells it. A scene that cannot be read even leniently is a failure; one that is not supported in full is not.
pub fn run(args: &InfoArgs) -> Result<(), Failure> {
    let console = Console::Quiet;
    let (mut loader, mut description) = read(args, false, console);
    let strict = description.is_some();
    if !strict {
        (loader, description) = read(args, true, console);
    }
    let compiled = description.as_ref().map(|description| {
        let _ = Job::compile(description, LayerSelection::default(), None, &mut loader.diagnostics);
        Scene::compile(description, &mut loader.diagnostics)
    });
    let Some(description) = description else { return Err(loader.fail()) };
    let scene = compiled.flatten();
    let verdict = verdict(strict, loader.diagnostics.has_errors());
    let inventory = Inventory::new(&description, scene.as_ref());
    let mut out = std::io::stdout().lock();
    if args.json {
        let mut json = inventory.json();
        json["scene"] =
            json!({ "path": loader.location.display(), "name": description.name, "hash": loader.hash() });
        json["seconds"] = json!({
            "load": loader.report.total_seconds,
            "load_parse": loader.report.parse_seconds,
            "load_meshes": loader.report.mesh_seconds,
            "load_images": loader.report.image_seconds,
        });
        json["verdict"] = json!(verdict);
        json["diagnostics"] = findings(&loader);
        writeln!(out, "{json:#}")?;
    } else {
        writeln!(out, "{} ({})", description.name, loader.location.display())?;
        for (key, value) in inventory.lines() {
            writeln!(out, "  {key:12}{value}")?;
        }
        writeln!(out, "  {:12}{verdict}", "verdict")?;
        out.flush()?;
        loader.show();
    }
    if loader.diagnostics.has_errors() { Err(Failure::Quiet(1)) } else { Ok(()) }
}

fn read(args: &InfoArgs, lenient: bool, console: Console) -> (Loader, Option<Description>) {
    let mut loader = Loader::new(&args.scene, lenient, console);
    let description = loader.read(&args.read.options());
    (loader, description)
}

fn verdict(strict: bool, has_errors: bool) -> &'static str {
    match (strict, has_errors) {
        (_, true) => "does not render",
        (true, false) => "renders",
        (false, false) => "renders with --lenient only",
    }
}

/// All findings as JSON, with file and line (from 1) where they have a place.
fn findings(loader: &Loader) -> Value {
    let finding = |d: &lichtweg::scene::description::Diagnostic| {
        let place = d.label.as_ref().and_then(|(span, _)| {
            let file = loader.sources.files().get(span.file as usize)?;
            let before = file.text.as_bytes().get(..span.start as usize)?;
            let line = (!file.text.is_empty()).then(|| 1 + before.iter().filter(|&&b| b == b'\n').count());
            Some(json!({ "file": file.path.display().to_string(), "line": line }))
        });
        json!({
            "severity": match d.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Note => "note",
            },
            "code": d.code,
            "message": d.message,
            "place": place,
            "help": d.help,
        })
    };
    loader.diagnostics.list.iter().map(finding).collect()
}
