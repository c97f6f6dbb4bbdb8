//! Tangents of a surface, and normals tilted along them.

use lichtweg_ray::math::{Vec2, Vec3};

use crate::bsdf::Frame;

/// Surface tangents at a point, computed when first needed.
pub(super) struct Tangents<F> {
    compute: F,
    partials: Option<Option<[Vec3; 2]>>,
}

impl<F: Fn() -> Option<[Vec3; 2]>> Tangents<F> {
    /// From what computes the derivatives of the position with respect to the surface coordinates.
    pub fn new(compute: F) -> Self {
        Self { compute, partials: None }
    }

    fn partials(&mut self) -> Option<[Vec3; 2]> {
        *self.partials.get_or_insert_with(&self.compute)
    }

    /// The frame about `normal` whose tangent follows dp/du.
    pub fn frame(&mut self, normal: Vec3) -> Frame {
        match self.partials() {
            Some([dp_du, _]) => Frame::from_normal_tangent(normal, dp_du),
            None => Frame::from_normal(normal),
        }
    }

    /// The normal of the surface displaced along `normal` by a height with a given gradient (Blinn 1978), neglecting the
    /// curvature of the surface itself.
    pub fn bump(&mut self, normal: Vec3, gradient: Vec2) -> Vec3 {
        let Some([dp_du, dp_dv]) = self.partials() else { return normal };
        let lifted = |dp: Vec3, slope: f32| dp + normal * (slope - normal.dot(dp));
        let tilted = lifted(dp_du, gradient.x).cross(lifted(dp_dv, gradient.y));
        match tilted.try_normalized() {
            Some(n) if n.dot(normal) < 0.0 => -n,
            Some(n) => n,
            None => normal,
        }
    }
}
