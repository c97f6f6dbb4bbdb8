//! The lanes in AVX2: two 256-bit registers a quantity, four for those of 64 bits; a truth value is a lane of ones.

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use super::{
    Double, Float, FloatLanes, LANES, Lanes, Long, Mask, Row, Wide, Word, WordLanes, assert_indices,
};

// SAFETY (every block in this file): the intrinsics need AVX2 and FMA; values of these types exist only below the dispatch
// that has detected them. Memory is touched by the loads, stores and gathers alone, all of whole, checked ranges.

/// 256-bit registers.
#[derive(Clone, Copy)]
pub(crate) struct Avx2;

impl Wide for Avx2 {
    const REGISTERS: bool = true;
    type F32 = F32;
    type U32 = U32;
    type U64 = U64;
    type Mask = Mask16;
}

/// Sixteen `f32`: lanes 0 to 7, and 8 to 15.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct F32(__m256, __m256);

/// Sixteen `u32`: lanes 0 to 7, and 8 to 15.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct U32(__m256i, __m256i);

/// Sixteen `u64`, four a register.
#[derive(Clone, Copy)]
pub(crate) struct U64(__m256i, __m256i, __m256i, __m256i);

/// Sixteen `f64`, four a register.
#[derive(Clone, Copy)]
pub(crate) struct F64(__m256d, __m256d, __m256d, __m256d);

/// Sixteen truth values, as lanes of ones or of zeros.
#[derive(Clone, Copy)]
pub(crate) struct Mask16(__m256, __m256);

/// An intrinsic on each register of some values.
macro_rules! pairs {
    ($intrinsic:path, $($value:expr),+) => {
        // SAFETY: see above.
        unsafe { ($intrinsic($($value.0),+), $intrinsic($($value.1),+)) }
    };
}

macro_rules! quads {
    ($intrinsic:path, $($value:expr),+) => {
        // SAFETY: see above.
        unsafe {
            (
                $intrinsic($($value.0),+),
                $intrinsic($($value.1),+),
                $intrinsic($($value.2),+),
                $intrinsic($($value.3),+),
            )
        }
    };
}

macro_rules! operators {
    ($($name:ident $op:ident $f:ident $intrinsic:ident),+ $(,)?) => {$(
        impl $op for $name {
            type Output = Self;
            #[inline(always)]
            fn $f(self, rhs: Self) -> Self {
                let (a, b) = pairs!($intrinsic, self, rhs);
                Self(a, b)
            }
        }
    )+};
}
operators!(
    F32 Add add _mm256_add_ps,
    F32 Sub sub _mm256_sub_ps,
    F32 Mul mul _mm256_mul_ps,
    F32 Div div _mm256_div_ps,
    U32 Add add _mm256_add_epi32,
    U32 Sub sub _mm256_sub_epi32,
    U32 Mul mul _mm256_mullo_epi32,
    U32 BitAnd bitand _mm256_and_si256,
    U32 BitOr bitor _mm256_or_si256,
    U32 BitXor bitxor _mm256_xor_si256,
    Mask16 BitAnd bitand _mm256_and_ps,
    Mask16 BitOr bitor _mm256_or_ps,
    Mask16 BitXor bitxor _mm256_xor_ps,
);

macro_rules! operators_of_quads {
    ($($name:ident $op:ident $f:ident $intrinsic:ident),+ $(,)?) => {$(
        impl $op for $name {
            type Output = Self;
            #[inline(always)]
            fn $f(self, rhs: Self) -> Self {
                let (a, b, c, d) = quads!($intrinsic, self, rhs);
                Self(a, b, c, d)
            }
        }
    )+};
}
operators_of_quads!(
    F64 Add add _mm256_add_pd,
    F64 Sub sub _mm256_sub_pd,
    F64 Mul mul _mm256_mul_pd,
    F64 Div div _mm256_div_pd,
    U64 BitXor bitxor _mm256_xor_si256,
    U64 BitOr bitor _mm256_or_si256,
);

impl Neg for F32 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let sign = Self::splat(-0.0);
        let (a, b) = pairs!(_mm256_xor_ps, self, sign);
        Self(a, b)
    }
}

impl Neg for F64 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let sign = Self::splat(-0.0);
        let (a, b, c, d) = quads!(_mm256_xor_pd, self, sign);
        Self(a, b, c, d)
    }
}

