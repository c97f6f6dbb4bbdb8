//! pbrt's named spectra: metals, glasses and standard illuminants.
//!
//! Limits: of a glass only the index at the sodium D line is known, of a fluorescent illuminant only its colour.

use lichtweg::scene::description::{ConductorQuantity, SpectrumDescription};

/// What a name stands for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Named {
    /// Part of a metal's index of refraction.
    Metal(SpectrumDescription),
    /// The index of refraction of a glass at 589.3 nm.
    Glass(f32),
    /// An illuminant of luminance 1, and whether only its colour is known.
    Illuminant(SpectrumDescription, bool),
}

/// The metals, as in pbrt; the presets of the description carry the same names.
const METALS: [&str; 7] = ["Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"];

/// Indices at 589.3 nm, interpolated from the catalogue values (Schott) that pbrt-v4 tabulates. It calls the glasses
/// SF5, SF10 and SF11 F5, F10 and F11.
const GLASSES: [(&str, f32); 7] = [
    ("glass-BK7", 1.51673),
    ("glass-BAF10", 1.66988),
    ("glass-FK51A", 1.48651),
    ("glass-LASF9", 1.85004),
    ("glass-F5", 1.67254),
    ("glass-F10", 1.72806),
    ("glass-F11", 1.78448),
];

/// Chromaticities x, y of the CIE 1931 observer (CIE 015:2018; D60 of the Academy: TB-2014-004).
const ILLUMINANTS: [(&str, [f64; 2]); 14] = [
    ("stdillum-D50", [0.34567, 0.35850]),
    ("illum-acesD60", [0.32168, 0.33767]),
    ("stdillum-F1", [0.31310, 0.33727]),
    ("stdillum-F2", [0.37208, 0.37529]),
    ("stdillum-F3", [0.40910, 0.39430]),
    ("stdillum-F4", [0.44018, 0.40329]),
    ("stdillum-F5", [0.31379, 0.34531]),
    ("stdillum-F6", [0.37790, 0.38835]),
    ("stdillum-F7", [0.31292, 0.32933]),
    ("stdillum-F8", [0.34588, 0.35875]),
    ("stdillum-F9", [0.37417, 0.37281]),
    ("stdillum-F10", [0.34609, 0.35986]),
    ("stdillum-F11", [0.38052, 0.37713]),
    ("stdillum-F12", [0.43695, 0.40441]),
];

/// Temperature of illuminant A: 2848 K on the scale of 1931, with today's second radiation constant.
const ILLUMINANT_A_KELVIN: f32 = 2855.54;

/// The spectrum of a name.
pub(super) fn find(name: &str) -> Option<Named> {
    if let Some((_, eta)) = GLASSES.iter().find(|(glass, _)| *glass == name) {
        return Some(Named::Glass(*eta));
    }
    if let Some((_, xy)) = ILLUMINANTS.iter().find(|(illuminant, _)| *illuminant == name) {
        return Some(Named::Illuminant(SpectrumDescription::Rgb(rgb_of_chromaticity(*xy)), true));
    }
    match name {
        // The white point of sRGB.
        "stdillum-D65" => return Some(Named::Illuminant(SpectrumDescription::Rgb([1.0; 3]), false)),
        "stdillum-A" => {
            let kelvin = ILLUMINANT_A_KELVIN;
            return Some(Named::Illuminant(SpectrumDescription::Blackbody { kelvin, scale: 1.0 }, false));
        }
        _ => {}
    }
    let (metal, part) = name.strip_prefix("metal-")?.rsplit_once('-')?;
    let quantity = match part {
        "eta" => ConductorQuantity::Eta,
        "k" => ConductorQuantity::K,
        _ => return None,
    };
    let name = METALS.iter().find(|known| **known == metal)?;
    Some(Named::Metal(SpectrumDescription::Conductor { name: (*name).to_owned(), quantity }))
}

/// All names.
pub(super) fn names() -> Vec<String> {
    let metals = METALS.iter().flat_map(|m| [format!("metal-{m}-eta"), format!("metal-{m}-k")]);
    let others = GLASSES.iter().map(|(n, _)| *n).chain(ILLUMINANTS.iter().map(|(n, _)| *n));
    metals.chain(others.chain(["stdillum-A", "stdillum-D65"]).map(str::to_owned)).collect()
}

/// Linear sRGB (IEC 61966-2-1) of luminance 1 and a chromaticity, clipped to the gamut.
fn rgb_of_chromaticity([x, y]: [f64; 2]) -> [f32; 3] {
    let (big_x, big_z) = (x / y, (1.0 - x - y) / y);
    let rows = [
        [3.240_97, -1.537_383, -0.498_611],
        [-0.969_244, 1.875_968, 0.041_555],
        [0.055_63, -0.203_977, 1.056_972],
    ];
    rows.map(|[a, b, c]| (a * big_x + b + c * big_z).max(0.0) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_found() {
        let names = names();
        assert_eq!(names.len(), 37);
        for name in names {
            assert!(find(&name).is_some(), "{name}");
        }
        assert_eq!(find("metal-Xx-eta"), None);
        assert_eq!(find("metal-Ag-q"), None);
    }

    #[test]
    fn daylight_is_near_white_and_warm_light_is_warm() {
        for channel in rgb_of_chromaticity([0.3127, 0.3290]) {
            assert!((channel - 1.0).abs() < 1e-3);
        }
        let [r, g, b] = rgb_of_chromaticity([0.43695, 0.40441]);
        assert!(r > g && g > b);
        assert!((0.212_639 * r + 0.715_169 * g + 0.072_192 * b - 1.0).abs() < 1e-3);
    }
}
