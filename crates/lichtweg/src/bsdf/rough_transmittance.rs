//! What a rough dielectric interface lets through: tabulated over the cosine of incidence.
//!
//! T(mu) = integral over transmitted directions of f |cos|, computed over the unit square of the visible-normal sampling, where
//! the integrand is (1 - F) G1(wi) of the drawn normal, by Gauss-Legendre quadrature. The table has 64 cosines, equally
//! spaced in [0, 1]; values between are linearly interpolated. Resolution and means are those of Mitsuba 3's `roughplastic`,
//! so that images agree.

use lichtweg_ray::math::Vec3;

use super::{fresnel, microfacet::Microfacets, reflect};

/// Entries of the table.
const RESOLUTION: usize = 64;

/// Transmittance of a rough interface from outside, and its mean reflectance from inside.
#[derive(Clone, Debug)]
pub struct RoughTransmittanceTable {
    facets: Microfacets,
    eta: f32,
    transmittance: [f32; RESOLUTION],
    internal_reflectance: f32,
}

impl RoughTransmittanceTable {
    /// The table of an interface of (isotropic) `facets` and index `eta` inside over outside. Takes tens of milliseconds: make
    /// one for each material, not for each point.
    pub fn new(facets: Microfacets, eta: f32) -> Self {
        let rule = gauss_legendre(32);
        let transmittance = std::array::from_fn(|i| {
            let wo = direction(i);
            integrate(&rule, |u| {
                let m = facets.sample_visible(wo, u);
                let f = fresnel::dielectric(wo.dot(m), eta);
                let wi = m * (f.eta_ti * wo.dot(m) + f.cos_theta_t) - wo * f.eta_ti;
                if wi.z < 0.0 { (1.0 - f.reflectance) * facets.masking(wi) } else { 0.0 }
            })
        });
        // Total reflection makes a kink that wants more points.
        let rule = gauss_legendre(48);
        let reflected_inside = (0..RESOLUTION).map(|i| {
            let wo = direction(i);
            let reflectance = integrate(&rule, |u| {
                let m = facets.sample_visible(wo, u);
                let wi = reflect(wo, m);
                let f = fresnel::dielectric(wo.dot(m), 1.0 / eta);
                if wi.z > 0.0 { f.reflectance * facets.masking(wi) } else { 0.0 }
            });
            2.0 * wo.z * reflectance
        });
        // The plain mean of the entries rather than the trapezium rule; some 1.5 % low, and part of the model as published.
        let internal_reflectance = reflected_inside.sum::<f32>() / RESOLUTION as f32;
        Self { facets, eta, transmittance, internal_reflectance }
    }

    /// The facets of the interface.
    #[inline]
    pub fn facets(&self) -> &Microfacets {
        &self.facets
    }

    /// Index of refraction inside over outside.
    #[inline]
    pub fn eta(&self) -> f32 {
        self.eta
    }

    /// Fraction of the flux from outside, under the cosine `mu` in [0, 1], that gets through.
    #[inline]
    pub fn transmittance(&self, mu: f32) -> f32 {
        let x = mu * (RESOLUTION - 1) as f32;
        let i = (x as usize).min(RESOLUTION - 2);
        let (low, high) = (self.transmittance[i], self.transmittance[i + 1]);
        low + (x - i as f32) * (high - low)
    }

    /// Fraction of diffuse light from inside that is thrown back.
    #[inline]
    pub fn internal_reflectance(&self) -> f32 {
        self.internal_reflectance
    }

    /// Fraction of diffuse light from outside that gets through.
    pub fn mean_transmittance(&self) -> f32 {
        let weighted = self.transmittance.iter().enumerate().map(|(i, t)| 2.0 * t * direction(i).z);
        weighted.sum::<f32>() / RESOLUTION as f32
    }
}

/// The direction of the table's entry `i`. A grazing one stays above the horizon.
fn direction(i: usize) -> Vec3 {
    let mu = (i as f32 / (RESOLUTION - 1) as f32).max(1e-6);
    Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu)
}

/// Integral of `f` over the unit square by the product of `rule` with itself.
fn integrate(rule: &[(f32, f32)], f: impl Fn([f32; 2]) -> f32) -> f32 {
    let row = |y: f32| rule.iter().map(|&(x, weight)| f64::from(weight * f([x, y]))).sum::<f64>();
    rule.iter().map(|&(y, weight)| f64::from(weight) * row(y)).sum::<f64>() as f32
}

/// Nodes and weights of the Gauss-Legendre rule of `n` points on (0, 1): the zeros of the Legendre polynomial P_n, found by
/// Newton's method (Press et al. 2007, "Numerical Recipes", section 4.6.1).
fn gauss_legendre(n: usize) -> Vec<(f32, f32)> {
    let order = n as f64;
    (0..n)
        .map(|i| {
            let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (order + 0.5)).cos();
            let mut derivative = 0.0;
            for _ in 0..8 {
                let (mut p, mut previous) = (x, 1.0);
                for k in 2..=n {
                    let k = k as f64;
                    (p, previous) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k, p);
                }
                derivative = order * (x * p - previous) / (x * x - 1.0);
                x -= p / derivative;
            }
            let weight = 2.0 / ((1.0 - x * x) * derivative * derivative);
            ((0.5 * (x + 1.0)) as f32, (0.5 * weight) as f32)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::MicrofacetKind;

    #[test]
    fn quadrature_is_exact_for_polynomials() {
        let rule = gauss_legendre(5);
        assert!((integrate(&rule, |_| 1.0) - 1.0).abs() < 1e-6);
        assert!((integrate(&rule, |[x, y]| x.powi(9) * y) - 0.05).abs() < 1e-6);
    }

    #[test]
    fn polished_coats_transmit_as_smooth_ones() {
        for kind in [MicrofacetKind::Beckmann, MicrofacetKind::Ggx] {
            let table = RoughTransmittanceTable::new(Microfacets::new(kind, 1e-3, 1e-3), 1.5);
            for i in [4, 20, 63] {
                let mu = i as f32 / 63.0;
                let smooth = 1.0 - fresnel::dielectric(mu, 1.5).reflectance;
                assert!((table.transmittance(mu) - smooth).abs() < 1e-3, "{kind:?} {mu}");
            }
            // The mean of the entries is 1/64 below the integral.
            let smooth = fresnel::diffuse_reflectance(1.0 / 1.5);
            assert!(
                (table.internal_reflectance() / smooth - 1.0).abs() < 0.02,
                "{}",
                table.internal_reflectance()
            );
        }
    }
}
