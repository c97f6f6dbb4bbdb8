//! Four `f32` lanes for the builder: boxes are pairs of these.
//!
//! SSE2 belongs to every x86-64, so no dispatch is needed. Neither `min` nor `max` cares for NaN.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// Four lanes.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub(crate) struct Quad(#[cfg(target_arch = "x86_64")] __m128, #[cfg(not(target_arch = "x86_64"))] [f32; 4]);

// SAFETY (every block below): SSE2 is part of the x86-64 baseline; no memory is touched.
#[cfg(target_arch = "x86_64")]
impl Quad {
    #[inline(always)]
    pub(crate) fn new(x: f32, y: f32, z: f32, w: f32) -> Self {
        // SAFETY: baseline instruction.
        Self(unsafe { _mm_setr_ps(x, y, z, w) })
    }

    #[inline(always)]
    pub(crate) fn splat(x: f32) -> Self {
        // SAFETY: baseline instruction.
        Self(unsafe { _mm_set1_ps(x) })
    }

    #[inline(always)]
    pub(crate) fn min(self, o: Self) -> Self {
        // SAFETY: baseline instruction.
        Self(unsafe { _mm_min_ps(self.0, o.0) })
    }

    #[inline(always)]
    pub(crate) fn max(self, o: Self) -> Self {
        // SAFETY: baseline instruction.
        Self(unsafe { _mm_max_ps(self.0, o.0) })
    }

    #[inline(always)]
    pub(crate) fn add(self, o: Self) -> Self {
        // SAFETY: baseline instruction.
        Self(unsafe { _mm_add_ps(self.0, o.0) })
    }

    #[inline(always)]
    pub(crate) fn sub(self, o: Self) -> Self {
        // SAFETY: baseline instruction.
        Self(unsafe { _mm_sub_ps(self.0, o.0) })
    }

    #[inline(always)]
    pub(crate) fn mul(self, o: Self) -> Self {
        // SAFETY: baseline instruction.
        Self(unsafe { _mm_mul_ps(self.0, o.0) })
    }

    /// Towards zero; lanes out of range give any value.
    #[inline(always)]
    pub(crate) fn truncate(self) -> [i32; 4] {
        // SAFETY: baseline instruction; both types are 16 plain bytes.
        unsafe { std::mem::transmute(_mm_cvttps_epi32(self.0)) }
    }

    #[inline(always)]
    pub(crate) fn to_array(self) -> [f32; 4] {
        // SAFETY: both types are 16 plain bytes.
        unsafe { std::mem::transmute(self.0) }
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl Quad {
    fn zip(self, o: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], o.0[i])))
    }

    pub(crate) fn new(x: f32, y: f32, z: f32, w: f32) -> Self {
        Self([x, y, z, w])
    }

    pub(crate) fn splat(x: f32) -> Self {
        Self([x; 4])
    }

    pub(crate) fn min(self, o: Self) -> Self {
        self.zip(o, |a, b| if a < b { a } else { b })
    }

    pub(crate) fn max(self, o: Self) -> Self {
        self.zip(o, |a, b| if a > b { a } else { b })
    }

    pub(crate) fn add(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }

    pub(crate) fn sub(self, o: Self) -> Self {
        self.zip(o, |a, b| a - b)
    }

    pub(crate) fn mul(self, o: Self) -> Self {
        self.zip(o, |a, b| a * b)
    }

    /// Towards zero; lanes out of range give any value.
    pub(crate) fn truncate(self) -> [i32; 4] {
        self.0.map(|x| x as i32)
    }

    pub(crate) fn to_array(self) -> [f32; 4] {
        self.0
    }
}

/// An axis-aligned box in the first three lanes.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct QuadBox {
    pub lo: Quad,
    pub hi: Quad,
}

impl QuadBox {
    #[inline(always)]
    pub(crate) fn empty() -> Self {
        Self { lo: Quad::splat(f32::INFINITY), hi: Quad::splat(f32::NEG_INFINITY) }
    }

    #[inline(always)]
    pub(crate) fn including(self, p: Quad) -> Self {
        Self { lo: self.lo.min(p), hi: self.hi.max(p) }
    }

    #[inline(always)]
    pub(crate) fn union(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    #[inline(always)]
    pub(crate) fn intersection(self, o: Self) -> Self {
        Self { lo: self.lo.max(o.lo), hi: self.hi.min(o.hi) }
    }

    /// Whether the box holds no point.
    #[inline(always)]
    pub(crate) fn is_empty(self) -> bool {
        let [x, y, z, _] = self.hi.sub(self.lo).to_array();
        !(x >= 0.0 && y >= 0.0 && z >= 0.0)
    }

    /// Half the surface area; not positive for the empty box.
    #[inline(always)]
    pub(crate) fn half_area(self) -> f32 {
        let [x, y, z, _] = self.hi.sub(self.lo).to_array();
        if x < 0.0 { 0.0 } else { x * (y + z) + y * z }
    }

    pub(crate) fn to_bounds(self) -> crate::math::Bounds3 {
        let corner = |q: Quad| {
            let [x, y, z, _] = q.to_array();
            crate::math::Vec3::new(x, y, z)
        };
        crate::math::Bounds3 { min: corner(self.lo), max: corner(self.hi) }
    }
}
