//! Scenes that come with the program, by name: `builtin:cornell-box`.
//!
//! Most are the files of the folder `scenes`, which need no others, compiled in; [`street`] is generated.

pub mod street;

use std::path::Path;
use std::time::Instant;

use lichtweg::scene::description::{Description, Diagnostic, Diagnostics, SourceMap};

use crate::mitsuba;
use crate::options::{LoadReport, ReadOptions};

/// What stands before a name wherever a scene is asked for.
pub const PREFIX: &str = "builtin:";

/// A scene that comes with the program.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinScene {
    /// Its name, without [`PREFIX`].
    pub name: &'static str,
    /// What it shows, in one line.
    pub about: &'static str,
    source: Source,
}

/// Where a scene comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// Mitsuba XML.
    Xml(&'static str),
    /// The generator [`street`].
    Street,
}

/// A file of the folder `scenes`.
macro_rules! scene {
    ($name:literal, $about:literal) => {
        BuiltinScene {
            name: $name,
            about: $about,
            source: Source::Xml(include_str!(concat!("../../../../scenes/", $name, ".xml"))),
        }
    };
}

/// All of them; the first is the one to render where none is named.
pub const SCENES: &[BuiltinScene] = &[
    scene!("cornell-box", "two blocks in a box with a red and a green wall, from the measured data"),
    scene!("veach-mis", "four glossy plates reflect four lights: what multiple importance sampling is for"),
    BuiltinScene {
        name: "street",
        about: "a street of houses, trees and cars in a low sun; -D detail=4 has four times the faces",
        source: Source::Street,
    },
    scene!("lamp-room", "a room lit by two lamps whose bulbs are hidden, with caustics of glass"),
    scene!("door-ajar", "a room lit only through a door left ajar"),
    scene!("furnace", "a diffuse block in a glowing sphere: its radiance is known exactly"),
    scene!(
        "knife-edge",
        "the penumbra of a straight edge: the fraction of the light that is seen is known exactly"
    ),
];

/// The scene of a name, with or without [`PREFIX`].
pub fn find(name: &str) -> Option<&'static BuiltinScene> {
    let name = name.strip_prefix(PREFIX).unwrap_or(name);
    SCENES.iter().find(|scene| scene.name == name)
}

impl BuiltinScene {
    /// Its description; see [`read_scene`](crate::scene_file::read_scene).
    pub fn read(
        &self,
        options: &ReadOptions,
        sources: &mut SourceMap,
        diagnostics: &mut Diagnostics,
        report: &mut LoadReport,
    ) -> Option<Description> {
        let file = format!("{PREFIX}{}", self.name);
        let mut description = match self.source {
            Source::Xml(xml) => {
                mitsuba::read_str(Path::new(&file), xml, options, sources, diagnostics, report)?
            }
            Source::Street => {
                let start = Instant::now();
                let parameters = street_parameters(options, diagnostics)?;
                // What the scene is a function of stands for its text.
                sources.add(file, format!("{parameters:?}\n"));
                let description = street::describe(parameters);
                report.parse_seconds = start.elapsed().as_secs_f64();
                report.total_seconds = report.parse_seconds;
                description
            }
        };
        self.name.clone_into(&mut description.name);
        Some(description)
    }
}

/// The parameters given with `-D`; `None`, with findings, where one is wrong.
fn street_parameters(options: &ReadOptions, diagnostics: &mut Diagnostics) -> Option<street::Parameters> {
    let mut parameters = street::Parameters::default();
    let set = |(name, value): &(String, String)| parameters.set(name, value).err();
    let findings: Vec<Diagnostic> = options.defines.iter().filter_map(set).collect();
    let sound = findings.is_empty();
    diagnostics.list.extend(findings);
    sound.then_some(parameters)
}
