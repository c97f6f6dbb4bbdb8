//! Systems x = M x + b, and the problems that are brought into this form.
//!
//! | problem | M | b | x_i |
//! |---|---|---|---|
//! | fixed point | M | b | as it is |
//! | A x = b, [`Splitting`] | I - w B^-1 A | w B^-1 b | the same x |
//! | absorbing chain (P, p0) | P^T | p0 | expected number of visits to state i |
//! | personalised PageRank | a P^T | (1 - a) s | rank of node i |
//!
//! The lecture's equilibrium P_i = sum_j p_ij P_j + p0_i has its indices the wrong way round for p_ij meaning i -> j:
//! a chain's M is the *transpose* of its transition matrix.

mod chain;
mod pagerank;
mod splitting;

use std::sync::OnceLock;

use crate::Matrix;
use crate::convergence::CONTRACTS;

pub use splitting::Splitting;

/// x = M x + b.
///
/// ```
/// use lichtweg_walk::{Matrix, System};
/// let a = Matrix::from_triplets(2, 2, &[(0, 0, 4.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 4.0)]).unwrap();
/// let system = System::linear(&a, &[3.0, 3.0], Default::default()).unwrap();
/// assert_eq!(system.matrix().get(0, 1), 0.25);
/// ```
#[derive(Debug)]
pub struct System {
    matrix: Matrix,
    source: Vec<f64>,
    summary: Summary,
    transposed: OnceLock<Matrix>,
    /// What A was before the splitting, for solvers that prefer it.
    linear: Option<Linear>,
}

/// What one pass over M and b tells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Summary {
    /// Smallest and largest row sum of |M|.
    pub row_mass: (f64, f64),
    /// Neither M nor b has a negative element.
    pub nonnegative: bool,
    /// Smallest b_i; infinite where there is none.
    pub smallest_source: f64,
    /// Largest |b_i|.
    pub largest_source: f64,
    /// Number of b_i that are not zero.
    pub sources: usize,
}

impl Summary {
    fn new(matrix: &Matrix, source: &[f64]) -> Self {
        let masses = matrix.map_rows(|i| matrix.row(i).mass());
        let range = masses.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &m| (low.min(m), high.max(m)));
        Self {
            row_mass: if masses.is_empty() { (0.0, 0.0) } else { range },
            nonnegative: source.iter().all(|&value| value >= 0.0) && matrix.is_nonnegative(),
            smallest_source: source.iter().copied().fold(f64::INFINITY, f64::min),
            largest_source: crate::vector::largest(source),
            sources: source.iter().filter(|&&value| value != 0.0).count(),
        }
    }
}

/// A x = b, as it was given.
#[derive(Clone, Debug)]
pub(crate) struct Linear {
    pub matrix: Matrix,
    pub right_side: Vec<f64>,
    /// How it was split.
    pub splitting: Splitting,
    /// Whether it is symmetric with a positive diagonal, and was split by that without damping.
    pub definite: bool,
}

impl Linear {
    /// Whether it was split by its diagonal.
    pub fn by_diagonal(&self) -> bool {
        matches!(self.splitting, Splitting::Jacobi { .. })
    }
}

/// Why numbers do not make a system.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SystemError {
    /// As many equations as unknowns are needed.
    #[error("the matrix is {rows} x {columns}: a system needs a square one")]
    NotSquare {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// A vector of another length than the matrix.
    #[error("the {what} has {length} elements, the matrix {rows} rows")]
    WrongLength {
        /// Which vector.
        what: &'static str,
        /// Its length.
        length: usize,
        /// Rows of the matrix.
        rows: usize,
    },
    /// An element that is NaN or infinite.
    #[error("element {index} (from 0) of the {what} is not finite")]
    NotFinite {
        /// Which vector.
        what: &'static str,
        /// The element.
        index: usize,
    },
    /// A diagonal element or block that cannot be divided by.
    #[error(
        "{what} at row {row} (from 0) cannot be divided by: this splitting does not exist; try another, or order the equations so that the diagonal is large"
    )]
    Singular {
        /// Diagonal element or block.
        what: &'static str,
        /// First row of it.
        row: usize,
    },
    /// A parameter outside of its range.
    #[error("{0}")]
    Parameter(String),
    /// What should be probabilities is not.
    #[error("state {state} (from 0): {message}")]
    Probability {
        /// The state.
        state: usize,
        /// What is wrong.
        message: String,
    },
}

