//! Pearson's chi-squared goodness of fit, sum (O - E)^2 / E, with pooling of sparse cells.

use super::Outcome;
use crate::special::chi_squared_survival;
use std::fmt;

/// Cells with a smaller expectation are pooled: below it the statistic is not chi-squared distributed (Cochran 1954).
pub const MIN_EXPECTED: f64 = 5.0;

/// Why counts cannot be tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChiSquaredError {
    /// Observed and expected differ in length.
    LengthMismatch,
    /// The expectation of this cell is negative or not finite, or (index of the last) all are zero.
    InvalidExpectation(usize),
    /// Fewer than two cells are left after pooling, so the test could not fail.
    TooFewCells,
}

impl fmt::Display for ChiSquaredError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LengthMismatch => write!(f, "observed and expected counts differ in number"),
            Self::InvalidExpectation(cell) => write!(f, "expected count of cell {cell} is not usable"),
            Self::TooFewCells => write!(f, "fewer than two cells expect {MIN_EXPECTED} or more"),
        }
    }
}

impl std::error::Error for ChiSquaredError {}

/// Tests counts against expectations that are known up to a common factor: they are scaled to the observed total.
///
/// Cells are pooled from the smallest expectation up until each pool expects [`MIN_EXPECTED`]. A count in a cell that
/// expects exactly nothing gives p = 0.
///
/// # Errors
/// See [`ChiSquaredError`].
pub fn chi_squared_test(observed: &[u64], expected: &[f64]) -> Result<Outcome, ChiSquaredError> {
    if observed.len() != expected.len() {
        return Err(ChiSquaredError::LengthMismatch);
    }
    if let Some(cell) = expected.iter().position(|e| !e.is_finite() || *e < 0.0) {
        return Err(ChiSquaredError::InvalidExpectation(cell));
    }
    let total: f64 = expected.iter().sum();
    if expected.is_empty() {
        return Err(ChiSquaredError::TooFewCells);
    }
    if total == 0.0 || total == f64::INFINITY {
        return Err(ChiSquaredError::InvalidExpectation(expected.len() - 1));
    }
    let scale = observed.iter().sum::<u64>() as f64 / total;
    let mut cells: Vec<(f64, u64)> =
        expected.iter().map(|e| e * scale).zip(observed.iter().copied()).collect();
    let impossible = cells.iter().any(|&(e, o)| e == 0.0 && o > 0);
    cells.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));

    let (mut statistic, mut pools) = (0.0, 0_u32);
    let mut pool = (0.0, 0.0);
    for (e, o) in cells {
        pool = (pool.0 + e, pool.1 + o as f64);
        if pool.0 >= MIN_EXPECTED {
            statistic += (pool.1 - pool.0) * (pool.1 - pool.0) / pool.0;
            pools += 1;
            pool = (0.0, 0.0);
        }
    }
    if impossible {
        return Ok(Outcome { statistic: f64::INFINITY, dof: f64::from(pools.max(1)), p_value: 0.0 });
    }
    if pools < 2 {
        return Err(ChiSquaredError::TooFewCells);
    }
    let dof = f64::from(pools - 1);
    Ok(Outcome { statistic, dof, p_value: chi_squared_survival(statistic, dof) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fair_die_by_hand() {
        // Statistic 13.4 for 5, 8, 9, 8, 10, 20 in 60 throws; P(chi2_5 > 13.4) = 0.0199 (tables: 0.02 at 13.388).
        let outcome = chi_squared_test(&[5, 8, 9, 8, 10, 20], &[1.0; 6]).unwrap();
        assert!((outcome.statistic - 13.4).abs() < 1e-12);
        assert_eq!(outcome.dof, 5.0);
        assert!((outcome.p_value - 0.019_905_220_334_774_4).abs() < 1e-9, "{}", outcome.p_value);
        assert!(outcome.rejects(0.05) && !outcome.rejects(0.01));
    }

    #[test]
    fn sparse_cells_are_pooled() {
        // Expectations 2, 2, 2 make one pool of 6; then 44 and 50: two degrees of freedom.
        let outcome = chi_squared_test(&[2, 50, 2, 44, 2], &[2.0, 50.0, 2.0, 44.0, 2.0]).unwrap();
        assert_eq!((outcome.statistic, outcome.dof, outcome.p_value), (0.0, 2.0, 1.0));
        // A sparse last pool joins the next cell rather than being dropped.
        let outcome = chi_squared_test(&[4, 48, 48], &[2.0, 49.0, 49.0]).unwrap();
        assert_eq!(outcome.dof, 1.0);
        assert!((outcome.statistic - (1.0 / 51.0 + 1.0 / 49.0)).abs() < 1e-12);
    }

    #[test]
    fn unusable_input() {
        assert_eq!(chi_squared_test(&[1], &[1.0, 2.0]), Err(ChiSquaredError::LengthMismatch));
        assert_eq!(chi_squared_test(&[], &[]), Err(ChiSquaredError::TooFewCells));
        assert_eq!(chi_squared_test(&[9, 9], &[1.0, f64::NAN]), Err(ChiSquaredError::InvalidExpectation(1)));
        assert_eq!(chi_squared_test(&[9, 9], &[0.0, 0.0]), Err(ChiSquaredError::InvalidExpectation(1)));
        assert_eq!(chi_squared_test(&[2, 2], &[1.0, 1.0]), Err(ChiSquaredError::TooFewCells));
        assert_eq!(chi_squared_test(&[50, 50, 1], &[1.0, 1.0, 0.0]).unwrap().p_value, 0.0);
    }
}
