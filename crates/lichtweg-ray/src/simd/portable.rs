//! The lanes in plain Rust: the definition that the intrinsics must reproduce.

use super::{Aligned8, Isa, Lanes, WIDTH};

/// Eight lanes in an array.
#[derive(Clone, Copy)]
pub(crate) struct Portable([f32; WIDTH]);

impl Portable {
    #[inline(always)]
    fn zip(self, b: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], b.0[i])))
    }

    #[inline(always)]
    fn test(self, b: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        (0..WIDTH).fold(0, |m, i| m | u32::from(f(self.0[i], b.0[i])) << i)
    }
}

impl Lanes for Portable {
    const ISA: Isa = Isa::Portable;
    type Mask = u32;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; WIDTH])
    }

    #[inline(always)]
    unsafe fn load(p: *const f32) -> Self {
        // SAFETY: the caller promises 32 readable, aligned bytes.
        Self(unsafe { *p.cast::<[f32; WIDTH]>() })
    }

    #[inline(always)]
    unsafe fn load_unaligned(p: *const f32) -> Self {
        // SAFETY: the caller promises 32 readable bytes.
        Self(unsafe { p.cast::<[f32; WIDTH]>().read_unaligned() })
    }

    #[inline(always)]
    fn to_array(self) -> Aligned8 {
        Aligned8(self.0)
    }

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.zip(b, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.zip(b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.zip(b, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, b: Self) -> Self {
        self.zip(b, |a, b| a / b)
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].mul_add(b.0[i], c.0[i])))
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].mul_add(b.0[i], -c.0[i])))
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self(std::array::from_fn(|i| (-self.0[i]).mul_add(b.0[i], c.0[i])))
    }

    #[inline(always)]
    fn min(self, b: Self) -> Self {
        self.zip(b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, b: Self) -> Self {
        self.zip(b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn copysign(self, b: Self) -> Self {
        self.zip(b, f32::copysign)
    }

    #[inline(always)]
    fn xor_sign(self, b: Self) -> Self {
        self.zip(b, |a, b| if b.is_sign_negative() { -a } else { a })
    }

    #[inline(always)]
    fn le(self, b: Self) -> u32 {
        self.test(b, |a, b| a <= b)
    }

    #[inline(always)]
    fn lt(self, b: Self) -> u32 {
        self.test(b, |a, b| a < b)
    }

    #[inline(always)]
    fn not_lt(self, b: Self) -> u32 {
        !self.lt(b) & 0xff
    }

    #[inline(always)]
    fn and(a: u32, b: u32) -> u32 {
        a & b
    }

    #[inline(always)]
    fn or(a: u32, b: u32) -> u32 {
        a | b
    }

    #[inline(always)]
    fn bits(m: u32) -> u32 {
        m
    }
}
