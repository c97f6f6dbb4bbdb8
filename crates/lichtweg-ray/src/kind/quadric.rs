//! Spheres, disks and cylinders, clipped in height and azimuth, under an affine map.
//!
//! The ray is mapped to object space in `f64`; the quadratic a t^2 + 2 b t + c = 0 is solved with the
//! discriminant taken from the perpendicular distance of the centre to the line, and the roots as
//! c/q and q/a (Haines, Guenther and Akenine-Moeller, *Precision Improvements for Ray/Sphere
//! Intersection*, Ray Tracing Gems, 2019, chapter 7). Surface parameters are those of pbrt.

use std::f64::consts::TAU;

use super::in_range;
use crate::accel::BuildError;
use crate::math::{Affine, Bounds3, Vec3};
use crate::ray::Ray;
use crate::wide::{Double, Float};

/// A quadric in its own space, about the z axis. Angles in radians; both sides can be hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum QuadricShape {
    /// The unit sphere between two heights; v = (theta - theta(z_min)) / (theta(z_max) - theta(z_min))
    /// with cos(theta) = z.
    Sphere {
        /// Lowest z, at least -1.
        z_min: f32,
        /// Highest z, at most 1.
        z_max: f32,
        /// Largest azimuth, at most 2 pi.
        phi_max: f32,
    },
    /// The unit disk in z = 0 with normal +z; v = (1 - radius) / (1 - inner_radius).
    Disk {
        /// Radius of the hole, in [0, 1).
        inner_radius: f32,
        /// Largest azimuth, at most 2 pi.
        phi_max: f32,
    },
    /// The open cylinder of unit radius; v = (z - z_min) / (z_max - z_min).
    Cylinder {
        /// Lowest z.
        z_min: f32,
        /// Highest z.
        z_max: f32,
        /// Largest azimuth, at most 2 pi.
        phi_max: f32,
    },
}

impl QuadricShape {
    /// The whole unit sphere.
    pub const SPHERE: Self = Self::Sphere { z_min: -1.0, z_max: 1.0, phi_max: std::f32::consts::TAU };
    /// The whole unit disk.
    pub const DISK: Self = Self::Disk { inner_radius: 0.0, phi_max: std::f32::consts::TAU };

    /// What is wrong with the parameters, if anything.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        let phi_ok = |phi: f32| phi > 0.0 && phi <= std::f32::consts::TAU * 1.000_001;
        match *self {
            Self::Sphere { z_min, z_max, phi_max } => {
                if !(z_min < z_max && z_min < 1.0 && z_max > -1.0) {
                    return Some("z_min must be below z_max, within the unit sphere");
                }
                (!phi_ok(phi_max)).then_some("phi_max must be in (0, 2 pi]")
            }
            Self::Disk { inner_radius, phi_max } => {
                if !(0.0..1.0).contains(&inner_radius) {
                    return Some("inner_radius must be in [0, 1)");
                }
                (!phi_ok(phi_max)).then_some("phi_max must be in (0, 2 pi]")
            }
            Self::Cylinder { z_min, z_max, phi_max } => {
                if !(z_min < z_max && z_min.is_finite() && z_max.is_finite()) {
                    return Some("z_min must be below z_max, both finite");
                }
                (!phi_ok(phi_max)).then_some("phi_max must be in (0, 2 pi]")
            }
        }
    }

    /// Half extent of the smallest origin-centred slab in z, as (lowest, highest).
    fn z_range(&self) -> (f64, f64) {
        match *self {
            Self::Sphere { z_min, z_max, .. } => (f64::from(z_min).max(-1.0), f64::from(z_max).min(1.0)),
            Self::Disk { .. } => (0.0, 0.0),
            Self::Cylinder { z_min, z_max, .. } => (f64::from(z_min), f64::from(z_max)),
        }
    }

    fn phi_max(&self) -> f64 {
        match *self {
            Self::Sphere { phi_max, .. } | Self::Disk { phi_max, .. } | Self::Cylinder { phi_max, .. } => {
                f64::from(phi_max)
            }
        }
    }
}

/// A quadric placed in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadric {
    /// The shape in its own space.
    pub shape: QuadricShape,
    /// Its place; must be invertible.
    pub object_to_world: Affine,
}

/// A quadric made ready for queries.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedQuadric {
    bounds: Bounds3,
    world_to_object: Affine,
    shape: QuadricShape,
    phi_max: f64,
    /// No clip in azimuth.
    full_turn: bool,
    /// A sphere without any clips.
    whole_sphere: bool,
}

