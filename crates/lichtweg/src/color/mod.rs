//! Colour: four-lane spectra, and what scene files' colours become in them.

mod blackbody;
mod cie;
mod conductor;
mod convert;
mod lanes;
mod spectrum;

pub use blackbody::blackbody_luminance;
pub use cie::luminance;
pub use conductor::{conductor, conductor_names};
pub use convert::{Role, rgb_spectrum};
pub(crate) use lanes::SpectrumLanes;
pub use spectrum::{Spectra, Spectrum};
