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

macro_rules! lanes {
    ($(#[$doc:meta] $name:ident $element:ty),+) => {$(
        #[$doc]
        #[derive(Clone, Copy)]
        #[repr(C, align(64))]
        pub(crate) struct $name([$element; LANES]);

        impl $name {
            #[inline(always)]
            fn zip(self, b: Self, f: impl Fn($element, $element) -> $element) -> Self {
                let mut out = self;
                for i in 0..LANES {
                    out.0[i] = f(self.0[i], b.0[i]);
                }
                out
            }

            #[inline(always)]
            fn map(self, f: impl Fn($element) -> $element) -> Self {
                let mut out = self;
                for i in 0..LANES {
                    out.0[i] = f(self.0[i]);
                }
                out
            }
        }
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
                self.zip(rhs, |$a, $b| $e)
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

impl Neg for F32 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

/// Sixteen bits.
#[derive(Clone, Copy)]
pub(crate) struct Mask16(u32);

impl Mask16 {
    #[inline(always)]
    fn test<T: Copy>(a: [T; LANES], b: [T; LANES], f: impl Fn(T, T) -> bool) -> Self {
        let mut bits = 0;
        for i in 0..LANES {
            bits |= u32::from(f(a[i], b[i])) << i;
        }
        Self(bits)
    }

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

/// The lanes of a mask moved to the front.
#[inline(always)]
fn compress<T: Copy + Default>(lanes: [T; LANES], mask: Mask16) -> [T; LANES] {
    let mut out = [T::default(); LANES];
    let mut count = 0;
    for (i, &lane) in lanes.iter().enumerate() {
        out[count & (LANES - 1)] = if mask.lane(i) { lane } else { out[count & (LANES - 1)] };
        count += usize::from(mask.lane(i));
    }
    out
}

/// What floats of both widths have in common.
macro_rules! common {
    ($element:ty) => {
        #[inline(always)]
        fn splat(x: $element) -> Self {
            Self([x; LANES])
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            self.map(<$element>::sqrt)
        }

        #[inline(always)]
        fn copysign(self, b: Self) -> Self {
            self.zip(b, <$element>::copysign)
        }

        #[inline(always)]
        fn lt(self, b: Self) -> Mask16 {
            Mask16::test(self.0, b.0, |a, b| a < b)
        }

        #[inline(always)]
        fn le(self, b: Self) -> Mask16 {
            Mask16::test(self.0, b.0, |a, b| a <= b)
        }

        #[inline(always)]
        fn equal(self, b: Self) -> Mask16 {
            Mask16::test(self.0, b.0, |a, b| a == b)
        }

        #[inline(always)]
        fn select(self, mask: Mask16, other: Self) -> Self {
            let mut out = self;
            for i in 0..LANES {
                out.0[i] = if mask.lane(i) { self.0[i] } else { other.0[i] };
            }
            out
        }
    };
}

impl Float for F32 {
    type Mask = Mask16;
    type Bits = U32;
    type Double = F64;

    common!(f32);

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
        self.map(f32::abs)
    }

    #[inline(always)]
    fn bits(self) -> U32 {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i].to_bits();
        }
        U32(out)
    }

    #[inline(always)]
    fn truncate(self) -> U32 {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i] as i32 as u32;
        }
        U32(out)
    }

    #[inline(always)]
    fn widen(self) -> F64 {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = f64::from(self.0[i]);
        }
        F64(out)
    }
}

impl Neg for F64 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Double for F64 {
    type Mask = Mask16;
    type F32 = F32;

    common!(f64);

    #[inline(always)]
    fn narrow(self) -> F32 {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i] as f32;
        }
        F32(out)
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
        let mut out = self;
        for i in 0..LANES {
            out.0[i] = self.0[i].mul_add(b.0[i], c.0[i]);
        }
        out
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
    fn compress(self, mask: Mask16) -> Self {
        Self(compress(self.0, mask))
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
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = table[index.0[i] as usize];
        }
        Self(out)
    }

    #[inline(always)]
    fn rows(columns: [Self; LANES]) -> [Row; LANES] {
        let mut out = [Lanes([0.0; LANES]); LANES];
        for (lane, row) in out.iter_mut().enumerate() {
            for column in 0..LANES {
                row.0[column] = columns[column].0[lane];
            }
        }
        out
    }

    #[inline(always)]
    fn columns(rows: &[&Row; LANES]) -> [Self; LANES] {
        let mut out = [Self([0.0; LANES]); LANES];
        for lane in 0..LANES {
            for column in 0..LANES {
                out[column].0[lane] = rows[lane].0[column];
            }
        }
        out
    }
}

impl Word for U32 {
    type Mask = Mask16;
    type F32 = F32;

    #[inline(always)]
    fn splat(x: u32) -> Self {
        Self([x; LANES])
    }

    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        self.map(|a| a << N)
    }

    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        self.map(|a| a >> N)
    }

    #[inline(always)]
    fn equal(self, b: Self) -> Mask16 {
        Mask16::test(self.0, b.0, |a, b| a == b)
    }

    #[inline(always)]
    fn lt(self, b: Self) -> Mask16 {
        Mask16::test(self.0, b.0, |a, b| a < b)
    }

    #[inline(always)]
    fn select(self, mask: Mask16, other: Self) -> Self {
        let mut out = self;
        for i in 0..LANES {
            out.0[i] = if mask.lane(i) { self.0[i] } else { other.0[i] };
        }
        out
    }

    #[inline(always)]
    fn as_float(self) -> F32 {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = f32::from_bits(self.0[i]);
        }
        F32(out)
    }

    #[inline(always)]
    fn to_float(self) -> F32 {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i] as i32 as f32;
        }
        F32(out)
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
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = table[index.0[i] as usize];
        }
        Self(out)
    }

    #[inline(always)]
    fn widen(self) -> U64 {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = u64::from(self.0[i]);
        }
        U64(out)
    }

    #[inline(always)]
    fn compress(self, mask: Mask16) -> Self {
        Self(compress(self.0, mask))
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
        self.zip(b, u64::wrapping_add)
    }

    #[inline(always)]
    fn wrapping_mul(self, b: Self) -> Self {
        self.zip(b, u64::wrapping_mul)
    }

    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        self.map(|a| a << N)
    }

    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        self.map(|a| a >> N)
    }

    #[inline(always)]
    fn low(self) -> U32 {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = self.0[i] as u32;
        }
        U32(out)
    }

    #[inline(always)]
    fn high(self) -> U32 {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = (self.0[i] >> 32) as u32;
        }
        U32(out)
    }
}
