//! Four `f32` lanes carried along every path.
//!
//! In RGB mode the lanes are linear sRGB red, green, blue, and blue again: a copy rather than a zero, so that no
//! quotient of spectra makes a NaN that the three used lanes do not have. In spectral mode they are four hero
//! wavelengths (Wilkie et al. 2014). Transport code treats all lanes alike and never asks which mode it is in.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

use lichtweg_ray::wide::Float;

/// Number of lanes.
const LANES: usize = 4;

/// Four lanes of a path, or of as many paths as `F` has lanes itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct Spectra<F>(pub [F; LANES]);

/// A radiometric quantity, or a factor on one, in each of four lanes.
pub type Spectrum = Spectra<f32>;

impl<F: Float> Spectra<F> {
    /// This where the mask is true, `other` elsewhere.
    #[inline(always)]
    pub fn select(self, mask: F::Mask, other: Self) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        Self([a.select(mask, p), b.select(mask, q), c.select(mask, r), d.select(mask, s)])
    }

    /// Largest lane.
    #[inline(always)]
    pub fn max_element(self) -> F {
        let [a, b, c, d] = self.0;
        a.max(b).max(c.max(d))
    }

    /// Whether any lane is not zero; NaN is not.
    #[inline(always)]
    pub fn is_lit(self) -> F::Mask {
        let zero = F::splat(0.0);
        let [a, b, c, d] = self.0;
        !(a.equal(zero) & b.equal(zero) & c.equal(zero) & d.equal(zero))
    }
}

impl Spectrum {
    /// Zero in every lane.
    pub const ZERO: Self = Self::splat(0.0);
    /// One in every lane.
    pub const ONE: Self = Self::splat(1.0);

    /// The same in every lane.
    #[inline]
    pub const fn splat(v: f32) -> Self {
        Self([v; LANES])
    }

    /// RGB mode: linear sRGB.
    #[inline]
    pub const fn rgb([r, g, b]: [f32; 3]) -> Self {
        Self([r, g, b, b])
    }

    /// RGB mode: the first three lanes.
    #[inline]
    pub const fn to_rgb(self) -> [f32; 3] {
        [self.0[0], self.0[1], self.0[2]]
    }

    /// `f` of each lane.
    #[inline(always)]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        let [a, b, c, d] = self.0;
        Self([f(a), f(b), f(c), f(d)])
    }

    /// `f` of each pair of lanes.
    #[inline(always)]
    pub fn zip(self, o: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, o.0);
        Self([f(a, p), f(b, q), f(c, r), f(d, s)])
    }

    /// Square root of each lane.
    #[inline]
    pub fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }

    /// Each lane, but at least `low`.
    #[inline]
    pub fn max_scalar(self, low: f32) -> Self {
        self.map(|v| v.max(low))
    }

    /// Whether every lane is zero.
    #[inline]
    pub fn is_zero(self) -> bool {
        self.0 == [0.0; LANES]
    }

    /// Whether every lane is finite and none is negative: what radiance has to be.
    #[inline]
    pub fn is_valid_radiance(self) -> bool {
        // One comparison a lane: NaN and negative numbers fail the first, infinity the second.
        self.0.iter().all(|&v| (0.0..f32::INFINITY).contains(&v))
    }
}

// Written out, since what is called through a closure may be compiled by itself, without the instruction set of lanes.
macro_rules! lanewise {
    ($($op:ident $f:ident $o:tt),+) => {$(
        impl<F: Float> $op for Spectra<F> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, rhs: Self) -> Self {
                let ([a, b, c, d], [p, q, r, s]) = (self.0, rhs.0);
                Self([a $o p, b $o q, c $o r, d $o s])
            }
        }
        impl<F: Float> $op<F> for Spectra<F> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, rhs: F) -> Self {
                let [a, b, c, d] = self.0;
                Self([a $o rhs, b $o rhs, c $o rhs, d $o rhs])
            }
        }
    )+};
}
lanewise!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<F: Float> AddAssign for Spectra<F> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<F: Float> MulAssign for Spectra<F> {
    #[inline(always)]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl<F: Float> MulAssign<F> for Spectra<F> {
    #[inline(always)]
    fn mul_assign(&mut self, s: F) {
        *self = *self * s;
    }
}
