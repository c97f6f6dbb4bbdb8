//! Rays and what they find.

use crate::math::Vec3;

/// The points `origin + t direction` for `tnear < t <= tfar`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where t = 0.
    pub origin: Vec3,
    /// Direction, of any length: t counts in its units.
    pub direction: Vec3,
    /// Hits lie strictly beyond this t; not negative (a negative value counts as zero).
    pub tnear: f32,
    /// Hits lie at this t or before; may be infinite.
    pub tfar: f32,
    /// Time in [0, 1] for moving geometry.
    pub time: f32,
}

impl Ray {
    /// The half line from `origin` along `direction`, at time zero.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, tnear: 0.0, tfar: f32::INFINITY, time: 0.0 }
    }

    /// The same ray, limited to `tnear < t <= tfar`.
    #[inline]
    pub fn between(self, tnear: f32, tfar: f32) -> Self {
        Self { tnear, tfar, ..self }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// Ray parameter of the point.
    pub t: f32,
    /// First surface parameter. Triangles: weight of vertex 1, p = (1-u-v) p0 + u p1 + v p2.
    /// Quadrics: azimuth over the largest azimuth, in [0, 1].
    pub u: f32,
    /// Second surface parameter. Triangles: weight of vertex 2. Quadrics: see [`crate::QuadricShape`].
    pub v: f32,
    /// Index of the geometry in the list the structure was built from.
    pub geometry: u32,
    /// Index of the triangle in its mesh; 0 for a quadric.
    pub primitive: u32,
}
