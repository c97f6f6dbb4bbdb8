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
//! Coordinates up to 2^60 cannot overflow.

use crate::math::Vec3;
use crate::ray::Ray;
use crate::simd::Lanes;

/// Doubled projected areas below this are left to `f64`.
const TINY_AREA: f32 = 7.888_609e-31; // 2^-100

/// A ray's shear: the axis z of largest direction component, the other two, and the map to the z axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    /// x, y, z in terms of world axes.
    pub axes: [usize; 3],
    /// Ray origin in permuted axes.
    pub origin: [f32; 3],
    /// (dx/dz, dy/dz, 1/dz) in permuted axes.
    pub scale: [f32; 3],
}

impl Shear {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let a = ray.direction.abs();
        let z = if a.x > a.y {
            if a.x > a.z { 0 } else { 2 }
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let o = ray.origin.to_array();
        let x = if z == 2 { 0 } else { z + 1 };
        let y = if x == 2 { 0 } else { x + 1 };
        Self {
            axes: [x, y, z],
            origin: [o[x], o[y], o[z]],
            scale: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]],
        }
    }
}

/// A hit of one triangle: t and the weights of vertices 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TriangleHit {
    pub t: f32,
    pub u: f32,
    pub v: f32,
}

/// The test of a single triangle.
#[cfg(test)]
pub(crate) fn intersect(
    shear: &Shear,
    corners: [Vec3; 3],
    tnear: f32,
    tfar: f32,
) -> Option<TriangleHit> {
    use crate::simd::Portable;
    let mut block = crate::bvh::Block::EMPTY;
    block.set(0, corners);
    let wide = WideShear::<Portable>::new(shear, tnear);
    let hits = wide.intersect(&block, Portable::splat(tfar));
    (hits.mask == 1).then(|| hits.lane(0))
}

/// A shear with its constants in all lanes.
#[derive(Clone, Copy)]
pub(crate) struct WideShear<V> {
    shear: Shear,
    origin: [V; 3],
    scale: [V; 3],
    tnear: V,
}

/// Hits of the triangles of a block: only lanes of the mask mean something.
pub(crate) struct BlockHits<V> {
    pub mask: u32,
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
    pub(crate) fn new(shear: &Shear, tnear: f32) -> Self {
        Self {
            shear: *shear,
            origin: wide(shear.origin),
            scale: wide(shear.scale),
            tnear: V::splat(tnear),
        }
    }

    /// Hits with `tnear < t <= tfar` among the triangles of a block.
    #[inline(always)]
    pub(crate) fn intersect(&self, block: &crate::bvh::Block, tfar: V) -> BlockHits<V> {
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
        let mut mask = V::bits(inside);
        if mask == 0 {
            return BlockHits { mask, t: zero, u: zero, v: zero };
        }
        let det = u.add(v).add(w);
        let r = V::splat(1.0).div(det);
        let (u, v, w) = (u.mul(r), v.mul(r), w.mul(r));
        let t = w.mul_add(cz, v.mul_add(bz, u.mul(az))).mul(self.scale[2]);
        let definite =
            V::and(V::or(zero.lt(least), most.lt(zero)), V::splat(TINY_AREA).le(det.abs()));
        let in_range = V::and(self.tnear.lt(t), t.le(tfar));
        let doubtful = mask & !V::bits(definite);
        mask &= V::bits(in_range) & !doubtful;
        let mut hits = BlockHits { mask, t, u: v, v: w };
        if doubtful != 0 {
            self.settle(block, doubtful, tfar, &mut hits);
        }
        hits
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

    /// Decides the lanes of `doubtful` in `f64`.
    #[cold]
    #[inline(never)]
    fn settle(
        &self,
        block: &crate::bvh::Block,
        doubtful: u32,
        tfar: V,
        hits: &mut BlockHits<V>,
    ) {
        let tnear = self.tnear.to_array().0[0];
        let tfar = tfar.to_array().0[0];
        let (mut t, mut u, mut v) = (hits.t.to_array(), hits.u.to_array(), hits.v.to_array());
        for lane in (0..8).filter(|l| doubtful >> l & 1 != 0) {
            let Some(h) = exact(&self.shear, block.triangle(lane)) else { continue };
            if h.t > tnear && h.t <= tfar {
                hits.mask |= 1 << lane;
                (t.0[lane], u.0[lane], v.0[lane]) = (h.t, h.u, h.v);
            }
        }
        // SAFETY: `Aligned8` has the size and alignment of a register.
        unsafe {
            hits.t = V::load(t.0.as_ptr());
            hits.u = V::load(u.0.as_ptr());
            hits.v = V::load(v.0.as_ptr());
        }
    }
}

// Not `array::map`: what is not inlined loses the instruction set.
#[inline(always)]
fn wide<V: Lanes>([x, y, z]: [f32; 3]) -> [V; 3] {
    [V::splat(x), V::splat(y), V::splat(z)]
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
