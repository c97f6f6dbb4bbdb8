//! Splittings of A x = b: with A = B - (B - A), x = (I - w B^-1 A) x + w B^-1 b for any damping w.
//!
//! Jacobi takes the diagonal for B, block Jacobi blocks along it, Richardson the identity (Saad, *Iterative methods
//! for sparse linear systems*, 2nd ed., section 4.1). All have the same solution; they differ in the spectral radius of
//! M, and so in how long walks are, or whether they end at all.

use crate::Matrix;

use super::SystemError;

/// How A x = b becomes x = M x + b'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Splitting {
    /// M = I - w D^-1 A with the diagonal D; w = 1 is Jacobi's.
    Jacobi {
        /// w.
        damping: f64,
    },
    /// The same with blocks of `size` consecutive unknowns.
    BlockJacobi {
        /// Unknowns in a block; the last may have fewer.
        size: usize,
        /// w.
        damping: f64,
    },
    /// M = I - w A.
    Richardson {
        /// w.
        damping: f64,
    },
}

impl Default for Splitting {
    fn default() -> Self {
        Self::Jacobi { damping: 1.0 }
    }
}

/// Blocks are inverted densely: beyond this they cost more than they help.
const LARGEST_BLOCK: usize = 256;

impl Splitting {
    /// M and b'.
    pub(super) fn split(self, a: &Matrix, b: &[f64]) -> Result<(Matrix, Vec<f64>), SystemError> {
        match self {
            Self::Jacobi { damping } => {
                check_damping(damping)?;
                let diagonal = a.diagonal();
                match diagonal.iter().position(|&d| !(damping / d).is_finite()) {
                    Some(row) => Err(SystemError::Singular { what: "the diagonal element", row }),
                    None => scaled(a, b, |i| damping / diagonal[i]),
                }
            }
            Self::Richardson { damping } => {
                check_damping(damping)?;
                scaled(a, b, |_| damping)
            }
            Self::BlockJacobi { size, damping } => {
                check_damping(damping)?;
                if size == 0 || size > LARGEST_BLOCK {
                    let message = format!("blocks have 1 to {LARGEST_BLOCK} unknowns, not {size}");
                    return Err(SystemError::Parameter(message));
                }
                blocks(a, b, size, damping)
            }
        }
    }
}

fn check_damping(damping: f64) -> Result<(), SystemError> {
    if damping.is_finite() && damping != 0.0 {
        Ok(())
    } else {
        Err(SystemError::Parameter(format!("the damping must be finite and not zero, not {damping}")))
    }
}

/// I - diag(s) A and diag(s) b.
fn scaled(a: &Matrix, b: &[f64], s: impl Fn(usize) -> f64) -> Result<(Matrix, Vec<f64>), SystemError> {
    let mut rows = Rows::with_capacity(a);
    for i in 0..a.rows() {
        let factor = s(i);
        rows.push(a.row(i).iter().map(|(j, value)| (j as u32, -factor * value)), i);
    }
    Ok((rows.finish()?, b.iter().enumerate().map(|(i, value)| s(i) * value).collect()))
}

/// I - w B^-1 A and w B^-1 b with the diagonal blocks B.
fn blocks(a: &Matrix, b: &[f64], size: usize, damping: f64) -> Result<(Matrix, Vec<f64>), SystemError> {
    let mut rows = Rows::with_capacity(a);
    let mut source = Vec::with_capacity(b.len());
    for start in (0..a.rows()).step_by(size) {
        let block = start..(start + size).min(a.rows());
        let inverse = inverse_block(a, block.clone())
            .ok_or(SystemError::Singular { what: "the diagonal block", row: start })?;
        for (i, weights) in block.clone().zip(inverse.chunks(block.len())) {
            source.push(
                damping * weights.iter().zip(&b[block.clone()]).map(|(w, value)| w * value).sum::<f64>(),
            );
            let mut row: Vec<(u32, f64)> = Vec::new();
            for (k, &weight) in block.clone().zip(weights) {
                row.extend(a.row(k).iter().map(|(j, value)| (j as u32, -damping * weight * value)));
            }
            // B^-1 A is the identity within the block: exactly so, not up to rounding.
            row.retain(|&(j, _)| !block.contains(&(j as usize)));
            row.push((i as u32, -damping));
            rows.push(row.into_iter(), i);
        }
    }
    Ok((rows.finish()?, source))
}

/// The inverse of a dense diagonal block by Gauss-Jordan elimination with partial pivoting, row by row.
fn inverse_block(a: &Matrix, block: std::ops::Range<usize>) -> Option<Vec<f64>> {
    let n = block.len();
    let mut left = vec![0.0; n * n];
    let mut right = vec![0.0; n * n];
    for (k, i) in block.clone().enumerate() {
        right[k * n + k] = 1.0;
        for (j, value) in a.row(i).iter().filter(|(j, _)| block.contains(j)) {
            left[k * n + j - block.start] = value;
        }
    }
    for column in 0..n {
        let largest = |&i: &usize, &j: &usize| {
            let [a, b] = [i, j].map(|row: usize| left[row * n + column].abs());
            a.total_cmp(&b)
        };
        let pivot = (column..n).max_by(largest)?;
        let inverse = 1.0 / left[pivot * n + column];
        if !inverse.is_finite() {
            return None;
        }
        for k in 0..n {
            left.swap(pivot * n + k, column * n + k);
            right.swap(pivot * n + k, column * n + k);
            left[column * n + k] *= inverse;
            right[column * n + k] *= inverse;
        }
        for row in (0..n).filter(|&row| row != column) {
            let factor = left[row * n + column];
            if factor != 0.0 {
                for k in 0..n {
                    left[row * n + k] -= factor * left[column * n + k];
                    right[row * n + k] -= factor * right[column * n + k];
                }
            }
        }
    }
    right.iter().all(|value| value.is_finite()).then_some(right)
}

/// Rows of a matrix I - ..., one after the other.
struct Rows {
    size: usize,
    offsets: Vec<usize>,
    indices: Vec<u32>,
    values: Vec<f64>,
}

impl Rows {
    fn with_capacity(a: &Matrix) -> Self {
        let (indices, values) = (Vec::with_capacity(a.entries()), Vec::with_capacity(a.entries()));
        Self { size: a.rows(), offsets: vec![0], indices, values }
    }

    /// Row `i` of the identity plus these entries. A diagonal that is rounding alone is nothing.
    fn push(&mut self, entries: impl Iterator<Item = (u32, f64)>, i: usize) {
        let mut diagonal = 1.0;
        for (j, value) in entries {
            if j as usize == i {
                diagonal += value;
            } else {
                self.indices.push(j);
                self.values.push(value);
            }
        }
        if diagonal.abs() > 4.0 * f64::EPSILON {
            self.indices.push(i as u32);
            self.values.push(diagonal);
        }
        self.offsets.push(self.values.len());
    }

    fn finish(self) -> Result<Matrix, SystemError> {
        Matrix::from_csr(self.size, self.size, self.offsets, self.indices, self.values)
            .map_err(|error| SystemError::Parameter(format!("the splitting overflows: {error}")))
    }
}
