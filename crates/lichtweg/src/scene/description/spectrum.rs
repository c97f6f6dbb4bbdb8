//! Colours as scene files state them.

/// A quantity over the visible wavelengths, as stated; what it becomes depends on the job's colour mode.
#[derive(Clone, Debug, PartialEq)]
pub enum SpectrumDescription {
    /// The same value at all wavelengths.
    Constant(f32),
    /// Linear sRGB.
    Rgb([f32; 3]),
    /// Values at increasing wavelengths in nanometres, linear between and constant outside.
    Sampled {
        /// Wavelengths in nanometres, strictly increasing.
        wavelengths: Vec<f32>,
        /// The value at each.
        values: Vec<f32>,
    },
    /// A black body's emission, scaled so that its luminance is `scale`.
    Blackbody {
        /// Temperature in kelvin.
        kelvin: f32,
        /// Luminance.
        scale: f32,
    },
    /// A measured conductor's index of refraction, by Mitsuba's preset name, such as `Au`.
    Conductor {
        /// The preset's name.
        name: String,
        /// Which part of the complex index.
        quantity: ConductorQuantity,
    },
}

/// The two parts of a conductor's complex index of refraction eta + i k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConductorQuantity {
    /// The real part.
    Eta,
    /// The imaginary part, the absorption.
    K,
}

impl Default for SpectrumDescription {
    fn default() -> Self {
        Self::Constant(0.0)
    }
}
