//! The image being made: how samples become pixels, and what is remembered of them.

mod filter;
mod pixel;
mod splat;

pub use filter::Filter;
pub use pixel::{AuxiliarySums, Pixel};
pub use splat::{Splat, SplatFilm};
