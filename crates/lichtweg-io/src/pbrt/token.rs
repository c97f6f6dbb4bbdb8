//! Tokens of a pbrt file: words, quoted strings and brackets, as ranges of bytes.
//!
//! A token borrows and allocates nothing, so that inline meshes of millions of numbers cost little more than their
//! conversion. The grammar is that of pbrt-v4 (`parser.cpp`, `Tokenizer::Next`): `#` opens a comment where a token
//! could begin, a word runs to the next white space, quote or bracket, and a string may not cross a line.

use std::borrow::Cow;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A directive, a number, `true`, `false`.
    Word,
    /// A quoted string; its range includes the quotes.
    Quoted,
    /// `[`
    Open,
    /// `]`
    Close,
}

/// A token at the bytes `start..end` of its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub kind: Kind,
    pub start: usize,
    pub end: usize,
}

impl Token {
    /// Its text, with quotes where it has them.
    pub fn text(self, source: &str) -> &str {
        &source[self.start..self.end]
    }

    /// The inside of a quoted token, escapes still in place.
    pub fn inner(self, source: &str) -> &str {
        &source[self.start + 1..self.end - 1]
    }
}

/// A string without a closing quote: where it starts, and where its line ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unterminated {
    pub start: usize,
    pub end: usize,
}

/// The next token at or after `*position`, which moves behind it; `None` at the end of the text.
pub(super) fn next(source: &str, position: &mut usize) -> Result<Option<Token>, Unterminated> {
    let bytes = source.as_bytes();
    let mut at = *position;
    loop {
        match bytes.get(at) {
            None => {
                *position = at;
                return Ok(None);
            }
            Some(b' ' | b'\n' | b'\t' | b'\r') => at += 1,
            Some(b'#') => {
                while bytes.get(at).is_some_and(|b| *b != b'\n' && *b != b'\r') {
                    at += 1;
                }
            }
            Some(_) => break,
        }
    }
    let start = at;
    let kind = match bytes[at] {
        b'[' => Kind::Open,
        b']' => Kind::Close,
        b'"' => {
            let end = end_of_string(bytes, start);
            *position = end.unwrap_or_else(|end| end);
            return match end {
                Ok(end) => Ok(Some(Token { kind: Kind::Quoted, start, end })),
                Err(end) => Err(Unterminated { start, end }),
            };
        }
        _ => {
            while bytes
                .get(at)
                .is_some_and(|b| !matches!(b, b' ' | b'\n' | b'\t' | b'\r' | b'"' | b'[' | b']'))
            {
                at += 1;
            }
            *position = at;
            return Ok(Some(Token { kind: Kind::Word, start, end: at }));
        }
    };
    *position = start + 1;
    Ok(Some(Token { kind, start, end: start + 1 }))
}

/// One past the closing quote of the string that opens at `start`; the error is the end of its line.
fn end_of_string(bytes: &[u8], start: usize) -> Result<usize, usize> {
    let mut at = start + 1;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'"' => return Ok(at + 1),
            b'\n' => return Err(at),
            b'\\' if bytes.get(at + 1).is_some_and(|b| *b != b'\n') => at += 2,
            _ => at += 1,
        }
    }
    Err(bytes.len())
}

/// Resolves the escapes of a string; the error is the character after a backslash that is no escape.
pub(super) fn unescape(text: &str) -> Result<Cow<'_, str>, char> {
    if !text.contains('\\') {
        return Ok(Cow::Borrowed(text));
    }
    let mut out = String::with_capacity(text.len());
    let mut characters = text.chars();
    while let Some(c) = characters.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        out.push(match characters.next() {
            Some('b') => '\u{8}',
            Some('f') => '\u{c}',
            Some('n') => '\n',
            Some('r') => '\r',
            Some('t') => '\t',
            Some(same @ ('\\' | '\'' | '"')) => same,
            Some(other) => return Err(other),
            None => return Err('\\'),
        });
    }
    Ok(Cow::Owned(out))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(source: &str) -> Vec<&str> {
        let mut position = 0;
        let mut out = Vec::new();
        while let Ok(Some(token)) = next(source, &mut position) {
            out.push(token.text(source));
        }
        out
    }

    #[test]
    fn splits_at_space_quotes_and_brackets() {
        let source = "Shape\"a b\"[1 -2e3]#[ comment\r\n# x\n\ttrue # end";
        assert_eq!(words(source), ["Shape", "\"a b\"", "[", "1", "-2e3", "]", "true"]);
        assert_eq!(words("a#b \"#\""), ["a#b", "\"#\""]);
        assert!(words(" \n# only a comment").is_empty());
    }

    #[test]
    fn strings_end_on_their_line() {
        for (source, end) in
            [("\"abc", 4), ("\"abc\nx\"", 4), ("\"ab\\\"", 5), ("\"ab\\\"\n\"", 5), ("\"", 1)]
        {
            let mut position = 0;
            assert_eq!(next(source, &mut position), Err(Unterminated { start: 0, end }), "{source}");
            assert_eq!(position, end);
        }
    }

    #[test]
    fn escapes() {
        assert_eq!(unescape("plain").unwrap(), "plain");
        assert_eq!(unescape(r#"a\\b\"c\n"#).unwrap(), "a\\b\"c\n");
        assert_eq!(unescape(r"\d"), Err('d'));
        let source = r#""a\"b" x"#;
        assert_eq!(words(source), [r#""a\"b""#, "x"]);
    }
}
