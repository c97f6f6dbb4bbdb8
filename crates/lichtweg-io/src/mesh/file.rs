//! Reading a whole file, with words for what can go wrong.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Larger files are refused before a byte is read.
const MAX_BYTES: u64 = 16 << 30;

/// The bytes of a regular file, or what was found instead and what to do about it. Devices and pipes, which may
/// never end, are refused.
pub(crate) fn read_regular_file(path: &Path) -> Result<Vec<u8>, (String, String)> {
    let describe = |error: std::io::Error| {
        let help = match error.kind() {
            ErrorKind::NotFound => {
                "check the name (letter case matters) and the directory it is looked for in".to_owned()
            }
            ErrorKind::PermissionDenied => "make the file readable".to_owned(),
            _ => "check the path and the disk it is on".to_owned(),
        };
        (error.to_string(), help)
    };
    let metadata = fs::metadata(path).map_err(describe)?;
    if metadata.is_dir() {
        return Err(("a directory".to_owned(), "name a file in it".to_owned()));
    }
    if !metadata.is_file() {
        return Err(("a device or a pipe".to_owned(), "copy its contents to a file first".to_owned()));
    }
    if metadata.len() > MAX_BYTES {
        return Err((format!("{} bytes", metadata.len()), "split the file; 16 GiB are the most".to_owned()));
    }
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(metadata.len() as usize + 1)
        .map_err(|_| (format!("{} bytes", metadata.len()), "free some memory".to_owned()))?;
    File::open(path).and_then(|file| file.take(MAX_BYTES).read_to_end(&mut bytes)).map_err(describe)?;
    Ok(bytes)
}
