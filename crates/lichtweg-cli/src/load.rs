//! Reading a scene, and keeping what was found on the way.

use std::path::{Path, PathBuf};

use clap::builder::{OsStringValueParser, TypedValueParser};
use lichtweg::scene::description::{Description, Diagnostics, SourceMap};
use lichtweg_io::options::{LoadReport, ReadOptions};
use lichtweg_io::scene_file::{SceneLocation, read_scene};
use sha2::{Digest, Sha256};

use crate::console::Console;
use crate::failure::Failure;

/// What is known of a scene besides its description.
#[derive(Debug)]
pub struct Loader {
    /// Where it is.
    pub location: SceneLocation,
    /// The text it was read from.
    pub sources: SourceMap,
    /// What was found.
    pub diagnostics: Diagnostics,
    /// What reading took.
    pub report: LoadReport,
    console: Console,
}

impl Loader {
    /// Nothing read yet.
    pub fn new(location: &SceneLocation, lenient: bool, console: Console) -> Self {
        Self {
            location: location.clone(),
            sources: SourceMap::default(),
            diagnostics: Diagnostics::new(lenient),
            report: LoadReport::default(),
            console,
        }
    }

    /// Reads the scene; `None`, with findings, where it cannot be rendered.
    pub fn read(&mut self, options: &ReadOptions) -> Option<Description> {
        let Self { location, sources, diagnostics, report, console } = self;
        console.stage(&format!("loading {}", location.display()), || {
            read_scene(location, options, sources, diagnostics, report)
        })
    }

    /// Shows all findings.
    pub fn show(&self) {
        self.console.show(&self.diagnostics, &self.sources);
    }

    /// Shows all findings, and fails.
    pub fn fail(&self) -> Failure {
        self.show();
        Failure::Quiet(1)
    }

    /// SHA-256 of the text of all its files, in the order they were read: for a scene of one file, what `sha256sum`
    /// says.
    pub fn hash(&self) -> String {
        let mut hash = Sha256::new();
        self.sources.files().iter().for_each(|file| hash.update(&file.text));
        let hex: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        format!("sha256:{hex}")
    }
}

/// Takes a scene from the command line.
pub fn location_parser() -> impl TypedValueParser<Value = SceneLocation> {
    OsStringValueParser::new().try_map(|text| SceneLocation::parse(&text))
}

/// The options of reading that subcommands share.
#[derive(Debug, clap::Args)]
pub struct ReadArgs {
    /// Set a parameter the scene declares with <default> (repeatable)
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = crate::options::parse_define)]
    defines: Vec<(String, String)>,
}

impl ReadArgs {
    /// For the readers.
    pub fn options(&self) -> ReadOptions {
        ReadOptions { defines: self.defines.clone() }
    }
}

/// A path as the user can find it from anywhere.
pub fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}
