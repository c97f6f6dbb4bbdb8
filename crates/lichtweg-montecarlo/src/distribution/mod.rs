//! Discrete and piecewise constant distributions by weight tables.
//!
//! | type | draws | cost of a draw | storage per entry |
//! |---|---|---|---|
//! | [`AliasTable`] | an index | O(1) | 12 bytes |
//! | [`Discrete`] | an index, monotone in u (keeps stratification) | O(log n) | 4 bytes |
//! | [`PiecewiseConstant1D`] | a point of `[0,1]` | O(log n) | 4 bytes |
//! | [`PiecewiseConstant2D`] | a point of `[0,1]^2` | O(log h), columns about O(1) | 4.25 bytes |
//!
//! In all of them an entry of weight zero is never drawn, and one of positive weight always can be.

mod alias;
mod cdf;
mod piecewise;

pub use alias::AliasTable;
pub use cdf::Discrete;
pub use piecewise::{PiecewiseConstant1D, PiecewiseConstant2D};

use std::fmt;

/// An index drawn from a discrete distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The entry drawn.
    pub index: usize,
    /// Its probability.
    pub pmf: f32,
    /// What is left of the random number: uniform in [0,1) given the index, to be used again.
    pub remapped: f32,
}

/// Why weights do not make a distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightError {
    /// There are no weights.
    Empty,
    /// More entries than the table can address.
    TooMany,
    /// The number of weights is not width times height.
    WrongLength,
    /// The weight at this index is negative.
    Negative(usize),
    /// The weight at this index is NaN or infinite.
    NotFinite(usize),
    /// All weights are zero.
    AllZero,
}

impl fmt::Display for WeightError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "no weights given"),
            Self::TooMany => write!(f, "too many weights"),
            Self::WrongLength => write!(f, "the number of weights is not width times height"),
            Self::Negative(index) => write!(f, "weight {index} is negative"),
            Self::NotFinite(index) => write!(f, "weight {index} is not finite"),
            Self::AllZero => write!(f, "all weights are zero"),
        }
    }
}

impl std::error::Error for WeightError {}

/// Checks one weight.
fn checked(index: usize, weight: f64) -> Result<f64, WeightError> {
    match weight {
        w if !w.is_finite() => Err(WeightError::NotFinite(index)),
        w if w < 0.0 => Err(WeightError::Negative(index)),
        w => Ok(w),
    }
}

/// The largest weight, after checking all; an error when there is none above zero.
fn largest_weight(weights: impl Iterator<Item = f64>) -> Result<f64, WeightError> {
    let mut largest = None;
    for (index, weight) in weights.enumerate() {
        largest = Some(checked(index, weight)?.max(largest.unwrap_or(0.0)));
    }
    match largest {
        None => Err(WeightError::Empty),
        Some(0.0) => Err(WeightError::AllZero),
        Some(weight) => Ok(weight),
    }
}

/// Largest f32 below one.
const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// Rounds a fraction in [0,1) to f32 without reaching one.
fn below_one(fraction: f64) -> f32 {
    (fraction as f32).min(ONE_MINUS_EPSILON)
}