impl Quadric {
    /// World bounds, a few ulps wide of exact.
    pub fn bounds(&self) -> Bounds3 {
        let (lo, hi) = self.shape.z_range();
        let mut out = Bounds3::EMPTY;
        for (axis, [a, b, c, t]) in self.object_to_world.rows.into_iter().enumerate() {
            let radial = (a * a + b * b).sqrt();
            let (min, max) = match self.shape {
                QuadricShape::Sphere { .. } if lo <= -1.0 && hi >= 1.0 => {
                    let r = (radial * radial + c * c).sqrt();
                    (-r, r)
                }
                QuadricShape::Sphere { .. } => {
                    let high = sphere_support(radial, c, lo, hi);
                    (-sphere_support(radial, -c, lo, hi), high)
                }
                _ => ((c * lo).min(c * hi) - radial, (c * lo).max(c * hi) + radial),
            };
            let slack = 4.0 * f64::from(f32::EPSILON) * (min.abs().max(max.abs()) + t.abs());
            out.min[axis] = (t + min - slack) as f32;
            out.max[axis] = (t + max + slack) as f32;
        }
        out
    }
}

/// max of radial * sqrt(1 - z^2) + c z over z in [lo, hi].
fn sphere_support(radial: f64, c: f64, lo: f64, hi: f64) -> f64 {
    let n = radial.hypot(c);
    let z = if n > 0.0 { (c / n).clamp(lo, hi) } else { lo };
    radial * (1.0 - z * z).max(0.0).sqrt() + c * z
}

type Point<D = f64> = [D; 3];

#[inline(always)]
fn dot<D: Double>(a: Point<D>, b: Point<D>) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A row of a linear map, applied.
#[inline(always)]
fn scaled<D: Double>(r: &[f64; 4], p: Point<D>) -> D {
    D::splat(r[0]) * p[0] + D::splat(r[1]) * p[1] + D::splat(r[2]) * p[2]
}

#[inline(always)]
fn along<D: Double>(o: Point<D>, d: Point<D>, t: D) -> Point<D> {
    [o[0] + d[0] * t, o[1] + d[1] * t, o[2] + d[2] * t]
}

impl PlacedQuadric {
    /// Checks a quadric and makes it ready.
    pub(crate) fn new(geometry: u32, quadric: &Quadric) -> Result<Self, BuildError> {
        let shape = quadric.shape;
        if let Some(reason) = shape.fault() {
            return Err(BuildError::InvalidQuadric { geometry, reason });
        }
        let bounds = quadric.bounds();
        let world_to_object = quadric.object_to_world.inverse().filter(|_| in_range(&bounds));
        let phi_max = shape.phi_max();
        let full_turn = phi_max >= TAU * (1.0 - 1e-6);
        let uncut =
            matches!(shape, QuadricShape::Sphere { z_min, z_max, .. } if z_min <= -1.0 && z_max >= 1.0);
        Ok(Self {
            bounds,
            world_to_object: world_to_object.ok_or(BuildError::SingularTransform { geometry })?,
            shape,
            phi_max,
            full_turn,
            whole_sphere: uncut && full_turn,
        })
    }

    pub(crate) fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// The nearest t with `tnear < t <= tfar`, already rounded to `f32`.
    #[inline(never)]
    pub(crate) fn intersect(&self, ray: &Ray, tnear: f32, tfar: f32) -> Option<f32> {
        if self.whole_sphere {
            let (t, hit) =
                self.intersect_sphere(ray.origin.to_array(), ray.direction.to_array(), tnear, tfar);
            return hit.then_some(t);
        }
        let (o, d) = self.local(ray);
        let roots = match self.shape {
            QuadricShape::Sphere { .. } => roots(o, d)?,
            QuadricShape::Cylinder { .. } => roots([o[0], o[1], 0.0], [d[0], d[1], 0.0])?,
            QuadricShape::Disk { .. } => {
                let t = -o[2] / d[2];
                [t, t]
            }
        };
        roots.into_iter().find_map(|exact| {
            let t = exact as f32;
            (t > tnear && t <= tfar && self.keeps(along(o, d, exact))).then_some(t)
        })
    }

    /// Whether this is a sphere without any clips.
    #[inline]
    pub(crate) fn is_whole_sphere(&self) -> bool {
        self.whole_sphere
    }

    /// [`PlacedQuadric::intersect`] of a whole sphere, for one ray or sixteen; and where there is a hit.
    #[inline(always)]
    pub(crate) fn intersect_sphere<F: Float>(
        &self,
        origin: [F; 3],
        direction: [F; 3],
        tnear: F,
        tfar: F,
    ) -> (F, F::Mask) {
        let [ox, oy, oz] = origin;
        let [dx, dy, dz] = direction;
        let (o, d) =
            self.in_object_space([ox.widen(), oy.widen(), oz.widen()], [dx.widen(), dy.widen(), dz.widen()]);
        let (roots, real) = quadratic(o, d);
        let (t0, t1) = (roots[0].narrow(), roots[1].narrow());
        let first = tnear.lt(t0) & t0.le(tfar);
        let second = tnear.lt(t1) & t1.le(tfar);
        (t0.select(first, t1), real & (first | second))
    }

