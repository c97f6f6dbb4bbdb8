//! Sixteen rays made ready for boxes and triangles: what `bvh::slab` and `triangle` do for one.

use crate::build::MAX_COORDINATE;
use crate::bvh::Block;
use crate::bvh::slab::{Slab, TINY, near_rows};
use crate::math::Vec3;
use crate::simd::{Lanes as NarrowLanes, WIDTH};
use crate::triangle::{SLACK, Shear, TINY_AREA};
use crate::wide::{Float, FloatLanes, Mask, Wide, Word};

use super::RayPacket;

/// The prepared rays.
pub(super) struct Prepared<W: Wide> {
    /// Rays that can hit something.
    pub active: W::Mask,
    pub tnear: W::F32,
    pub tfar: W::F32,
    /// Whether the direction is negative along x, y, z.
    pub negative: [W::Mask; 3],
    pub near_scale: [W::F32; 3],
    pub near_shift: [W::F32; 3],
    pub far_scale: [W::F32; 3],
    pub far_shift: [W::F32; 3],
    /// Whether the shear's z is the world's x, or y.
    steep: [W::Mask; 2],
    /// The shear's axes in terms of world axes, where all active rays have the same.
    pub axes: Option<[usize; 3]>,
    /// Origin, in the shear's axes.
    origin: [W::F32; 3],
    /// (dx/dz, dy/dz, 1/dz).
    scale: [W::F32; 3],
    near_z: W::F32,
    /// |dz|, with some slack.
    pace: W::F32,
    /// dz.
    dz: W::F32,
}

/// How the rays pass the edges of a triangle: what is known without a division.
struct Passage<W: Wide> {
    /// Edge functions, opposite to the corners; their least and largest, their sum.
    edges: [W::F32; 3],
    least: W::F32,
    most: W::F32,
    det: W::F32,
    /// Distance along the shear's z, times the sum of the edge functions.
    depth: W::F32,
    /// z of the corners.
    z: [W::F32; 3],
}

impl<W: Wide> Passage<W> {
    #[inline(always)]
    fn before(&self, rays: &Prepared<W>, tfar: W::F32) -> W::Mask {
        let zero = W::F32::splat(0.0);
        let inside = zero.le(self.least) | self.most.le(zero);
        let z = xor_sign::<W>(xor_sign::<W>(self.depth, self.det), rays.scale[2]);
        let area = self.det.abs();
        inside.and_not(z.lt(area * rays.near_z)).and_not((area * (tfar * rays.pace)).lt(z))
    }
}

/// Hits of one triangle by the rays.
pub(super) struct TriangleHits<W: Wide> {
    /// Rays that hit it, those in doubt included.
    pub mask: W::Mask,
    /// Rays that need the slow test.
    pub doubtful: W::Mask,
    pub t: W::F32,
    pub u: W::F32,
    pub v: W::F32,
}

/// `if z is x { a[1], a[2], a[0] } ...`: a vector in the shear's axes.
#[inline(always)]
fn permute<W: Wide>([zx, zy]: [W::Mask; 2], [x, y, z]: [W::F32; 3]) -> [W::F32; 3] {
    [y.select(zx, z.select(zy, x)), z.select(zx, x.select(zy, y)), x.select(zx, y.select(zy, z))]
}

/// `a`, negated where `b` has its sign bit set.
#[inline(always)]
fn xor_sign<W: Wide>(a: W::F32, b: W::F32) -> W::F32 {
    (a.bits() ^ (b.bits() & W::U32::splat(1 << 31))).as_float()
}

