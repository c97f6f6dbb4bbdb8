//! The lanes in plain Rust: the definition that the intrinsics must reproduce.

use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use super::{Double, Float, FloatLanes, LANES, Lanes, Long, Mask, Row, Wide, Word, WordLanes};

/// Arrays.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

impl Wide for Portable {
    const REGISTERS: bool = false;
    type F32 = F32;
    type U32 = U32;
    type U64 = U64;
    type Mask = Mask16;
}

/// A value for each lane. A function by itself, since hundreds of loops in one kernel take the compiler long.
#[inline(never)]
fn each<T: Copy + Default>(f: impl Fn(usize) -> T) -> [T; LANES] {
    let mut out = [T::default(); LANES];
    for i in 0..LANES {
        out[i] = f(i);
    }
    out
}

/// Which lanes a predicate holds for.
#[inline(never)]
fn which(f: impl Fn(usize) -> bool) -> Mask16 {
    let mut bits = 0;
    for i in 0..LANES {
        bits |= u32::from(f(i)) << i;
    }
    Mask16(bits)
}

macro_rules! lanes {
    ($(#[$doc:meta] $name:ident $element:ty),+) => {$(
        #[$doc]
        #[derive(Clone, Copy)]
        #[repr(C, align(64))]
        pub(crate) struct $name([$element; LANES]);
    )+};
}
lanes!(
    /// Sixteen `f32`.
    F32 f32,
    /// Sixteen `u32`.
    U32 u32,
    /// Sixteen `u64`.
    U64 u64,
    /// Sixteen `f64`.
    F64 f64
);

macro_rules! operators {
    ($($name:ident $op:ident $f:ident |$a:ident, $b:ident| $e:expr),+ $(,)?) => {$(
        impl $op for $name {
            type Output = Self;
            #[inline(always)]
            fn $f(self, rhs: Self) -> Self {
                Self(each(|i| {
                    let ($a, $b) = (self.0[i], rhs.0[i]);
                    $e
                }))
            }
        }
    )+};
}
operators!(
    F32 Add add |a, b| a + b,
    F32 Sub sub |a, b| a - b,
    F32 Mul mul |a, b| a * b,
    F32 Div div |a, b| a / b,
    F64 Add add |a, b| a + b,
    F64 Sub sub |a, b| a - b,
    F64 Mul mul |a, b| a * b,
    F64 Div div |a, b| a / b,
    U32 Add add |a, b| a.wrapping_add(b),
    U32 Sub sub |a, b| a.wrapping_sub(b),
    U32 Mul mul |a, b| a.wrapping_mul(b),
    U32 BitAnd bitand |a, b| a & b,
    U32 BitOr bitor |a, b| a | b,
    U32 BitXor bitxor |a, b| a ^ b,
    U64 BitOr bitor |a, b| a | b,
    U64 BitXor bitxor |a, b| a ^ b,
);

/// Sixteen bits.
#[derive(Clone, Copy)]
pub(crate) struct Mask16(u32);

impl Mask16 {
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.0 >> i & 1 != 0
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
        Self(!self.0 & 0xffff)
    }
}

impl Mask for Mask16 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits & 0xffff)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.0
    }
}

/// What all types have in common.
macro_rules! common {
    ($element:ty) => {
        #[inline(always)]
        fn splat(x: $element) -> Self {
            Self([x; LANES])
        }

        #[inline(always)]
        fn lt(self, b: Self) -> Mask16 {
            which(|i| self.0[i] < b.0[i])
        }

        #[inline(always)]
        fn equal(self, b: Self) -> Mask16 {
            which(|i| self.0[i] == b.0[i])
        }

        #[inline(always)]
        fn select(self, mask: Mask16, other: Self) -> Self {
            Self(each(|i| if mask.lane(i) { self.0[i] } else { other.0[i] }))
        }
    };
}

/// What floats of both widths have in common.
macro_rules! common_of_floats {
    ($element:ty) => {
        common!($element);

        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(each(|i| self.0[i].sqrt()))
        }

        #[inline(always)]
        fn copysign(self, b: Self) -> Self {
            Self(each(|i| self.0[i].copysign(b.0[i])))
        }

        #[inline(always)]
        fn le(self, b: Self) -> Mask16 {
            which(|i| self.0[i] <= b.0[i])
        }
    };
}

