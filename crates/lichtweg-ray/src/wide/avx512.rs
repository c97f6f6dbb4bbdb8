//! The lanes in AVX-512: one 512-bit register a quantity, two for `u64`, and mask registers.

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use super::{
    Double, Float, FloatLanes, LANES, Lanes, Long, Mask, Row, Wide, Word, WordLanes, assert_indices,
};

// SAFETY (every block in this file): the intrinsics need AVX-512 F and DQ; values of these types exist only below the
// dispatch that has detected them. Memory is touched by the loads and stores alone, which are unaligned ones of whole,
// checked ranges.

/// 512-bit registers.
#[derive(Clone, Copy)]
pub(crate) struct Avx512;

impl Wide for Avx512 {
    const REGISTERS: bool = true;
    type F32 = F32;
    type U32 = U32;
    type U64 = U64;
    type Mask = Mask16;
}

/// Sixteen `f32`.
#[derive(Clone, Copy)]
pub(crate) struct F32(__m512);

/// Sixteen `u32`.
#[derive(Clone, Copy)]
pub(crate) struct U32(__m512i);

/// Sixteen `u64`: lanes 0 to 7, and 8 to 15.
#[derive(Clone, Copy)]
pub(crate) struct U64(__m512i, __m512i);

/// Sixteen `f64`: lanes 0 to 7, and 8 to 15.
#[derive(Clone, Copy)]
pub(crate) struct F64(__m512d, __m512d);

/// Sixteen bits.
#[derive(Clone, Copy)]
pub(crate) struct Mask16(__mmask16);

/// Operators of a type around one register.
macro_rules! operators {
    ($($name:ident $op:ident $f:ident $intrinsic:ident),+ $(,)?) => {$(
        impl $op for $name {
            type Output = Self;
            #[inline(always)]
            fn $f(self, rhs: Self) -> Self {
                // SAFETY: see above.
                Self(unsafe { $intrinsic(self.0, rhs.0) })
            }
        }
    )+};
}
operators!(
    F32 Add add _mm512_add_ps,
    F32 Sub sub _mm512_sub_ps,
    F32 Mul mul _mm512_mul_ps,
    F32 Div div _mm512_div_ps,
    U32 Add add _mm512_add_epi32,
    U32 Sub sub _mm512_sub_epi32,
    U32 Mul mul _mm512_mullo_epi32,
    U32 BitAnd bitand _mm512_and_si512,
    U32 BitOr bitor _mm512_or_si512,
    U32 BitXor bitxor _mm512_xor_si512,
);

/// Operators of a type around two registers.
macro_rules! operators_of_pairs {
    ($($name:ident $op:ident $f:ident $intrinsic:ident),+ $(,)?) => {$(
        impl $op for $name {
            type Output = Self;
            #[inline(always)]
            fn $f(self, rhs: Self) -> Self {
                // SAFETY: see above.
                unsafe { Self($intrinsic(self.0, rhs.0), $intrinsic(self.1, rhs.1)) }
            }
        }
    )+};
}
operators_of_pairs!(
    F64 Add add _mm512_add_pd,
    F64 Sub sub _mm512_sub_pd,
    F64 Mul mul _mm512_mul_pd,
    F64 Div div _mm512_div_pd,
    U64 BitXor bitxor _mm512_xor_si512,
    U64 BitOr bitor _mm512_or_si512,
);

impl Neg for F32 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_xor_ps(self.0, _mm512_set1_ps(-0.0)) })
    }
}

impl BitAnd for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, rhs: Self) -> Self {
        Self(self.0 & rhs.0)
    }
}

impl BitOr for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, rhs: Self) -> Self {
        Self(self.0 | rhs.0)
    }
}

impl BitXor for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitxor(self, rhs: Self) -> Self {
        Self(self.0 ^ rhs.0)
    }
}

impl Not for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Mask for Mask16 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits as __mmask16)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self.0)
    }
}