impl Not for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: see above.
        let ones = unsafe { _mm256_castsi256_ps(_mm256_set1_epi32(-1)) };
        self ^ Self(ones, ones)
    }
}

impl Mask16 {
    /// Words of ones or of zeros.
    #[inline(always)]
    fn of_words(words: U32) -> Self {
        let F32(a, b) = words.as_float();
        Self(a, b)
    }

    /// Lanes of 64 bits, of ones or of zeros.
    #[inline(always)]
    fn of_doubles(m: (__m256d, __m256d, __m256d, __m256d)) -> Self {
        let (a, b, c, d) = quads!(_mm256_castpd_ps, m);
        Self(even(a, b), even(c, d))
    }

    /// The reverse of [`Self::of_doubles`].
    #[inline(always)]
    fn doubles(self) -> (__m256d, __m256d, __m256d, __m256d) {
        let words = F32(self.0, self.1).bits().sign_extended();
        quads!(_mm256_castsi256_pd, words)
    }
}

/// The 32-bit lanes of even numbers of two registers.
#[inline(always)]
fn even(a: __m256, b: __m256) -> __m256 {
    // SAFETY: see above.
    unsafe {
        let mixed = _mm256_castps_pd(_mm256_shuffle_ps::<0b10_00_10_00>(a, b));
        _mm256_castpd_ps(_mm256_permute4x64_pd::<0b11_01_10_00>(mixed))
    }
}

impl Mask for Mask16 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        // SAFETY: see above.
        unsafe {
            let all = _mm256_set1_epi32(bits as i32);
            let low = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let high = _mm256_slli_epi32::<8>(low);
            let low = _mm256_cmpeq_epi32(_mm256_and_si256(all, low), low);
            let high = _mm256_cmpeq_epi32(_mm256_and_si256(all, high), high);
            Self::of_words(U32(low, high))
        }
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        let (low, high) = pairs!(_mm256_movemask_ps, self);
        (low | high << 8) as u32
    }

    #[inline(always)]
    fn any(self) -> bool {
        // SAFETY: see above.
        unsafe { _mm256_movemask_ps(_mm256_or_ps(self.0, self.1)) != 0 }
    }
}

impl Float for F32 {
    type Mask = Mask16;
    type Bits = U32;
    type Double = F64;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see above.
        let all = unsafe { _mm256_set1_ps(x) };
        Self(all, all)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let (a, b) = pairs!(_mm256_sqrt_ps, self);
        Self(a, b)
    }

    #[inline(always)]
    fn min(self, b: Self) -> Self {
        let (a, b) = pairs!(_mm256_min_ps, self, b);
        Self(a, b)
    }

    #[inline(always)]
    fn max(self, b: Self) -> Self {
        let (a, b) = pairs!(_mm256_max_ps, self, b);
        Self(a, b)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let sign = Self::splat(-0.0);
        let (a, b) = pairs!(_mm256_andnot_ps, sign, self);
        Self(a, b)
    }

    #[inline(always)]
    fn copysign(self, b: Self) -> Self {
        let sign = Self::splat(-0.0);
        let signs = pairs!(_mm256_and_ps, sign, b);
        let magnitudes = self.abs();
        let (a, b) = pairs!(_mm256_or_ps, magnitudes, signs);
        Self(a, b)
    }

    #[inline(always)]
    fn lt(self, b: Self) -> Mask16 {
        let (a, b) = pairs!(_mm256_cmp_ps::<_CMP_LT_OQ>, self, b);
        Mask16(a, b)
    }

    #[inline(always)]
    fn le(self, b: Self) -> Mask16 {
        let (a, b) = pairs!(_mm256_cmp_ps::<_CMP_LE_OQ>, self, b);
        Mask16(a, b)
    }

    #[inline(always)]
    fn equal(self, b: Self) -> Mask16 {
        let (a, b) = pairs!(_mm256_cmp_ps::<_CMP_EQ_OQ>, self, b);
        Mask16(a, b)
    }

    #[inline(always)]
    fn select(self, mask: Mask16, other: Self) -> Self {
        let (a, b) = pairs!(_mm256_blendv_ps, other, self, mask);
        Self(a, b)
    }

    #[inline(always)]
    fn bits(self) -> U32 {
        let (a, b) = pairs!(_mm256_castps_si256, self);
        U32(a, b)
    }

    #[inline(always)]
    fn truncate(self) -> U32 {
        let (a, b) = pairs!(_mm256_cvttps_epi32, self);
        U32(a, b)
    }

    #[inline(always)]
    fn widen(self) -> F64 {
        // SAFETY: see above.
        unsafe {
            F64(
                _mm256_cvtps_pd(_mm256_castps256_ps128(self.0)),
                _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.0)),
                _mm256_cvtps_pd(_mm256_castps256_ps128(self.1)),
                _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.1)),
            )
        }
    }
}

