//! From stated colours to spectra.

use super::blackbody::planck;
use super::cie::{Illuminant, luminance, tristimulus, xyz_to_srgb};
use super::{Spectrum, conductor};
use crate::scene::description::{ConductorQuantity, SpectrumDescription};

/// What a stated colour is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A factor in [0, 1] on reflected light, or another property of matter.
    Property,
    /// Emitted light.
    Emission,
}

/// The spectrum that a stated colour becomes in RGB mode; `None` where it names an unknown preset.
///
/// Sampled spectra are weighed by the CIE 1931 observer, properties under D65; what falls outside the sRGB gamut
/// is cut to zero.
pub fn rgb_spectrum(description: &SpectrumDescription, role: Role) -> Option<Spectrum> {
    let illuminant = match role {
        Role::Property => Illuminant::D65,
        Role::Emission => Illuminant::Equal,
    };
    let in_gamut = |xyz| Spectrum::rgb(xyz_to_srgb(xyz).map(|c| c as f32)).max_scalar(0.0);
    Some(match description {
        SpectrumDescription::Constant(v) => Spectrum::splat(*v),
        SpectrumDescription::Rgb(rgb) => Spectrum::rgb(*rgb),
        SpectrumDescription::Sampled { wavelengths, values } => {
            in_gamut(tristimulus(|w| interpolate(wavelengths, values, w), illuminant))
        }
        SpectrumDescription::Blackbody { kelvin, scale } => {
            let kelvin = f64::from(*kelvin);
            let color =
                in_gamut(tristimulus(|w| planck(w, kelvin) / planck(560.0, kelvin), Illuminant::Equal));
            color * (scale / luminance(color.to_rgb()))
        }
        SpectrumDescription::Conductor { name, quantity } => {
            let (eta, k) = conductor(name)?;
            match quantity {
                ConductorQuantity::Eta => eta,
                ConductorQuantity::K => k,
            }
        }
    })
}

/// Linear between the samples, constant outside.
fn interpolate(wavelengths: &[f32], values: &[f32], w: f64) -> f64 {
    let after = wavelengths.partition_point(|&x| f64::from(x) <= w);
    let value = |i: usize| f64::from(values.get(i).copied().unwrap_or(0.0));
    if after == 0 || after == wavelengths.len() {
        return value(after.saturating_sub(1));
    }
    let (a, b) = (f64::from(wavelengths[after - 1]), f64::from(wavelengths[after]));
    let t = (w - a) / (b - a);
    value(after - 1) * (1.0 - t) + value(after) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_and_flat_spectra_agree() {
        let flat = SpectrumDescription::Sampled { wavelengths: vec![400.0, 700.0], values: vec![0.3, 0.3] };
        let s = rgb_spectrum(&flat, Role::Property).unwrap();
        for (a, b) in s.0.iter().zip(Spectrum::splat(0.3).0) {
            assert!((a - b).abs() < 1e-4);
        }
    }

    #[test]
    fn black_bodies_redden_as_they_cool() {
        let color = |kelvin| {
            rgb_spectrum(&SpectrumDescription::Blackbody { kelvin, scale: 2.0 }, Role::Emission).unwrap()
        };
        let (warm, cold) = (color(2700.0).to_rgb(), color(10000.0).to_rgb());
        assert!(warm[0] > warm[2] && cold[2] > cold[0]);
        assert!((luminance(warm) - 2.0).abs() < 1e-3);
        // A 6504 K black body lies close to the white of sRGB.
        let white = color(6504.0).to_rgb();
        assert!(white.iter().all(|c| (c - 2.0).abs() < 0.15), "{white:?}");
    }
}
