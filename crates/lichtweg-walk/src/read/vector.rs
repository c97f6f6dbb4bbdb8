//! Vectors as plain text: numbers separated by white space, commas or semicolons; `#` and `%` begin comments.

use std::path::Path;

use super::lines::{Lines, number};
use super::{ReadError, market};

/// Reads a vector from memory, plain or Matrix Market; `name` stands for it in errors.
///
/// # Errors
/// A word is not a finite number, or the Matrix Market file is not a vector.
pub fn parse_vector(name: &str, bytes: &[u8]) -> Result<Vec<f64>, ReadError> {
    let mut lines = Lines::new(Path::new(name), bytes)?;
    if lines.is_market()? { market::vector(lines) } else { numbers(lines) }
}

pub(super) fn numbers(mut lines: Lines<'_>) -> Result<Vec<f64>, ReadError> {
    let mut vector = Vec::new();
    while let Some(line) = lines.next()? {
        let text = line.split(|byte| matches!(byte, b'#' | b'%')).next().unwrap_or_default();
        let words = text.split(|byte| byte.is_ascii_whitespace() || matches!(byte, b',' | b';'));
        let parsed: Result<Vec<f64>, String> = words.filter(|word| !word.is_empty()).map(number).collect();
        match parsed {
            Ok(values) => vector.extend(values),
            Err(message) => return Err(lines.error(message)),
        }
    }
    Ok(vector)
}