impl Double for F64 {
    type Mask = Mask16;
    type F32 = F32;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see above.
        let all = unsafe { _mm256_set1_pd(x) };
        Self(all, all, all, all)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let (a, b, c, d) = quads!(_mm256_sqrt_pd, self);
        Self(a, b, c, d)
    }

    #[inline(always)]
    fn copysign(self, b: Self) -> Self {
        let sign = Self::splat(-0.0);
        let signs = quads!(_mm256_and_pd, sign, b);
        let magnitudes = quads!(_mm256_andnot_pd, sign, self);
        let (a, b, c, d) = quads!(_mm256_or_pd, magnitudes, signs);
        Self(a, b, c, d)
    }

    #[inline(always)]
    fn lt(self, b: Self) -> Mask16 {
        Mask16::of_doubles(quads!(_mm256_cmp_pd::<_CMP_LT_OQ>, self, b))
    }

    #[inline(always)]
    fn le(self, b: Self) -> Mask16 {
        Mask16::of_doubles(quads!(_mm256_cmp_pd::<_CMP_LE_OQ>, self, b))
    }

    #[inline(always)]
    fn equal(self, b: Self) -> Mask16 {
        Mask16::of_doubles(quads!(_mm256_cmp_pd::<_CMP_EQ_OQ>, self, b))
    }

    #[inline(always)]
    fn select(self, mask: Mask16, other: Self) -> Self {
        let mask = mask.doubles();
        let (a, b, c, d) = quads!(_mm256_blendv_pd, other, self, mask);
        Self(a, b, c, d)
    }

    #[inline(always)]
    fn narrow(self) -> F32 {
        let (a, b, c, d) = quads!(_mm256_cvtpd_ps, self);
        // SAFETY: see above.
        unsafe { F32(_mm256_set_m128(b, a), _mm256_set_m128(d, c)) }
    }
}

impl FloatLanes for F32 {
    #[inline(always)]
    fn load(from: &Lanes<f32>) -> Self {
        let p = from.0.as_ptr();
        // SAFETY: see above.
        unsafe { Self(_mm256_load_ps(p), _mm256_load_ps(p.add(8))) }
    }

    #[inline(always)]
    fn to_lanes(self) -> Lanes<f32> {
        let mut out = Lanes([0.0; LANES]);
        let p = out.0.as_mut_ptr();
        // SAFETY: see above.
        unsafe {
            _mm256_store_ps(p, self.0);
            _mm256_store_ps(p.add(8), self.1);
        }
        out
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f32 {
        assert!(lane < LANES);
        // SAFETY: two registers in memory are sixteen `f32`.
        unsafe { (&raw const *self).cast::<f32>().add(lane).read() }
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        let (a, b) = pairs!(_mm256_fmadd_ps, self, b, c);
        Self(a, b)
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        let (a, b) = pairs!(_mm256_fmsub_ps, self, b, c);
        Self(a, b)
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        let (a, b) = pairs!(_mm256_fnmadd_ps, self, b, c);
        Self(a, b)
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        // SAFETY: see above.
        unsafe {
            let eight = _mm256_min_ps(self.0, self.1);
            let four = _mm_min_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps::<1>(eight));
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
        }
    }

    #[inline(always)]
    fn gather(table: &[f32], index: U32) -> Self {
        assert_indices(index, table.len());
        let p = table.as_ptr();
        // SAFETY: see above.
        unsafe { Self(_mm256_i32gather_ps::<4>(p, index.0), _mm256_i32gather_ps::<4>(p, index.1)) }
    }

    #[inline(always)]
    fn rows(columns: [Self; LANES]) -> [Row; LANES] {
        let transposed = transpose(columns);
        let mut out = [Lanes([0.0; LANES]); LANES];
        for i in 0..LANES {
            out[i] = transposed[i].to_lanes();
        }
        out
    }

    #[inline(always)]
    fn columns(rows: &[&Row; LANES]) -> [Self; LANES] {
        let mut lanes = [Self::splat(0.0); LANES];
        for i in 0..LANES {
            lanes[i] = Self::load(rows[i]);
        }
        transpose(lanes)
    }
}

