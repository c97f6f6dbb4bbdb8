//! Eight `f32` lanes on whatever the machine has.
//!
//! Kernels are written once over [`Lanes`] and compiled for each instruction set below one run-time
//! dispatch (see [`Isa`]). Every operation is exactly rounded IEEE arithmetic with the same treatment of
//! NaN, so that all instruction sets give the same bits.

use std::sync::OnceLock;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;
mod quad;
#[cfg(target_arch = "x86_64")]
mod wide;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
pub(crate) use portable::Portable;
pub(crate) use quad::{Quad, QuadBox};

/// Number of lanes: children of a node, triangles of a block.
pub(crate) const WIDTH: usize = 8;

/// An instruction set the queries can run on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Isa {
    /// Plain Rust.
    Portable,
    /// AVX2 with FMA and BMI.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 F, VL and DQ on 256-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Isa {
    /// All that this machine can run, worst first; under Miri, which knows few intrinsics, only the portable one.
    pub(crate) fn available() -> Vec<Self> {
        #[cfg_attr(any(not(target_arch = "x86_64"), miri), allow(unused_mut))]
        let mut all = vec![Self::Portable];
        #[cfg(all(target_arch = "x86_64", not(miri)))]
        {
            use std::arch::is_x86_feature_detected as has;
            let avx2 = has!("avx2") && has!("fma") && has!("bmi1") && has!("bmi2") && has!("lzcnt");
            if avx2 {
                all.push(Self::Avx2);
            }
            if avx2 && has!("avx512f") && has!("avx512vl") && has!("avx512dq") {
                all.push(Self::Avx512);
            }
        }
        all
    }

    /// The best that this machine can run, or the one that `LICHTWEG_ISA` names, if the machine has it.
    pub(crate) fn best() -> Self {
        static BEST: OnceLock<Isa> = OnceLock::new();
        *BEST.get_or_init(|| Self::chosen(&Self::available(), std::env::var("LICHTWEG_ISA").ok().as_deref()))
    }

    fn chosen(available: &[Self], name: Option<&str>) -> Self {
        let named = available.iter().find(|isa| name == Some(isa.name()));
        *named.or(available.last()).expect("the portable set is always there")
    }

    fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "avx512",
        }
    }
}

/// Eight `f32` lanes.
///
/// Implementors that use intrinsics may be touched only below a dispatch that has detected the
/// instruction set; the module boundary keeps that promise, hence the methods are not `unsafe`.
pub(crate) trait Lanes: Copy {
    /// Which one this is.
    const ISA: Isa;
    /// One truth value a lane.
    type Mask: Copy;

    /// All lanes equal to `x`.
    fn splat(x: f32) -> Self;
    /// Eight consecutive values.
    ///
    /// # Safety
    /// `p` must be valid for reading 32 bytes and 32-byte aligned.
    unsafe fn load(p: *const f32) -> Self;
    /// Eight consecutive values.
    ///
    /// # Safety
    /// `p` must be valid for reading 32 bytes.
    unsafe fn load_unaligned(p: *const f32) -> Self;
    /// The values of an array.
    #[inline(always)]
    fn from_array(a: Aligned8) -> Self {
        // SAFETY: `Aligned8` has the size and alignment of a register.
        unsafe { Self::load(a.0.as_ptr()) }
    }
    /// The lanes as an array.
    fn to_array(self) -> Aligned8;
    /// a + b.
    fn add(self, b: Self) -> Self;
    /// a - b.
    fn sub(self, b: Self) -> Self;
    /// a b.
    fn mul(self, b: Self) -> Self;
    /// a / b.
    fn div(self, b: Self) -> Self;
    /// a b + c, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// a b - c, rounded once.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// c - a b, rounded once.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// `if a < b { a } else { b }`: `b` where either is NaN.
    fn min(self, b: Self) -> Self;
    /// `if a > b { a } else { b }`: `b` where either is NaN.
    fn max(self, b: Self) -> Self;
    /// |a|.
    fn abs(self) -> Self;
    /// |a| with the sign of `b`.
    fn copysign(self, b: Self) -> Self;
    /// a, negated where `b` has its sign bit set.
    fn xor_sign(self, b: Self) -> Self;
    /// a <= b.
    fn le(self, b: Self) -> Self::Mask;
    /// a < b.
    fn lt(self, b: Self) -> Self::Mask;
    /// Not a < b: true where either is NaN.
    fn not_lt(self, b: Self) -> Self::Mask;
    /// Both.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Either.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Lane i as bit i.
    fn bits(m: Self::Mask) -> u32;
}

/// Eight values at the alignment of a vector register.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Aligned8(pub [f32; WIDTH]);

#[cfg(test)]
mod tests {
    use super::Isa;

    #[test]
    fn an_instruction_set_can_be_chosen() {
        let available = Isa::available();
        for &isa in &available {
            assert_eq!(Isa::chosen(&available, Some(isa.name())), isa);
        }
        let best = *available.last().unwrap();
        assert_eq!(Isa::chosen(&available, None), best);
        assert_eq!(Isa::chosen(&available, Some("nonsense")), best);
    }
}
