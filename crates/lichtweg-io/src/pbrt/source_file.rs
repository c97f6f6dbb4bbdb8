//! Files of text and bytes, plain or packed with gzip.

use std::io::Read;
use std::path::Path;

use crate::mesh::read_regular_file;

/// Spans count bytes in 32 bits.
const MOST_BYTES: u64 = u32::MAX as u64;

/// The text of a file, unpacked if its name ends in `.gz`, and whether it was UTF-8.
pub(super) fn read_text(path: &Path) -> Result<(String, bool), String> {
    let bytes = read_bytes(path, MOST_BYTES)?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err("the file is encoded as UTF-16; convert it to UTF-8".to_owned());
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok((text, true)),
        Err(error) => {
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            if text.len() as u64 > MOST_BYTES { Err("too large".to_owned()) } else { Ok((text, false)) }
        }
    }
}

/// Unpacks a gzip file of at most `most` bytes.
fn unpack(bytes: &[u8], most: u64) -> Result<Vec<u8>, String> {
    let mut out = Vec::new();
    let mut reader = flate2::read::MultiGzDecoder::new(bytes).take(most + 1);
    reader.read_to_end(&mut out).map_err(|e| format!("not a whole gzip file ({e})"))?;
    if out.len() as u64 > most {
        return Err(format!("more than {most} bytes when unpacked"));
    }
    Ok(out)
}

/// The bytes of a file of at most `most`, unpacked if its name ends in `.gz`.
pub(super) fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    let bytes = read_regular_file(path).map_err(|(found, help)| format!("{found}; {help}"))?;
    if has_extension(path, "gz") {
        return unpack(&bytes, most);
    }
    if bytes.len() as u64 > most { Err(format!("larger than {most} bytes")) } else { Ok(bytes) }
}

/// Whether a file's name ends in an extension, of any letter case.
pub(super) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}