/// Sixteen rows to sixteen columns: four blocks of eight by eight.
#[inline(always)]
fn transpose(r: [F32; LANES]) -> [F32; LANES] {
    let a = transpose8([r[0].0, r[1].0, r[2].0, r[3].0, r[4].0, r[5].0, r[6].0, r[7].0]);
    let b = transpose8([r[8].0, r[9].0, r[10].0, r[11].0, r[12].0, r[13].0, r[14].0, r[15].0]);
    let c = transpose8([r[0].1, r[1].1, r[2].1, r[3].1, r[4].1, r[5].1, r[6].1, r[7].1]);
    let d = transpose8([r[8].1, r[9].1, r[10].1, r[11].1, r[12].1, r[13].1, r[14].1, r[15].1]);
    let mut out = r;
    for i in 0..8 {
        out[i] = F32(a[i], b[i]);
        out[8 + i] = F32(c[i], d[i]);
    }
    out
}

/// Eight rows to eight columns: pairs, then quadruples of floats within 128-bit parts, then the parts.
#[inline(always)]
fn transpose8(r: [__m256; 8]) -> [__m256; 8] {
    // SAFETY: see above.
    unsafe {
        let mut t = r;
        for i in 0..4 {
            t[2 * i] = _mm256_unpacklo_ps(r[2 * i], r[2 * i + 1]);
            t[2 * i + 1] = _mm256_unpackhi_ps(r[2 * i], r[2 * i + 1]);
        }
        // q[4 k + j]: columns j and j + 4 of rows 4 k to 4 k + 3.
        let mut q = t;
        for k in 0..2 {
            let (a, b, c, d) = (t[4 * k], t[4 * k + 1], t[4 * k + 2], t[4 * k + 3]);
            q[4 * k] = _mm256_shuffle_ps::<0b01_00_01_00>(a, c);
            q[4 * k + 1] = _mm256_shuffle_ps::<0b11_10_11_10>(a, c);
            q[4 * k + 2] = _mm256_shuffle_ps::<0b01_00_01_00>(b, d);
            q[4 * k + 3] = _mm256_shuffle_ps::<0b11_10_11_10>(b, d);
        }
        let mut out = q;
        for j in 0..4 {
            out[j] = _mm256_permute2f128_ps::<0x20>(q[j], q[4 + j]);
            out[4 + j] = _mm256_permute2f128_ps::<0x31>(q[j], q[4 + j]);
        }
        out
    }
}

impl U32 {
    /// Lanes of 64 bits.
    #[inline(always)]
    fn sign_extended(self) -> U64 {
        // SAFETY: see above.
        unsafe {
            U64(
                _mm256_cvtepi32_epi64(_mm256_castsi256_si128(self.0)),
                _mm256_cvtepi32_epi64(_mm256_extracti128_si256::<1>(self.0)),
                _mm256_cvtepi32_epi64(_mm256_castsi256_si128(self.1)),
                _mm256_cvtepi32_epi64(_mm256_extracti128_si256::<1>(self.1)),
            )
        }
    }
}

impl Word for U32 {
    type Mask = Mask16;
    type F32 = F32;

    #[inline(always)]
    fn splat(x: u32) -> Self {
        // SAFETY: see above.
        let all = unsafe { _mm256_set1_epi32(x as i32) };
        Self(all, all)
    }

    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        // SAFETY: see above.
        unsafe {
            let count = _mm_cvtsi32_si128(N as i32);
            Self(_mm256_sll_epi32(self.0, count), _mm256_sll_epi32(self.1, count))
        }
    }

    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        // SAFETY: see above.
        unsafe {
            let count = _mm_cvtsi32_si128(N as i32);
            Self(_mm256_srl_epi32(self.0, count), _mm256_srl_epi32(self.1, count))
        }
    }

    #[inline(always)]
    fn equal(self, b: Self) -> Mask16 {
        let (a, b) = pairs!(_mm256_cmpeq_epi32, self, b);
        Mask16::of_words(U32(a, b))
    }

    #[inline(always)]
    fn lt(self, b: Self) -> Mask16 {
        // Signed comparisons are the only ones.
        let half = Self::splat(1 << 31);
        let (a, b) = (self ^ half, b ^ half);
        let (a, b) = pairs!(_mm256_cmpgt_epi32, b, a);
        Mask16::of_words(U32(a, b))
    }

    #[inline(always)]
    fn select(self, mask: Mask16, other: Self) -> Self {
        self.as_float().select(mask, other.as_float()).bits()
    }

    #[inline(always)]
    fn as_float(self) -> F32 {
        let (a, b) = pairs!(_mm256_castsi256_ps, self);
        F32(a, b)
    }

    #[inline(always)]
    fn to_float(self) -> F32 {
        let (a, b) = pairs!(_mm256_cvtepi32_ps, self);
        F32(a, b)
    }
}