impl<W: Wide> Prepared<W> {
    #[inline(always)]
    pub(super) fn new(rays: &RayPacket, active: u32, reach: f32) -> Self {
        let splat = W::F32::splat;
        let load = |v: &[_; 3]| [W::F32::load(&v[0]), W::F32::load(&v[1]), W::F32::load(&v[2])];
        let (o, d) = (load(&rays.origin), load(&rays.direction));
        let (zero, one) = (splat(0.0), splat(1.0));
        let given_near = W::F32::load(&rays.tnear);
        let given_far = W::F32::load(&rays.tfar);
        let tnear = given_near.max(zero);
        let tfar = given_far.min(splat(f32::MAX));
        let size = [d[0].abs(), d[1].abs(), d[2].abs()];
        let steepest = size[0].max(size[1]).max(size[2]);
        let far_out = o[0].abs().max(o[1].abs()).max(o[2].abs());
        // Comparisons with NaN are false; `max` may drop one, so each component is looked at.
        let mut sound = W::Mask::from_bits(active);
        for axis in 0..3 {
            sound = sound & o[axis].abs().le(splat(MAX_COORDINATE)) & size[axis].le(splat(f32::MAX));
        }
        let sound = sound & tnear.lt(tfar) & given_near.le(given_far) & splat(f32::MIN_POSITIVE).le(steepest);

        let zy_over_x = size[0].lt(size[1]);
        let z_over = size[0].max(size[1]).lt(size[2]);
        let steep = [!(zy_over_x | z_over), zy_over_x.and_not(z_over)];
        let [dx, dy, dz] = permute::<W>(steep, d);
        // The steepest component is never replaced by the smallest allowed.
        let scale = [dx / dz, dy / dz, one / dz];

        let shallowest = steepest * splat(TINY);
        let bend = (splat(reach) + far_out) * splat(4.0 * TINY);
        let mut out = Self {
            active: sound,
            tnear,
            tfar,
            negative: [sound; 3],
            near_scale: d,
            near_shift: d,
            far_scale: d,
            far_shift: d,
            steep,
            axes: common_axes(sound, steep),
            origin: permute::<W>(steep, o),
            scale,
            near_z: tnear * dz.abs() * splat(1.0 - SLACK),
            pace: dz.abs() * splat(1.0 + SLACK),
            dz,
        };
        for axis in 0..3 {
            let divisor = size[axis].max(shallowest).copysign(d[axis]);
            let quotient = one / divisor;
            let margin = o[axis].abs().mul_add(splat(2.0_f32.powi(-22)), bend);
            let near_scale = quotient * splat(1.0 - 2.0_f32.powi(-21));
            let far_scale = quotient * splat(1.0 + 2.0_f32.powi(-21));
            out.negative[axis] = divisor.lt(zero);
            out.near_scale[axis] = near_scale;
            out.far_scale[axis] = far_scale;
            out.near_shift[axis] = o[axis].mul_add(near_scale, (margin * near_scale).abs());
            out.far_shift[axis] = o[axis].mul_sub(far_scale, (margin * far_scale).abs());
        }
        out
    }

    /// Which rays meet a box before `tfar`, and where they enter it. `planes`: least and largest x, y, z.
    #[inline(always)]
    pub(super) fn meet(&self, planes: [f32; 6], tfar: W::F32) -> (W::Mask, W::F32) {
        let mut enter = self.tnear;
        let mut leave = tfar;
        for axis in 0..3 {
            let (low, high) = (W::F32::splat(planes[2 * axis]), W::F32::splat(planes[2 * axis + 1]));
            let near = high.select(self.negative[axis], low);
            let far = low.select(self.negative[axis], high);
            // `max` and `min` yield their second operand for NaN, which drops the plane's constraint.
            enter = near.mul_sub(self.near_scale[axis], self.near_shift[axis]).max(enter);
            leave = far.mul_sub(self.far_scale[axis], self.far_shift[axis]).min(leave);
        }
        (enter.le(leave), enter)
    }

    /// Rays that pass through a triangle before `tfar`, as far as can be told without a division.
    #[inline(always)]
    pub(super) fn near(&self, triangle: &impl Triangle<W>, tfar: W::F32) -> W::Mask {
        self.passage(triangle).before(self, tfar)
    }

    /// Of the rays of [`Prepared::near`], the hits with `tnear < t <= tfar`.
    #[inline(always)]
    pub(super) fn intersect(
        &self,
        triangle: &impl Triangle<W>,
        near: W::Mask,
        tfar: W::F32,
    ) -> TriangleHits<W> {
        let Passage { edges: [u, v, w], least, most, det, z: [az, bz, cz], .. } = self.passage(triangle);
        let zero = W::F32::splat(0.0);
        let r = W::F32::splat(1.0) / det;
        let (u, v, w) = (u * r, v * r, w * r);
        let t = w.mul_add(cz, v.mul_add(bz, u * az)) * self.scale[2];
        let definite = (zero.lt(least) | most.lt(zero)) & W::F32::splat(TINY_AREA).le(det.abs());
        let in_range = self.tnear.lt(t) & t.le(tfar);
        let doubtful = near.and_not(definite);
        TriangleHits { mask: in_range & near | doubtful, doubtful, t, u: v, v: w }
    }

    #[inline(always)]
    fn passage(&self, triangle: &impl Triangle<W>) -> Passage<W> {
        let [ax, ay, az] = self.sheared(triangle.corner(0, self.steep));
        let [bx, by, bz] = self.sheared(triangle.corner(1, self.steep));
        let [cx, cy, cz] = self.sheared(triangle.corner(2, self.steep));
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        Passage {
            edges: [u, v, w],
            least: u.min(v).min(w),
            most: u.max(v).max(w),
            det: u + v + w,
            depth: w.mul_add(cz, v.mul_add(bz, u * az)),
            z: [az, bz, cz],
        }
    }

