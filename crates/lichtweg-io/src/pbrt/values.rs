//! Tokens as values of parameters.

use super::params::{Type, Values};
use super::token::{self, Kind};

/// Turns tokens into values of a type.
pub(super) struct ValueReader {
    kind: Type,
    pub values: Values,
}

impl ValueReader {
    pub fn new(kind: Type) -> Self {
        let values = match kind {
            Type::Bool => Values::Bools(Vec::new()),
            Type::Integer => Values::Integers(Vec::new()),
            Type::String | Type::Texture => Values::Strings(Vec::new()),
            _ => Values::Numbers(Vec::new()),
        };
        Self { kind, values }
    }

    /// Adds a value; false if it is of another kind.
    pub fn push(&mut self, kind: Kind, text: &str) -> bool {
        match (&mut self.values, kind) {
            (Values::Numbers(numbers), Kind::Word) => match number_of::<f32>(text) {
                Some(value) => numbers.push(value),
                None => return false,
            },
            (Values::Integers(integers), Kind::Word) => {
                match text.strip_prefix('+').unwrap_or(text).parse() {
                    Ok(value) => integers.push(value),
                    Err(_) => return false,
                }
            }
            (Values::Bools(bools), _) => match text.trim_matches('"') {
                "true" => bools.push(true),
                "false" => bools.push(false),
                _ => return false,
            },
            (Values::Strings(strings), Kind::Quoted) => match token::unescape(&text[1..text.len() - 1]) {
                Ok(text) => strings.push(text.into_owned()),
                Err(_) => return false,
            },
            // A spectrum is a list of numbers, or a name.
            (Values::Numbers(numbers), Kind::Quoted) if self.kind == Type::Spectrum && numbers.is_empty() => {
                self.values = Values::Strings(Vec::new());
                return self.push(kind, text);
            }
            _ => return false,
        }
        true
    }

    pub fn expected(&self) -> &'static str {
        match (&self.values, self.kind) {
            (Values::Bools(_), _) => "true or false",
            (Values::Integers(_), _) => "an integer of 32 bits",
            (Values::Strings(_), _) => "a quoted string with known escapes",
            (Values::Numbers(_), Type::Spectrum) => "a number or a spectrum's name",
            (Values::Numbers(_), _) => "a finite number",
        }
    }
}

/// The number of a word: decimal digits, a point, an exponent; finite, and no name such as `nan`.
pub(super) fn number_of<T: fast_float2::FastFloat + Into<f64> + Copy>(text: &str) -> Option<T> {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    if !digits.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        return None;
    }
    let number: T = fast_float2::parse(text.strip_prefix('+').unwrap_or(text)).ok()?;
    number.into().is_finite().then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        for (text, want) in [("1", 1.0), ("-.5", -0.5), ("+2.", 2.0), ("1e-3", 0.001), ("0.1E+2", 10.0)] {
            assert_eq!(number_of::<f32>(text), Some(want), "{text}");
        }
        for text in [
            "", "-", ".", "+-1", "nan", "-inf", "+inf", "infinity", "1x", "0x10", "1e", "1e99", "true", "--1",
        ] {
            assert_eq!(number_of::<f32>(text), None, "{text}");
        }
        assert_eq!(number_of::<f64>("1e99"), Some(1e99));
    }

    #[test]
    fn kinds_do_not_mix() {
        let read = |kind, tokens: &[(Kind, &str)]| {
            let mut reader = ValueReader::new(kind);
            tokens.iter().all(|(k, t)| reader.push(*k, t)).then_some(reader.values)
        };
        let (word, quoted) = (Kind::Word, Kind::Quoted);
        assert_eq!(read(Type::Float, &[(word, "1"), (quoted, "\"1\"")]), None);
        assert_eq!(read(Type::Integer, &[(word, "1.5")]), None);
        assert_eq!(read(Type::Integer, &[(word, "+3"), (word, "-4")]), Some(Values::Integers(vec![3, -4])));
        assert_eq!(read(Type::Integer, &[(word, "3000000000")]), None);
        assert_eq!(
            read(Type::Bool, &[(word, "true"), (quoted, "\"false\"")]),
            Some(Values::Bools(vec![true, false]))
        );
        assert_eq!(read(Type::String, &[(word, "a")]), None);
        assert_eq!(read(Type::Spectrum, &[(quoted, "\"a\"")]), Some(Values::Strings(vec!["a".to_owned()])));
        assert_eq!(read(Type::Spectrum, &[(word, "400"), (quoted, "\"a\"")]), None);
        assert_eq!(read(Type::Spectrum, &[(quoted, "\"a\""), (word, "400")]), None);
    }
}
