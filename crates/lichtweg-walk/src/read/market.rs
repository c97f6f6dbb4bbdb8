//! Matrix Market files (NISTIR 5935). Complex and Hermitian matrices are refused.

use std::path::Path;

use super::ReadError;
use super::lines::{Lines, number, shown, whole, words};
use crate::Matrix;

/// Reads a Matrix Market file from memory; `name` stands for it in errors.
///
/// ```
/// let text = b"%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 4.0\n2 1 -1\n";
/// let matrix = lichtweg_walk::read::parse_market("text", text).unwrap();
/// assert_eq!(matrix.get(0, 1), -1.0);
/// ```
///
/// # Errors
/// A line makes no sense, or the compressed stream is damaged.
pub fn parse_market(name: &str, bytes: &[u8]) -> Result<Matrix, ReadError> {
    matrix(Lines::new(Path::new(name), bytes)?)
}

#[derive(Clone, Copy, PartialEq)]
enum Symmetry {
    General,
    Symmetric,
    Skew,
}

/// The first line, and the sizes that follow it.
struct Header {
    dense: bool,
    pattern: bool,
    integer: bool,
    symmetry: Symmetry,
    rows: usize,
    columns: usize,
    /// Lines of entries.
    promised: u64,
}

/// What header and size promise is believed up to here; beyond, vectors grow as entries come.
const BELIEVED: u64 = 1 << 20;

pub(super) fn matrix(mut lines: Lines<'_>) -> Result<Matrix, ReadError> {
    let header = header(&mut lines)?;
    let (rows, columns) = (header.rows, header.columns);
    let triplets = if header.dense { array(&mut lines, &header)? } else { coordinates(&mut lines, &header)? };
    // An empty matrix of a billion rows needs eight gigabytes of offsets that no entry pays for.
    if rows > 1 << 24 && rows as u64 / 64 > header.promised {
        return Err(
            lines.error(format!("{rows} rows for {} entries: the size cannot be meant", header.promised))
        );
    }
    Matrix::from_triplets(rows, columns, &triplets).map_err(|error| lines.error(error.to_string()))
}

/// A vector: one column or row.
pub(super) fn vector(mut lines: Lines<'_>) -> Result<Vec<f64>, ReadError> {
    let header = header(&mut lines)?;
    if header.rows != 1 && header.columns != 1 {
        let message = format!("a vector is expected, not a matrix of {} x {}", header.rows, header.columns);
        return Err(lines.error(message));
    }
    let length = header.rows.max(header.columns).min(header.rows * header.columns);
    if length as u64 > 1 << 24 && length as u64 / 64 > header.promised {
        return Err(lines.error(format!("{length} elements for {} entries", header.promised)));
    }
    let triplets = if header.dense { array(&mut lines, &header)? } else { coordinates(&mut lines, &header)? };
    let mut vector = vec![0.0; length];
    for (row, column, value) in triplets {
        vector[row.max(column) as usize] += value;
    }
    Ok(vector)
}

fn header(lines: &mut Lines<'_>) -> Result<Header, ReadError> {
    let first = lines.next()?.unwrap_or_default().to_ascii_lowercase();
    let kinds: Vec<&[u8]> = words(&first).collect();
    let [b"%%matrixmarket", b"matrix", format, field, symmetry] = kinds[..] else {
        return Err(lines.error("expected \"%%MatrixMarket matrix FORMAT FIELD SYMMETRY\""));
    };
    let dense = match format {
        b"coordinate" => false,
        b"array" => true,
        other => return Err(lines.error(format!("unknown format {}: coordinate or array", shown(other)))),
    };
    let known = [&b"real"[..], b"double", b"integer", b"pattern"];
    if !known.contains(&field) {
        return Err(lines.error(format!("unsupported field {}: real, integer or pattern", shown(field))));
    }
    let symmetry = match symmetry {
        b"general" => Symmetry::General,
        b"symmetric" => Symmetry::Symmetric,
        b"skew-symmetric" => Symmetry::Skew,
        other => {
            let message =
                format!("unsupported symmetry {}: general, symmetric or skew-symmetric", shown(other));
            return Err(lines.error(message));
        }
    };
    let (pattern, integer) = (field == b"pattern", field == b"integer");
    if pattern && (dense || symmetry == Symmetry::Skew) {
        return Err(lines.error("a pattern has neither an array nor a sign"));
    }
    let sizes = sizes(lines, if dense { 2 } else { 3 })?;
    let [rows, columns] = [sizes[0], sizes[1]].map(|size| usize::try_from(size).unwrap_or(usize::MAX));
    if rows.max(columns) > u32::MAX as usize {
        return Err(lines.error(format!("{rows} x {columns} is too large: at most 4294967295")));
    }
    if symmetry != Symmetry::General && rows != columns {
        return Err(lines.error(format!("a symmetric matrix of {rows} x {columns} is not square")));
    }
    let all = rows as u64 * columns as u64;
    let promised = match (dense, symmetry) {
        (false, _) => sizes[2],
        (true, Symmetry::General) => all,
        (true, Symmetry::Symmetric) => (all + rows as u64) / 2,
        (true, Symmetry::Skew) => (all - rows as u64) / 2,
    };
    if promised > all {
        return Err(lines.error(format!("{promised} entries do not fit into {rows} x {columns}")));
    }
    Ok(Header { dense, pattern, integer, symmetry, rows, columns, promised })
}

