//! Functions of any width: written once over [`Float`](lichtweg_ray::wide::Float), they serve one path as well as sixteen,
//! operation by operation the same.

mod elementary;
pub(crate) mod owen;
pub(crate) mod warp;

use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::{Float, FloatLanes, Lanes};

pub(crate) use elementary::{atan2, exp, ln, polynomial};

/// The largest number below 1.
pub(crate) const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// The lanes of a mask.
#[inline(always)]
pub(crate) fn lanes_of(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        (mask != 0).then(|| {
            mask &= mask - 1;
            lane
        })
    })
}

/// A vector, lane by lane in memory.
#[inline(always)]
pub(crate) fn lanes_of_vector<F: FloatLanes>(v: Vector<F>) -> [Lanes<f32>; 3] {
    [v.x.to_lanes(), v.y.to_lanes(), v.z.to_lanes()]
}

/// The same vector in all lanes.
#[inline(always)]
pub(crate) fn spread<F: Float>(v: Vec3) -> Vector<F> {
    Vector::new(F::splat(v.x), F::splat(v.y), F::splat(v.z))
}

/// The vector of a lane.
#[inline(always)]
pub(crate) fn vec3(v: &[Lanes<f32>; 3], lane: usize) -> Vec3 {
    Vec3::new(v[0].0[lane], v[1].0[lane], v[2].0[lane])
}
