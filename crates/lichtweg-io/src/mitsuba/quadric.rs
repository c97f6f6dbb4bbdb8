//! Spheres, disks and cylinders as unit shapes under a transform (Mitsuba 3 `src/shapes/sphere.cpp`, `disk.cpp`,
//! `cylinder.cpp`).
//!
//! Normals: a sphere's and a cylinder's point outwards, a disk's along +z. Under a mirroring transform Mitsuba 3.9 turns
//! spheres inside out and leaves the others as they are (measured).

use lichtweg::scene::description::GeometryDescription;
use lichtweg_ray::math::Affine;

use super::shape::Form;
use super::translate::Translator;
use super::tree::Object;

const FULL_TURN: f32 = 360.0;

impl<'a> Translator<'a> {
    pub fn sphere(&mut self, object: &'a Object) -> Form {
        let [x, y, z] = self.vector(object, "center").unwrap_or([0.0; 3]);
        let r = self.radius(object);
        Form {
            geometry: GeometryDescription::Sphere { z_min: -1.0, z_max: 1.0, phi_max: FULL_TURN },
            to_object: Affine::translation(x, y, z).after(&Affine::scaling(r, r, r)),
            flipped_by_mirror: true,
            file: None,
        }
    }

    pub fn disk(&mut self, _object: &'a Object) -> Form {
        Form {
            geometry: GeometryDescription::Disk { inner_radius: 0.0, phi_max: FULL_TURN },
            to_object: Affine::IDENTITY,
            flipped_by_mirror: false,
            file: None,
        }
    }

    pub fn cylinder(&mut self, object: &'a Object) -> Option<Form> {
        let p0 = self.vector(object, "p0").unwrap_or([0.0; 3]);
        let p1 = self.vector(object, "p1").unwrap_or([0.0, 0.0, 1.0]);
        let r = self.radius(object);
        let axis: [f64; 3] = std::array::from_fn(|i| p1[i] - p0[i]);
        let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
        if !(length > 0.0 && length.is_finite()) {
            self.error(
                "out-of-range",
                "the ends \"p0\" and \"p1\" of a cylinder must differ",
                object.span_of("p1"),
            );
            return None;
        }
        let frame = frame_about(axis.map(|v| v / length));
        let to_object =
            Affine::translation(p0[0], p0[1], p0[2]).after(&frame).after(&Affine::scaling(r, r, length));
        let geometry = GeometryDescription::Cylinder { z_min: 0.0, z_max: 1.0, phi_max: FULL_TURN };
        Some(Form { geometry, to_object, flipped_by_mirror: false, file: None })
    }

    fn radius(&mut self, object: &'a Object) -> f64 {
        f64::from(self.float_in(object, "radius", 1.0, "greater than 0", |v| v > 0.0))
    }
}

/// A right-handed rotation that takes +z to `n`, the one Mitsuba takes: Duff et al., "Building an Orthonormal Basis,
/// Revisited", JCGT 6(1), 2017.
fn frame_about(n: [f64; 3]) -> Affine {
    let sign = 1.0f64.copysign(n[2]);
    let a = -1.0 / (sign + n[2]);
    let b = n[0] * n[1] * a;
    let s = [1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]];
    let t = [b, sign + n[1] * n[1] * a, -n[1]];
    Affine { rows: std::array::from_fn(|i| [s[i], t[i], n[i], 0.0]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lichtweg_ray::math::Vec3;

    #[test]
    fn frames_are_rotations_onto_their_axis() {
        for n in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.36, 0.48, 0.8], [0.0, 1.0, 0.0]] {
            let frame = frame_about(n);
            assert!((frame.determinant() - 1.0).abs() < 1e-12, "{n:?}");
            let z = frame.vector(Vec3::Z).to_array();
            assert!(z.iter().zip(n).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-6), "{n:?}");
        }
    }
}
