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
    /// Time in [0, 1] for moving geometry; what lies outside counts as the nearest of these, NaN as 0.
    pub time: f32,
    /// Meets the geometries whose mask has a bit in common with this; all by default.
    pub mask: u32,
}

impl Ray {
    /// The half line from `origin` along `direction`, at time zero, with no mask.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, tnear: 0.0, tfar: f32::INFINITY, time: 0.0, mask: u32::MAX }
    }

    /// The same ray, limited to `tnear < t <= tfar`.
    #[inline]
    pub fn between(self, tnear: f32, tfar: f32) -> Self {
        Self { tnear, tfar, ..self }
    }

    /// The same ray at another time.
    #[inline]
    pub fn at_time(self, time: f32) -> Self {
        Self { time, ..self }
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
    /// Index of the geometry in the list its structure was built from.
    pub geometry: u32,
    /// Index of the primitive in its geometry: the triangle of a mesh; 0 for a quadric.
    pub primitive: u32,
    /// The instances that were gone through, outermost first, as indices of geometries; then
    /// [`Hit::NO_INSTANCE`].
    pub instances: [u32; Hit::MAX_INSTANCES],
}

impl Hit {
    /// What stands where there is no instance.
    pub const NO_INSTANCE: u32 = u32::MAX;
    /// How deep instances of instances go.
    pub const MAX_INSTANCES: usize = 2;

    /// Nothing in particular.
    pub(crate) const NONE: Self = Self::plain(0.0, 0.0, 0.0, u32::MAX, 0);

    /// A hit outside all instances.
    #[inline(always)]
    pub(crate) const fn plain(t: f32, u: f32, v: f32, geometry: u32, primitive: u32) -> Self {
        Self { t, u, v, geometry, primitive, instances: [Self::NO_INSTANCE; Self::MAX_INSTANCES] }
    }

    /// The same hit as the structure around instance `geometry` sees it.
    #[inline]
    pub(crate) fn inside(&self, geometry: u32) -> Self {
        Self { instances: [geometry, self.instances[0]], ..*self }
    }

    /// The same hit as the outermost instance's own structure gave it.
    #[inline]
    pub(crate) fn outside(&self) -> Self {
        Self { instances: [self.instances[1], Self::NO_INSTANCE], ..*self }
    }

    /// Whether the surface belongs to an instance.
    #[inline]
    pub fn is_instanced(&self) -> bool {
        self.instances[0] != Self::NO_INSTANCE
    }
}

/// A caller's choice among hits.
pub(crate) type Accept<'a> = &'a dyn Fn(&Hit) -> bool;

/// The nearest time in [0, 1]; 0 for NaN.
#[inline]
pub(crate) fn unit_time(time: f32) -> f32 {
    if time > 0.0 { time.min(1.0) } else { 0.0 }
}