    #[inline(always)]
    fn sheared(&self, [x, y, z]: [W::F32; 3]) -> [W::F32; 3] {
        let [x, y, z] = [x - self.origin[0], y - self.origin[1], z - self.origin[2]];
        [self.scale[0].neg_mul_add(z, x), self.scale[1].neg_mul_add(z, y), z]
    }

    /// One ray's own, for the slow test and for its way alone: what `bvh::slab::prepare` makes of it.
    #[inline(always)]
    pub(super) fn shear(&self, lane: usize) -> Shear {
        let axes = match (self.steep[0].bits() >> lane & 1, self.steep[1].bits() >> lane & 1) {
            (1, _) => [1, 2, 0],
            (_, 1) => [2, 0, 1],
            _ => [0, 1, 2],
        };
        Shear {
            axes,
            origin: of_lane::<W>(&self.origin, lane),
            scale: of_lane::<W>(&self.scale, lane),
            tnear: self.tnear.lane(lane),
            pace: self.dz.lane(lane),
        }
    }

    /// As [`Prepared::shear`].
    #[inline(always)]
    pub(super) fn slab<V: NarrowLanes>(&self, lane: usize) -> Slab<V> {
        let bit = |mask: W::Mask| (mask.bits() >> lane & 1) as usize;
        let [x, y, z] = self.negative;
        let splat = |v: &[W::F32; 3]| {
            let [x, y, z] = of_lane::<W>(v, lane);
            [V::splat(x), V::splat(y), V::splat(z)]
        };
        Slab {
            near_row: near_rows([bit(x), bit(y), bit(z)]),
            near_scale: splat(&self.near_scale),
            near_shift: splat(&self.near_shift),
            far_scale: splat(&self.far_scale),
            far_shift: splat(&self.far_shift),
            tnear: V::splat(self.tnear.lane(lane)),
        }
    }
}

#[inline(always)]
fn of_lane<W: Wide>(v: &[W::F32; 3], lane: usize) -> [f32; 3] {
    [v[0].lane(lane), v[1].lane(lane), v[2].lane(lane)]
}

/// The axes of the shears of some rays, where they are the same.
#[inline(always)]
fn common_axes<M: Mask>(rays: M, [zx, zy]: [M; 2]) -> Option<[usize; 3]> {
    let rays = rays.bits();
    match (zx.bits() & rays, zy.bits() & rays) {
        (0, 0) => Some([0, 1, 2]),
        (x, 0) if x == rays => Some([1, 2, 0]),
        (0, y) if y == rays => Some([2, 0, 1]),
        _ => None,
    }
}

/// A triangle in the axes of the rays' shears.
pub(super) trait Triangle<W: Wide> {
    /// A corner. `steep`: see [`Prepared`].
    fn corner(&self, corner: usize, steep: [W::Mask; 2]) -> [W::F32; 3];
}

/// A triangle of a block, for rays whose shears have the same axes: a third of the test's arithmetic less.
pub(super) struct Aligned<'a> {
    pub block: &'a Block,
    pub lane: usize,
    /// See [`Prepared::axes`].
    pub axes: [usize; 3],
}

impl<W: Wide> Triangle<W> for Aligned<'_> {
    #[inline(always)]
    fn corner(&self, corner: usize, _: [W::Mask; 2]) -> [W::F32; 3] {
        let &Self { block, lane, axes: [x, y, z] } = self;
        [
            coordinate::<W>(block, lane, corner, x),
            coordinate::<W>(block, lane, corner, y),
            coordinate::<W>(block, lane, corner, z),
        ]
    }
}

/// A triangle of a block, for any rays.
pub(super) struct Mixed<'a> {
    pub block: &'a Block,
    pub lane: usize,
}

impl<W: Wide> Triangle<W> for Mixed<'_> {
    #[inline(always)]
    fn corner(&self, corner: usize, steep: [W::Mask; 2]) -> [W::F32; 3] {
        let &Self { block, lane } = self;
        let at = [
            coordinate::<W>(block, lane, corner, 0),
            coordinate::<W>(block, lane, corner, 1),
            coordinate::<W>(block, lane, corner, 2),
        ];
        permute::<W>(steep, at)
    }
}

/// A number of a block, in all lanes.
#[inline(always)]
fn coordinate<W: Wide>(block: &Block, lane: usize, corner: usize, axis: usize) -> W::F32 {
    debug_assert!(axis < 3 && lane < WIDTH);
    // SAFETY: callers name one of three axes and a lane below the width.
    W::F32::splat(unsafe { *block.corners[corner].get_unchecked(axis).get_unchecked(lane) })
}

/// The slow test of one ray against one triangle; see [`crate::triangle`].
pub(super) fn settle(shear: &Shear, corners: [Vec3; 3], tfar: f32) -> Option<crate::triangle::TriangleHit> {
    let h = crate::triangle::triangle(shear, corners)?;
    (h.t > shear.tnear && h.t <= tfar).then_some(h)
}
