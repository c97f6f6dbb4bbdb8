//! Triangles whose vertices move.
//!
//! Corners are interpolated for the ray's time and go to the watertight test one triangle at a time. A vertex depends
//! on the time alone, so that moving meshes do not leak either.

use std::sync::Arc;

use super::Candidate;
use crate::accel::BuildError;
use crate::build::{MAX_COORDINATE, padded};
use crate::math::{Bounds3, Vec3};
use crate::ray::unit_time;
use crate::triangle::{Shear, triangle};

/// A triangle mesh with vertices that move linearly between keys, which are spread evenly over the times [0, 1].
/// Clones share their arrays.
#[derive(Clone, Debug)]
pub struct MovingMesh {
    /// Vertex positions at each key, the same number in all; a single key stands still.
    pub keys: Arc<[Arc<[Vec3]>]>,
    /// Three positions a triangle; the counter-clockwise side is the front.
    pub indices: Arc<[[u32; 3]]>,
}

impl MovingMesh {
    /// A mesh from its arrays; [`crate::Accel::build`] checks them.
    pub fn new(keys: impl IntoIterator<Item = Arc<[Vec3]>>, indices: impl Into<Arc<[[u32; 3]]>>) -> Self {
        Self { keys: keys.into_iter().collect(), indices: indices.into() }
    }

    /// The corners of triangle `primitive` at a time in [0, 1]. Panics where an index is out of range.
    pub fn corners(&self, primitive: u32, time: f32) -> [Vec3; 3] {
        let last = self.keys.len() - 1;
        let at = unit_time(time) * last as f32;
        let segment = (at as usize).min(last.saturating_sub(1));
        let part = at - segment as f32;
        let (from, to) = (&self.keys[segment], &self.keys[(segment + 1).min(last)]);
        self.indices[primitive as usize].map(|i| between(from[i as usize], to[i as usize], part))
    }

    pub(crate) fn check(&self, geometry: u32) -> Result<(), BuildError> {
        let vertices = self.keys.first().map_or(0, |key| key.len());
        if self.keys.is_empty() || self.keys.iter().any(|key| key.len() != vertices) {
            let reason = "a moving mesh needs a key, and the same number of vertices in all";
            return Err(BuildError::InvalidMotion { geometry, reason });
        }
        for (primitive, triangle) in (0..).zip(self.indices.iter()) {
            if let Some(&index) = triangle.iter().find(|&&i| i as usize >= vertices) {
                return Err(BuildError::IndexOutOfRange { geometry, primitive, index, vertices });
            }
        }
        Ok(())
    }

    /// A box around all times of each triangle; not a number where one of its corners is not finite.
    pub(crate) fn boxes(&self) -> Vec<Bounds3> {
        let of = |triangle: &[u32; 3]| {
            let corners = || self.keys.iter().flat_map(|key| triangle.map(|i| key[i as usize]));
            if corners().all(|p| p.is_finite() && p.abs().max_element() <= MAX_COORDINATE) {
                padded(Bounds3::of(corners()))
            } else {
                Bounds3 { min: Vec3::splat(f32::NAN), max: Vec3::splat(f32::NAN) }
            }
        };
        self.indices.iter().map(of).collect()
    }

    #[inline(never)]
    pub(crate) fn intersect(
        &self,
        primitive: u32,
        shear: &Shear,
        time: f32,
        tnear: f32,
        tfar: f32,
    ) -> Option<Candidate> {
        let h = triangle(shear, self.corners(primitive, time))?;
        (h.t > tnear && h.t <= tfar).then_some(Candidate { t: h.t, u: h.u, v: h.v, primitive })
    }

    pub(crate) fn normal(&self, primitive: u32, time: f32) -> Vec3 {
        let [a, b, c] = self.corners(primitive, time);
        (b - a).cross(c - a)
    }
}

/// The point at a fraction of the way; rounding does not carry it out of the box of the two.
fn between(a: Vec3, b: Vec3, part: f32) -> Vec3 {
    (a + (b - a) * part).max(a.min(b)).min(a.max(b))
}