impl Neg for F32 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(each(|i| -self.0[i]))
    }
}

impl Float for F32 {
    type Mask = Mask16;
    type Bits = U32;
    type Double = F64;

    common_of_floats!(f32);

    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self(each(|i| if self.0[i] < b.0[i] { self.0[i] } else { b.0[i] }))
    }

    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self(each(|i| if self.0[i] > b.0[i] { self.0[i] } else { b.0[i] }))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(each(|i| self.0[i].abs()))
    }

    #[inline(always)]
    fn bits(self) -> U32 {
        U32(each(|i| self.0[i].to_bits()))
    }

    #[inline(always)]
    fn truncate(self) -> U32 {
        U32(each(|i| self.0[i] as i32 as u32))
    }

    #[inline(always)]
    fn widen(self) -> F64 {
        F64(each(|i| f64::from(self.0[i])))
    }
}

impl Neg for F64 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(each(|i| -self.0[i]))
    }
}

impl Double for F64 {
    type Mask = Mask16;
    type F32 = F32;

    common_of_floats!(f64);

    #[inline(always)]
    fn narrow(self) -> F32 {
        F32(each(|i| self.0[i] as f32))
    }
}

impl FloatLanes for F32 {
    #[inline(always)]
    fn load(from: &Lanes<f32>) -> Self {
        Self(from.0)
    }

    #[inline(always)]
    fn to_lanes(self) -> Lanes<f32> {
        Lanes(self.0)
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f32 {
        self.0[lane]
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(each(|i| self.0[i].mul_add(b.0[i], c.0[i])))
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        (-self).mul_add(b, c)
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        let mut least = self.0[0];
        for lane in self.0 {
            least = if lane < least { lane } else { least };
        }
        least
    }

    #[inline(always)]
    fn gather(table: &[f32], index: U32) -> Self {
        Self(each(|i| table[index.0[i] as usize]))
    }

    #[inline(always)]
    fn rows(columns: [Self; LANES]) -> [Row; LANES] {
        each(|lane| Lanes(each(|column| columns[column].0[lane])))
    }

    #[inline(always)]
    fn columns(rows: &[&Row; LANES]) -> [Self; LANES] {
        each(|column| Lanes(each(|lane| rows[lane].0[column]))).map(|Lanes(column)| Self(column))
    }
}

impl Word for U32 {
    type Mask = Mask16;
    type F32 = F32;

    common!(u32);

    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        Self(each(|i| self.0[i] << N))
    }

    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        Self(each(|i| self.0[i] >> N))
    }

    #[inline(always)]
    fn as_float(self) -> F32 {
        F32(each(|i| f32::from_bits(self.0[i])))
    }

    #[inline(always)]
    fn to_float(self) -> F32 {
        F32(each(|i| self.0[i] as i32 as f32))
    }
}

impl WordLanes for U32 {
    type U64 = U64;

    #[inline(always)]
    fn load(from: &Lanes<u32>) -> Self {
        Self(from.0)
    }

    #[inline(always)]
    fn to_lanes(self) -> Lanes<u32> {
        Lanes(self.0)
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> u32 {
        self.0[lane]
    }

    #[inline(always)]
    fn gather(table: &[u32], index: Self) -> Self {
        Self(each(|i| table[index.0[i] as usize]))
    }

    #[inline(always)]
    fn widen(self) -> U64 {
        U64(each(|i| u64::from(self.0[i])))
    }
}

impl Long for U64 {
    type U32 = U32;

    #[inline(always)]
    fn splat(x: u64) -> Self {
        Self([x; LANES])
    }

    #[inline(always)]
    fn wrapping_add(self, b: Self) -> Self {
        Self(each(|i| self.0[i].wrapping_add(b.0[i])))
    }

    #[inline(always)]
    fn wrapping_mul(self, b: Self) -> Self {
        Self(each(|i| self.0[i].wrapping_mul(b.0[i])))
    }

    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        Self(each(|i| self.0[i] << N))
    }

    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        Self(each(|i| self.0[i] >> N))
    }

    #[inline(always)]
    fn low(self) -> U32 {
        U32(each(|i| self.0[i] as u32))
    }

    #[inline(always)]
    fn high(self) -> U32 {
        U32(each(|i| (self.0[i] >> 32) as u32))
    }
}
