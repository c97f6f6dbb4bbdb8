//! Distributions of microfacet normals: Beckmann and GGX, with a roughness along each tangent axis.
//!
//! A rough surface is an ensemble of mirrors with normals m. Models need three things of it:
//!
//! - D(m), the area of facets per solid angle of normals over the area of the surface, so that the projected area
//!   integrates to one: integral of D(m) (m.n) dm = 1;
//! - G1(v), the fraction of facets seen from v that is not masked by others (Smith 1967). Masking and shadowing are taken to be
//!   independent, G(wo, wi) = G1(wo) G1(wi), as Mitsuba 3 does (Walter et al. 2007, equation 23);
//! - a way to draw m in proportion to what is visible from v (Heitz and d'Eon 2014):
//!   D_v(m) = D(m) G1(v) max(0, v.m) / |v.n|.
//!
//! GGX normals are drawn by Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps"; Beckmann's by
//! inverting the distribution of visible slopes (Jakob 2014, "An Improved Visible Normal Sampling Routine for the Beckmann
//! Distribution"), with the iteration kept inside a bracket.
//!
//! Limits: heights and normals are uncorrelated, light scatters once, no energy is put back. Beckmann's G1 in scattering
//! values is the rational fit of Walter et al. 2007 (below 0.35 % relative error), which Mitsuba uses too; densities use
//! the exact function, so that they are those of the drawn normals.

use std::f32::consts::FRAC_1_PI;

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::Float;

use super::erf::{erfc, inverse_erfc};
use crate::lanes::warp::sin_cos_turn;
use crate::lanes::{BELOW_ONE, exp, ln};
pub use crate::scene::description::MicrofacetKind;

/// Smallest roughness: below it, a facet's half vector is lost in the rounding of its directions.
const MIN_ALPHA: f32 = 1e-4;
/// Largest roughness: a plane of slopes so wide is as good as flat.
const MAX_ALPHA: f32 = 1e3;
/// 1 / sqrt(pi).
const FRAC_1_SQRT_PI: f32 = 0.564_189_6;

/// A distribution of facet normals about the local z axis; or, of one kind, as many as `F` has lanes.
#[derive(Clone, Copy, Debug)]
pub struct Microfacets<F = f32> {
    pub(crate) kind: MicrofacetKind,
    /// Within the bounds that [`Microfacets::new`] holds it in, as is the other.
    pub(crate) alpha_u: F,
    pub(crate) alpha_v: F,
}

impl Microfacets {
    /// A distribution of roughness `alpha_u` along x and `alpha_v` along y, each held within 1e-4 and 1e3.
    #[inline]
    pub fn new(kind: MicrofacetKind, alpha_u: f32, alpha_v: f32) -> Self {
        // The maximum comes first, and makes a number of NaN.
        let hold = |alpha: f32| alpha.max(MIN_ALPHA).clamp(MIN_ALPHA, MAX_ALPHA);
        Self { kind, alpha_u: hold(alpha_u), alpha_v: hold(alpha_v) }
    }
}

impl<F: Float> Microfacets<F> {
    /// D(m): area of facets per area of surface and per solid angle of normals, for the unit normal `m` with m.z > 0.
    #[inline(always)]
    pub fn density(&self, m: Vector<F>) -> F {
        let (splat, zero) = (F::splat, F::splat(0.0));
        let (x, y) = (m.x / self.alpha_u, m.y / self.alpha_v);
        let (radius2, cos2) = (x * x + y * y, m.z * m.z);
        let scale = splat(FRAC_1_PI) / (self.alpha_u * self.alpha_v);
        let density = match self.kind {
            MicrofacetKind::Beckmann => {
                let density = scale * exp(-radius2 / cos2) / (cos2 * cos2);
                // Below the cut in any case, and beyond the range of the exponential; spares a division by zero.
                zero.select((splat(87.0) * cos2).lt(radius2), density)
            }
            MicrofacetKind::Ggx => {
                let s = radius2 + cos2;
                scale / (s * s)
            }
        };
        // Mitsuba's cut: rids the tails of denormals, and facets on edge of NaN.
        density.select(splat(1e-20).lt(density * m.z), zero)
    }

