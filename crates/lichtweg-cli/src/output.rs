//! Where pictures go: checked before a render, and written after it whatever happens.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use lichtweg_io::image::{OutputImage, ToneMap, write_image};

use crate::console::{Console, tell};
use crate::failure::Failure;
use crate::load::absolute;

/// What the image writer puts into the header of its EXR files.
const SOFTWARE: &[u8] = b"Lichtweg";

/// The files of a render.
#[derive(Debug)]
pub struct Outputs {
    images: Vec<PathBuf>,
    statistics: Option<PathBuf>,
}

impl Outputs {
    /// Those that were asked for; refused where they cannot be written.
    pub fn new(images: &[PathBuf], statistics: Option<&Path>) -> Result<Self, Failure> {
        let mut unique: Vec<PathBuf> = Vec::new();
        for path in images {
            if !unique.contains(path) {
                unique.push(path.clone());
            }
        }
        for path in unique.iter().map(PathBuf::as_path).chain(statistics) {
            check_writable(path)?;
        }
        Ok(Self { images: unique, statistics: statistics.map(Path::to_owned) })
    }

    /// Completes them with NAME.exr and NAME.png in the current directory where none was asked for.
    pub fn complete(&mut self, name: &str) -> Result<(), Failure> {
        if self.images.is_empty() {
            self.images = default_names(name);
            self.images.iter().try_for_each(|path| check_writable(path))?;
        }
        Ok(())
    }

    /// Writes the image to all its files. One that cannot be written is tried in the current and in the temporary
    /// directory, so that no picture is lost. Returns what was written, and whether all went where it should.
    pub fn save(&self, image: &OutputImage, tone_map: &ToneMap, console: Console) -> (Vec<PathBuf>, bool) {
        let mut written = Vec::new();
        let mut all_well = true;
        for path in &self.images {
            let Err(error) = write_image(path, image, tone_map) else {
                console.say(&format!("wrote {}", absolute(path).display()));
                written.push(absolute(path));
                continue;
            };
            all_well = false;
            tell(format_args!("error: {error}\n = help: {}", error.help));
            match rescue(path, |path| write_image(path, image, tone_map).is_ok()) {
                Some(path) => {
                    tell(format_args!("the picture is in {} instead", path.display()));
                    written.push(path);
                }
                None => tell("error: nor could it be written to the current or the temporary directory"),
            }
        }
        (written, all_well)
    }

    /// Writes the statistics, if they were asked for; whether that went well.
    pub fn save_statistics(&self, json: &serde_json::Value) -> bool {
        let Some(path) = &self.statistics else { return true };
        let temporary = path.with_file_name(format!(".lichtweg-{}-stats.tmp", std::process::id()));
        let result = fs::write(&temporary, format!("{json:#}\n")).and_then(|()| fs::rename(&temporary, path));
        if let Err(error) = &result {
            // It may never have been created.
            let _ = fs::remove_file(&temporary);
            tell(format_args!("error: {} cannot be written: {error}", path.display()));
        }
        result.is_ok()
    }
}

/// `NAME.exr` and `NAME.png`, or with `-render`, `-render-2`, ... after the name where a file of these names is there that
/// is not from an earlier render: it may be a texture of the scene.
fn default_names(name: &str) -> Vec<PathBuf> {
    let name = if name.is_empty() { "image" } else { name };
    let names = |stem: &str| ["exr", "png"].map(|extension| PathBuf::from(format!("{stem}.{extension}")));
    let free = |[exr, png]: &[PathBuf; 2]| if exr.exists() { is_own(exr) } else { !png.exists() };
    let numbered = (2..).map(|i| format!("{name}-render-{i}"));
    let stems = [name.to_owned(), format!("{name}-render")].into_iter().chain(numbered);
    stems.map(|stem| names(&stem)).find(free).map(Vec::from).unwrap_or_default()
}

/// Whether an EXR file says that it comes from here.
fn is_own(exr: &Path) -> bool {
    const HEADER_BYTES: u64 = 1 << 16;
    let mut header = Vec::new();
    let read = File::open(exr).and_then(|file| file.take(HEADER_BYTES).read_to_end(&mut header));
    read.is_ok() && header.windows(SOFTWARE.len()).any(|bytes| bytes == SOFTWARE)
}

/// Tries a file's name in the current and in the temporary directory, overwriting nothing; the path that worked.
fn rescue(path: &Path, write: impl Fn(&Path) -> bool) -> Option<PathBuf> {
    let name = path.file_name()?;
    let directories = [std::env::current_dir().ok(), Some(std::env::temp_dir())];
    directories.into_iter().flatten().find_map(|directory| {
        let mut candidate = directory.join(name);
        if candidate.exists() {
            let unique = format!("lichtweg-{}-{}", std::process::id(), name.to_string_lossy());
            candidate = directory.join(unique);
        }
        write(&candidate).then_some(candidate)
    })
}

/// Fails where a file cannot be written, by writing another one next to it.
fn check_writable(path: &Path) -> Result<(), Failure> {
    let shown = path.display();
    if path.is_dir() {
        return Err(Failure::Failed(format!("{shown} is a directory; name a file in it")));
    }
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let directory = parent.display();
    if !parent.exists() {
        let message = format!("{shown} cannot be written: there is no directory {directory}; make it first");
        return Err(Failure::Failed(message));
    }
    if !parent.is_dir() {
        let message = format!("{shown} cannot be written: {directory} is no directory; choose another path");
        return Err(Failure::Failed(message));
    }
    let probe = path.with_file_name(format!(".lichtweg-{}-probe.tmp", std::process::id()));
    match OpenOptions::new().write(true).create_new(true).open(&probe) {
        Ok(_) => {
            // What cannot be removed again is empty, and hidden.
            let _ = fs::remove_file(&probe);
            Ok(())
        }
        Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(()),
        Err(error) => Err(Failure::Failed(format!(
            "{shown} cannot be written: {error}; make the directory {directory} writable, or name another with -o"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rescue_goes_on_to_the_next_directory_and_overwrites_nothing() {
        let temporary = std::env::temp_dir();
        let picture = format!("picture-{}.exr", std::process::id());
        let path = Path::new("/nowhere").join(&picture);
        let rescued = rescue(&path, |path| path.parent() == Some(&temporary));
        assert_eq!(rescued, Some(temporary.join(&picture)));
        assert_eq!(rescue(Path::new("/nowhere/picture.exr"), |_| false), None);
        // Tests run in the package's directory.
        let kept = rescue(Path::new("/nowhere/Cargo.toml"), |_| true).unwrap();
        assert_ne!(kept.file_name().unwrap(), "Cargo.toml");
    }
}
