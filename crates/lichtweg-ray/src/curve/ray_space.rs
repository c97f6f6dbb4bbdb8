//! A frame about a ray: the origin is the ray's, z runs along it, in units of length.
//!
//! What a ray sees is what lies about the z axis. The frame is orthonormal to the precision of `f64`, which is
//! far beyond that of the `f32` coordinates that enter.

use crate::ray::Ray;

/// The map of the world to a ray's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RaySpace {
    origin: [f64; 3],
    axes: [[f64; 3]; 3],
    inverse_length: f64,
}

impl RaySpace {
    /// The frame of a ray that is finite and has a direction.
    pub(crate) fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array().map(f64::from);
        let inverse_length = 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let [x, y, z] = d.map(|v| v * inverse_length);
        // Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
        let sign = 1.0_f64.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        let axes = [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y], [x, y, z]];
        Self { origin: ray.origin.to_array().map(f64::from), axes, inverse_length }
    }

    /// A point of the world in the frame.
    #[inline(always)]
    pub(crate) fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|i| p[i] - self.origin[i]);
        self.axes.map(|a| a[0] * x + a[1] * y + a[2] * z)
    }

    /// A direction of the world in the frame.
    pub(crate) fn vector(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        self.axes.map(|a| a[0] * x + a[1] * y + a[2] * z)
    }

    /// A direction of the frame in the world.
    pub(crate) fn world_vector(&self, v: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = &self.axes;
        std::array::from_fn(|i| x[i] * v[0] + y[i] * v[1] + z[i] * v[2])
    }

    /// A point of the frame in the world.
    pub(crate) fn world_point(&self, p: [f64; 3]) -> [f64; 3] {
        let v = self.world_vector(p);
        std::array::from_fn(|i| v[i] + self.origin[i])
    }

    /// The axes of the frame in the world; the last is the ray's direction.
    pub(crate) fn axes(&self) -> &[[f64; 3]; 3] {
        &self.axes
    }

    /// The distance along the ray of a parameter.
    pub(crate) fn distance(&self, t: f32) -> f32 {
        (f64::from(t) / self.inverse_length) as f32
    }

    /// The ray parameter of a distance along the ray.
    #[inline(always)]
    pub(crate) fn parameter(&self, z: f64) -> f32 {
        (z * self.inverse_length) as f32
    }
}
