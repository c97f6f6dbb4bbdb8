//! Sparse matrices in compressed rows (CSR), the ground that walks are made on.
//!
//! Columns within a row ascend, no entry is stored twice, and none is zero, NaN or infinite: a stored entry is a step
//! that a walk can take. Indices are 32 bits wide: at most 2^32 - 1 rows and columns.

mod build;

use rayon::prelude::*;

pub use build::MatrixError;

/// A sparse matrix of `rows` x `columns`.
///
/// ```
/// use lichtweg_walk::Matrix;
/// let m = Matrix::from_triplets(2, 2, &[(0, 1, 0.5), (1, 0, 0.25), (1, 0, 0.25)]).unwrap();
/// assert_eq!(m.get(1, 0), 0.5);
/// assert_eq!(m.multiply(&[2.0, 4.0]), [2.0, 1.0]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrix {
    columns: usize,
    /// Entries of the longest row.
    longest: usize,
    /// Row i is `offsets[i]..offsets[i + 1]` of the two below. Never empty but in `Matrix::default()`.
    offsets: Vec<usize>,
    indices: Vec<u32>,
    values: Vec<f64>,
}

/// Columns and values of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a> {
    /// Columns, ascending.
    pub indices: &'a [u32],
    /// Their values, none of them zero.
    pub values: &'a [f64],
}

impl<'a> Row<'a> {
    /// Pairs of column and value.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f64)> + use<'a> {
        self.indices.iter().zip(self.values).map(|(&j, &value)| (j as usize, value))
    }

    /// Sum of the magnitudes.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.values.iter().map(|value| value.abs()).sum()
    }

    /// Product with a vector.
    #[inline]
    #[must_use]
    pub fn dot(&self, vector: &[f64]) -> f64 {
        self.iter().map(|(j, value)| value * vector[j]).sum()
    }
}

/// Rows that one task of a parallel loop takes.
const ROWS_PER_TASK: usize = 4096;

impl Matrix {
    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of stored entries.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// Whether it has as many rows as columns.
    #[must_use]
    pub fn is_square(&self) -> bool {
        self.rows() == self.columns
    }

    /// Row `i`.
    #[inline]
    #[must_use]
    pub fn row(&self, i: usize) -> Row<'_> {
        let range = self.offsets[i]..self.offsets[i + 1];
        Row { indices: &self.indices[range.clone()], values: &self.values[range] }
    }

    /// Number of entries in row `i`.
    #[inline]
    #[must_use]
    pub fn row_len(&self, i: usize) -> usize {
        self.offsets[i + 1] - self.offsets[i]
    }

    /// Number of entries in the longest row.
    #[must_use]
    pub fn longest_row(&self) -> usize {
        self.longest
    }

    /// The entry at row `i` and column `j`; 0 where none is stored.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let row = self.row(i);
        let found = u32::try_from(j).ok().and_then(|j| row.indices.binary_search(&j).ok());
        found.map_or(0.0, |at| row.values[at])
    }

    /// The diagonal.
    #[must_use]
    pub fn diagonal(&self) -> Vec<f64> {
        self.map_rows(|i| self.get(i, i))
    }

    /// The product with a vector.
    ///
    /// # Panics
    /// When the vector is shorter than there are columns.
    #[must_use]
    pub fn multiply(&self, vector: &[f64]) -> Vec<f64> {
        self.map_rows(|i| self.row(i).dot(vector))
    }

    /// The product into an existing vector, of one element for each row.
    pub fn multiply_into(&self, vector: &[f64], product: &mut [f64]) {
        product.par_iter_mut().enumerate().with_min_len(ROWS_PER_TASK).for_each(|(i, out)| {
            *out = self.row(i).dot(vector);
        });
    }

    /// Something of each row, in parallel.
    #[must_use]
    pub fn map_rows<T: Send>(&self, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
        (0..self.rows()).into_par_iter().with_min_len(ROWS_PER_TASK).map(&f).collect()
    }

    /// Whether no entry is negative.
    #[must_use]
    pub fn is_nonnegative(&self) -> bool {
        self.values.par_chunks(ROWS_PER_TASK).all(|values| values.iter().all(|&value| value > 0.0))
    }

    /// Whether it equals its transpose, exactly.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.is_square()
            && (0..self.rows())
                .into_par_iter()
                .with_min_len(ROWS_PER_TASK)
                .all(|i| self.row(i).iter().all(|(j, value)| j == i || self.get(j, i) == value))
    }

    /// The transpose.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let mut offsets = vec![0; self.columns + 1];
        for &j in &self.indices {
            offsets[j as usize + 1] += 1;
        }
        for j in 0..self.columns {
            offsets[j + 1] += offsets[j];
        }
        let mut next = offsets.clone();
        let mut indices = vec![0; self.entries()];
        let mut values = vec![0.0; self.entries()];
        for i in 0..self.rows() {
            for (j, value) in self.row(i).iter() {
                indices[next[j]] = i as u32;
                values[next[j]] = value;
                next[j] += 1;
            }
        }
        let longest = build::longest(&offsets);
        Self { columns: self.rows(), longest, offsets, indices, values }
    }

    /// The matrix of magnitudes.
    #[must_use]
    pub fn magnitudes(&self) -> Self {
        let mut magnitudes = self.clone();
        magnitudes.values.iter_mut().for_each(|value| *value = value.abs());
        magnitudes
    }

    /// Ostrowski's comparison matrix: magnitudes on the diagonal, negative magnitudes elsewhere.
    #[must_use]
    pub fn comparison(&self) -> Self {
        let mut signed = self.clone();
        for i in 0..self.rows() {
            for at in self.offsets[i]..self.offsets[i + 1] {
                let magnitude = self.values[at].abs();
                signed.values[at] = if self.indices[at] as usize == i { magnitude } else { -magnitude };
            }
        }
        signed
    }

    /// D^-1 M D with D = diag(d): a similar matrix, on which walks prefer states of large d.
    ///
    /// `d` has to be positive; entries that underflow to zero are kept as the smallest positive number, so that no
    /// step is lost.
    #[must_use]
    pub fn similar(&self, d: &[f64]) -> Self {
        let mut scaled = self.clone();
        let starts = &self.offsets;
        for i in 0..self.rows() {
            for at in starts[i]..starts[i + 1] {
                let value = self.values[at] * (d[self.indices[at] as usize] / d[i]);
                scaled.values[at] =
                    if value == 0.0 { f64::MIN_POSITIVE.copysign(self.values[at]) } else { value };
            }
        }
        scaled
    }

    /// The stored entries as (row, column, value), row by row.
    pub fn triplets(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.rows()).flat_map(|i| self.row(i).iter().map(move |(j, value)| (i, j, value)))
    }
}
