//! Files that appear complete or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::ImageError;

/// Lets `write` fill a temporary file next to `path`, then renames it to `path`, which replaces what was there. On failure
/// the temporary is removed and `path` left as it was.
pub(super) fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), ImageError>,
) -> Result<(), ImageError> {
    let io_error = |error: io::Error| describe(&error, path);
    let temporary = Temporary(temporary_path(path));
    let file = OpenOptions::new().write(true).create_new(true).open(&temporary.0).map_err(io_error)?;
    let mut writer = BufWriter::with_capacity(1 << 20, file);
    write(&mut writer)?;
    writer.flush().map_err(io_error)?;
    // Where the disk is full some file systems say so only now.
    drop(writer.into_inner().map_err(|error| io_error(error.into_error()))?);
    fs::rename(&temporary.0, path).map_err(io_error)?;
    std::mem::forget(temporary);
    Ok(())
}

/// Removes its file when dropped.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        // It may never have been created; there is nothing to do about a failure here anyway.
        let _ = fs::remove_file(&self.0);
    }
}

/// A name in the same directory (renames do not cross file systems) that no other process or thread uses.
fn temporary_path(path: &Path) -> PathBuf {
    static COUNTER: AtomicU32 = AtomicU32::new(0);
    let unique = COUNTER.fetch_add(1, Ordering::Relaxed);
    path.with_file_name(format!(".lichtweg-{}-{unique}.tmp", std::process::id()))
}

fn describe(error: &io::Error, path: &Path) -> ImageError {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let directory_name = directory.display();
    let help = match error.kind() {
        ErrorKind::NotFound if !directory.exists() => format!("make the directory {directory_name} first"),
        ErrorKind::NotADirectory => format!("{directory_name} is no directory; choose another path"),
        ErrorKind::IsADirectory => "it is a directory; name a file in it".to_owned(),
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            format!("make the directory {directory_name} writable, or choose another")
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "free some space, or choose another disk".to_owned()
        }
        _ => "choose another path".to_owned(),
    };
    ImageError::new(format!("cannot be written: {error}"), help)
}
