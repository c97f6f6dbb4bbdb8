//! Linear systems x = M x + b by random walks: the discrete counterpart of light transport.
#![allow(missing_docs)]
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
