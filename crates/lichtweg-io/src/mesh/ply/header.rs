//! The header of a PLY file: which elements follow, with which properties, in which encoding.

use crate::mesh::text::quote;
use crate::mesh::{MeshError, Place};

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// In bytes, when binary.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// By its name, old or new; 64-bit integers are an extension of Mitsuba's.
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "long" | "int64" => Self::I64,
            "ulong" | "uint64" => Self::U64,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }
}

/// One number, or a counted list of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Single(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A column of an element.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

/// A table of the body.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
    /// The line that declares it.
    pub line: u64,
}

impl Element {
    /// Bytes a row, if all rows have the same in binary.
    pub fn stride(&self) -> Option<usize> {
        let size = |property: &Property| match property.kind {
            Kind::Single(scalar) => Some(scalar.size()),
            Kind::List { .. } => None,
        };
        self.properties.iter().map(size).sum()
    }

    /// The least bytes a row can take in the body.
    pub fn least_bytes(&self, encoding: Encoding) -> u64 {
        let least = |property: &Property| match (encoding, property.kind) {
            // One digit and one separator.
            (Encoding::Ascii, _) => 2,
            (_, Kind::Single(scalar) | Kind::List { count: scalar, .. }) => scalar.size() as u64,
        };
        self.properties.iter().map(least).sum()
    }
}

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Bytes up to the body.
    pub length: usize,
    /// Lines up to the body.
    pub lines: u64,
}

/// Headers are short; this many elements or properties are no mesh.
const MOST_DECLARATIONS: u64 = 10_000;

impl Header {
    /// Parses everything up to and including `end_header`.
    pub fn parse(bytes: &[u8]) -> Result<Self, MeshError> {
        let mut lines = Lines::new(bytes)?;
        let mut encoding = None;
        let mut elements = Vec::new();
        loop {
            let line = lines.next()?;
            let number = lines.number;
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words[..] {
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, "1.0"] => encoding = Some(parse_encoding(name, number)?),
                ["element", name, count] => elements.push(parse_element(name, count, number)?),
                ["property", ..] => {
                    let Some(element) = elements.last_mut() else {
                        return Err(header_error(number, "an `element` before its properties", &line));
                    };
                    element.properties.push(parse_property(&words, number)?);
                }
                ["end_header"] => break,
                _ => {
                    let expected = "`format … 1.0`, `element`, `property`, `comment` or `end_header`";
                    return Err(header_error(number, expected, &line));
                }
            }
            if number > MOST_DECLARATIONS {
                return Err(header_error(number, "a header of at most 10000 lines", "more"));
            }
        }
        let Some(encoding) = encoding else {
            return Err(header_error(lines.number, "a `format` line before the end of the header", "none"));
        };
        Ok(Self { encoding, elements, length: lines.position, lines: lines.number })
    }
}

fn parse_encoding(name: &str, line: u64) -> Result<Encoding, MeshError> {
    match name {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(header_error(line, "`ascii`, `binary_little_endian` or `binary_big_endian`", name)),
    }
}

fn parse_element(name: &str, count: &str, line: u64) -> Result<Element, MeshError> {
    let count = count.parse().map_err(|_| header_error(line, "a count of rows", count))?;
    Ok(Element { name: name.to_owned(), count, properties: Vec::new(), line })
}

fn parse_property(words: &[&str], line: u64) -> Result<Property, MeshError> {
    let scalar = |name: &str| {
        let expected = "a type such as `float`, `uchar` or `int32`";
        Scalar::named(name).ok_or_else(|| header_error(line, expected, name))
    };
    let (name, kind) = match *words {
        ["property", "list", count, item, name] => {
            (name, Kind::List { count: scalar(count)?, item: scalar(item)? })
        }
        ["property", kind, name] => (name, Kind::Single(scalar(kind)?)),
        _ => {
            let expected = "`property TYPE NAME` or `property list TYPE TYPE NAME`";
            return Err(header_error(line, expected, &words.join(" ")));
        }
    };
    Ok(Property { name: name.to_owned(), kind })
}

fn header_error(line: u64, expected: &str, found: &str) -> MeshError {
    MeshError::new(
        Place::Line(line),
        expected,
        quote(found.as_bytes()),
        "the PLY header is damaged; export the file again",
    )
}

/// The header's lines. How the first one ends tells how all do: a lone `\r` must not swallow a `\n` that is data.
struct Lines<'a> {
    bytes: &'a [u8],
    position: usize,
    number: u64,
    end: &'static [u8],
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Result<Self, MeshError> {
        for end in [&b"\r\n"[..], b"\n", b"\r"] {
            if bytes.strip_prefix(b"ply").is_some_and(|rest| rest.starts_with(end)) {
                return Ok(Self { bytes, position: 3 + end.len(), number: 1, end });
            }
        }
        let word = bytes.split(u8::is_ascii_whitespace).next().unwrap_or(&[]);
        let found = if bytes.is_empty() { "an empty file".to_owned() } else { quote(word) };
        let help = "check that this is a PLY file and has not been cut off";
        Err(MeshError::new(Place::Byte(0), "`ply` as the first line", found, help))
    }

    fn next(&mut self) -> Result<String, MeshError> {
        let rest = &self.bytes[self.position..];
        let Some(length) = rest.windows(self.end.len()).position(|window| window == self.end) else {
            return Err(MeshError::new(
                Place::Line(self.number + 1),
                "a header that ends with `end_header`",
                "the end of the file",
                "the file is truncated or no PLY file; export it again",
            ));
        };
        self.position += length + self.end.len();
        self.number += 1;
        Ok(String::from_utf8_lossy(&rest[..length]).into_owned())
    }
}
