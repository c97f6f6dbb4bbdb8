//! Sixteen lanes on whatever the machine has: kernels that follow sixteen rays or paths at a time.
//!
//! A kernel is written once over [`Wide`], and [`dispatch`] runs it on the best instruction set of the machine: one
//! 512-bit register a quantity with AVX-512, two of 256 bits with AVX2, arrays elsewhere. Every operation is exactly rounded and
//! treats NaN alike, so that all instruction sets give the same bits.
//!
//! ```
//! use lichtweg_ray::wide::{self, Float, FloatLanes, Kernel, Lanes, Wide};
//!
//! struct Hypotenuse(Lanes<f32>, Lanes<f32>);
//!
//! impl Kernel for Hypotenuse {
//!     type Output = Lanes<f32>;
//!
//!     #[inline(always)]
//!     fn run<W: Wide>(self) -> Lanes<f32> {
//!         let (a, b) = (W::F32::load(&self.0), W::F32::load(&self.1));
//!         (a * a + b * b).sqrt().to_lanes()
//!     }
//! }
//!
//! let c = wide::dispatch(Hypotenuse(Lanes([3.0; 16]), Lanes([4.0; 16])));
//! assert_eq!(c.0, [5.0; 16]);
//! ```
//!
//! All that a kernel calls must be `#[inline(always)]`: what is compiled by itself does not have the instruction set. A closure
//! over lanes that is longer than a line may be.

#[cfg(target_arch = "x86_64")]
#[allow(
    clippy::needless_range_loop,
    reason = "lanes are numbered, and loops over numbers are surely inlined"
)]
mod avx2;
#[cfg(target_arch = "x86_64")]
#[allow(clippy::needless_range_loop, reason = "as above")]
mod avx512;
#[allow(clippy::needless_range_loop, reason = "as above")]
mod portable;
mod single;
#[cfg(test)]
mod tests;

use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use crate::simd::Isa;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
pub(crate) use portable::Portable;

/// Number of lanes.
pub const LANES: usize = 16;

/// Sixteen values in memory, aligned like a vector register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C, align(64))]
pub struct Lanes<T>(pub [T; LANES]);

impl<T: Copy> Lanes<T> {
    /// The same value in all lanes.
    #[inline(always)]
    pub const fn splat(value: T) -> Self {
        Self([value; LANES])
    }
}

impl<T: Copy + Default> Default for Lanes<T> {
    #[inline(always)]
    fn default() -> Self {
        Self([T::default(); LANES])
    }
}

/// An instruction set, as a kernel sees it: the types of its registers.
pub trait Wide: Copy + 'static {
    /// Whether the lanes are registers. Where they are arrays, it is faster to compute for one ray or path at a time.
    const REGISTERS: bool;
    /// Sixteen `f32`.
    type F32: FloatLanes<Mask = Self::Mask, Bits = Self::U32>;
    /// Sixteen `u32`.
    type U32: WordLanes<Mask = Self::Mask, F32 = Self::F32, U64 = Self::U64>;
    /// Sixteen `u64`.
    type U64: Long<U32 = Self::U32>;
    /// Sixteen truth values.
    type Mask: Mask;
}

/// A truth value, or sixteen.
pub trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> + Not<Output = Self>
{
    /// From bits: lane i is bit i.
    fn from_bits(bits: u32) -> Self;
    /// Lane i as bit i; the bits above are zero.
    fn bits(self) -> u32;
    /// Whether any lane is true.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
    /// This and not the other.
    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        self & !other
    }
}

/// An `f32`, or sixteen: what formulas are written over that serve one path and many.
///
/// A single number has the same operations, in the same rounding: so whoever computes with these alone gives a path the same
/// bits by itself and among others.
pub trait Float:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// One truth value a lane.
    type Mask: Mask;
    /// One word a lane.
    type Bits: Word<Mask = Self::Mask, F32 = Self>;
    /// One double a lane.
    type Double: Double<Mask = Self::Mask, F32 = Self>;

    /// All lanes equal to `x`.
    fn splat(x: f32) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// `if a < b { a } else { b }`: `b` where either is NaN.
    fn min(self, b: Self) -> Self;
    /// `if a > b { a } else { b }`: `b` where either is NaN.
    fn max(self, b: Self) -> Self;
    /// |a|.
    fn abs(self) -> Self;
    /// |a| with the sign of `b`.
    fn copysign(self, b: Self) -> Self;
    /// a < b.
    fn lt(self, b: Self) -> Self::Mask;
    /// a <= b.
    fn le(self, b: Self) -> Self::Mask;
    /// a == b.
    fn equal(self, b: Self) -> Self::Mask;
    /// a > b.
    #[inline(always)]
    fn gt(self, b: Self) -> Self::Mask {
        b.lt(self)
    }
    /// a >= b.
    #[inline(always)]
    fn ge(self, b: Self) -> Self::Mask {
        b.le(self)
    }
    /// This where the mask is true, `other` elsewhere.
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// The bits of each lane.
    fn bits(self) -> Self::Bits;
    /// Rounded towards zero, as two's complement; lanes beyond 32 bits give any value.
    fn truncate(self) -> Self::Bits;
    /// The same in double precision.
    fn widen(self) -> Self::Double;
}

