//! Linear systems x = M x + b by random walks: the discrete counterpart of light transport.
#![allow(missing_docs)]
pub mod matrix;
pub mod read;
pub mod system;
pub mod walk;

pub use matrix::Matrix;
pub use system::{Splitting, System};
pub mod convergence;
pub mod push;
pub mod stopping;
