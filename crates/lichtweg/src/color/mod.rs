//! Colour: four-lane spectra, and what scene files' colours become in them.

mod cie;
mod conductor;
mod convert;
mod spectrum;

pub use cie::luminance;
pub use conductor::{conductor, conductor_names};
pub use convert::{Role, rgb_spectrum};
pub use spectrum::{Spectra, Spectrum};
