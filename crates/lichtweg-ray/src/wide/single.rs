//! One lane: plain numbers, for formulas that serve one path as well as sixteen.

use super::{Double, Float, Mask, Word};

impl Mask for bool {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        bits & 1 != 0
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

/// What floats of both widths have in common.
macro_rules! common {
    ($element:ty) => {
        #[inline(always)]
        fn splat(x: $element) -> Self {
            x
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            self.sqrt()
        }

        #[inline(always)]
        fn copysign(self, b: Self) -> Self {
            self.copysign(b)
        }

        #[inline(always)]
        fn lt(self, b: Self) -> bool {
            self < b
        }

        #[inline(always)]
        fn le(self, b: Self) -> bool {
            self <= b
        }

        #[inline(always)]
        fn equal(self, b: Self) -> bool {
            self == b
        }

        #[inline(always)]
        fn select(self, mask: bool, other: Self) -> Self {
            if mask { self } else { other }
        }
    };
}

impl Float for f32 {
    type Mask = bool;
    type Bits = u32;
    type Double = f64;

    common!(f32);

    #[inline(always)]
    fn min(self, b: Self) -> Self {
        if self < b { self } else { b }
    }

    #[inline(always)]
    fn max(self, b: Self) -> Self {
        if self > b { self } else { b }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.to_bits()
    }

    #[inline(always)]
    fn truncate(self) -> u32 {
        self as i32 as u32
    }

    #[inline(always)]
    fn widen(self) -> f64 {
        self.into()
    }
}

impl Double for f64 {
    type Mask = bool;
    type F32 = f32;

    common!(f64);

    #[inline(always)]
    fn narrow(self) -> f32 {
        self as f32
    }
}

impl Word for u32 {
    type Mask = bool;
    type F32 = f32;

    #[inline(always)]
    fn splat(x: u32) -> Self {
        x
    }

    #[inline(always)]
    fn shl<const N: u32>(self) -> Self {
        self << N
    }

    #[inline(always)]
    fn shr<const N: u32>(self) -> Self {
        self >> N
    }

    #[inline(always)]
    fn equal(self, b: Self) -> bool {
        self == b
    }

    #[inline(always)]
    fn lt(self, b: Self) -> bool {
        self < b
    }

    #[inline(always)]
    fn select(self, mask: bool, other: Self) -> Self {
        if mask { self } else { other }
    }

    #[inline(always)]
    fn as_float(self) -> f32 {
        f32::from_bits(self)
    }

    #[inline(always)]
    fn to_float(self) -> f32 {
        self as i32 as f32
    }
}
