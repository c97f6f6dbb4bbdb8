//! Four `f32` lanes for the builder: boxes are pairs of these.
//!
//! SSE2 belongs to every x86-64, so no dispatch is needed. `a.min(b)` and `a.max(b)` are `b` where either is NaN.

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

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        // SAFETY: baseline instruction.
        Self(unsafe { _mm_sqrt_ps(self.0) })
    }

    /// The first lanes of three, the second ones, the third ones.
    #[inline(always)]
    pub(crate) fn transposed([a, b, c]: [Self; 3]) -> [Self; 3] {
        // SAFETY: baseline instructions.
        unsafe {
            // No fourth lane gets into the result: a whole number there would be a denormal, which is slow.
            let (low, high) = (_mm_unpacklo_ps(a.0, b.0), _mm_unpackhi_ps(a.0, b.0));
            let x = _mm_movelh_ps(low, c.0);
            let y = _mm_shuffle_ps::<0b00_01_11_10>(low, c.0);
            let z = _mm_shuffle_ps::<0b10_10_01_00>(high, c.0);
            [Self(x), Self(y), Self(z)]
        }
    }

    /// All lanes NaN, if that is wanted.
    #[inline(always)]
    pub(crate) fn or_nan(self, is_nan: bool) -> Self {
        // SAFETY: baseline instructions.
        Self(unsafe { _mm_or_ps(self.0, _mm_castsi128_ps(_mm_set1_epi32(-i32::from(is_nan)))) })
    }

    /// Whole numbers below 2^31.
    #[inline(always)]
    pub(crate) fn from_counts(counts: [u32; 4]) -> Self {
        // SAFETY: baseline instruction; both types are 16 plain bytes.
        Self(unsafe { _mm_cvtepi32_ps(std::mem::transmute::<[u32; 4], __m128i>(counts)) })
    }

    /// Lane i as bit i: whether the lane, taken towards zero and modulo a power of two, is below `limit`. As
    /// [`Quad::truncate`] lanes out of range give any value, but the same one.
    #[inline(always)]
    pub(crate) fn truncates_below(self, modulo: i32, limit: i32) -> u32 {
        // SAFETY: baseline instructions.
        unsafe {
            let i = _mm_and_si128(_mm_cvttps_epi32(self.0), _mm_set1_epi32(modulo - 1));
            _mm_movemask_ps(_mm_castsi128_ps(_mm_cmplt_epi32(i, _mm_set1_epi32(limit)))) as u32
        }
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

    pub(crate) fn sqrt(self) -> Self {
        Self(self.0.map(f32::sqrt))
    }

    /// The first lanes of three, the second ones, the third ones.
    pub(crate) fn transposed([a, b, c]: [Self; 3]) -> [Self; 3] {
        std::array::from_fn(|i| Self([a.0[i], b.0[i], c.0[i], 0.0]))
    }

    /// All lanes NaN, if that is wanted.
    pub(crate) fn or_nan(self, is_nan: bool) -> Self {
        if is_nan { Self([f32::NAN; 4]) } else { self }
    }

    /// Whole numbers below 2^31.
    pub(crate) fn from_counts(counts: [u32; 4]) -> Self {
        Self(counts.map(|c| c as f32))
    }

    /// Lane i as bit i: whether the lane, taken towards zero and modulo a power of two, is below `limit`. As
    /// [`Quad::truncate`] lanes out of range give any value, but the same one.
    pub(crate) fn truncates_below(self, modulo: i32, limit: i32) -> u32 {
        let below = self.truncate().map(|i| i & (modulo - 1) < limit);
        (0..4).fold(0, |bits, i| bits | u32::from(below[i]) << i)
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

    /// With a point, if it is wanted: without a branch.
    #[inline(always)]
    pub(crate) fn including_if(self, wanted: bool, p: Quad) -> Self {
        let p = p.or_nan(!wanted);
        Self { lo: p.min(self.lo), hi: p.max(self.hi) }
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
