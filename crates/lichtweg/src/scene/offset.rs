//! Rays that leave a surface without hitting it again.
//!
//! A computed point lies near the surface, not on it, and a ray query that starts there finds the surface again at a
//! distance that is zero but for rounding. How large both errors can be follows from the arithmetic: a few units in the last
//! place of the largest coordinate involved, whichever coordinate the normal lies along. A ray starts beyond that bound
//! (compare Pharr, Jakob and Humphreys 2023, section 6.8.6), which adapts to the magnitude of the coordinates, not to the size of
//! the scene.

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::Float;

/// Bound on the relative error of `n` rounded operations (Higham 2002, section 3.1).
pub const fn gamma(n: i32) -> f32 {
    let nu = n as f32 * (f32::EPSILON * 0.5);
    nu / (1.0 - nu)
}

/// The rounding error of a point on a primitive whose coordinates are at most `size` in magnitude.
///
/// Seven operations bound the error of the point itself; the ray query that starts at it translates, shears and scales the
/// primitive once more, which the rest allows for.
#[inline]
pub fn position_error(size: f32) -> f32 {
    size * gamma(24)
}

/// The point moved off the surface, along the unit normal, to the side that `direction` points to.
#[inline(always)]
pub fn offset<F: Float>(position: Vector<F>, error: F, normal: Vector<F>, direction: Vector<F>) -> Vector<F> {
    position + normal * error.copysign(normal.dot(direction))
}
