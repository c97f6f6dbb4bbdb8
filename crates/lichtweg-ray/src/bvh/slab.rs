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

use crate::ray::Ray;
use crate::simd::Lanes;

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
    /// `reach` is the largest absolute coordinate of the scene.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, tnear: f32, reach: f32) -> Self {
        let d = ray.direction.to_array();
        let o = ray.origin.to_array();
        let steepest = ray.direction.abs().max_element();
        let shallowest = steepest * 2.0_f32.powi(-60);
        let bend = (reach + ray.origin.abs().max_element()) * 2.0_f32.powi(-58);
        let zero = V::splat(0.0);
        let mut slab = Self {
            near_row: [0; 3],
            near_scale: [zero; 3],
            near_shift: [zero; 3],
            far_scale: [zero; 3],
            far_shift: [zero; 3],
            tnear: V::splat(tnear),
        };
        for i in 0..3 {
            let di = if d[i].abs() < shallowest { shallowest.copysign(d[i]) } else { d[i] };
            let inverse = 1.0 / di;
            let margin = o[i].abs() * 2.0_f32.powi(-22) + bend;
            let near = inverse * (1.0 - 2.0_f32.powi(-21));
            let far = inverse * (1.0 + 2.0_f32.powi(-21));
            slab.near_row[i] = 2 * ROW * i + if di < 0.0 { ROW } else { 0 };
            slab.near_scale[i] = V::splat(near);
            slab.near_shift[i] = V::splat(o[i] * near + (margin * near).abs());
            slab.far_scale[i] = V::splat(far);
            slab.far_shift[i] = V::splat(o[i] * far - (margin * far).abs());
        }
        slab
    }

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
