//! Which pieces of curves a ray may meet: eight at a time, in `f32`, before any is looked at in `f64`.
//!
//! A capsule is what lies within a radius of a line. Seen along the ray it is a stadium about the line from a to b, and with
//! the middle m = (a + b) / 2 and the half d = (b - a) / 2 the ray at the origin passes it by where
//!
//!   |m.x| > |d.x| + R   or   |m.y| > |d.y| + R   or   |d x m| > R |d|,
//!
//! a separating axis each. R is the radius and a margin: distances are off by less than 2^-20 of how far the ends are from
//! the ray's origin, d too; so |d| is taken longer by as much, which the cross product needs where d is short.

use rayon::prelude::*;

use super::ray_space::RaySpace;
use crate::kind::{Item, Kind};
use crate::ray::Ray;
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, Lanes, Portable, WIDTH};

/// Part of the distance from the ray's origin that makes a margin: 2^-19.
const MARGIN: f32 = 1.907_348_6e-6;
/// Slack of distances along the ray, for the rounding of t.
const SLACK: f32 = 1.0 + 1e-5;

/// What lies within a radius of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Capsule {
    pub ends: [[f32; 3]; 2],
    pub radius: f32,
}

/// Eight capsules.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Block {
    ends: [[[f32; WIDTH]; 3]; 2],
    radius: [f32; WIDTH],
    /// Lane i as bit i: what is no curve, and not for this test to reject.
    foreign: u32,
}

impl Block {
    const EMPTY: Self = Self { ends: [[[0.0; WIDTH]; 3]; 2], radius: [0.0; WIDTH], foreign: 0 };

    fn set(&mut self, lane: usize, capsule: &Capsule) {
        for (to, from) in self.ends.iter_mut().zip(&capsule.ends) {
            for (row, x) in to.iter_mut().zip(from) {
                row[lane] = *x;
            }
        }
        self.radius[lane] = capsule.radius;
    }
}

/// The capsules of all items of a structure, in the order of its leaves; none where no item is a piece of a curve.
#[derive(Debug, Default)]
pub(crate) struct Capsules(Vec<Block>);

/// A ray made ready for curves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveRay {
    pub space: RaySpace,
    /// The frame, rounded.
    origin: [f32; 3],
    axes: [[f32; 3]; 3],
    /// Where the range begins, in units of length.
    begin: f32,
}

impl CurveRay {
    pub(crate) fn new(ray: &Ray) -> Self {
        let space = RaySpace::new(ray);
        Self {
            space,
            origin: ray.origin.to_array(),
            axes: space.axes().map(|axis| axis.map(|x| x as f32)),
            begin: space.distance(ray.tnear) / SLACK,
        }
    }
}

impl Capsules {
    pub(crate) fn new(items: &[Item], kinds: &[Kind]) -> Self {
        if !kinds.iter().any(|kind| matches!(kind, Kind::Curves(_))) {
            return Self::default();
        }
        let block = |items: &[Item]| {
            let mut block = Block::EMPTY;
            for (lane, item) in items.iter().enumerate() {
                match kinds.get(item.geometry as usize) {
                    Some(Kind::Curves(curves)) => block.set(lane, &curves.capsule(item.index)),
                    _ => block.foreign |= 1 << lane,
                }
            }
            block
        };
        Self(items.par_chunks(WIDTH).map(block).collect())
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.0)
    }

    /// Whether there are no curves.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Which of `count` items from `begin` on, eight at most, the ray may meet before `tfar`: item i as bit i.
    #[inline(always)]
    pub(crate) fn near(&self, isa: Isa, begin: usize, count: usize, ray: &CurveRay, tfar: f32) -> u32 {
        let (first, shift) = (begin / WIDTH, begin % WIDTH);
        let end = ray.space.distance(tfar) * SLACK;
        let mut near = self.0[first].near(isa, ray, end);
        if shift + count > WIDTH {
            near |= self.0[first + 1].near(isa, ray, end) << WIDTH;
        }
        near >> shift & ((1 << count) - 1)
    }
}

