//! Vectors and spectra of sixteen lanes, with the arithmetic of [`Vec3`](lichtweg_ray::math::Vec3) and
//! [`Spectrum`](crate::color::Spectrum), operation by operation.

use std::ops::{Add, Mul, Neg, Sub};

use lichtweg_ray::wide::Float;

/// Sixteen vectors.
#[derive(Clone, Copy)]
pub struct Vector<F> {
    pub x: F,
    pub y: F,
    pub z: F,
}

impl<F: Float> Vector<F> {
    #[inline(always)]
    pub fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }

    #[inline(always)]
    pub fn dot(self, o: Self) -> F {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    #[inline(always)]
    pub fn select(self, mask: F::Mask, other: Self) -> Self {
        Self::new(self.x.select(mask, other.x), self.y.select(mask, other.y), self.z.select(mask, other.z))
    }
}

impl<F: Float> Add for Vector<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<F: Float> Sub for Vector<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl<F: Float> Mul<F> for Vector<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: F) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl<F: Float> Neg for Vector<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

/// Sixteen spectra.
#[derive(Clone, Copy)]
pub struct Spectra<F>(pub [F; 4]);

impl<F: Float> Spectra<F> {
    #[inline(always)]
    pub fn select(self, mask: F::Mask, other: Self) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        Self([a.select(mask, p), b.select(mask, q), c.select(mask, r), d.select(mask, s)])
    }

    #[inline(always)]
    pub fn max_element(self) -> F {
        let [a, b, c, d] = self.0;
        a.max(b).max(c.max(d))
    }

    /// Where any lane of the spectrum is not zero; NaN counts as not zero.
    #[inline(always)]
    pub fn is_lit(self) -> F::Mask {
        let zero = F::splat(0.0);
        let [a, b, c, d] = self.0;
        !(a.equal(zero) & b.equal(zero) & c.equal(zero) & d.equal(zero))
    }
}

impl<F: Float> Mul for Spectra<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, o.0);
        Self([a * p, b * q, c * r, d * s])
    }
}

impl<F: Float> Mul<F> for Spectra<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: F) -> Self {
        let [a, b, c, d] = self.0;
        Self([a * s, b * s, c * s, d * s])
    }
}