impl Float for F32 {
    type Mask = Mask16;
    type Bits = U32;
    type Double = F64;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_set1_ps(x) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn min(self, b: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_min_ps(self.0, b.0) })
    }

    #[inline(always)]
    fn max(self, b: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_max_ps(self.0, b.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_abs_ps(self.0) })
    }

    #[inline(always)]
    fn copysign(self, b: Self) -> Self {
        // SAFETY: see above. The table of the ternary operation says: the third operand's bit picks.
        Self(unsafe {
            let sign = _mm512_castps_si512(_mm512_set1_ps(-0.0));
            let (a, b) = (_mm512_castps_si512(self.0), _mm512_castps_si512(b.0));
            _mm512_castsi512_ps(_mm512_ternarylogic_epi32::<0xd8>(a, b, sign))
        })
    }

    #[inline(always)]
    fn lt(self, b: Self) -> Mask16 {
        // SAFETY: see above.
        Mask16(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, b.0) })
    }

    #[inline(always)]
    fn le(self, b: Self) -> Mask16 {
        // SAFETY: see above.
        Mask16(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, b.0) })
    }

    #[inline(always)]
    fn equal(self, b: Self) -> Mask16 {
        // SAFETY: see above.
        Mask16(unsafe { _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, b.0) })
    }

    #[inline(always)]
    fn select(self, mask: Mask16, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_mask_blend_ps(mask.0, other.0, self.0) })
    }

    #[inline(always)]
    fn bits(self) -> U32 {
        // SAFETY: see above.
        U32(unsafe { _mm512_castps_si512(self.0) })
    }

    #[inline(always)]
    fn truncate(self) -> U32 {
        // SAFETY: see above.
        U32(unsafe { _mm512_cvttps_epi32(self.0) })
    }

    #[inline(always)]
    fn widen(self) -> F64 {
        // SAFETY: see above.
        unsafe {
            F64(
                _mm512_cvtps_pd(_mm512_castps512_ps256(self.0)),
                _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(self.0)),
            )
        }
    }
}

impl Neg for F64 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see above.
        unsafe {
            let sign = _mm512_set1_pd(-0.0);
            Self(_mm512_xor_pd(self.0, sign), _mm512_xor_pd(self.1, sign))
        }
    }
}

impl F64 {
    /// A comparison of both registers.
    #[inline(always)]
    fn compare<const PREDICATE: i32>(self, b: Self) -> Mask16 {
        // SAFETY: see above.
        let (low, high) = unsafe {
            (_mm512_cmp_pd_mask::<PREDICATE>(self.0, b.0), _mm512_cmp_pd_mask::<PREDICATE>(self.1, b.1))
        };
        Mask16(u16::from(low) | u16::from(high) << 8)
    }
}

impl Double for F64 {
    type Mask = Mask16;
    type F32 = F32;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see above.
        let all = unsafe { _mm512_set1_pd(x) };
        Self(all, all)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see above.
        unsafe { Self(_mm512_sqrt_pd(self.0), _mm512_sqrt_pd(self.1)) }
    }

    #[inline(always)]
    fn copysign(self, b: Self) -> Self {
        // SAFETY: see above.
        unsafe {
            let sign = _mm512_set1_pd(-0.0);
            let low = _mm512_or_pd(_mm512_andnot_pd(sign, self.0), _mm512_and_pd(sign, b.0));
            let high = _mm512_or_pd(_mm512_andnot_pd(sign, self.1), _mm512_and_pd(sign, b.1));
            Self(low, high)
        }
    }

    #[inline(always)]
    fn lt(self, b: Self) -> Mask16 {
        self.compare::<_CMP_LT_OQ>(b)
    }

    #[inline(always)]
    fn le(self, b: Self) -> Mask16 {
        self.compare::<_CMP_LE_OQ>(b)
    }

    #[inline(always)]
    fn equal(self, b: Self) -> Mask16 {
        self.compare::<_CMP_EQ_OQ>(b)
    }

    #[inline(always)]
    fn select(self, mask: Mask16, other: Self) -> Self {
        // SAFETY: see above.
        unsafe {
            Self(
                _mm512_mask_blend_pd(mask.0 as __mmask8, other.0, self.0),
                _mm512_mask_blend_pd((mask.0 >> 8) as __mmask8, other.1, self.1),
            )
        }
    }

    #[inline(always)]
    fn narrow(self) -> F32 {
        // SAFETY: see above.
        unsafe {
            let (low, high) = (_mm512_cvtpd_ps(self.0), _mm512_cvtpd_ps(self.1));
            F32(_mm512_insertf32x8::<1>(_mm512_castps256_ps512(low), high))
        }
    }
}

