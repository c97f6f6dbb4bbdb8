//! Transitions: where a walk goes from a state, and what that does to its weight.
//!
//! * proportional: p_ij = |K_ij| / m_i with the row's mass m_i = sum_j |K_ij|; the weight is multiplied by sign(K_ij) m_i.
//!   Among all choices it has the least variance that can be had without knowing the solution (Halton 1970).
//! * uniform: p_ij = 1 / (entries of row i).
//! * any positive importance d, such as the Perron vector (p_ij = |K_ij| v_j / (rho v_i)) or an approximate solution: the
//!   proportional choice on the similar matrix D^-1 K D ([`Matrix::similar`]), from the start s D to the score D^-1 r.
//!
//! Rows of a few entries are added up and searched as they are met, so that one walk on a large matrix needs no
//! preparation. Long rows have their cumulative sums in a table, unless all of their entries are equal. Where in it to begin to
//! search is kept for as many even steps as there are entries, so that it takes about two comparisons for any length (the
//! cutpoint method: Chen and Asau, *On generating random variates from an empirical distribution*, 1974).

use std::borrow::Cow;

use crate::Matrix;

/// How the next state is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// By the magnitudes of the row.
    #[default]
    Proportional,
    /// All entries of the row alike.
    Uniform,
}

/// A matrix, made ready to be walked on.
#[derive(Clone, Debug)]
pub struct Kernel<'a> {
    matrix: &'a Matrix,
    selection: Selection,
    long: Cow<'a, Prepared>,
}

/// What a kernel looks up of long rows; costs a pass over the matrix where there are any, so it is worth keeping.
#[derive(Clone, Debug)]
pub(crate) struct Prepared(Option<LongRows>);

impl Prepared {
    pub(crate) fn new(matrix: &Matrix) -> Self {
        Self(LongRows::new(matrix))
    }
}

/// Rows up to this length are searched without a table.
const SHORT: usize = 16;

/// Masses and cumulative sums of long rows.
#[derive(Clone, Debug)]
struct LongRows {
    /// For each row, its place in the table; nothing for short ones.
    slot: Vec<u32>,
    table: Vec<LongRow>,
    cumulative: Vec<f64>,
    /// For the k-th of n even steps of a row of n entries: the entry that k / n of its mass lies in.
    cuts: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct LongRow {
    mass: f64,
    /// Where its cumulative sums begin; `usize::MAX` where all entries are equal in magnitude.
    cumulative: usize,
}

const EVEN: usize = usize::MAX;

/// A step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Where to.
    pub state: usize,
    /// K_ij / p_ij.
    pub factor: f64,
}

impl<'a> Kernel<'a> {
    /// Of a square matrix.
    #[must_use]
    pub fn new(matrix: &'a Matrix, selection: Selection) -> Self {
        Self { matrix, selection, long: Cow::Owned(Prepared::new(matrix)) }
    }

    /// The same, with what was prepared of this matrix before.
    pub(crate) fn with(matrix: &'a Matrix, selection: Selection, prepared: &'a Prepared) -> Self {
        Self { matrix, selection, long: Cow::Borrowed(prepared) }
    }

    /// The matrix K.
    #[must_use]
    pub fn matrix(&self) -> &'a Matrix {
        self.matrix
    }

    /// m_i = sum_j |K_ij|.
    #[inline]
    #[must_use]
    pub fn mass(&self, i: usize) -> f64 {
        if self.matrix.row_len(i) <= SHORT {
            return self.matrix.row(i).mass();
        }
        self.long_row(i).map_or(0.0, |(row, _)| row.mass)
    }

    /// A step from state `i` of mass `mass` by a uniform number in [0,1). The row must not be empty.
    #[inline]
    #[must_use]
    pub fn step(&self, i: usize, mass: f64, u: f64) -> Step {
        let row = self.matrix.row(i);
        let last = row.indices.len() - 1;
        let even = |u: f64| ((u * row.indices.len() as f64) as usize).min(last);
        if self.selection == Selection::Uniform {
            let at = even(u);
            return Step {
                state: row.indices[at] as usize,
                factor: row.values[at] * row.indices.len() as f64,
            };
        }
        let at = if last < SHORT {
            let mut left = u * mass;
            // The last entry also takes what rounding leaves over.
            row.values[..last]
                .iter()
                .take_while(|value| {
                    left -= value.abs();
                    left >= 0.0
                })
                .count()
        } else {
            match self.long_row(i) {
                Some((_, Some(table))) => table.find(even(u), u * mass).min(last),
                _ => even(u),
            }
        };
        Step { state: row.indices[at] as usize, factor: mass.copysign(row.values[at]) }
    }

    #[inline]
    fn long_row(&self, i: usize) -> Option<(LongRow, Option<Table<'_>>)> {
        let long = self.long.0.as_ref()?;
        let row = long.table[long.slot[i] as usize];
        let range = row.cumulative..row.cumulative.wrapping_add(self.matrix.row_len(i));
        let table = (row.cumulative != EVEN)
            .then(|| Table { cumulative: &long.cumulative[range.clone()], cuts: &long.cuts[range] });
        Some((row, table))
    }
}

