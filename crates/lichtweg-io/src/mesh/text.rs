//! A cursor over the bytes of a text file: numbers, words and line numbers.

use super::{MeshError, Place};

/// Reads forward through `bytes`, counting lines. A `\r\n`, a `\n` and a lone `\r` each end a line.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    position: usize,
    line: u64,
}

impl<'a> Cursor<'a> {
    /// At the first byte, in line `line`.
    pub fn new(bytes: &'a [u8], line: u64) -> Self {
        Self { bytes, position: 0, line }
    }

    /// The current line, from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// How many bytes are left.
    pub fn remaining(&self) -> usize {
        self.bytes.len() - self.position
    }

    /// Whether nothing is left.
    pub fn at_end(&self) -> bool {
        self.remaining() == 0
    }

    #[inline]
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.position).copied()
    }

    /// Skips blanks within a line, and line ends that a backslash takes back.
    #[inline]
    pub fn skip_blanks(&mut self) {
        while let Some(byte) = self.peek() {
            match byte {
                b' ' | b'\t' => self.position += 1,
                b'\\' if self.line_end_at(self.position + 1) > 0 => {
                    self.position += 1 + self.line_end_at(self.position + 1);
                    self.line += 1;
                }
                _ => break,
            }
        }
    }

    /// Skips blanks and line ends.
    #[inline]
    pub fn skip_whitespace(&mut self) {
        while let Some(byte) = self.peek() {
            match byte {
                b' ' | b'\t' => self.position += 1,
                b'\n' | b'\r' => {
                    self.position += self.line_end_at(self.position);
                    self.line += 1;
                }
                _ => break,
            }
        }
    }

    /// Whether the line is over, but for a comment. Call after skipping blanks.
    #[inline]
    pub fn at_line_end(&self) -> bool {
        matches!(self.peek(), None | Some(b'\n' | b'\r' | b'#'))
    }

    /// Whether the current word is over.
    #[inline]
    pub fn at_word_end(&self) -> bool {
        self.is_delimiter(self.position)
    }

    /// Goes to the start of the next line, minding continuations, except in a comment: one may end in a Windows path.
    pub fn next_line(&mut self) {
        let mut in_comment = false;
        while let Some(byte) = self.peek() {
            match byte {
                b'\n' | b'\r' => {
                    self.position += self.line_end_at(self.position);
                    self.line += 1;
                    return;
                }
                b'#' => {
                    in_comment = true;
                    self.position += 1;
                }
                b'\\' if !in_comment => {
                    let length = self.line_end_at(self.position + 1);
                    self.position += 1 + length;
                    self.line += u64::from(length > 0);
                }
                _ => self.position += 1,
            }
        }
    }

    /// The bytes up to the next blank or line end; does not skip blanks first.
    #[inline]
    pub fn word(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.position..];
        let ends = |&byte: &u8| matches!(byte, b' ' | b'\t' | b'\n' | b'\r');
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        self.position += length;
        &rest[..length]
    }

    /// Takes this byte if it is the next.
    #[inline]
    pub fn take(&mut self, byte: u8) -> bool {
        let is_next = self.peek() == Some(byte);
        self.position += usize::from(is_next);
        is_next
    }

    /// A decimal number right here, followed by a blank, a line end or a comment.
    #[inline]
    pub fn float(&mut self) -> Result<f32, MeshError> {
        match fast_float2::parse_partial::<f32, _>(&self.bytes[self.position..]) {
            Ok((value, length)) if self.is_delimiter(self.position + length) => {
                self.position += length;
                Ok(value)
            }
            _ => Err(self.expected("a number")),
        }
    }

    /// As [`Cursor::float`], in double precision.
    #[inline]
    pub fn double(&mut self) -> Result<f64, MeshError> {
        match fast_float2::parse_partial::<f64, _>(&self.bytes[self.position..]) {
            Ok((value, length)) if self.is_delimiter(self.position + length) => {
                self.position += length;
                Ok(value)
            }
            _ => Err(self.expected("a number")),
        }
    }

    /// A whole number right here, whatever follows; numbers too large for 64 bits saturate.
    #[inline]
    pub fn integer(&mut self) -> Option<i64> {
        let start = self.position;
        let negative = self.take(b'-');
        if !negative {
            self.take(b'+');
        }
        let digits = self.position;
        let mut value = 0_i64;
        while let Some(digit) = self.peek().map(|byte| byte.wrapping_sub(b'0')).filter(|&d| d < 10) {
            value = value.saturating_mul(10).saturating_add(i64::from(digit));
            self.position += 1;
        }
        if self.position == digits {
            self.position = start;
            return None;
        }
        Some(if negative { -value } else { value })
    }

    /// The error that something else stands here.
    #[cold]
    pub fn expected(&self, what: &str) -> MeshError {
        let word = Cursor { bytes: self.bytes, position: self.position, line: 0 }.word();
        let found = match (word, self.peek()) {
            (_, None) => "the end of the file".to_owned(),
            ([], _) => "the end of the line".to_owned(),
            (word, _) => quote(word),
        };
        let help = if self.at_end() { "the file is truncated; export it again" } else { "correct this line" };
        MeshError::new(Place::Line(self.line), what, found, help)
    }

    #[inline]
    fn is_delimiter(&self, position: usize) -> bool {
        matches!(self.bytes.get(position), None | Some(b' ' | b'\t' | b'\n' | b'\r' | b'#' | b'\\'))
    }

    /// Length of the line end at a position: 0 if there is none.
    #[inline]
    fn line_end_at(&self, position: usize) -> usize {
        match (self.bytes.get(position), self.bytes.get(position + 1)) {
            (Some(b'\r'), Some(b'\n')) => 2,
            (Some(b'\r' | b'\n'), _) => 1,
            _ => 0,
        }
    }
}

/// A word of a file, made fit for a message.
pub(super) fn quote(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let shown = String::from_utf8_lossy(&word[..word.len().min(LONGEST)]);
    let dots = if word.len() > LONGEST { "…" } else { "" };
    format!("\"{}{dots}\"", shown.escape_debug())
}
