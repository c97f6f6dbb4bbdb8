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
//! search is kept for as many even steps as there are entries, so that it takes about two comparisons for any length, and they
//! are side by side in memory: a step of a walk is little more than a line that is not in the cache (the cutpoint method: Chen and Asau, *On generating random variates from an empirical distribution*, 1974).

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
    entries: Vec<LongEntry>,
}

/// The k-th entry of a row of n, with what is needed of it.
#[derive(Clone, Copy, Debug)]
struct LongEntry {
    /// Sum of magnitudes up to and with this entry.
    cumulative: f64,
    /// Where it leads.
    state: u32,
    /// The entry that k / n of the row's mass lies in.
    cut: u32,
}

#[derive(Clone, Copy, Debug)]
struct LongRow {
    mass: f64,
    /// Where its entries begin; `usize::MAX` where all are equal in magnitude.
    first: usize,
    /// Whether any entry is negative.
    signed: bool,
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
        } else if let Some((long, entries)) = self.long_row(i).filter(|(long, _)| long.first != EVEN) {
            let (at, state) = find(entries, even(u), u * mass);
            // Mostly no other line of memory is needed.
            let factor = if long.signed { mass.copysign(row.values[at]) } else { mass };
            return Step { state, factor };
        } else {
            even(u)
        };
        Step { state: row.indices[at] as usize, factor: mass.copysign(row.values[at]) }
    }

    #[inline]
    fn long_row(&self, i: usize) -> Option<(LongRow, &[LongEntry])> {
        let long = self.long.0.as_ref()?;
        let row = long.table[long.slot[i] as usize];
        let range = if row.first == EVEN { 0..0 } else { row.first..row.first + self.matrix.row_len(i) };
        Some((row, &long.entries[range]))
    }
}

/// The first entry whose cumulative sum is above `sought`, which lies in step `step`, and where it leads; the last one, where
/// rounding leaves none.
#[inline]
fn find(entries: &[LongEntry], step: usize, sought: f64) -> (usize, usize) {
    let last = entries.len() - 1;
    let mut at = entries[step].cut as usize;
    while at < last && entries[at].cumulative <= sought {
        at += 1;
    }
    (at, entries[at].state as usize)
}

impl LongRows {
    fn new(matrix: &Matrix) -> Option<Self> {
        if matrix.longest_row() <= SHORT {
            return None;
        }
        let long = (0..matrix.rows()).filter(|&i| matrix.row_len(i) > SHORT);
        let mut rows = Self { slot: vec![0; matrix.rows()], table: Vec::new(), entries: Vec::new() };
        for i in long {
            let row = matrix.row(i);
            let (first, count) = (rows.entries.len(), row.values.len());
            let signed = row.values.iter().any(|&value| value < 0.0);
            rows.slot[i] = rows.table.len() as u32;
            let magnitude = row.values[0].abs();
            if row.values.iter().all(|value| value.abs() == magnitude) {
                rows.table.push(LongRow { mass: magnitude * count as f64, first: EVEN, signed });
                continue;
            }
            let mut mass = 0.0;
            rows.entries.extend(row.iter().map(|(j, value)| {
                mass += value.abs();
                LongEntry { cumulative: mass, state: j as u32, cut: 0 }
            }));
            rows.table.push(LongRow { mass, first, signed });
            let entries = &mut rows.entries[first..];
            let (step, mut cut) = (mass / count as f64, 0);
            for k in 0..count {
                while cut + 1 < count && entries[cut].cumulative <= k as f64 * step {
                    cut += 1;
                }
                entries[k].cut = cut as u32;
            }
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