/// How to find an entry of a long row.
#[derive(Clone, Copy, Debug)]
struct Table<'a> {
    cumulative: &'a [f64],
    cuts: &'a [u32],
}

impl Table<'_> {
    /// The first entry whose cumulative sum is above `sought`, which lies in step `step`; the length, where none is.
    #[inline]
    fn find(self, step: usize, sought: f64) -> usize {
        let mut at = self.cuts[step] as usize;
        // A step begins where rounding left it.
        while at > 0 && self.cumulative[at - 1] > sought {
            at -= 1;
        }
        while at < self.cumulative.len() && self.cumulative[at] <= sought {
            at += 1;
        }
        at
    }
}

impl LongRows {
    fn new(matrix: &Matrix) -> Option<Self> {
        if matrix.longest_row() <= SHORT {
            return None;
        }
        let long = (0..matrix.rows()).filter(|&i| matrix.row_len(i) > SHORT);
        let mut rows = Self {
            slot: vec![0; matrix.rows()],
            table: Vec::new(),
            cumulative: Vec::new(),
            cuts: Vec::new(),
        };
        for i in long {
            let values = matrix.row(i).values;
            rows.slot[i] = rows.table.len() as u32;
            if values.iter().all(|value| value.abs() == values[0].abs()) {
                rows.table.push(LongRow { mass: values[0].abs() * values.len() as f64, cumulative: EVEN });
                continue;
            }
            let start = rows.cumulative.len();
            let mut sum = 0.0;
            rows.cumulative.extend(values.iter().map(|value| {
                sum += value.abs();
                sum
            }));
            rows.table.push(LongRow { mass: sum, cumulative: start });
            let (sums, step) = (&rows.cumulative[start..], sum / values.len() as f64);
            let mut at = 0;
            rows.cuts.extend((0..values.len()).map(|k| {
                while at + 1 < sums.len() && sums[at] <= k as f64 * step {
                    at += 1;
                }
                at as u32
            }));
        }
        Some(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frequencies over an even grid of numbers equal the probabilities, for short, long and even rows.
    #[test]
    fn steps_follow_the_row() {
        for length in [1, 5, SHORT, SHORT + 1, 100] {
            for even in [false, true] {
                let value = |j: usize| if even { 0.5 } else { 0.1 + (j % 7) as f64 } * [1.0, -1.0][j % 2];
                let row: Vec<_> = (0..length).map(|j| (0, j as u32, value(j))).collect();
                let matrix = Matrix::from_triplets(length, length, &row).unwrap();
                for selection in [Selection::Proportional, Selection::Uniform] {
                    let kernel = Kernel::new(&matrix, selection);
                    let mass = kernel.mass(0);
                    let mut mean = vec![0.0; length];
                    let grid = 100_000;
                    for k in 0..grid {
                        let step = kernel.step(0, mass, (f64::from(k) + 0.5) / f64::from(grid));
                        mean[step.state] += step.factor / f64::from(grid);
                    }
                    for (j, mean) in mean.iter().enumerate() {
                        let error = (mean - value(j)).abs();
                        assert!(
                            error < 2.0 * mass.max(length as f64 * 6.1) / f64::from(grid),
                            "{length} {j}: {error}"
                        );
                    }
                }
            }
        }
    }
}