    /// G1(v) for the values of a model; `v` may be on either side.
    #[inline(always)]
    pub fn masking(&self, v: Vector<F>) -> F {
        let splat = F::splat;
        match self.kind {
            MicrofacetKind::Beckmann => {
                let a = self.inverse_slope(v);
                let fit = a * (splat(3.535) + splat(2.181) * a)
                    / (splat(1.0) + a * (splat(2.276) + splat(2.577) * a));
                fit.select(a.lt(splat(1.6)), splat(1.0))
            }
            MicrofacetKind::Ggx => self.masking_ggx(v),
        }
    }

    /// G1(v) such that the visible normals have a density that integrates to one.
    #[inline(always)]
    pub fn visibility(&self, v: Vector<F>) -> F {
        let splat = F::splat;
        match self.kind {
            MicrofacetKind::Beckmann => {
                // Beyond 9 nothing is masked, and the exponential would underflow.
                let a = self.inverse_slope(v).min(splat(9.0));
                let gauss = exp(-a * a);
                splat(2.0) / (splat(2.0) - erfc(a, gauss) + splat(FRAC_1_SQRT_PI) * gauss / a)
            }
            MicrofacetKind::Ggx => self.masking_ggx(v),
        }
    }

    #[inline(always)]
    fn masking_ggx(&self, v: Vector<F>) -> F {
        let (x, y, z) = (self.alpha_u * v.x, self.alpha_v * v.y, v.z.abs());
        F::splat(2.0) * z / (z + (x * x + y * y + z * z).sqrt())
    }

    /// 1 / (alpha tan theta): the slope of `v` in units of the roughness along its azimuth.
    #[inline(always)]
    fn inverse_slope(&self, v: Vector<F>) -> F {
        let (x, y) = (self.alpha_u * v.x, self.alpha_v * v.y);
        v.z.abs() / (x * x + y * y).sqrt()
    }

    /// A facet normal visible from `v` (v.z > 0), with density D(m) `visibility(v)` (v.m) / v.z per solid angle.
    #[inline(always)]
    pub fn sample_visible(&self, v: Vector<F>, u: [F; 2]) -> Vector<F> {
        // Stretched along the axes by its roughness the distribution is isotropic with alpha = 1; normals stretch inversely.
        let v = Vector::new(self.alpha_u * v.x, self.alpha_v * v.y, v.z).normalized();
        let m = match self.kind {
            MicrofacetKind::Beckmann => sample_visible_beckmann(v, u),
            MicrofacetKind::Ggx => sample_visible_ggx(v, u),
        };
        Vector::new(self.alpha_u * m.x, self.alpha_v * m.y, m.z).normalized()
    }
}

/// A normal (of any length) of the GGX hemisphere, alpha = 1: the bisector of `v` and a direction uniform on the cap
/// z > -v.z (Dupuy and Benyoub 2023, listing 3).
#[inline(always)]
fn sample_visible_ggx<F: Float>(v: Vector<F>, u: [F; 2]) -> Vector<F> {
    let one = F::splat(1.0);
    // The sum's height comes first, lest a subtraction make it zero.
    let height = (one - u[1].min(F::splat(BELOW_ONE))) * (one + v.z);
    let z = height - v.z;
    let radius = ((one - z) * (one + z)).max(F::splat(0.0)).sqrt();
    let (sin, cos) = sin_cos_turn(u[0]);
    Vector::new(radius * cos + v.x, radius * sin + v.y, height)
}