impl System {
    /// x = M x + b directly.
    ///
    /// # Errors
    /// M is not square, b has another length or is not finite.
    pub fn fixed_point(matrix: Matrix, source: Vec<f64>) -> Result<Self, SystemError> {
        check_square(&matrix)?;
        check_vector("source vector", &source, &matrix)?;
        let summary = Summary::new(&matrix, &source);
        Ok(Self { matrix, source, summary, transposed: OnceLock::new(), linear: None })
    }

    /// A x = b, split into x = M x + b'.
    ///
    /// # Errors
    /// As [`System::fixed_point`]; the diagonal (or a block of it) is singular; the damping is not finite or zero.
    pub fn linear(matrix: &Matrix, right_side: &[f64], splitting: Splitting) -> Result<Self, SystemError> {
        check_square(matrix)?;
        check_vector("right side", right_side, matrix)?;
        let (split, source) = splitting.split(matrix, right_side)?;
        let mut system = Self::fixed_point(split, source)?;
        let definite = splitting == Splitting::default()
            && matrix.is_symmetric()
            && matrix.diagonal().iter().all(|&d| d > 0.0);
        let (matrix, right_side) = (matrix.clone(), right_side.to_vec());
        system.linear = Some(Linear { matrix, right_side, splitting, definite });
        Ok(system)
    }

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.source.len()
    }

    /// M.
    #[must_use]
    pub fn matrix(&self) -> &Matrix {
        &self.matrix
    }

    /// b.
    #[must_use]
    pub fn source(&self) -> &[f64] {
        &self.source
    }

    /// M transposed; made at the first call.
    pub fn transposed(&self) -> &Matrix {
        self.transposed.get_or_init(|| self.matrix.transposed())
    }

    /// Smallest and largest row sum of |M|; the largest is its maximum norm.
    #[must_use]
    pub fn row_mass(&self) -> (f64, f64) {
        self.summary.row_mass
    }

    /// Whether neither M nor b has a negative element, so that x has none.
    #[must_use]
    pub fn is_nonnegative(&self) -> bool {
        self.summary.nonnegative
    }

    /// What one pass over M and b told.
    pub(crate) fn summary(&self) -> &Summary {
        &self.summary
    }

    /// A lower bound of all x_i where neither M nor b has a negative element: x >= min b + min mass * min x.
    pub(crate) fn smallest_solution(&self) -> f64 {
        let Summary { row_mass, nonnegative, smallest_source, .. } = self.summary;
        if nonnegative && row_mass.0 < CONTRACTS { smallest_source / (1.0 - row_mass.0) } else { 0.0 }
    }

    /// Whether M^T is at hand.
    pub(crate) fn has_transposed(&self) -> bool {
        self.transposed.get().is_some()
    }

    /// A and b of A x = b, where the system was given so.
    pub(crate) fn as_linear(&self) -> Option<&Linear> {
        self.linear.as_ref()
    }

    /// Whether M = I - D^-1 A with the diagonal D > 0 of a symmetric A, which is positive definite if rho(|M|) < 1.
    pub(crate) fn is_definite(&self) -> bool {
        self.linear.as_ref().is_some_and(|linear| linear.definite)
    }

    /// b + M x - x: zero where x solves the system.
    ///
    /// # Panics
    /// When x has another length.
    #[must_use]
    pub fn residual(&self, x: &[f64]) -> Vec<f64> {
        self.matrix.map_rows(|i| self.source[i] + self.matrix.row(i).dot(x) - x[i])
    }
}

fn check_square(matrix: &Matrix) -> Result<(), SystemError> {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    if rows == columns { Ok(()) } else { Err(SystemError::NotSquare { rows, columns }) }
}

fn check_vector(what: &'static str, vector: &[f64], matrix: &Matrix) -> Result<(), SystemError> {
    if vector.len() != matrix.rows() {
        return Err(SystemError::WrongLength { what, length: vector.len(), rows: matrix.rows() });
    }
    match vector.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(SystemError::NotFinite { what, index }),
        None => Ok(()),
    }
}
