//! Named RGB colour spaces, converted to linear sRGB.
//!
//! Both spaces other than sRGB share its white point D65, so white stays white for colours of surfaces and of lights.
//! Matrices from the primaries (SMPTE EG 432-1 "P3", ITU-R BT.2020) by way of CIE XYZ.
//!
//! Limits: a colour outside the gamut of sRGB is clipped to it. ACES is not converted.

/// The meaning of three numbers that follow `rgb`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum ColorSpace {
    #[default]
    Srgb,
    DciP3,
    Rec2020,
}

impl ColorSpace {
    /// The names of pbrt.
    pub const NAMES: [(&'static str, Self); 3] =
        [("srgb", Self::Srgb), ("dci-p3", Self::DciP3), ("rec2020", Self::Rec2020)];

    /// Linear sRGB of a colour in this space.
    pub fn to_srgb(self, rgb: [f32; 3]) -> [f32; 3] {
        let matrix: [[f32; 3]; 3] = match self {
            Self::Srgb => return rgb,
            Self::DciP3 => [
                [1.224_940_2, -0.224_940_18, 0.0],
                [-0.042_056_955, 1.042_057, 0.0],
                [-0.019_637_555, -0.078_636_04, 1.098_273_6],
            ],
            Self::Rec2020 => [
                [1.660_491, -0.587_641_1, -0.072_849_86],
                [-0.124_550_48, 1.132_899_9, -0.008_349_42],
                [-0.018_150_76, -0.100_578_9, 1.118_729_7],
            ],
        };
        matrix.map(|row| (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_stays_white() {
        for (name, space) in ColorSpace::NAMES {
            for channel in space.to_srgb([0.7; 3]) {
                assert!((channel - 0.7).abs() < 1e-5, "{name}");
            }
        }
    }

    #[test]
    fn primaries_are_more_saturated() {
        assert_eq!(ColorSpace::Rec2020.to_srgb([1.0, 0.0, 0.0])[1], 0.0);
        assert!(ColorSpace::DciP3.to_srgb([1.0, 0.0, 0.0])[0] > 1.2);
    }
}
