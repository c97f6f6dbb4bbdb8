//! Text line by line, decompressed where it begins like a gzip file.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use flate2::bufread::MultiGzDecoder;

use super::ReadError;

/// Longest line. Nobody writes one by hand, and a file without line ends must not fill the memory.
const LONGEST: u64 = 1 << 26;

/// The lines of a text, counted.
pub(super) struct Lines<'a> {
    path: PathBuf,
    reader: Box<dyn BufRead + 'a>,
    buffer: Vec<u8>,
    number: u64,
    /// The line in the buffer has been looked at, but not been taken.
    peeked: bool,
}

impl Lines<'static> {
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let failed = |source| ReadError::Io { path: path.to_owned(), source };
        let file = File::open(path).map_err(failed)?;
        Self::new(path, BufReader::with_capacity(1 << 16, file))
    }
}

impl<'a> Lines<'a> {
    /// Of a text that is known by the name `path` in errors.
    pub fn new(path: &Path, mut text: impl BufRead + 'a) -> Result<Self, ReadError> {
        let start = text.fill_buf().map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
        let reader: Box<dyn BufRead + 'a> = if start.starts_with(&[0x1f, 0x8b]) {
            Box::new(BufReader::with_capacity(1 << 16, MultiGzDecoder::new(text)))
        } else {
            Box::new(text)
        };
        Ok(Self { path: path.to_owned(), reader, buffer: Vec::new(), number: 0, peeked: false })
    }

    /// The next line without white space around it; `None` at the end.
    pub fn next(&mut self) -> Result<Option<&[u8]>, ReadError> {
        if !std::mem::take(&mut self.peeked) && !self.fill()? {
            return Ok(None);
        }
        Ok(Some(self.buffer.trim_ascii()))
    }

    /// Whether the first line is that of a Matrix Market file. To be asked before any line is taken.
    pub fn is_market(&mut self) -> Result<bool, ReadError> {
        self.peeked = self.fill()?;
        Ok(self.peeked
            && self.buffer.len() >= 14
            && self.buffer[..14].eq_ignore_ascii_case(b"%%MatrixMarket"))
    }

    /// Reads a line into the buffer; false at the end.
    fn fill(&mut self) -> Result<bool, ReadError> {
        self.buffer.clear();
        let read = self.reader.by_ref().take(LONGEST).read_until(b'\n', &mut self.buffer);
        let read = read.map_err(|source| ReadError::Io { path: self.path.clone(), source })?;
        self.number += u64::from(read > 0);
        if read as u64 == LONGEST {
            return Err(self.error("the line is longer than 64 MiB"));
        }
        Ok(read > 0)
    }

    /// An error in the line taken last.
    pub fn error(&self, message: impl Into<String>) -> ReadError {
        ReadError::Syntax { path: self.path.clone(), line: self.number.max(1), message: message.into() }
    }
}

/// Words between white space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|byte| byte.is_ascii_whitespace()).filter(|word| !word.is_empty())
}

/// A number of a file as it may be told in an error.
pub(super) fn shown(word: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(word).chars().take(40).collect();
    format!("\"{}\"", text.escape_debug())
}

/// A finite number.
pub(super) fn number(word: &[u8]) -> Result<f64, String> {
    match fast_float2::parse::<f64, _>(word) {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("{} is not finite", shown(word))),
        Err(_) => Err(format!("{} is not a number", shown(word))),
    }
}

/// A whole number from 0.
pub(super) fn whole(word: &[u8]) -> Result<u64, String> {
    let digits = word.strip_prefix(b"+").unwrap_or(word);
    let value = digits.iter().try_fold(0_u64, |value, byte| {
        byte.is_ascii_digit().then(|| value.checked_mul(10)?.checked_add(u64::from(byte - b'0')))?
    });
    value.filter(|_| !digits.is_empty()).ok_or_else(|| format!("{} is not a whole number", shown(word)))
}