/// The line of sizes, after comments and empty lines.
fn sizes(lines: &mut Lines<'_>, count: usize) -> Result<Vec<u64>, ReadError> {
    let expected = if count == 2 { "ROWS COLUMNS" } else { "ROWS COLUMNS ENTRIES" };
    while let Some(line) = lines.next()? {
        if line.is_empty() || line.starts_with(b"%") {
            continue;
        }
        let parsed: Result<Vec<u64>, String> = words(line).map(whole).collect();
        return match parsed {
            Ok(sizes) if sizes.len() == count => Ok(sizes),
            Ok(_) => Err(lines.error(format!("expected \"{expected}\""))),
            Err(message) => Err(lines.error(message)),
        };
    }
    Err(lines.error(format!("the file ends before \"{expected}\"")))
}

type Triplets = Vec<(u32, u32, f64)>;

fn coordinates(lines: &mut Lines<'_>, header: &Header) -> Result<Triplets, ReadError> {
    let twice = if header.symmetry == Symmetry::General { 1 } else { 2 };
    let mut triplets = Vec::with_capacity(header.promised.min(BELIEVED) as usize * twice);
    let mut count = 0;
    while let Some(line) = lines.next()? {
        if line.is_empty() || line.starts_with(b"%") {
            continue;
        }
        count += 1;
        if count > header.promised {
            return Err(lines.error(format!("more than the {} entries promised", header.promised)));
        }
        match entry(line, header) {
            Ok((row, column, value)) => {
                triplets.push((row, column, value));
                if row != column {
                    mirror(&mut triplets, header.symmetry, row, column, value);
                }
            }
            Err(message) => return Err(lines.error(message)),
        }
    }
    if count < header.promised {
        return Err(lines.error(format!("the file ends after {count} of {} entries", header.promised)));
    }
    Ok(triplets)
}

/// One line `ROW COLUMN [VALUE]`, from 1; the result is from 0.
fn entry(line: &[u8], header: &Header) -> Result<(u32, u32, f64), String> {
    let mut words = words(line);
    let mut index = |what: &str, count: usize| match words.next().map(whole) {
        Some(Ok(index)) if index >= 1 && index <= count as u64 => Ok((index - 1) as u32),
        Some(Ok(index)) => Err(format!("{what} {index} is not in 1 to {count}")),
        Some(Err(message)) => Err(message),
        None => Err(format!("the {what} is missing")),
    };
    let (row, column) = (index("row", header.rows)?, index("column", header.columns)?);
    let value =
        if header.pattern { 1.0 } else { value(words.next().ok_or("the value is missing")?, header)? };
    if let Some(word) = words.next() {
        return Err(format!("unexpected {} after the entry", shown(word)));
    }
    match header.symmetry {
        Symmetry::Skew if row == column && value != 0.0 => {
            Err("the diagonal of a skew-symmetric matrix is zero".to_owned())
        }
        Symmetry::General => Ok((row, column, value)),
        _ if row < column => {
            Err("symmetric matrices store the lower triangle: the row comes before the column".to_owned())
        }
        _ => Ok((row, column, value)),
    }
}

fn value(word: &[u8], header: &Header) -> Result<f64, String> {
    let value = number(word)?;
    if header.integer && value.fract() != 0.0 {
        Err(format!("{} is not an integer", shown(word)))
    } else {
        Ok(value)
    }
}

fn array(lines: &mut Lines<'_>, header: &Header) -> Result<Triplets, ReadError> {
    let mut triplets = Vec::with_capacity(header.promised.min(BELIEVED) as usize);
    // Column by column; of a symmetric matrix only what is below the diagonal.
    let first_row = |column: u32| match header.symmetry {
        Symmetry::General => 0,
        Symmetry::Symmetric => column,
        Symmetry::Skew => column + 1,
    };
    let (mut row, mut column) = (first_row(0), 0_u32);
    let mut count = 0;
    while let Some(line) = lines.next()? {
        if line.starts_with(b"%") {
            continue;
        }
        let parsed: Result<Vec<f64>, String> = words(line).map(|word| value(word, header)).collect();
        let parsed = match parsed {
            Ok(values) => values,
            Err(message) => return Err(lines.error(message)),
        };
        for value in parsed {
            count += 1;
            if count > header.promised {
                return Err(lines.error(format!("more than the {} numbers promised", header.promised)));
            }
            if value != 0.0 {
                triplets.push((row, column, value));
                if row != column {
                    mirror(&mut triplets, header.symmetry, row, column, value);
                }
            }
            row += 1;
            if row as usize == header.rows {
                column += 1;
                row = first_row(column);
            }
        }
    }
    if count < header.promised {
        return Err(lines.error(format!("the file ends after {count} of {} numbers", header.promised)));
    }
    Ok(triplets)
}

fn mirror(triplets: &mut Triplets, symmetry: Symmetry, row: u32, column: u32, value: f64) {
    match symmetry {
        Symmetry::General => {}
        Symmetry::Symmetric => triplets.push((column, row, value)),
        Symmetry::Skew => triplets.push((column, row, -value)),
    }
}
