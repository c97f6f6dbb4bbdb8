//! Numbers in attributes.

/// A finite number, or what is wrong with the text.
pub(super) fn parse_float(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let value: f64 = text.parse().map_err(|_| format!("float expected, got '{}'", shortened(text)))?;
    if !value.is_finite() {
        return Err(format!("finite number expected, got '{}'", shortened(text)));
    }
    Ok(value)
}

/// A whole number, or what is wrong with the text.
pub(super) fn parse_integer(text: &str) -> Result<i64, String> {
    let text = text.trim();
    text.parse().map_err(|_| format!("integer expected, got '{}'", shortened(text)))
}

/// Finite numbers separated by blanks, commas or semicolons.
pub(super) fn parse_floats(text: &str) -> Result<Vec<f64>, String> {
    tokens(text).map(parse_float).collect()
}

/// The parts of a list.
pub(super) fn tokens(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|t| !t.is_empty())
}

/// At most some dozens of characters, for messages.
pub(super) fn shortened(text: &str) -> String {
    const MOST: usize = 40;
    match text.char_indices().nth(MOST) {
        Some((at, _)) => format!("{}...", &text[..at]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_numbers() {
        assert_eq!(parse_float(" -1.5e2 "), Ok(-150.0));
        assert_eq!(parse_float("abc").unwrap_err(), "float expected, got 'abc'");
        assert_eq!(parse_float("nan").unwrap_err(), "finite number expected, got 'nan'");
        assert!(parse_float("1e999").is_err() && parse_float("").is_err() && parse_float("1.0f").is_err());
        assert_eq!(parse_integer(" -7"), Ok(-7));
        assert!(parse_integer("7.0").is_err() && parse_integer("99999999999999999999").is_err());
        assert_eq!(parse_floats("1, 2  3;4"), Ok(vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(shortened(&"ä".repeat(50)).chars().count(), 43);
    }
}