impl Block {
    fn near(&self, isa: Isa, ray: &CurveRay, end: f32) -> u32 {
        match isa {
            Isa::Portable => self.near_as::<Portable>(ray, end),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: values of `Isa` come from detection.
            Isa::Avx2 => unsafe { near_avx2(self, ray, end) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Isa::Avx512 => unsafe { near_avx512(self, ray, end) },
        }
    }

    #[inline(always)]
    fn near_as<V: Lanes>(&self, ray: &CurveRay, end: f32) -> u32 {
        let (a, size_a) = project::<V>(&self.ends[0], ray);
        let (b, size_b) = project::<V>(&self.ends[1], ray);
        let margin = size_a.max(size_b).mul(V::splat(MARGIN));
        let radius = row::<V>(&self.radius).add(margin);
        let beside = meets_stadium([a[0], a[1]], [b[0], b[1]], radius, margin);
        let begins = a[2].min(b[2]).sub(radius).le(V::splat(end));
        let ends = V::splat(ray.begin).le(a[2].max(b[2]).add(radius));
        V::bits(V::and(beside, V::and(begins, ends))) | self.foreign
    }
}

/// Points in the ray's frame, and the sums of their absolute distances from its origin.
///
/// No closures in arithmetic on lanes: they do not take on the instruction set of the function around them.
#[inline(always)]
fn project<V: Lanes>(points: &[[f32; WIDTH]; 3], ray: &CurveRay) -> ([V; 3], V) {
    let [ox, oy, oz] = ray.origin;
    let p = [
        row::<V>(&points[0]).sub(V::splat(ox)),
        row::<V>(&points[1]).sub(V::splat(oy)),
        row::<V>(&points[2]).sub(V::splat(oz)),
    ];
    let [x, y, z] = &ray.axes;
    ([along(p, x), along(p, y), along(p, z)], p[0].abs().add(p[1].abs()).add(p[2].abs()))
}

#[inline(always)]
fn along<V: Lanes>([x, y, z]: [V; 3], axis: &[f32; 3]) -> V {
    x.mul_add(V::splat(axis[0]), y.mul_add(V::splat(axis[1]), z.mul(V::splat(axis[2]))))
}

/// Whether the origin may lie within `radius` of the lines from `a` to `b`, whose differences are off by `margin`.
#[inline(always)]
pub(super) fn meets_stadium<V: Lanes>(a: [V; 2], b: [V; 2], radius: V, margin: V) -> V::Mask {
    let half = V::splat(0.5);
    let (x, y) = (a[0].add(b[0]).mul(half), a[1].add(b[1]).mul(half));
    let (dx, dy) = (b[0].sub(a[0]).mul(half), b[1].sub(a[1]).mul(half));
    let moment = dx.mul_sub(y, dy.mul(x)).abs();
    let (dx, dy) = (dx.abs(), dy.abs());
    // At least the length: 0.4142... of the smaller part, and what underflows.
    let length = dx.min(dy).mul_add(V::splat(0.414_22), dx.max(dy).add(margin));
    let beside = moment.le(radius.mul_add(length, V::splat(1e-36)));
    V::and(beside, V::and(x.abs().le(dx.add(radius)), y.abs().le(dy.add(radius))))
}

#[inline(always)]
fn row<V: Lanes>(values: &[f32; WIDTH]) -> V {
    // SAFETY: a row of a block is 32 bytes, and aligned since blocks are and rows come one after the other.
    unsafe { V::load(values.as_ptr()) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
fn near_avx2(block: &Block, ray: &CurveRay, end: f32) -> u32 {
    block.near_as::<Avx2>(ray, end)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,avx512f,avx512vl,avx512dq")]
fn near_avx512(block: &Block, ray: &CurveRay, end: f32) -> u32 {
    block.near_as::<Avx512>(ray, end)
}
