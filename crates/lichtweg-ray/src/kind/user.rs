//! Primitives of the caller's own.

use std::fmt;

use super::Candidate;
use crate::math::{Bounds3, Vec3};
use crate::ray::Ray;

/// Primitives that the caller intersects. Queries call from any thread.
pub trait UserPrimitives: fmt::Debug + Send + Sync {
    /// How many there are; always the same number.
    fn count(&self) -> usize;

    /// A box around a primitive, at all times in [0, 1]. Give it a margin for the rounding of `intersect`. Primitives
    /// whose box is empty, not finite or beyond 2^40 are left out.
    fn bounds(&self, primitive: u32) -> Bounds3;

    /// The nearest hit with `ray.tnear < t <= ray.tfar`, where `ray.time` is in [0, 1]. It must not depend on
    /// `ray.tfar`, but for whether it is in range; others are ignored.
    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<UserHit>;

    /// The outward normal at a hit, of any length.
    fn normal(&self, primitive: u32, ray: &Ray, hit: &UserHit) -> Vec3;
}

/// A hit of a user's primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UserHit {
    /// Ray parameter of the point.
    pub t: f32,
    /// First surface parameter.
    pub u: f32,
    /// Second surface parameter.
    pub v: f32,
}

/// Asks the caller, and does not trust the answer.
#[inline(never)]
pub(super) fn intersect(
    user: &dyn UserPrimitives,
    primitive: u32,
    ray: &Ray,
    tnear: f32,
    tfar: f32,
) -> Option<Candidate> {
    let hit = user.intersect(primitive, &ray.between(tnear, tfar))?;
    let in_range = hit.t > tnear && hit.t <= tfar;
    in_range.then_some(Candidate { t: hit.t, u: hit.u, v: hit.v, primitive })
}
