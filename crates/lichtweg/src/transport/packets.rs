//! Many rays, traced sixteen at a time: those that go the same way together.

use lichtweg_ray::math::Vec3;
use lichtweg_ray::wide::LANES;
use lichtweg_ray::{Hit, Ray, RayPacket};

use super::wave::queue::{BUCKETS, bucket};
use crate::scene::{RayCounts, Scene};

/// Rays by direction.
#[derive(Debug, Default)]
pub struct Order {
    order: Vec<u32>,
    buckets: Vec<u8>,
}

impl Order {
    /// Sorts rays of these directions; those that go the same way stay in their order.
    pub fn sort(&mut self, directions: impl ExactSizeIterator<Item = Vec3>) {
        let mut next = [0; BUCKETS + 1];
        self.buckets.clear();
        self.order.clear();
        self.order.resize(directions.len(), 0);
        self.buckets.extend(directions.map(bucket));
        for &bucket in &self.buckets {
            next[usize::from(bucket) + 1] += 1;
        }
        for i in 1..BUCKETS {
            next[i] += next[i - 1];
        }
        for (i, &bucket) in self.buckets.iter().enumerate() {
            let to: &mut usize = &mut next[usize::from(bucket)];
            self.order[*to] = i as u32;
            *to += 1;
        }
    }
}

/// The nearest hits of rays, in some order; `each` is told the number of the ray, the ray and its hit.
#[inline]
pub fn closest(
    scene: &Scene,
    order: &Order,
    ray: impl Fn(usize) -> Ray,
    mut each: impl FnMut(usize, &Ray, Option<Hit>),
) {
    let mut packet = RayPacket::default();
    for numbers in order.order.chunks(LANES) {
        for (lane, &number) in numbers.iter().enumerate() {
            packet.set(lane, &ray(number as usize));
        }
        let hits = scene.accel().closest_packet(&packet, (1 << numbers.len()) - 1);
        for (lane, &number) in numbers.iter().enumerate() {
            each(number as usize, &packet.get(lane), hits.get(lane));
        }
    }
}

/// The fraction of light that passes along each ray.
pub fn transmittance(
    scene: &Scene,
    rays: &[Ray],
    order: &mut Order,
    counts: &mut RayCounts,
    out: &mut Vec<f32>,
) {
    out.clear();
    if scene.has_holes() {
        out.extend(rays.iter().map(|ray| scene.transmittance(ray, counts)));
        return;
    }
    counts.occlusion += rays.len() as u64;
    out.resize(rays.len(), 0.0);
    order.sort(rays.iter().map(|ray| ray.direction));
    let mut packet = RayPacket::default();
    for numbers in order.order.chunks(LANES) {
        for (lane, &number) in numbers.iter().enumerate() {
            packet.set(lane, &rays[number as usize]);
        }
        let occluded = scene.accel().occluded_packet(&packet, (1 << numbers.len()) - 1);
        for (lane, &number) in numbers.iter().enumerate() {
            out[number as usize] = if occluded >> lane & 1 == 0 { 1.0 } else { 0.0 };
        }
    }
}
