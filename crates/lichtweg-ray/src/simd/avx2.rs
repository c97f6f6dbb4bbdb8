//! The lanes in AVX2 with FMA.

use std::arch::x86_64::*;

use super::wide::arithmetic_256;
use super::{Aligned8, Isa, Lanes};

// SAFETY (every block in this file): the intrinsics need AVX2 and FMA; values of this type exist only below
// the dispatch that has detected them. Memory is touched by `load` and `to_array` alone.

/// Eight lanes in a 256-bit register.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(__m256);

impl Lanes for Avx2 {
    const ISA: Isa = Isa::Avx2;
    type Mask = __m256;

    arithmetic_256!();

    #[inline(always)]
    fn le(self, b: Self) -> Self::Mask {
        // SAFETY: the instruction set is detected, see above.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, b.0) }
    }

    #[inline(always)]
    fn lt(self, b: Self) -> Self::Mask {
        // SAFETY: the instruction set is detected, see above.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, b.0) }
    }

    #[inline(always)]
    fn not_lt(self, b: Self) -> Self::Mask {
        // SAFETY: the instruction set is detected, see above.
        unsafe { _mm256_cmp_ps::<_CMP_NLT_UQ>(self.0, b.0) }
    }

    #[inline(always)]
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        // SAFETY: the instruction set is detected, see above.
        unsafe { _mm256_and_ps(a, b) }
    }

    #[inline(always)]
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        // SAFETY: the instruction set is detected, see above.
        unsafe { _mm256_or_ps(a, b) }
    }

    #[inline(always)]
    fn bits(m: Self::Mask) -> u32 {
        // SAFETY: the instruction set is detected, see above.
        unsafe { _mm256_movemask_ps(m) as u32 }
    }
}
