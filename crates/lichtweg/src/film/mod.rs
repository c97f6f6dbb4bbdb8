//! The image being made: how samples become pixels, and what is remembered of them.

mod filter;
mod pixel;

pub use filter::Filter;
pub use pixel::{AuxiliarySums, Pixel};
