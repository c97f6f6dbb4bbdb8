//! Whether two vertices see each other.

use lichtweg_ray::Ray;
use lichtweg_ray::math::Vec3;

use super::WalkCounts;
use crate::light::LightSample;
use crate::scene::{Scene, SurfacePoint};

/// Part of a shadow ray's length left out at its end, where its target itself is.
pub const SHADOW_END: f32 = 1e-5;

/// The fraction of light that passes between two surface points, `direction` from the first to the second.
#[inline]
pub fn between(
    scene: &Scene,
    from: &SurfacePoint,
    to: &SurfacePoint,
    direction: Vec3,
    time: f32,
    counts: &mut WalkCounts,
) -> f32 {
    let origin = from.leave(direction);
    let ray = Ray { tfar: 1.0 - SHADOW_END, time, ..Ray::new(origin, to.leave(-direction) - origin) };
    scene.transmittance(&ray, &mut counts.rays)
}

/// The fraction of light that passes from a light to a surface point.
#[inline]
pub fn from_light(
    scene: &Scene,
    point: &SurfacePoint,
    sample: &LightSample,
    time: f32,
    counts: &mut WalkCounts,
) -> f32 {
    let origin = point.leave(sample.direction);
    let ray = match sample.target {
        Some(target) => Ray { tfar: 1.0 - SHADOW_END, ..Ray::new(origin, target - origin) },
        None => Ray::new(origin, sample.direction),
    };
    scene.transmittance(&Ray { time, ..ray }, &mut counts.rays)
}
