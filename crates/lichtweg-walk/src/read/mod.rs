//! Readers: Matrix Market files, edge lists and vectors, plain or compressed by gzip.
//!
//! | what | format | source |
//! |---|---|---|
//! | matrices | Matrix Market, `coordinate` or `array`; `real`, `integer`, `pattern`; `general`, `symmetric`, `skew-symmetric` | Boisvert, Pozo, Remington: *The Matrix Market exchange formats*, NISTIR 5935 (1996) |
//! | graphs | lines of two node ids and an optional weight; `#` and `%` begin comments | the SNAP collection, Stanford |
//! | vectors | Matrix Market of one column or row, or numbers separated by white space or commas | |
//!
//! Files are read line by line, and nothing is allocated for numbers that a header only promises. Errors tell the line.

mod edges;
mod lines;
mod market;
mod vector;

use std::path::{Path, PathBuf};

pub use edges::{Graph, parse_edges};
pub use market::parse_market;
pub use vector::parse_vector;

use lines::Lines;

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file, or the compressed stream in it, could not be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The text is not what it should be.
    #[error("{}:{line}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is wrong.
        message: String,
    },
}

/// What a file of a system holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// A Matrix Market file.
    Matrix(crate::Matrix),
    /// An edge list.
    Graph(Graph),
}

/// Reads a matrix or a graph: a Matrix Market file where the first line says so, otherwise an edge list.
///
/// # Errors
/// The file cannot be read, or a line of it makes no sense.
pub fn read_input(path: &Path) -> Result<Input, ReadError> {
    let mut lines = Lines::open(path)?;
    if lines.is_market()? {
        market::matrix(lines).map(Input::Matrix)
    } else {
        edges::graph(lines).map(Input::Graph)
    }
}

/// Reads a Matrix Market file.
///
/// # Errors
/// The file cannot be read, or a line of it makes no sense.
pub fn read_matrix(path: &Path) -> Result<crate::Matrix, ReadError> {
    market::matrix(Lines::open(path)?)
}

/// Reads an edge list.
///
/// # Errors
/// The file cannot be read, or a line of it makes no sense.
pub fn read_edges(path: &Path) -> Result<Graph, ReadError> {
    edges::graph(Lines::open(path)?)
}

/// Reads a vector: a Matrix Market file of one column or row where the first line says so, otherwise plain numbers.
///
/// # Errors
/// The file cannot be read, or a line of it makes no sense.
pub fn read_vector(path: &Path) -> Result<Vec<f64>, ReadError> {
    let mut lines = Lines::open(path)?;
    if lines.is_market()? { market::vector(lines) } else { vector::numbers(lines) }
}
