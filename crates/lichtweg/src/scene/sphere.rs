//! Whole spheres: the quadrics that hits and lights meet most, and whose formulas serve any width.

use lichtweg_ray::QuadricShape;
use lichtweg_ray::math::{Affine, Vec3, Vector};
use lichtweg_ray::wide::{Float, Row};

use super::offset::position_error;

/// A sphere, or as many as `F` has lanes.
#[derive(Clone, Copy, Debug)]
pub struct Sphere<F = f32> {
    /// In the world.
    pub center: Vector<F>,
    /// In the world.
    pub radius: F,
    /// Bound on the rounding error of points on it.
    pub error: F,
    /// -1 where the inside is the outside.
    pub orientation: F,
}

impl Sphere {
    /// The image of a quadric, if that is an uncut sphere but for a relative `tolerance`.
    pub fn of(shape: &QuadricShape, to_world: &Affine, orientation: f32, tolerance: f32) -> Option<Self> {
        let QuadricShape::Sphere { z_min, z_max, phi_max } = *shape else { return None };
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| to_world.vector(axis));
        let radius = x.length();
        let close = |a: f32, b: f32| (a - b).abs() <= tolerance * radius;
        let similar = close(y.length(), radius) && close(z.length(), radius);
        let square = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|d| d.abs() <= tolerance * radius * radius);
        let whole = z_min <= -1.0 && z_max >= 1.0 && phi_max >= std::f32::consts::TAU * (1.0 - 1e-6);
        let center = to_world.point(Vec3::ZERO);
        let error = position_error(center.abs().max_element() + radius);
        (similar && square && whole).then_some(Self { center, radius, error, orientation })
    }

    /// As [`Sphere::from_columns`] reads it.
    pub(crate) fn to_row(self) -> Row {
        let mut row = Row::splat(0.0);
        let c = self.center;
        row.0[..6].copy_from_slice(&[c.x, c.y, c.z, self.radius, self.error, self.orientation]);
        row
    }

    /// From a row.
    #[inline]
    pub(crate) fn from_row(row: &Row) -> Self {
        Self::from_columns(&row.0)
    }
}

impl<F: Float> Sphere<F> {
    /// From the columns of rows.
    #[inline(always)]
    pub(crate) fn from_columns(c: &[F; 16]) -> Self {
        Self { center: Vector::new(c[0], c[1], c[2]), radius: c[3], error: c[4], orientation: c[5] }
    }

    /// The point nearest to another one, and the normal there.
    #[inline(always)]
    pub fn nearest(&self, to: Vector<F>) -> [Vector<F>; 2] {
        self.in_direction((to - self.center).normalized())
    }

    /// The point in a unit direction from the centre, and the normal there.
    #[inline(always)]
    pub fn in_direction(&self, outward: Vector<F>) -> [Vector<F>; 2] {
        [self.center + outward * self.radius, outward * self.orientation]
    }
}