    /// Surface parameters (u, v) of the point at `t`.
    pub(crate) fn parameters(&self, ray: &Ray, t: f32) -> (f32, f32) {
        let (o, d) = self.local(ray);
        let p = along(o, d, f64::from(t));
        let u = azimuth(p) / self.phi_max;
        let (lo, hi) = self.shape.z_range();
        let v = match self.shape {
            QuadricShape::Sphere { .. } => {
                let theta = p[2].atan2(p[0].hypot(p[1]));
                (theta - lo.asin()) / (hi.asin() - lo.asin())
            }
            QuadricShape::Cylinder { .. } => (p[2] - lo) / (hi - lo),
            QuadricShape::Disk { inner_radius, .. } => {
                (1.0 - p[0].hypot(p[1])) / (1.0 - f64::from(inner_radius))
            }
        };
        (u.clamp(0.0, 1.0) as f32, v.clamp(0.0, 1.0) as f32)
    }

    /// Outward normal at `t`, of any length: the gradient, mapped by the transposed inverse.
    pub(crate) fn normal(&self, ray: &Ray, t: f32) -> Vec3 {
        let (o, d) = self.local(ray);
        let [x, y, z] = along(o, d, f64::from(t));
        let n = match self.shape {
            QuadricShape::Sphere { .. } => [x, y, z],
            QuadricShape::Disk { .. } => [0.0, 0.0, 1.0],
            QuadricShape::Cylinder { .. } => [x, y, 0.0],
        };
        let m = &self.world_to_object.rows;
        Vec3::from_array([0, 1, 2].map(|i| (m[0][i] * n[0] + m[1][i] * n[1] + m[2][i] * n[2]) as f32))
    }

    fn local(&self, ray: &Ray) -> (Point, Point) {
        self.in_object_space(ray.origin.to_array().map(f64::from), ray.direction.to_array().map(f64::from))
    }

    /// An origin and a direction in object space.
    #[inline(always)]
    fn in_object_space<D: Double>(&self, o: Point<D>, d: Point<D>) -> (Point<D>, Point<D>) {
        let [x, y, z] = &self.world_to_object.rows;
        let p = [scaled(x, o) + D::splat(x[3]), scaled(y, o) + D::splat(y[3]), scaled(z, o) + D::splat(z[3])];
        (p, [scaled(x, d), scaled(y, d), scaled(z, d)])
    }

    /// Whether the clips in height, radius and azimuth keep a point of the full surface.
    fn keeps(&self, p: Point) -> bool {
        let inside = match self.shape {
            QuadricShape::Sphere { z_min, z_max, .. } => {
                (z_min <= -1.0 || p[2] >= f64::from(z_min)) && (z_max >= 1.0 || p[2] <= f64::from(z_max))
            }
            QuadricShape::Cylinder { z_min, z_max, .. } => {
                p[2] >= f64::from(z_min) && p[2] <= f64::from(z_max)
            }
            QuadricShape::Disk { inner_radius, .. } => {
                let r2 = p[0] * p[0] + p[1] * p[1];
                r2 <= 1.0 && r2 >= f64::from(inner_radius) * f64::from(inner_radius)
            }
        };
        inside && (self.full_turn || azimuth(p) <= self.phi_max)
    }
}

/// Azimuth in [0, 2 pi).
fn azimuth(p: Point) -> f64 {
    let phi = p[1].atan2(p[0]);
    if phi < 0.0 { phi + TAU } else { phi }
}

/// Both roots, in order, of |o + t d| = 1.
fn roots(o: Point, d: Point) -> Option<[f64; 2]> {
    let (roots, real) = quadratic(o, d);
    real.then_some(roots)
}

/// [`roots`], for one ray or sixteen, and whether they are real.
#[inline(always)]
fn quadratic<D: Double>(o: Point<D>, d: Point<D>) -> ([D; 2], D::Mask) {
    let (zero, one) = (D::splat(0.0), D::splat(1.0));
    let a = dot(d, d);
    let b = dot(o, d);
    // The point of the line nearest to the centre: its distance decides without cancellation.
    let nearest = along(o, d, -b / a);
    let discriminant = a * (one - dot(nearest, nearest));
    let real = zero.lt(a) & zero.le(discriminant);
    let q = -b - discriminant.sqrt().copysign(b);
    let c = dot(o, o) - one;
    // q = 0 only for a centre on a tangent line, where both roots are zero.
    let tangent = q.equal(zero);
    let (t0, t1) = (zero.select(tangent, q / a), zero.select(tangent, c / q));
    let ordered = t0.lt(t1);
    ([t0.select(ordered, t1), t1.select(ordered, t0)], real)
}
