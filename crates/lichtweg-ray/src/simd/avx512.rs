//! The lanes in AVX-512 VL: 256-bit registers, 32 of them, with mask registers.

use std::arch::x86_64::*;

use super::{Aligned8, Lanes};

// SAFETY (every block in this file): the intrinsics need AVX-512 F, VL and DQ; values of this type exist only below
// the dispatch that has detected them. Memory is touched by `load` and `to_array` alone.

/// Eight lanes in a 256-bit register.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(__m256);

impl Lanes for Avx512 {
    type Mask = __mmask8;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    unsafe fn load(p: *const f32) -> Self {
        // SAFETY: the caller promises 32 readable, aligned bytes; for the instruction set see above.
        Self(unsafe { _mm256_load_ps(p) })
    }

    #[inline(always)]
    unsafe fn load_unaligned(p: *const f32) -> Self {
        // SAFETY: the caller promises 32 readable bytes; for the instruction set see above.
        Self(unsafe { _mm256_loadu_ps(p) })
    }

    #[inline(always)]
    fn to_array(self) -> Aligned8 {
        let mut out = Aligned8([0.0; 8]);
        // SAFETY: `out` is 32 bytes, 32-byte aligned; for the instruction set see above.
        unsafe { _mm256_store_ps(out.0.as_mut_ptr(), self.0) };
        out
    }

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_add_ps(self.0, b.0) })
    }

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_sub_ps(self.0, b.0) })
    }

    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_mul_ps(self.0, b.0) })
    }

    #[inline(always)]
    fn div(self, b: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_div_ps(self.0, b.0) })
    }

    #[inline(always)]
    fn min(self, b: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_min_ps(self.0, b.0) })
    }

    #[inline(always)]
    fn max(self, b: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_max_ps(self.0, b.0) })
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_fmadd_ps(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_fmsub_ps(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_fnmadd_ps(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn copysign(self, b: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe {
            let sign = _mm256_set1_ps(-0.0);
            _mm256_or_ps(_mm256_andnot_ps(sign, self.0), _mm256_and_ps(sign, b.0))
        })
    }

    #[inline(always)]
    fn xor_sign(self, b: Self) -> Self {
        // SAFETY: the instruction set is detected, see above.
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_and_ps(_mm256_set1_ps(-0.0), b.0)) })
    }

    #[inline(always)]
    fn le(self, b: Self) -> Self::Mask {
        // SAFETY: the instruction set is detected, see above.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(self.0, b.0) }
    }

    #[inline(always)]
    fn lt(self, b: Self) -> Self::Mask {
        // SAFETY: the instruction set is detected, see above.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(self.0, b.0) }
    }

    #[inline(always)]
    fn not_lt(self, b: Self) -> Self::Mask {
        // SAFETY: the instruction set is detected, see above.
        unsafe { _mm256_cmp_ps_mask::<_CMP_NLT_UQ>(self.0, b.0) }
    }

    #[inline(always)]
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        a & b
    }

    #[inline(always)]
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        a | b
    }

    #[inline(always)]
    fn bits(m: Self::Mask) -> u32 {
        u32::from(m)
    }
}
