//! The transform directives as matrices (pbrt-v4 `util/transform.cpp`).
//!
//! pbrt's camera space has x to the right, y up and z forward: left-handed where the world is taken as right-handed.
//! `LookAt` maps the world to it.

use lichtweg::scene::description::{Diagnostic, Span};
use lichtweg_ray::math::Affine;

use super::parser::{Parser, Reported};

/// Reads the numbers of the transform directive `word`. A map that is singular or not affine is reported and left out.
pub(super) fn read(parser: &mut Parser, word: &str, directive: Span) -> Result<Affine, Reported> {
    let (map, span) = match word {
        "Translate" => {
            let ([x, y, z], span) = parser.numbers(false)?;
            (Some(Affine::translation(x, y, z)), span)
        }
        "Scale" => {
            let ([x, y, z], span) = parser.numbers(false)?;
            (Some(Affine::scaling(x, y, z)), span)
        }
        "Rotate" => {
            let ([degrees, x, y, z], span) = parser.numbers(false)?;
            let axis = [x, y, z];
            (axis.iter().any(|a| *a != 0.0).then(|| Affine::rotation(axis, degrees)), span)
        }
        "LookAt" => {
            let ([ex, ey, ez, lx, ly, lz, ux, uy, uz], span) = parser.numbers(false)?;
            (look_at([ex, ey, ez], [lx, ly, lz], [ux, uy, uz]), span)
        }
        _ => {
            let (matrix, span) = parser.numbers::<16>(true)?;
            (affine(&matrix), span)
        }
    };
    match map.filter(|map| map.inverse().is_some()) {
        Some(map) => Ok(map),
        None => {
            let text = match word {
                "LookAt" => "LookAt needs a target away from the eye, and an up that points elsewhere",
                "Rotate" => "the axis of a rotation cannot be zero",
                "Transform" | "ConcatTransform" => "the matrix is singular or not affine",
                _ => "the map is singular",
            };
            let whole = Span { start: directive.start, ..span };
            parser
                .report
                .substitute(Diagnostic::error("bad-transform", text).at(whole, "left out"), "it is left out");
            Ok(Affine::IDENTITY)
        }
    }
}

/// The map of sixteen numbers, column by column; `None` where it is not affine.
fn affine(m: &[f64; 16]) -> Option<Affine> {
    let w = m[15];
    let is_affine = m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0 && w != 0.0;
    is_affine.then(|| Affine { rows: std::array::from_fn(|r| std::array::from_fn(|c| m[4 * c + r] / w)) })
}

/// From the world to the space of a camera at `eye`. Its x axis is up x forward, as that of
/// [`Affine::look_at`] is; only what it is called differs: in pbrt it points to the right of the image.
fn look_at(eye: [f64; 3], target: [f64; 3], up: [f64; 3]) -> Option<Affine> {
    Affine::look_at(eye, target, up)?.inverse()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lichtweg_ray::math::Vec3;

    #[test]
    fn look_at_is_up_cross_forward() {
        // up x forward = y x (-z) = -x
        let to_camera = look_at([0.0, 0.0, 5.0], [0.0; 3], [0.0, 1.0, 0.0]).unwrap();
        assert_eq!(to_camera.point(Vec3::new(0.0, 0.0, 5.0)), Vec3::ZERO);
        assert_eq!(to_camera.vector(Vec3::X), Vec3::new(-1.0, 0.0, 0.0));
        assert_eq!(to_camera.vector(Vec3::new(0.0, 0.0, -1.0)), Vec3::Z);
    }
}
