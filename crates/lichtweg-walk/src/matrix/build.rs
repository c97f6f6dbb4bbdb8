//! Making matrices from triplets and from compressed rows of other programs.

use super::Matrix;

/// Why numbers do not make a matrix.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MatrixError {
    /// More rows or columns than 32 bits can count.
    #[error("a matrix of {rows} x {columns} is too large: at most 4294967295 rows and columns")]
    TooLarge {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// An index out of range, from 0.
    #[error("entry ({row}, {column}) (from 0) is outside of a matrix of {rows} x {columns}")]
    OutOfRange {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// NaN or infinite.
    #[error("entry ({row}, {column}) (from 0) is not finite")]
    NotFinite {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
    },
    /// Arrays of compressed rows that do not fit together.
    #[error("the arrays of compressed rows do not fit together: {0}")]
    Inconsistent(&'static str),
}

impl Matrix {
    /// From (row, column, value), from 0, in any order. Values of the same place are added; zeros are dropped.
    ///
    /// # Errors
    /// An index out of range, a value (or sum of values) that is not finite, too many rows or columns.
    pub fn from_triplets(
        rows: usize,
        columns: usize,
        triplets: &[(u32, u32, f64)],
    ) -> Result<Self, MatrixError> {
        check_size(rows, columns)?;
        let mut offsets = vec![0_usize; rows + 1];
        for &(row, column, _) in triplets {
            let (row, column) = (row as usize, column as usize);
            if row >= rows || column >= columns {
                return Err(MatrixError::OutOfRange { row, column, rows, columns });
            }
            offsets[row + 1] += 1;
        }
        for i in 0..rows {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let mut indices = vec![0; triplets.len()];
        let mut values = vec![0.0; triplets.len()];
        for &(row, column, value) in triplets {
            let at = next[row as usize];
            indices[at] = column;
            values[at] = value;
            next[row as usize] += 1;
        }
        Self { columns, longest: 0, offsets, indices, values }.canonical()
    }

    /// From compressed rows, as other programs store them. Columns may come in any order and more than once.
    ///
    /// # Errors
    /// Arrays that do not fit together, an index out of range, a value that is not finite.
    pub fn from_csr(
        rows: usize,
        columns: usize,
        offsets: Vec<usize>,
        indices: Vec<u32>,
        values: Vec<f64>,
    ) -> Result<Self, MatrixError> {
        check_size(rows, columns)?;
        if rows.checked_add(1) != Some(offsets.len()) {
            return Err(MatrixError::Inconsistent("there has to be one offset more than rows"));
        }
        if indices.len() != values.len() || offsets[rows] != values.len() || offsets[0] != 0 {
            return Err(MatrixError::Inconsistent("offsets have to run from 0 to the number of entries"));
        }
        if offsets.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err(MatrixError::Inconsistent("offsets have to ascend"));
        }
        let matrix = Self { columns, longest: 0, offsets, indices, values };
        let outside = matrix.triplets().find(|&(_, column, _)| column >= columns);
        match outside {
            Some((row, column, _)) => Err(MatrixError::OutOfRange { row, column, rows, columns }),
            None => matrix.canonical(),
        }
    }

    /// Sorts the rows, adds what is stored twice, drops zeros; an error at a value that is not finite.
    fn canonical(mut self) -> Result<Self, MatrixError> {
        let mut kept = 0;
        let mut scratch: Vec<(u32, f64)> = Vec::new();
        for i in 0..self.rows() {
            let range = self.offsets[i]..self.offsets[i + 1];
            scratch.clear();
            scratch.extend(range.map(|at| (self.indices[at], self.values[at])));
            if !scratch.is_sorted_by(|a, b| a.0 < b.0) {
                // Stable, so that sums do not depend on anything but the order of the input.
                scratch.sort_by_key(|&(column, _)| column);
            }
            self.offsets[i] = kept;
            for same in scratch.chunk_by(|a, b| a.0 == b.0) {
                let column = same[0].0;
                let value: f64 = same.iter().map(|&(_, value)| value).sum();
                if !value.is_finite() {
                    return Err(MatrixError::NotFinite { row: i, column: column as usize });
                }
                if value != 0.0 {
                    self.indices[kept] = column;
                    self.values[kept] = value;
                    kept += 1;
                }
            }
        }
        if let Some(end) = self.offsets.last_mut() {
            *end = kept;
        }
        self.longest = longest(&self.offsets);
        self.indices.truncate(kept);
        self.values.truncate(kept);
        Ok(self)
    }
}

/// Entries of the longest row.
pub(super) fn longest(offsets: &[usize]) -> usize {
    offsets.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(0)
}

fn check_size(rows: usize, columns: usize) -> Result<(), MatrixError> {
    let too_large = |count: usize| u32::try_from(count).is_err();
    if too_large(rows) || too_large(columns) { Err(MatrixError::TooLarge { rows, columns }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wrong_numbers_are_refused() {
        let out = MatrixError::OutOfRange { row: 0, column: 2, rows: 2, columns: 2 };
        assert_eq!(Matrix::from_triplets(2, 2, &[(0, 2, 1.0)]), Err(out.clone()));
        assert_eq!(Matrix::from_csr(2, 2, vec![0, 1, 1], vec![2], vec![1.0]), Err(out));
        let nan = Matrix::from_triplets(1, 1, &[(0, 0, f64::NAN)]);
        assert_eq!(nan, Err(MatrixError::NotFinite { row: 0, column: 0 }));
        for (offsets, indices) in [(vec![0, 1], vec![0]), (vec![0, 2, 1], vec![0]), (vec![0, 1, 1], vec![])] {
            let made = Matrix::from_csr(2, 2, offsets, indices, vec![1.0]);
            assert!(matches!(made, Err(MatrixError::Inconsistent(_))), "{made:?}");
        }
    }

    #[test]
    fn empty_matrices_are_matrices() {
        let empty = Matrix::from_triplets(0, 0, &[]).unwrap();
        assert_eq!((empty.rows(), empty.entries(), empty.transposed().rows()), (0, 0, 0));
        assert!(empty.multiply(&[]).is_empty());
    }

    proptest! {
        #[test]
        fn triplets_rows_and_transpose_agree(
            entries in prop::collection::vec((0_u32..7, 0_u32..5, -2_i32..3), 0..60),
        ) {
            let triplets: Vec<_> = entries.iter().map(|&(i, j, v)| (i, j, f64::from(v))).collect();
            let matrix = Matrix::from_triplets(7, 5, &triplets).unwrap();
            let transposed = matrix.transposed();
            for i in 0..7 {
                for j in 0..5 {
                    let sum: f64 = triplets.iter().filter(|t| (t.0, t.1) == (i, j)).map(|t| t.2).sum();
                    prop_assert_eq!(matrix.get(i as usize, j as usize), sum);
                    prop_assert_eq!(transposed.get(j as usize, i as usize), sum);
                }
            }
            prop_assert!(matrix.triplets().all(|(_, _, value)| value != 0.0));
            prop_assert_eq!(transposed.transposed(), matrix);
        }
    }
}
