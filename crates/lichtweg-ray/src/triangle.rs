//! The watertight ray-triangle test.
//!
//! Vertices are moved to the ray's origin and sheared so that the ray becomes the z axis; the signs of
//! the three edge functions in the plane then decide (Woop, Benthin and Wald, *Watertight Ray/Triangle
//! Intersection*, JCGT 2(1), 2013). A sheared vertex depends on the ray and the vertex alone and the
//! edge function of a reversed edge is exactly the negative (so no fused operation there), hence a ray
//! cannot slip through a shared edge. Rounding is monotone: a computed sign is never wrong, only zero
//! may stand for a sign. Triangles with a zero among signs that agree otherwise are settled in `f64`,
//! where the products are exact, as are those whose area nearly underflows.
//!
//! Coordinates up to 2^40 cannot overflow.

use crate::math::Vec3;
use crate::simd::Lanes;

/// Doubled projected areas below this are left to `f64`.
pub(crate) const TINY_AREA: f32 = 7.888_609e-31; // 2^-100

/// Relative slack of the first look at the depth.
pub(crate) const SLACK: f32 = 1e-6;

/// A ray's shear: the axis z of largest direction component, the other two, and the map to the z axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    /// x, y, z in terms of world axes.
    pub axes: [usize; 3],
    /// Ray origin in permuted axes.
    pub origin: [f32; 3],
    /// (dx/dz, dy/dz, 1/dz) in permuted axes.
    pub scale: [f32; 3],
    /// Hits lie beyond this t.
    pub tnear: f32,
    /// dz.
    pub pace: f32,
}

/// World axes x, y, z of a shear whose z is the world axis of largest absolute value.
#[inline(always)]
pub(crate) fn shear_axes(a: Vec3) -> [usize; 3] {
    let z = usize::from(a.x < a.y);
    let z = if a.x.max(a.y) < a.z { 2 } else { z };
    [[1, 2, 0, 0][z], [2, 0, 1, 1][z], z]
}

/// A hit of one triangle: t and the weights of vertices 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TriangleHit {
    pub t: f32,
    pub u: f32,
    pub v: f32,
}

/// A shear with its constants in all lanes.
#[derive(Clone, Copy)]
pub(crate) struct WideShear<V> {
    shear: Shear,
    origin: [V; 3],
    scale: [V; 3],
    tnear: V,
    /// Signs of 1 / dz.
    near_z: V,
    pace: f32,
}

/// The end of a ray's range: t, and distance along z with some slack.
#[derive(Clone, Copy)]
pub(crate) struct End<V> {
    pub t: V,
    z: V,
}

/// Hits of the triangles of a block: only lanes of the mask mean something.
pub(crate) struct BlockHits<V> {
    pub mask: u32,
    /// Whether the block needs [`WideShear::settle`] instead; the rest means nothing then.
    pub doubt: bool,
    t: V,
    u: V,
    v: V,
}

impl<V: Lanes> BlockHits<V> {
    #[inline(always)]
    pub(crate) fn lane(&self, lane: usize) -> TriangleHit {
        TriangleHit {
            t: self.t.to_array().0[lane],
            u: self.u.to_array().0[lane],
            v: self.v.to_array().0[lane],
        }
    }

    #[inline(always)]
    pub(crate) fn t(&self) -> [f32; 8] {
        self.t.to_array().0
    }
}

impl<V: Lanes> WideShear<V> {
    #[inline(always)]
    pub(crate) fn new(shear: &Shear) -> Self {
        Self {
            shear: *shear,
            origin: wide(shear.origin),
            scale: wide(shear.scale),
            tnear: V::splat(shear.tnear),
            near_z: V::splat(shear.tnear * shear.pace.abs() * (1.0 - SLACK)),
            pace: shear.pace.abs() * (1.0 + SLACK),
        }
    }

    /// The shear itself.
    #[inline(always)]
    pub(crate) fn scalar(&self) -> Shear {
        self.shear
    }

    /// The range's end, as [`WideShear::intersect`] wants it.
    #[inline(always)]
    pub(crate) fn end(&self, tfar: f32) -> End<V> {
        End { t: V::splat(tfar), z: V::splat(tfar * self.pace) }
    }