impl FloatLanes for F32 {
    #[inline(always)]
    fn load(from: &Lanes<f32>) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_load_ps(from.0.as_ptr()) })
    }

    #[inline(always)]
    fn to_lanes(self) -> Lanes<f32> {
        let mut out = Lanes([0.0; LANES]);
        // SAFETY: see above.
        unsafe { _mm512_store_ps(out.0.as_mut_ptr(), self.0) };
        out
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f32 {
        assert!(lane < LANES);
        // SAFETY: a register in memory is sixteen `f32`.
        unsafe { (&raw const self.0).cast::<f32>().add(lane).read() }
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_fmadd_ps(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_fmsub_ps(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_fnmadd_ps(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        // SAFETY: see above.
        unsafe { _mm512_reduce_min_ps(self.0) }
    }

    #[inline(always)]
    fn gather(table: &[f32], index: U32) -> Self {
        assert_indices(index, table.len());
        // SAFETY: see above.
        Self(unsafe { _mm512_i32gather_ps::<4>(index.0, table.as_ptr()) })
    }

    #[inline(always)]
    fn rows(columns: [Self; LANES]) -> [Row; LANES] {
        let mut registers = [columns[0].0; LANES];
        for i in 0..LANES {
            registers[i] = columns[i].0;
        }
        let registers = transpose(registers);
        let mut out = [Lanes([0.0; LANES]); LANES];
        for i in 0..LANES {
            out[i] = Self(registers[i]).to_lanes();
        }
        out
    }

    #[inline(always)]
    fn columns(rows: &[&Row; LANES]) -> [Self; LANES] {
        // SAFETY: see above.
        let zero = unsafe { _mm512_setzero_ps() };
        let mut lane = [zero; LANES];
        for i in 0..LANES {
            // SAFETY: see above.
            lane[i] = unsafe { _mm512_load_ps(rows[i].0.as_ptr()) };
        }
        // Not `array::map`: what is not inlined loses the instruction set.
        let lane = transpose(lane);
        let mut out = [Self(zero); LANES];
        for i in 0..LANES {
            out[i] = Self(lane[i]);
        }
        out
    }
}

/// Sixteen rows to sixteen columns: pairs, then quadruples of floats within 128-bit parts, then the parts.
#[inline(always)]
fn transpose(r: [__m512; LANES]) -> [__m512; LANES] {
    // SAFETY: see above.
    unsafe {
        let mut t = r;
        for i in 0..8 {
            t[2 * i] = _mm512_unpacklo_ps(r[2 * i], r[2 * i + 1]);
            t[2 * i + 1] = _mm512_unpackhi_ps(r[2 * i], r[2 * i + 1]);
        }
        let d = |x: __m512| _mm512_castps_pd(x);
        let s = |x: __m512d| _mm512_castpd_ps(x);
        // q[4 k + j]: columns j, j + 4, j + 8, j + 12 of rows 4 k to 4 k + 3.
        let mut q = t;
        for k in 0..4 {
            let (a, b, c, e) = (d(t[4 * k]), d(t[4 * k + 1]), d(t[4 * k + 2]), d(t[4 * k + 3]));
            q[4 * k] = s(_mm512_unpacklo_pd(a, c));
            q[4 * k + 1] = s(_mm512_unpackhi_pd(a, c));
            q[4 * k + 2] = s(_mm512_unpacklo_pd(b, e));
            q[4 * k + 3] = s(_mm512_unpackhi_pd(b, e));
        }
        let mut out = q;
        for j in 0..4 {
            let low02 = _mm512_shuffle_f32x4::<0b10_00_10_00>(q[j], q[4 + j]);
            let low13 = _mm512_shuffle_f32x4::<0b11_01_11_01>(q[j], q[4 + j]);
            let high02 = _mm512_shuffle_f32x4::<0b10_00_10_00>(q[8 + j], q[12 + j]);
            let high13 = _mm512_shuffle_f32x4::<0b11_01_11_01>(q[8 + j], q[12 + j]);
            out[j] = _mm512_shuffle_f32x4::<0b10_00_10_00>(low02, high02);
            out[8 + j] = _mm512_shuffle_f32x4::<0b11_01_11_01>(low02, high02);
            out[4 + j] = _mm512_shuffle_f32x4::<0b10_00_10_00>(low13, high13);
            out[12 + j] = _mm512_shuffle_f32x4::<0b11_01_11_01>(low13, high13);
        }
        out
    }
}

impl Word for U32 {
    type Mask = Mask16;
    type F32 = F32;

    #[inline(always)]
    fn splat(x: u32) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_set1_epi32(x as i32) })
    }

    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_sll_epi32(self.0, _mm_cvtsi32_si128(N as i32)) })
    }

    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_srl_epi32(self.0, _mm_cvtsi32_si128(N as i32)) })
    }

    #[inline(always)]
    fn equal(self, b: Self) -> Mask16 {
        // SAFETY: see above.
        Mask16(unsafe { _mm512_cmpeq_epu32_mask(self.0, b.0) })
    }

    #[inline(always)]
    fn lt(self, b: Self) -> Mask16 {
        // SAFETY: see above.
        Mask16(unsafe { _mm512_cmplt_epu32_mask(self.0, b.0) })
    }

    #[inline(always)]
    fn select(self, mask: Mask16, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_mask_blend_epi32(mask.0, other.0, self.0) })
    }

    #[inline(always)]
    fn as_float(self) -> F32 {
        // SAFETY: see above.
        F32(unsafe { _mm512_castsi512_ps(self.0) })
    }

    #[inline(always)]
    fn to_float(self) -> F32 {
        // SAFETY: see above.
        F32(unsafe { _mm512_cvtepi32_ps(self.0) })
    }
}