impl WordLanes for U32 {
    type U64 = U64;

    #[inline(always)]
    fn load(from: &Lanes<u32>) -> Self {
        let p = from.0.as_ptr().cast::<__m256i>();
        // SAFETY: see above.
        unsafe { Self(_mm256_load_si256(p), _mm256_load_si256(p.add(1))) }
    }

    #[inline(always)]
    fn to_lanes(self) -> Lanes<u32> {
        let mut out = Lanes([0; LANES]);
        let p = out.0.as_mut_ptr().cast::<__m256i>();
        // SAFETY: see above.
        unsafe {
            _mm256_store_si256(p, self.0);
            _mm256_store_si256(p.add(1), self.1);
        }
        out
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> u32 {
        assert!(lane < LANES);
        // SAFETY: two registers in memory are sixteen `u32`.
        unsafe { (&raw const *self).cast::<u32>().add(lane).read() }
    }

    #[inline(always)]
    fn gather(table: &[u32], index: Self) -> Self {
        assert_indices(index, table.len());
        let p = table.as_ptr().cast();
        // SAFETY: see above.
        unsafe { Self(_mm256_i32gather_epi32::<4>(p, index.0), _mm256_i32gather_epi32::<4>(p, index.1)) }
    }

    #[inline(always)]
    fn widen(self) -> U64 {
        // SAFETY: see above.
        unsafe {
            U64(
                _mm256_cvtepu32_epi64(_mm256_castsi256_si128(self.0)),
                _mm256_cvtepu32_epi64(_mm256_extracti128_si256::<1>(self.0)),
                _mm256_cvtepu32_epi64(_mm256_castsi256_si128(self.1)),
                _mm256_cvtepu32_epi64(_mm256_extracti128_si256::<1>(self.1)),
            )
        }
    }
}

/// Product modulo 2^64, of the three products of halves that matter.
#[inline(always)]
fn multiply(a: __m256i, b: __m256i) -> __m256i {
    // SAFETY: see above.
    unsafe {
        let low = _mm256_mul_epu32(a, b);
        let crossed = _mm256_add_epi64(
            _mm256_mul_epu32(_mm256_srli_epi64::<32>(a), b),
            _mm256_mul_epu32(a, _mm256_srli_epi64::<32>(b)),
        );
        _mm256_add_epi64(low, _mm256_slli_epi64::<32>(crossed))
    }
}

impl Long for U64 {
    type U32 = U32;

    #[inline(always)]
    fn splat(x: u64) -> Self {
        // SAFETY: see above.
        let all = unsafe { _mm256_set1_epi64x(x as i64) };
        Self(all, all, all, all)
    }

    #[inline(always)]
    fn wrapping_add(self, b: Self) -> Self {
        let (a, b, c, d) = quads!(_mm256_add_epi64, self, b);
        Self(a, b, c, d)
    }

    #[inline(always)]
    fn wrapping_mul(self, b: Self) -> Self {
        Self(multiply(self.0, b.0), multiply(self.1, b.1), multiply(self.2, b.2), multiply(self.3, b.3))
    }

    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        // SAFETY: see above.
        let count = unsafe { _mm_cvtsi32_si128(N as i32) };
        let counts = (count, count, count, count);
        let (a, b, c, d) = quads!(_mm256_sll_epi64, self, counts);
        Self(a, b, c, d)
    }

    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        // SAFETY: see above.
        let count = unsafe { _mm_cvtsi32_si128(N as i32) };
        let counts = (count, count, count, count);
        let (a, b, c, d) = quads!(_mm256_srl_epi64, self, counts);
        Self(a, b, c, d)
    }

    #[inline(always)]
    fn low(self) -> U32 {
        let (a, b, c, d) = quads!(_mm256_castsi256_ps, self);
        F32(even(a, b), even(c, d)).bits()
    }

    #[inline(always)]
    fn high(self) -> U32 {
        self.shr::<32>().low()
    }
}
