//! Absorbing Markov chains: x_j is the expected number of visits to state j of a particle that is created with
//! probabilities p0, goes from i to j with probability p_ij, and ends in i with what is left, p*_i = 1 - sum_j p_ij.
//!
//! x = P^T x + p0 (Kemeny and Snell, *Finite Markov chains*, 1960, chapter 3: x is the fundamental matrix applied to p0).
//! The probability to end in j is p*_j x_j. A state with p_jj = 1 is absorbing: it is left nowhere, and its x_j is the
//! probability to be absorbed there.

use super::{System, SystemError, check_square, check_vector};
use crate::Matrix;

/// How far rows may exceed 1 by rounding.
const ROUNDING: f64 = 1e-9;

impl System {
    /// The visits of an absorbing chain of transition probabilities `p` (row i: from state i) that starts by `start`.
    ///
    /// # Errors
    /// Negative probabilities, rows that sum to more than 1, lengths that do not fit.
    pub fn absorbing_chain(p: &Matrix, start: Vec<f64>) -> Result<Self, SystemError> {
        Self::fixed_point(checked(p)?.transposed(), start)
    }

    /// As [`System::absorbing_chain`], with the probabilities p* to end in each state given, and checked.
    ///
    /// # Errors
    /// As there; p*_i and row i do not sum to 1.
    pub fn absorbing_chain_with(
        p: &Matrix,
        absorption: &[f64],
        start: Vec<f64>,
    ) -> Result<Self, SystemError> {
        check_vector("absorption", absorption, p)?;
        for (state, &ending) in absorption.iter().enumerate() {
            let sum = p.row(state).iter().map(|(_, value)| value).sum::<f64>() + ending;
            if ending < 0.0 || (sum - 1.0).abs() > ROUNDING {
                let message = format!("transitions and absorption sum to {sum}, not to 1");
                return Err(SystemError::Probability { state, message });
            }
        }
        Self::absorbing_chain(p, start)
    }
}

/// P without the rows of absorbing states.
fn checked(p: &Matrix) -> Result<Matrix, SystemError> {
    check_square(p)?;
    let mut kept = Vec::with_capacity(p.entries());
    for state in 0..p.rows() {
        let row = p.row(state);
        if let Some((j, value)) = row.iter().find(|&(_, value)| value < 0.0) {
            let message = format!("the probability to go to {j} is {value}");
            return Err(SystemError::Probability { state, message });
        }
        if row.mass() > 1.0 + ROUNDING {
            let message = format!("the probabilities to go on sum to {}", row.mass());
            return Err(SystemError::Probability { state, message });
        }
        let absorbing = row.indices == [state as u32] && row.values[0] >= 1.0 - ROUNDING;
        if !absorbing {
            kept.extend(row.iter().map(|(j, value)| (state as u32, j as u32, value)));
        }
    }
    let size = p.rows();
    Matrix::from_triplets(size, size, &kept).map_err(|error| SystemError::Parameter(error.to_string()))
}
