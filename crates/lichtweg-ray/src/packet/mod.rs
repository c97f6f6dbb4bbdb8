//! Sixteen rays through the hierarchy together.
//!
//! Rays that go the same way share the visits to nodes and triangles, and fill the lanes of the registers. The lanes
//! here are rays where those of a single query are boxes and triangles. Where only few rays of a packet want a part of
//! the tree, each goes on there by itself (the "hybrid" traversal of Benthin, Wald, Woop, Ernst and Mark, *Combining
//! Single and Packet-Ray Tracing for Arbitrary Ray Distributions on the Intel MIC Architecture*, TVCG 2012).
//!
//! The arithmetic of hits is that of single queries, operation by operation, so a packet's answers are theirs, bit by bit.

mod ray;
mod traverse;

use crate::accel::Accel;
use crate::math::Vec3;
use crate::ray::{Hit, Ray};
use crate::wide::{LANES, Lanes};

pub(crate) use traverse::{closest, occluded};

/// Sixteen rays.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct RayPacket {
    /// x, y and z of the origins.
    pub origin: [Lanes<f32>; 3],
    /// x, y and z of the directions.
    pub direction: [Lanes<f32>; 3],
    /// See [`Ray::tnear`].
    pub tnear: Lanes<f32>,
    /// See [`Ray::tfar`].
    pub tfar: Lanes<f32>,
    /// See [`Ray::time`].
    pub time: Lanes<f32>,
    /// See [`Ray::mask`].
    pub mask: Lanes<u32>,
}

impl Default for RayPacket {
    /// Rays that hit nothing.
    fn default() -> Self {
        let zero = Lanes::splat(0.0);
        Self {
            origin: [zero; 3],
            direction: [zero; 3],
            tnear: zero,
            tfar: zero,
            time: zero,
            mask: Lanes::splat(u32::MAX),
        }
    }
}

impl RayPacket {
    /// The ray of a lane.
    #[inline]
    pub fn get(&self, lane: usize) -> Ray {
        let vector = |v: &[Lanes<f32>; 3]| Vec3::new(v[0].0[lane], v[1].0[lane], v[2].0[lane]);
        Ray {
            origin: vector(&self.origin),
            direction: vector(&self.direction),
            tnear: self.tnear.0[lane],
            tfar: self.tfar.0[lane],
            time: self.time.0[lane],
            mask: self.mask.0[lane],
        }
    }

    /// Sets the ray of a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, ray: &Ray) {
        for axis in 0..3 {
            self.origin[axis].0[lane] = ray.origin[axis];
            self.direction[axis].0[lane] = ray.direction[axis];
        }
        self.tnear.0[lane] = ray.tnear;
        self.tfar.0[lane] = ray.tfar;
        self.time.0[lane] = ray.time;
        self.mask.0[lane] = ray.mask;
    }
}

/// What sixteen rays found.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct HitPacket {
    /// See [`Hit::t`].
    pub t: Lanes<f32>,
    /// See [`Hit::u`].
    pub u: Lanes<f32>,
    /// See [`Hit::v`].
    pub v: Lanes<f32>,
    /// See [`Hit::geometry`]; [`HitPacket::NOTHING`] where nothing was hit.
    pub geometry: Lanes<u32>,
    /// See [`Hit::primitive`].
    pub primitive: Lanes<u32>,
    /// See [`Hit::instances`].
    pub instances: [Lanes<u32>; Hit::MAX_INSTANCES],
}

impl Default for HitPacket {
    fn default() -> Self {
        let zero = Lanes::splat(0.0);
        Self {
            t: zero,
            u: zero,
            v: zero,
            geometry: Lanes::splat(Self::NOTHING),
            primitive: Lanes::splat(0),
            instances: [Lanes::splat(Hit::NO_INSTANCE); Hit::MAX_INSTANCES],
        }
    }
}

impl HitPacket {
    /// In place of a geometry: nothing was hit.
    pub const NOTHING: u32 = u32::MAX;

    /// The hit of a lane.
    #[inline]
    pub fn get(&self, lane: usize) -> Option<Hit> {
        (self.geometry.0[lane] != Self::NOTHING).then(|| Hit {
            t: self.t.0[lane],
            u: self.u.0[lane],
            v: self.v.0[lane],
            geometry: self.geometry.0[lane],
            primitive: self.primitive.0[lane],
            instances: std::array::from_fn(|level| self.instances[level].0[lane]),
        })
    }

    fn set(&mut self, lane: usize, hit: &Hit) {
        self.t.0[lane] = hit.t;
        self.u.0[lane] = hit.u;
        self.v.0[lane] = hit.v;
        self.geometry.0[lane] = hit.geometry;
        self.primitive.0[lane] = hit.primitive;
        for (to, from) in self.instances.iter_mut().zip(hit.instances) {
            to.0[lane] = from;
        }
    }
}

/// The nearest hits of the active rays, without sharing anything: for structures with masks.
pub(crate) fn closest_one_by_one(accel: &Accel, rays: &RayPacket, active: u32) -> HitPacket {
    let mut out = HitPacket::default();
    for lane in (0..LANES).filter(|lane| active >> lane & 1 != 0) {
        if let Some(hit) = accel.closest(&rays.get(lane)) {
            out.set(lane, &hit);
        }
    }
    out
}

/// The active rays that hit anything, as [`closest_one_by_one`].
pub(crate) fn occluded_one_by_one(accel: &Accel, rays: &RayPacket, active: u32) -> u32 {
    (0..LANES)
        .filter(|&lane| active >> lane & 1 != 0 && accel.occluded(&rays.get(lane)))
        .fold(0, |found, lane| found | 1 << lane)
}

impl Accel {
    /// [`Accel::closest`] of many rays; the answers are in the order of the rays.
    ///
    /// Neighbours should go similar ways: that is where a batch is faster than its rays one by one.
    /// Panics where the slices differ in length.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one answer a ray");
        let mut packet = RayPacket::default();
        for (rays, hits) in rays.chunks(LANES).zip(hits.chunks_mut(LANES)) {
            rays.iter().enumerate().for_each(|(lane, ray)| packet.set(lane, ray));
            let found = self.closest_packet(&packet, mask_of(rays.len()));
            hits.iter_mut().enumerate().for_each(|(lane, hit)| *hit = found.get(lane));
        }
    }

    /// [`Accel::occluded`] of many rays; see [`Accel::closest_batch`].
    pub fn occluded_batch(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "one answer a ray");
        let mut packet = RayPacket::default();
        for (rays, occluded) in rays.chunks(LANES).zip(occluded.chunks_mut(LANES)) {
            rays.iter().enumerate().for_each(|(lane, ray)| packet.set(lane, ray));
            let found = self.occluded_packet(&packet, mask_of(rays.len()));
            occluded.iter_mut().enumerate().for_each(|(lane, out)| *out = found >> lane & 1 != 0);
        }
    }
}

/// The first `count` lanes.
fn mask_of(count: usize) -> u32 {
    (1 << count) - 1
}

#[cfg(test)]
mod tests;
