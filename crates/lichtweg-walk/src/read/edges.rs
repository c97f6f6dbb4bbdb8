//! Edge lists: a line for each edge, two node ids and an optional weight, separated by white space or commas.
//!
//! Node ids are any whole numbers below 2^64. Those that occur are the nodes, in ascending order, as in NetworkX.

use std::path::Path;

use super::ReadError;
use super::lines::{Lines, number, shown, whole};
use crate::Matrix;

/// A directed graph. Edges that occur more than once have the sum of their weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// Weight of the edge from row to column.
    pub adjacency: Matrix,
    /// The id of each node in the file, ascending.
    pub labels: Vec<u64>,
}

impl Graph {
    /// The index of a node by its id in the file.
    #[must_use]
    pub fn node(&self, label: u64) -> Option<usize> {
        self.labels.binary_search(&label).ok()
    }
}

/// Reads an edge list from memory; `name` stands for it in errors.
///
/// # Errors
/// A line makes no sense, or the compressed stream is damaged.
pub fn parse_edges(name: &str, bytes: &[u8]) -> Result<Graph, ReadError> {
    graph(Lines::new(Path::new(name), bytes)?)
}

pub(super) fn graph(mut lines: Lines<'_>) -> Result<Graph, ReadError> {
    let mut edges: Vec<(u64, u64, f64)> = Vec::new();
    while let Some(line) = lines.next()? {
        if line.is_empty() || line.starts_with(b"#") || line.starts_with(b"%") {
            continue;
        }
        match edge(line) {
            Ok(edge) => edges.push(edge),
            Err(message) => return Err(lines.error(message)),
        }
    }
    let labels = labels(&edges);
    let index = |label: u64| {
        // Nearly all files count from 0 or 1 without gaps.
        let guess = label.wrapping_sub(labels[0]) as usize;
        if labels.get(guess) == Some(&label) {
            guess as u32
        } else {
            labels.partition_point(|&l| l < label) as u32
        }
    };
    let triplets: Vec<_> = edges.iter().map(|&(from, to, weight)| (index(from), index(to), weight)).collect();
    drop(edges);
    let adjacency = Matrix::from_triplets(labels.len(), labels.len(), &triplets);
    Ok(Graph { adjacency: adjacency.map_err(|error| lines.error(error.to_string()))?, labels })
}

fn labels(edges: &[(u64, u64, f64)]) -> Vec<u64> {
    let mut labels: Vec<u64> = edges.iter().flat_map(|&(from, to, _)| [from, to]).collect();
    labels.sort_unstable();
    labels.dedup();
    labels
}

fn edge(line: &[u8]) -> Result<(u64, u64, f64), String> {
    let separator = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
    let mut words = line.split(separator).filter(|word| !word.is_empty());
    let from = whole(words.next().ok_or("the node is missing")?)?;
    let to = whole(words.next().ok_or("the second node of the edge is missing")?)?;
    let weight = match words.next() {
        None => 1.0,
        Some(word) => match number(word)? {
            weight if weight >= 0.0 => weight,
            _ => return Err(format!("the weight {} is negative", shown(word))),
        },
    };
    match words.next() {
        None => Ok((from, to, weight)),
        Some(word) => Err(format!("unexpected {} after the edge", shown(word))),
    }
}