/// An `f64`, or sixteen.
pub trait Double:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// One truth value a lane.
    type Mask: Mask;
    /// One float a lane.
    type F32: Float;

    /// All lanes equal to `x`.
    fn splat(x: f64) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// |a| with the sign of `b`.
    fn copysign(self, b: Self) -> Self;
    /// a < b.
    fn lt(self, b: Self) -> Self::Mask;
    /// a <= b.
    fn le(self, b: Self) -> Self::Mask;
    /// a == b.
    fn equal(self, b: Self) -> Self::Mask;
    /// This where the mask is true, `other` elsewhere.
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// The nearest floats.
    fn narrow(self) -> Self::F32;
}

/// What only sixteen `f32` have.
pub trait FloatLanes: Float {
    /// From memory.
    fn load(from: &Lanes<f32>) -> Self;
    /// To memory.
    fn to_lanes(self) -> Lanes<f32>;
    /// One lane. Panics where there is none of that number.
    fn lane(&self, lane: usize) -> f32;
    /// a b + c, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// a b - c, rounded once.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// c - a b, rounded once.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// Smallest lane; lanes must not be NaN.
    fn smallest(self) -> f32;
    /// Element `index` of a table. Panics where a lane's index is out of range.
    fn gather(table: &[f32], index: Self::Bits) -> Self;
    /// Column i holds element i of every lane's row.
    fn columns(rows: &[&Row; LANES]) -> [Self; LANES];
    /// The reverse of [`Float::columns`]: row i holds lane i of every column.
    fn rows(columns: [Self; LANES]) -> [Row; LANES];
}

/// Sixteen consecutive `f32`: one cache line of a table, to be read by [`Float::columns`].
pub type Row = Lanes<f32>;

/// A `u32`, or sixteen. Arithmetic is modulo 2^32 in lanes; single words must not overflow.
pub trait Word:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
{
    /// One truth value a lane.
    type Mask: Mask;
    /// One float a lane.
    type F32: Float;

    /// All lanes equal to `x`.
    fn splat(x: u32) -> Self;
    /// Shifted left by `N` bits.
    fn shl<const N: u32>(self) -> Self;
    /// Shifted right by `N` bits, zeros shifted in.
    fn shr<const N: u32>(self) -> Self;
    /// a == b.
    fn equal(self, b: Self) -> Self::Mask;
    /// a < b as unsigned numbers.
    fn lt(self, b: Self) -> Self::Mask;
    /// This where the mask is true, `other` elsewhere.
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// The lanes as bits of floats.
    fn as_float(self) -> Self::F32;
    /// The nearest floats; lanes are taken as two's complement.
    fn to_float(self) -> Self::F32;
}

/// What only sixteen `u32` have.
pub trait WordLanes: Word {
    /// Twice as wide.
    type U64;

    /// From memory.
    fn load(from: &Lanes<u32>) -> Self;
    /// To memory.
    fn to_lanes(self) -> Lanes<u32>;
    /// One lane. Panics where there is none of that number.
    fn lane(&self, lane: usize) -> u32;
    /// Element `index` of a table. Panics where a lane's index is out of range.
    fn gather(table: &[u32], index: Self) -> Self;
    /// Zero-extended.
    fn widen(self) -> Self::U64;
}

/// Sixteen `u64`, for hashing.
pub trait Long: Copy + BitXor<Output = Self> + BitOr<Output = Self> {
    /// Half as wide.
    type U32;

    /// All lanes equal to `x`.
    fn splat(x: u64) -> Self;
    /// Sum modulo 2^64.
    fn wrapping_add(self, b: Self) -> Self;
    /// Product modulo 2^64.
    fn wrapping_mul(self, b: Self) -> Self;
    /// Shifted left by `N` bits.
    fn shl<const N: u32>(self) -> Self;
    /// Shifted right by `N` bits, zeros shifted in.
    fn shr<const N: u32>(self) -> Self;
    /// The lower 32 bits.
    fn low(self) -> Self::U32;
    /// The upper 32 bits.
    fn high(self) -> Self::U32;
}

/// Panics where a lane is not an index of a table of `len` elements, or does not fit into an `i32`: what gathers rely on.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn assert_indices<U: WordLanes>(index: U, len: usize) {
    let len = u32::try_from(len).unwrap_or(u32::MAX).min(1 << 31);
    assert!(index.lt(U::splat(len)).bits() == 0xffff, "an index is out of range");
}

/// A piece of work that is written once and runs on every instruction set.
pub trait Kernel {
    /// What it yields.
    type Output;

    /// Does the work. Must be `#[inline(always)]`.
    fn run<W: Wide>(self) -> Self::Output;
}

/// Runs a kernel on the best instruction set of this machine.
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    on(Isa::best(), kernel)
}

/// Runs a kernel on a given instruction set, which the machine must have.
#[inline]
pub(crate) fn on<K: Kernel>(isa: Isa, kernel: K) -> K::Output {
    match isa {
        Isa::Portable => kernel.run::<Portable>(),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: values of `Isa` come from detection.
        Isa::Avx2 => unsafe { on_avx2(kernel) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Isa::Avx512 => unsafe { on_avx512(kernel) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn on_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl,avx512dq")]
fn on_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx512>()
}
