//! Rays that leave a surface without hitting it again.
//!
//! A computed point lies near the surface, not on it; how near follows from the rounding of the arithmetic that made it.
//! A ray starts on the far side of that bound (Pharr, Jakob and Humphreys 2023, section 6.8.6), so that the distance
//! adapts to the magnitude of the coordinates, not to the size of the scene.

use lichtweg_ray::math::Vec3;

/// Bound on the relative error of `n` rounded operations (Higham 2002, section 3.1).
pub const fn gamma(n: i32) -> f32 {
    let nu = n as f32 * (f32::EPSILON * 0.5);
    nu / (1.0 - nu)
}

/// The rounding error of a point computed as a sum of terms of total magnitude `magnitude` a component.
///
/// Seven operations bound the error of the point itself; the ray query that starts at it subtracts and rotates it once
/// more, which the rest allows for.
#[inline]
pub fn position_error(magnitude: Vec3) -> Vec3 {
    magnitude * gamma(24)
}

/// The point moved off the surface, along the unit normal, to the side that `direction` points to.
#[inline]
pub fn offset(position: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    let distance = normal.abs().dot(error);
    position + normal * distance.copysign(normal.dot(direction))
}
