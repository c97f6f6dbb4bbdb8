//! Linear systems x = M x + b by random walks: one unknown of many, with an honest interval.
//!
//! The rendering equation is such a system, and this crate is the discrete counterpart of light transport: a walk is created,
//! makes transitions and ends (von Neumann and Ulam; Forsythe and Leibler 1950), and it may be walked from either end, or from
//! both at once. Who needs one number out of a million does not have to solve for all of them.
//!
//! | module | what |
//! |---|---|
//! | [`matrix`], [`mod@system`] | sparse matrices; A x = b by splittings, absorbing chains, personalised PageRank |
//! | [`read`] | Matrix Market files, edge lists, vectors; plain or gzip |
//! | [`walk`] | walks forward and adjoint, their scores, endings and choices |
//! | [`push`] | the deterministic walk, with proven bounds |
//! | [`sequential`], [`krylov`] | all unknowns, by walks or without; `direct` by the feature `faer` |
//! | [`convergence`] | whether walks converge, between proven bounds |
//! | [`stopping`] | how many walks are enough |
//! | [`solver`] | all of it together, by plan |
//!
//! Results are the same bits for a seed, for any number of threads: sample values are counted, not remembered, and sums are
//! made in a fixed order.
//!
//! # Example
//!
//! The gambler who owns 3, plays for 1, and stops at 0 or 10, leaves with 10 in 3 of 10 cases:
//!
//! ```
//! use lichtweg_walk::{Functional, Matrix, Options, Solver, System};
//!
//! let mut p = vec![(0, 0, 1.0), (10, 10, 1.0)];
//! for money in 1..10 {
//!     p.extend([(money, money - 1, 0.5), (money, money + 1, 0.5)]);
//! }
//! let mut start = vec![0.0; 11];
//! start[3] = 1.0;
//! let system = System::absorbing_chain(&Matrix::from_triplets(11, 11, &p)?, start)?;
//! let answer = Solver::new(&system).solve(&Functional::Unknown(10), &Options::default())?;
//! assert!(answer.low() <= 0.3 && 0.3 <= answer.high());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod convergence;
#[cfg(feature = "faer")]
pub mod direct;
pub mod krylov;
pub mod matrix;
pub mod push;
pub mod read;
pub mod sequential;
pub mod solver;
pub mod stopping;
pub mod system;
mod vector;
pub mod walk;

pub use matrix::Matrix;
pub use solver::{Answer, Functional, Method, Options, Refusal, Solver};
pub use system::{Splitting, System};
