//! Two- and three-component vectors; points, directions and normals are all [`Vec3`], or sixteen of them a [`Vector`] of lanes.

use std::ops::{Add, AddAssign, Div, Index, IndexMut, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::wide::Float;

/// A pair of `f32`: texture coordinates, raster positions, sample pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Vec2 {
    /// First component.
    pub x: f32,
    /// Second component.
    pub y: f32,
}

/// A vector of three dimensions, or as many as `F` has lanes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Vector<F> {
    /// First component.
    pub x: F,
    /// Second component.
    pub y: F,
    /// Third component.
    pub z: F,
}

/// A point, direction or normal in three dimensions.
pub type Vec3 = Vector<f32>;

impl Vec2 {
    /// The origin.
    pub const ZERO: Self = Self::new(0.0, 0.0);

    /// A pair from its components.
    #[inline]
    pub const fn new(x: f32, y: f32) -> Self {
        Self { x, y }
    }

    /// Whether neither component is NaN or infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

impl<F> Vector<F> {
    /// A vector from its components.
    #[inline(always)]
    pub const fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }
}

impl<F: Float> Vector<F> {
    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, o: Self) -> F {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Squared Euclidean length.
    #[inline(always)]
    pub fn length_squared(self) -> F {
        self.dot(self)
    }

    /// Euclidean length.
    #[inline(always)]
    pub fn length(self) -> F {
        self.length_squared().sqrt()
    }

    /// The vector scaled to unit length; not finite for the zero vector.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        self * (F::splat(1.0) / self.length())
    }

    /// This where the mask is true, `other` elsewhere.
    #[inline(always)]
    pub fn select(self, mask: F::Mask, other: Self) -> Self {
        Self::new(self.x.select(mask, other.x), self.y.select(mask, other.y), self.z.select(mask, other.z))
    }
}

impl Vec3 {
    /// The origin.
    pub const ZERO: Self = Self::splat(0.0);
    /// (1, 1, 1).
    pub const ONE: Self = Self::splat(1.0);
    /// The first axis.
    pub const X: Self = Self::new(1.0, 0.0, 0.0);
    /// The second axis.
    pub const Y: Self = Self::new(0.0, 1.0, 0.0);
    /// The third axis.
    pub const Z: Self = Self::new(0.0, 0.0, 1.0);

    /// A vector with three equal components.
    #[inline]
    pub const fn splat(v: f32) -> Self {
        Self::new(v, v, v)
    }

    /// A vector from an array `[x, y, z]`.
    #[inline]
    pub const fn from_array(a: [f32; 3]) -> Self {
        Self::new(a[0], a[1], a[2])
    }

    /// The components as an array `[x, y, z]`.
    #[inline]
    pub const fn to_array(self) -> [f32; 3] {
        [self.x, self.y, self.z]
    }

    /// Vector product.
    #[inline]
    pub fn cross(self, o: Self) -> Self {
        Self::new(self.y * o.z - self.z * o.y, self.z * o.x - self.x * o.z, self.x * o.y - self.y * o.x)
    }

    /// The vector scaled to unit length, or `None` where that is not finite.
    #[inline]
    pub fn try_normalized(self) -> Option<Self> {
        let n = self.normalized();
        n.is_finite().then_some(n)
    }

    /// Componentwise minimum.
    #[inline]
    pub fn min(self, o: Self) -> Self {
        Self::new(self.x.min(o.x), self.y.min(o.y), self.z.min(o.z))
    }

    /// Componentwise maximum.
    #[inline]
    pub fn max(self, o: Self) -> Self {
        Self::new(self.x.max(o.x), self.y.max(o.y), self.z.max(o.z))
    }

    /// Componentwise absolute value.
    #[inline]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// Largest component.
    #[inline]
    pub fn max_element(self) -> f32 {
        self.x.max(self.y).max(self.z)
    }

    /// Smallest component.
    #[inline]
    pub fn min_element(self) -> f32 {
        self.x.min(self.y).min(self.z)
    }

    /// Whether no component is NaN or infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

/// Arithmetic by components; `$bound` is what they need, `$f` what they are.
macro_rules! componentwise {
    ($t:ty, $f:ty $(, $bound:ident)?: $($c:ident),+) => {
        impl$(<F: $bound>)? Add for $t {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self { Self { $($c: self.$c + o.$c),+ } }
        }
        impl$(<F: $bound>)? Sub for $t {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self { Self { $($c: self.$c - o.$c),+ } }
        }
        impl$(<F: $bound>)? Mul for $t {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self { Self { $($c: self.$c * o.$c),+ } }
        }
        impl$(<F: $bound>)? Mul<$f> for $t {
            type Output = Self;
            #[inline(always)]
            fn mul(self, s: $f) -> Self { Self { $($c: self.$c * s),+ } }
        }
        impl$(<F: $bound>)? Div<$f> for $t {
            type Output = Self;
            #[inline(always)]
            fn div(self, s: $f) -> Self { self * (<$f as Float>::splat(1.0) / s) }
        }
        impl$(<F: $bound>)? Neg for $t {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self { Self { $($c: -self.$c),+ } }
        }
        impl$(<F: $bound>)? AddAssign for $t {
            #[inline(always)]
            fn add_assign(&mut self, o: Self) { *self = *self + o; }
        }
        impl$(<F: $bound>)? SubAssign for $t {
            #[inline(always)]
            fn sub_assign(&mut self, o: Self) { *self = *self - o; }
        }
        impl$(<F: $bound>)? MulAssign<$f> for $t {
            #[inline(always)]
            fn mul_assign(&mut self, s: $f) { *self = *self * s; }
        }
    };
}
componentwise!(Vec2, f32: x, y);
componentwise!(Vector<F>, F, Float: x, y, z);

impl Mul<Vec2> for f32 {
    type Output = Vec2;
    #[inline]
    fn mul(self, v: Vec2) -> Vec2 {
        v * self
    }
}

impl Mul<Vec3> for f32 {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        v * self
    }
}

impl Index<usize> for Vec3 {
    type Output = f32;
    #[inline]
    fn index(&self, i: usize) -> &f32 {
        match i {
            0 => &self.x,
            1 => &self.y,
            _ => &self.z,
        }
    }
}

impl IndexMut<usize> for Vec3 {
    #[inline]
    fn index_mut(&mut self, i: usize) -> &mut f32 {
        match i {
            0 => &mut self.x,
            1 => &mut self.y,
            _ => &mut self.z,
        }
    }
}
