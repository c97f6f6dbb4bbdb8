//! A ray prepared for conservative box tests.
//!
//! A box is entered at max over axes of (near plane - o) / d and left at min of (far plane - o) / d, here
//! as one fused multiply-subtract a plane. Three margins make the test conservative with respect to the
//! rounded triangle test, so that watertight meshes stay so (after Woop, Benthin and Wald 2013, section 3.3,
//! and Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013):
//!
//! * the near and far reciprocals are scaled by 1 -+ 2^-21, for all errors proportional to distance
//!   (at most 5 units of 2^-24 from shearing a vertex, one each from the reciprocal and the result);
//! * the origin is moved outwards by 2^-22 of its size, for the rounding of o / d;
//! * boxes of triangles are built wider by 3 * 2^-23 of their size (see `build::primitive`), for errors
//!   proportional to the triangle.
//!
//! A direction component below 2^-60 of the largest is replaced by that; the origin's margin takes in
//! how far this can bend the ray within the scene.

use crate::build::MAX_COORDINATE;
use crate::ray::Ray;
use crate::simd::{Aligned8, Lanes, WIDTH};
use crate::triangle::{Shear, shear_axes};

/// A ray made ready for boxes and triangles, or `None` where it can hit nothing: not finite, beyond the
/// largest coordinate, without direction or range. `reach` is the largest absolute coordinate of the scene.
#[inline(always)]
pub(crate) fn prepare<V: Lanes>(ray: &Ray, reach: f32) -> Option<(Slab<V>, Shear, f32)> {
    let tnear = if ray.tnear > 0.0 { ray.tnear } else { 0.0 };
    let tfar = if ray.tfar < f32::MAX { ray.tfar } else { f32::MAX };
    // Lanes 0 to 2: origin, 3 to 5: direction.
    // SAFETY: a ray is nine consecutive `f32`.
    let all = unsafe { V::load_unaligned((&raw const *ray).cast()) }.abs();
    let (c, m) = (MAX_COORDINATE, f32::MAX);
    let limits = V::from_array(Aligned8([c, c, c, m, m, m, m, m]));
    let finite = V::bits(all.le(limits)) & 0x3f == 0x3f;
    let size = ray.direction.abs();
    let steepest = size.max_element();
    if !(finite && tnear < tfar && ray.tnear <= ray.tfar && steepest >= f32::MIN_POSITIVE) {
        return None;
    }
    let axes = shear_axes(size);
    let d = ray.direction.to_array();
    let o = ray.origin.to_array();
    let [x, y, z] = axes;

    let zero = V::splat(0.0);
    let shallowest = V::splat(steepest * TINY);
    let direction = V::from_array(Aligned8([d[0], d[1], d[2], d[z], d[z], d[z], 1.0, 1.0]));
    let divisor = direction.abs().max(shallowest).copysign(direction);
    let dividend = V::from_array(Aligned8([1.0, 1.0, 1.0, d[x], d[y], 1.0, 1.0, 1.0]));
    let quotient = dividend.div(divisor);

    let origin = V::from_array(Aligned8([o[0], o[1], o[2], 0.0, 0.0, 0.0, 0.0, 0.0]));
    let bend = V::splat((reach + ray.origin.abs().max_element()) * (4.0 * TINY));
    let margin = origin.abs().mul_add(V::splat(2.0_f32.powi(-22)), bend);
    let near_scale = quotient.mul(V::splat(1.0 - 2.0_f32.powi(-21)));
    let far_scale = quotient.mul(V::splat(1.0 + 2.0_f32.powi(-21)));
    let near_shift = origin.mul_add(near_scale, margin.mul(near_scale).abs()).to_array().0;
    let far_shift = origin.mul_sub(far_scale, margin.mul(far_scale).abs()).to_array().0;
    let negative = V::bits(divisor.lt(zero)) as usize;
    let negative = [negative & 1, negative >> 1 & 1, negative >> 2 & 1];
    let (near_scale, far_scale) = (near_scale.to_array().0, far_scale.to_array().0);
    let slab = Slab {
        near_row: near_rows(negative),
        near_scale: first3(&near_scale),
        near_shift: first3(&near_shift),
        far_scale: first3(&far_scale),
        far_shift: first3(&far_shift),
        tnear: V::splat(tnear),
    };
    let quotient = quotient.to_array().0;
    let shear = Shear {
        axes,
        origin: [o[x], o[y], o[z]],
        scale: [quotient[3], quotient[4], quotient[5]],
        tnear,
        pace: d[z],
    };
    Some((slab, shear, tfar))
}

/// Byte offsets of the near planes' rows in a node, of a direction whose negative components are 1 here.
#[inline(always)]
pub(crate) fn near_rows([x, y, z]: [usize; 3]) -> [usize; 3] {
    [x * ROW, 2 * ROW + y * ROW, 4 * ROW + z * ROW]
}

/// The first three values, each in all lanes.
#[inline(always)]
fn first3<V: Lanes>(a: &[f32; WIDTH]) -> [V; 3] {
    [V::splat(a[0]), V::splat(a[1]), V::splat(a[2])]
}

/// Ratio of direction components below which one is replaced: 2^-60.
pub(crate) const TINY: f32 = 8.673_617e-19;

/// Byte distance of a minimum plane row and its maximum row in a node.
const ROW: usize = 32;

/// Constants of the slab test, one vector of equal lanes each.
#[derive(Clone, Copy)]
pub(crate) struct Slab<V> {
    /// Byte offset of each axis' near plane row; the far row is at `offset ^ ROW`.
    pub near_row: [usize; 3],
    pub near_scale: [V; 3],
    pub near_shift: [V; 3],
    pub far_scale: [V; 3],
    pub far_shift: [V; 3],
    pub tnear: V,
}

impl<V: Lanes> Slab<V> {
    /// Which of eight boxes the ray meets before `tfar`, and where it enters them.
    ///
    /// A NaN (overflow) drops its plane's constraint, which is conservative.
    ///
    /// # Safety
    /// `planes` must point at the six rows of a [`super::Node`], 32-byte aligned.
    #[inline(always)]
    pub(crate) unsafe fn meet(&self, planes: *const u8, tfar: V) -> (u32, V) {
        // SAFETY: the caller's.
        let (near, far) = unsafe {
            (
                [self.near(planes, 0), self.near(planes, 1), self.near(planes, 2)],
                [self.far(planes, 0), self.far(planes, 1), self.far(planes, 2)],
            )
        };
        let enter = near[0].max(near[1]).max(near[2].max(self.tnear));
        let leave = far[0].min(far[1]).min(far[2].min(tfar));
        (V::bits(enter.le(leave)), enter)
    }

    /// Where the near planes of an axis are crossed.
    ///
    /// # Safety
    /// As for [`Slab::meet`].
    #[inline(always)]
    unsafe fn near(&self, planes: *const u8, axis: usize) -> V {
        // SAFETY: the offset is that of one of the six rows.
        let row = unsafe { V::load(planes.add(self.near_row[axis]).cast()) };
        row.mul_sub(self.near_scale[axis], self.near_shift[axis])
    }

    /// Where the far planes of an axis are crossed.
    ///
    /// # Safety
    /// As for [`Slab::meet`].
    #[inline(always)]
    unsafe fn far(&self, planes: *const u8, axis: usize) -> V {
        // SAFETY: flipping the row bit gives the other row of the same axis.
        let row = unsafe { V::load(planes.add(self.near_row[axis] ^ ROW).cast()) };
        row.mul_sub(self.far_scale[axis], self.far_shift[axis])
    }
}