/// A normal (of any length) of the Beckmann surface, alpha = 1.
#[inline(always)]
fn sample_visible_beckmann<F: Float>(v: Vector<F>, u: [F; 2]) -> Vector<F> {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let sin_theta = (v.x * v.x + v.y * v.y).sqrt();
    let slanted = zero.lt(sin_theta);
    let cos_phi = (v.x / sin_theta).select(slanted, one);
    let sin_phi = (v.y / sin_theta).select(slanted, zero);
    // Along the azimuth of v slopes are seen more the more they face v; across it they stay Gaussian.
    let along = sample_visible_slope(v.z, sin_theta, u[0]);
    let across = inverse_erfc(F::splat(2.0) * u[1]);
    Vector::new(-(cos_phi * along - sin_phi * across), -(sin_phi * along + cos_phi * across), one)
}

/// A slope s < cot(theta) with density proportional to (cos - s sin) exp(-s^2), by inverting its distribution function
///
/// C(s) = cos erfc(-s) + sin exp(-s^2) / sqrt(pi)
///
/// for the fraction `u`. With q = erfc(-s) as the unknown C is smooth up to its flat end, dC/dq = cos - s sin, and tails
/// keep their digits.
#[inline(always)]
fn sample_visible_slope<F: Float>(cos_theta: F, sin_theta: F, u: F) -> F {
    let splat = F::splat;
    let u = u.max(splat(f32::EPSILON / 4.0)).min(splat(BELOW_ONE));
    // Beyond 9 nothing is cut off, and the exponential would underflow.
    let cot = (cos_theta / sin_theta).min(splat(9.0));
    let gauss_end = exp(-cot * cot);
    let q_end = splat(2.0) - erfc(cot, gauss_end);
    let linear_end = cos_theta * q_end;
    let end = linear_end + splat(FRAC_1_SQRT_PI) * sin_theta * gauss_end;

    // C is linear at normal incidence, and exp(-s^2) at grazing: a mean of both answers to begin with.
    let weight = linear_end / end;
    let mut q = q_end * (weight * u + (splat(1.0) - weight) * erfc((-ln(u)).sqrt(), u));
    // Steps to the zero of the parabola that touches C (Cauchy's method), for which the flat end is no obstacle. After
    // two of them C is right to 10^-6 of its range everywhere.
    for _ in 0..2 {
        let slope = -inverse_erfc(q);
        let gauss = exp(-slope * slope);
        let residual = cos_theta * q + splat(FRAC_1_SQRT_PI) * sin_theta * gauss - u * end;
        let first = cos_theta - slope * sin_theta;
        let second = splat(-0.5 / FRAC_1_SQRT_PI) * sin_theta / gauss;
        let root = (first * first - splat(2.0) * residual * second).max(splat(0.0)).sqrt();
        let step = splat(2.0) * residual / (first + root).max(splat(f32::EPSILON));
        q = (q - step).max(splat(f32::MIN_POSITIVE)).min(q_end);
    }
    -inverse_erfc(q)
}

#[cfg(test)]
mod tests {
    use lichtweg_montecarlo::special;
    use lichtweg_ray::math::Vec3;

    use super::*;

    const KINDS: [MicrofacetKind; 2] = [MicrofacetKind::Beckmann, MicrofacetKind::Ggx];

    fn direction(z: f32, phi: f32) -> Vec3 {
        let r = ((1.0 - z) * (1.0 + z)).sqrt();
        Vec3::new(r * phi.cos(), r * phi.sin(), z)
    }

    /// Integral of `f` over the hemisphere of normals, by the midpoint rule in (tan theta)-like coordinates that follow `alpha`.
    fn integrate_normals(facets: &Microfacets, f: impl Fn(Vec3) -> f32) -> f64 {
        let n = 400;
        let mut sum = 0.0;
        for i in 0..n {
            // Slopes r / (1 - r) span the hemisphere; dm = m.z^3 dslope.
            let r = (f64::from(i) + 0.5) / f64::from(n);
            let slope = r / (1.0 - r);
            for j in 0..n {
                let (sin, cos) = (std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(n)).sin_cos();
                let (x, y) =
                    (slope * cos * f64::from(facets.alpha_u), slope * sin * f64::from(facets.alpha_v));
                let z = 1.0 / (1.0 + x * x + y * y).sqrt();
                let jacobian =
                    slope / (1.0 - r).powi(2) * f64::from(facets.alpha_u * facets.alpha_v) * z.powi(3);
                sum += jacobian * f64::from(f(Vec3::new((x * z) as f32, (y * z) as f32, z as f32)));
            }
        }
        sum * std::f64::consts::TAU / f64::from(n * n)
    }