impl WordLanes for U32 {
    type U64 = U64;

    #[inline(always)]
    fn load(from: &Lanes<u32>) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_load_si512(from.0.as_ptr().cast()) })
    }

    #[inline(always)]
    fn to_lanes(self) -> Lanes<u32> {
        let mut out = Lanes([0; LANES]);
        // SAFETY: see above.
        unsafe { _mm512_store_si512(out.0.as_mut_ptr().cast(), self.0) };
        out
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> u32 {
        assert!(lane < LANES);
        // SAFETY: a register in memory is sixteen `u32`.
        unsafe { (&raw const self.0).cast::<u32>().add(lane).read() }
    }

    #[inline(always)]
    fn gather(table: &[u32], index: Self) -> Self {
        assert_indices(index, table.len());
        // SAFETY: see above.
        Self(unsafe { _mm512_i32gather_epi32::<4>(index.0, table.as_ptr().cast()) })
    }

    #[inline(always)]
    fn widen(self) -> U64 {
        // SAFETY: see above.
        unsafe {
            U64(
                _mm512_cvtepu32_epi64(_mm512_castsi512_si256(self.0)),
                _mm512_cvtepu32_epi64(_mm512_extracti32x8_epi32::<1>(self.0)),
            )
        }
    }
}

impl Long for U64 {
    type U32 = U32;

    #[inline(always)]
    fn splat(x: u64) -> Self {
        // SAFETY: see above.
        let all = unsafe { _mm512_set1_epi64(x as i64) };
        Self(all, all)
    }

    #[inline(always)]
    fn wrapping_add(self, b: Self) -> Self {
        // SAFETY: see above.
        unsafe { Self(_mm512_add_epi64(self.0, b.0), _mm512_add_epi64(self.1, b.1)) }
    }

    #[inline(always)]
    fn wrapping_mul(self, b: Self) -> Self {
        // SAFETY: see above.
        unsafe { Self(_mm512_mullo_epi64(self.0, b.0), _mm512_mullo_epi64(self.1, b.1)) }
    }

    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        // SAFETY: see above.
        unsafe {
            let count = _mm_cvtsi32_si128(N as i32);
            Self(_mm512_sll_epi64(self.0, count), _mm512_sll_epi64(self.1, count))
        }
    }

    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        // SAFETY: see above.
        unsafe {
            let count = _mm_cvtsi32_si128(N as i32);
            Self(_mm512_srl_epi64(self.0, count), _mm512_srl_epi64(self.1, count))
        }
    }

    #[inline(always)]
    fn low(self) -> U32 {
        // SAFETY: see above.
        unsafe {
            let (a, b) = (_mm512_cvtepi64_epi32(self.0), _mm512_cvtepi64_epi32(self.1));
            U32(_mm512_inserti32x8::<1>(_mm512_castsi256_si512(a), b))
        }
    }

    #[inline(always)]
    fn high(self) -> U32 {
        self.shr::<32>().low()
    }
}
