//! A scene from wherever it is: a file of any known format, or built in.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use lichtweg::scene::description::{Description, Diagnostic, Diagnostics, SourceMap};

use crate::builtin::{self, BuiltinScene};
use crate::options::{LoadReport, ReadOptions};
use crate::{mitsuba, pbrt};

/// Where a scene is.
#[derive(Clone, Debug)]
pub enum SceneLocation {
    /// In a file, whose extension tells its format.
    File(PathBuf),
    /// In the program.
    Builtin(&'static BuiltinScene),
}

/// The formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Mitsuba,
    Pbrt,
}

/// The extensions of scenes, as messages name them.
const EXTENSIONS: &str = ".xml (Mitsuba), .pbrt or .pbrt.gz (pbrt-v4)";

impl SceneLocation {
    /// From what a user types: a path, or `builtin:NAME`.
    ///
    /// # Errors
    /// There is no built-in scene of that name; the message lists those there are.
    pub fn parse(text: &(impl AsRef<OsStr> + ?Sized)) -> Result<Self, String> {
        let text = text.as_ref();
        let Some(name) = text.to_str().filter(|text| text.starts_with(builtin::PREFIX)) else {
            return Ok(Self::File(text.into()));
        };
        builtin::find(name).map(Self::Builtin).ok_or_else(|| {
            let names: Vec<String> =
                builtin::SCENES.iter().map(|s| format!("{}{}", builtin::PREFIX, s.name)).collect();
            format!("there is no such scene; built in are {}", names.join(", "))
        })
    }

    /// What the user would call it.
    pub fn display(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Builtin(scene) => format!("{}{}", builtin::PREFIX, scene.name),
        }
    }
}

/// Reads a scene and all files it refers to.
///
/// Findings go to `diagnostics`, their places into `sources`. `None` where any of them is an error.
pub fn read_scene(
    location: &SceneLocation,
    options: &ReadOptions,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
    report: &mut LoadReport,
) -> Option<Description> {
    match location {
        SceneLocation::Builtin(scene) => scene.read(options, sources, diagnostics, report),
        SceneLocation::File(path) => {
            let format = match format(path) {
                Ok(format) => format,
                Err(diagnostic) => {
                    diagnostics.push(diagnostic);
                    return None;
                }
            };
            match format {
                Format::Mitsuba => mitsuba::read(path, options, sources, diagnostics, report),
                Format::Pbrt => pbrt::read(path, options, sources, diagnostics, report),
            }
        }
    }
}

/// The format that a file's extension names; the finding where it names none, or there is no such file.
fn format(path: &Path) -> Result<Format, Diagnostic> {
    let shown = path.display();
    if path.is_dir() {
        let diagnostic = Diagnostic::error("not-a-scene", format!("{shown} is a directory, not a scene"));
        return Err(diagnostic.help(scenes_in(path)));
    }
    let name = path.file_name().map(|n| n.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let format = if name.ends_with(".xml") {
        Format::Mitsuba
    } else if name.ends_with(".pbrt") || name.ends_with(".pbrt.gz") {
        Format::Pbrt
    } else {
        let diagnostic = Diagnostic::error("not-a-scene", format!("{shown} is no scene that can be read"));
        let help = match builtin::find(&name) {
            Some(scene) => {
                format!("the scene of this name that is built in is {}{}", builtin::PREFIX, scene.name)
            }
            None => format!("a scene is a file with the extension {EXTENSIONS}"),
        };
        return Err(diagnostic.help(help));
    };
    if !path.exists() {
        let diagnostic = Diagnostic::error("missing-file", format!("there is no file {shown}"));
        return Err(diagnostic.help("check its spelling, and the directory it is relative to"));
    }
    Ok(format)
}

/// Advice on a directory: the scenes in it.
fn scenes_in(directory: &Path) -> String {
    let entries = std::fs::read_dir(directory).into_iter().flatten().flatten();
    let mut scenes: Vec<String> = entries
        .map(|entry| entry.path())
        .filter(|path| path.is_file() && format(path).is_ok())
        .map(|path| path.display().to_string())
        .collect();
    scenes.sort();
    scenes.truncate(5);
    if scenes.is_empty() {
        format!("name a file with the extension {EXTENSIONS}")
    } else {
        format!("it holds {}", scenes.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(path: &str) -> String {
        let diagnostic = format(Path::new(path)).unwrap_err();
        format!("{} {}", diagnostic.message, diagnostic.help.join(" "))
    }

    #[test]
    fn says_what_is_no_scene() {
        assert!(finding("picture.png").contains(".xml (Mitsuba)"));
        assert!(finding("absent.xml").contains("there is no file absent.xml"));
        assert!(finding("/").contains("directory"));
    }

    #[test]
    fn builtin_scenes_are_found_by_name_only() {
        assert!(SceneLocation::parse("builtin:nothing").unwrap_err().contains("built in are"));
        assert!(matches!(SceneLocation::parse("x.xml"), Ok(SceneLocation::File(_))));
        for scene in builtin::SCENES {
            let location = SceneLocation::parse(&format!("builtin:{}", scene.name)).unwrap();
            assert_eq!(location.display(), format!("builtin:{}", scene.name));
        }
    }
}