    #[test]
    fn projected_area_and_visible_normals_integrate_to_one() {
        for kind in KINDS {
            for (alpha_u, alpha_v) in [(0.1, 0.1), (0.5, 0.2), (1.0, 1.0)] {
                let facets = Microfacets::new(kind, alpha_u, alpha_v);
                let area = integrate_normals(&facets, |m| facets.density(m) * m.z);
                assert!((area - 1.0).abs() < 2e-3, "{facets:?}: {area}");
                for z in [0.05, 0.5, 1.0] {
                    let v = direction(z, 0.7);
                    let visible = |m: Vec3| facets.density(m) * facets.visibility(v) * v.dot(m).max(0.0) / z;
                    let total = integrate_normals(&facets, visible);
                    assert!((total - 1.0).abs() < 3e-3, "{facets:?} z {z}: {total}");
                }
            }
        }
    }

    #[test]
    fn rational_masking_is_within_its_published_error() {
        let facets = Microfacets::new(MicrofacetKind::Beckmann, 0.5, 0.5);
        let worst = (1..1000)
            .map(|i| direction(i as f32 / 1000.0, 0.0))
            .map(|v| (facets.masking(v) / facets.visibility(v) - 1.0).abs())
            .fold(0.0, f32::max);
        assert!(worst > 1e-3 && worst < 4e-3, "{worst}");
    }

    #[test]
    fn slopes_invert_their_distribution() {
        let distribution = |cos: f64, sin: f64, s: f64| {
            cos * special::erfc(-s) + sin * (-s * s).exp() / std::f64::consts::PI.sqrt()
        };
        for cos in [1e-6f32, 1e-3, 0.05, 0.3, 0.7, 0.95, 0.9999, 1.0] {
            let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
            let end = distribution(cos.into(), sin.into(), f64::from(cos / sin).min(30.0));
            for i in 0..2000 {
                let u = (i as f32 + 0.5) / 2000.0;
                let s = sample_visible_slope(cos, sin, u);
                let fraction = distribution(cos.into(), sin.into(), s.into()) / end;
                assert!((fraction - f64::from(u)).abs() < 3e-6, "cos {cos} u {u}: slope {s}, {fraction}");
            }
        }
    }

    #[test]
    fn extreme_arguments_give_unit_normals() {
        let uniform = [0.0, f32::MIN_POSITIVE, 0.5, BELOW_ONE, 1.0];
        for kind in KINDS {
            for alpha in [f32::NAN, 0.0, 1e-4, 0.3, 10.0, f32::INFINITY] {
                let facets = Microfacets::new(kind, alpha, 0.2);
                for z in [1e-30, 1e-7, 1e-3, 0.5, 1.0] {
                    let v = direction(z, 1.0);
                    assert!(
                        (0.0..=1.01).contains(&facets.masking(v))
                            && (0.0..=1.0001).contains(&facets.visibility(v))
                    );
                    for (a, b) in uniform.iter().flat_map(|&a| uniform.map(|b| (a, b))) {
                        let m = facets.sample_visible(v, [a, b]);
                        assert!(
                            (m.length() - 1.0).abs() < 1e-5 && m.z >= 0.0,
                            "{facets:?} {v:?} [{a} {b}]: {m:?}"
                        );
                        assert!(facets.density(m).is_finite());
                    }
                }
            }
        }
    }
}