    /// Hits with `tnear < t <= tfar` among the triangles of a block.
    #[inline(always)]
    pub(crate) fn intersect(&self, block: &crate::bvh::Block, end: &End<V>) -> BlockHits<V> {
        let [ax, ay, az] = self.sheared(&block.corners[0]);
        let [bx, by, bz] = self.sheared(&block.corners[1]);
        let [cx, cy, cz] = self.sheared(&block.corners[2]);
        let u = cx.mul(by).sub(cy.mul(bx));
        let v = ax.mul(cy).sub(ay.mul(cx));
        let w = bx.mul(ay).sub(by.mul(ax));
        let zero = V::splat(0.0);
        let least = u.min(v).min(w);
        let most = u.max(v).max(w);
        let inside = V::or(zero.le(least), most.le(zero));
        // A first look at the depth, without a division: one branch for most that is no hit.
        let det = u.add(v).add(w);
        let z = w.mul_add(cz, v.mul_add(bz, u.mul(az))).xor_sign(det).xor_sign(self.scale[2]);
        let area = det.abs();
        let near = V::and(z.not_lt(area.mul(self.near_z)), area.mul(end.z).not_lt(z));
        let mask = V::bits(V::and(inside, near));
        if mask == 0 {
            return BlockHits { mask, doubt: false, t: zero, u: zero, v: zero };
        }
        let r = V::splat(1.0).div(det);
        let (u, v, w) = (u.mul(r), v.mul(r), w.mul(r));
        let t = w.mul_add(cz, v.mul_add(bz, u.mul(az))).mul(self.scale[2]);
        let definite = V::and(V::or(zero.lt(least), most.lt(zero)), V::splat(TINY_AREA).le(area));
        let in_range = V::and(self.tnear.lt(t), t.le(end.t));
        let doubtful = mask & !V::bits(definite);
        BlockHits { mask: V::bits(in_range) & mask | doubtful, doubt: doubtful != 0, t, u: v, v: w }
    }

    /// The slow test of one lane.
    #[inline(never)]
    pub(crate) fn settle(&self, block: &crate::bvh::Block, lane: usize, tfar: f32) -> Option<TriangleHit> {
        let tnear = self.shear.tnear;
        let h = triangle(&self.shear, block.triangle(lane))?;
        (h.t > tnear && h.t <= tfar).then_some(h)
    }

    #[inline(always)]
    fn sheared(&self, corner: &[[f32; 8]; 3]) -> [V; 3] {
        let [x, y, z] = [self.moved(corner, 0), self.moved(corner, 1), self.moved(corner, 2)];
        [self.scale[0].neg_mul_add(z, x), self.scale[1].neg_mul_add(z, y), z]
    }

    /// A coordinate relative to the ray's origin.
    #[inline(always)]
    fn moved(&self, corner: &[[f32; 8]; 3], axis: usize) -> V {
        // SAFETY: axes are 0, 1 or 2; rows of a block are 32-byte aligned.
        let row = unsafe { V::load(corner.get_unchecked(self.shear.axes[axis]).as_ptr()) };
        row.sub(self.origin[axis])
    }
}

// Not `array::map`: what is not inlined loses the instruction set.
#[inline(always)]
fn wide<V: Lanes>([x, y, z]: [f32; 3]) -> [V; 3] {
    [V::splat(x), V::splat(y), V::splat(z)]
}

/// The scalar test, with the same result as the vector test where that is definite.
pub(crate) fn triangle(shear: &Shear, corners: [Vec3; 3]) -> Option<TriangleHit> {
    let [sx, sy, sz] = shear.scale;
    let [a, b, c] = corners.map(|p| {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|i| p[shear.axes[i]] - shear.origin[i]);
        [(-sx).mul_add(z, x), (-sy).mul_add(z, y), z]
    });
    let edge = |p: [f32; 3], q: [f32; 3]| p[0] * q[1] - p[1] * q[0];
    let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
    let positive = u > 0.0 && v > 0.0 && w > 0.0;
    let negative = u < 0.0 && v < 0.0 && w < 0.0;
    let det = u + v + w;
    if !(positive || negative) || det.abs() < TINY_AREA {
        return exact(shear, corners);
    }
    let r = 1.0 / det;
    let (u, v, w) = (u * r, v * r, w * r);
    let t = w.mul_add(c[2], v.mul_add(b[2], u * a[2])) * sz;
    Some(TriangleHit { t, u: v, v: w })
}

/// The test with the sheared `f32` vertices taken as exact and all else in `f64`.
fn exact(shear: &Shear, corners: [Vec3; 3]) -> Option<TriangleHit> {
    let [sx, sy, sz] = shear.scale;
    let [a, b, c] = corners.map(|p| {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|i| p[shear.axes[i]] - shear.origin[i]);
        [(-sx).mul_add(z, x), (-sy).mul_add(z, y), z].map(f64::from)
    });
    let edge = |p: [f64; 3], q: [f64; 3]| p[0] * q[1] - p[1] * q[0];
    let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
    let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let det = u + v + w;
    if !inside || det == 0.0 {
        return None;
    }
    let t = (u * a[2] + v * b[2] + w * c[2]) / det * f64::from(sz);
    Some(TriangleHit { t: t as f32, u: (v / det) as f32, v: (w / det) as f32 })
}
