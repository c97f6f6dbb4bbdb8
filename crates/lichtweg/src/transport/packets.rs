//! Many rays, a row of memory each, traced sixteen at a time: those that go the same way together.

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{self, Float, FloatLanes, Kernel, LANES, Lanes, Row, Wide};
use lichtweg_ray::{Ray, RayPacket};

use super::counting_sort::CountingSort;
use super::wave::queue::{BUCKETS, bucket};
use crate::lanes::lanes_of_vector;
use crate::scene::{RayCounts, Scene};

/// A row that means nothing, to point at where a lane has none.
pub static NO_ROW: Row = Lanes([0.0; LANES]);

/// Elements of a row that are those of a ray: origin, direction, ends, time.
pub const RAY: usize = 9;

/// A ray as its row has it; or as many as `F` has lanes.
#[derive(Clone, Copy)]
pub struct RayLanes<F> {
    pub origin: Vector<F>,
    pub direction: Vector<F>,
    pub tnear: F,
    pub tfar: F,
    pub time: F,
}

impl<F: Float> RayLanes<F> {
    /// From the columns of rows.
    #[inline(always)]
    pub fn new(c: &[F; LANES]) -> Self {
        Self {
            origin: Vector::new(c[0], c[1], c[2]),
            direction: Vector::new(c[3], c[4], c[5]),
            tnear: c[6],
            tfar: c[7],
            time: c[8],
        }
    }

    /// As columns, with what else the rows shall hold.
    #[inline(always)]
    pub fn columns(&self, rest: [F; LANES - RAY]) -> [F; LANES] {
        let (o, d) = (self.origin, self.direction);
        let [a, b, c, e, f, g, h] = rest;
        [o.x, o.y, o.z, d.x, d.y, d.z, self.tnear, self.tfar, self.time, a, b, c, e, f, g, h]
    }
}

impl<F: FloatLanes> RayLanes<F> {
    /// As the ray engine takes them.
    #[inline(always)]
    pub fn packet(&self) -> RayPacket {
        RayPacket {
            origin: lanes_of_vector(self.origin),
            direction: lanes_of_vector(self.direction),
            tnear: self.tnear.to_lanes(),
            tfar: self.tfar.to_lanes(),
            time: self.time.to_lanes(),
            ..RayPacket::default()
        }
    }
}

impl From<Ray> for RayLanes<f32> {
    #[inline(always)]
    fn from(ray: Ray) -> Self {
        let Ray { origin, direction, tnear, tfar, time, .. } = ray;
        Self { origin, direction, tnear, tfar, time }
    }
}

impl From<RayLanes<f32>> for Ray {
    #[inline(always)]
    fn from(ray: RayLanes<f32>) -> Self {
        Ray::new(ray.origin, ray.direction).between(ray.tnear, ray.tfar).at_time(ray.time)
    }
}

/// Rays by direction.
#[derive(Debug, Default)]
pub struct Order {
    buckets: Vec<u8>,
    sorted: CountingSort,
}

impl Order {
    /// Sorts rays by rows; those that go the same way stay in their order.
    pub fn sort<'r>(&mut self, rows: impl Iterator<Item = &'r Row>) {
        self.buckets.clear();
        self.buckets.extend(rows.map(|Lanes(row)| bucket(RayLanes::new(row).direction) as u8));
        self.sorted.sort(BUCKETS, self.buckets.iter().map(|&bucket| bucket.into()));
    }

    /// The numbers of rays that go together.
    pub fn groups(&self) -> impl Iterator<Item = &[u32]> {
        self.sorted.order().chunks(LANES)
    }
}

/// The rows of a group; those behind its end mean nothing.
#[inline(always)]
pub fn rows_of<'r>(numbers: &[u32], row: impl Fn(usize) -> &'r Row) -> [&'r Row; LANES] {
    let mut rows = [&NO_ROW; LANES];
    for (to, &number) in rows.iter_mut().zip(numbers) {
        *to = row(number as usize);
    }
    rows
}

/// The fraction of light that passes along each ray.
pub fn transmittance(
    scene: &Scene,
    rays: &[Row],
    order: &mut Order,
    counts: &mut RayCounts,
    out: &mut Vec<f32>,
) {
    out.clear();
    if scene.has_holes() {
        out.extend(rays.iter().map(|row| scene.transmittance(&RayLanes::new(&row.0).into(), counts)));
        return;
    }
    counts.occlusion += rays.len() as u64;
    out.resize(rays.len(), 0.0);
    order.sort(rays.iter());
    wide::dispatch(Shadows { scene, rays, order, out });
}

/// Rays that nothing passes in part.
struct Shadows<'s> {
    scene: &'s Scene,
    rays: &'s [Row],
    order: &'s Order,
    out: &'s mut [f32],
}

impl Kernel for Shadows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self) {
        for numbers in self.order.groups() {
            let rows = rows_of(numbers, |i| &self.rays[i]);
            let packet = RayLanes::new(&W::F32::columns(&rows)).packet();
            let occluded = self.scene.accel().occluded_packet(&packet, (1 << numbers.len()) - 1);
            for (lane, &number) in numbers.iter().enumerate() {
                self.out[number as usize] = if occluded >> lane & 1 == 0 { 1.0 } else { 0.0 };
            }
        }
    }
}
