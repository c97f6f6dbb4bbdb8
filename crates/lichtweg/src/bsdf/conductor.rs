//! Metals, smooth and rough: reflection with the colour of a complex index of refraction, on the front side only.

use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::Float;

use super::{BsdfSample, Lobe, Proposal, fresnel, microfacet::Microfacets, reflect};
use crate::color::{Spectra, Spectrum};

/// A metallic mirror.
#[derive(Clone, Copy, Debug)]
pub struct SmoothConductor {
    /// Real part of the index, relative to the outside.
    pub eta: Spectrum,
    /// Imaginary part.
    pub k: Spectrum,
    /// Factor on reflection (1 is physical).
    pub specular_reflectance: Spectrum,
}

impl SmoothConductor {
    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline]
    pub fn sample(&self, wo: Vec3) -> Option<BsdfSample> {
        let weight = self.specular_reflectance * fresnel::conductor(wo.z, self.eta, self.k);
        (wo.z > 0.0).then(|| BsdfSample::mirror(wo, weight, 1.0))
    }
}

/// A metal of microfacets (Torrance and Sparrow 1967, Walter et al. 2007 equation 20):
/// f cos_i = F(wo.m) D(m) G(wo, wi) / (4 cos_o), where m bisects wo and wi.
///
/// Or as many as `F` has lanes.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor<F = f32> {
    /// Distribution of facet normals.
    pub facets: Microfacets<F>,
    /// Real part of the index, relative to the outside.
    pub eta: Spectra<F>,
    /// Imaginary part.
    pub k: Spectra<F>,
    /// Factor on reflection (1 is physical).
    pub specular_reflectance: Spectra<F>,
}

impl<F: Float> Lobe<F> for RoughConductor<F> {
    #[inline(always)]
    fn value_and_pdf(&self, wo: Vector<F>, wi: Vector<F>) -> (Spectra<F>, F) {
        let zero = F::splat(0.0);
        let front = zero.lt(wo.z) & zero.lt(wi.z);
        let m = (wo + wi).normalized();
        let density = F::splat(0.25) * self.facets.density(m);
        // G1 vanishes with its cosine: their quotient stays finite where 1 / cos alone would not.
        let masking = self.facets.masking(wo) / wo.z * self.facets.masking(wi);
        // The minimum rids of NaN, where both directions graze so much that their bisector has no length.
        let cos = wo.dot(m).min(F::splat(1.0));
        let value =
            self.specular_reflectance * fresnel::conductor(cos, self.eta, self.k) * (density * masking);
        let pdf = density * (self.facets.visibility(wo) / wo.z);
        (value.select(front, Spectra([zero; 4])), pdf.select(front, zero))
    }

    #[inline(always)]
    fn propose(&self, wo: Vector<F>, u: [F; 2]) -> Proposal<F> {
        let zero = F::splat(0.0);
        let m = self.facets.sample_visible(wo, u);
        let wi = reflect(wo, m);
        // The Jacobian 1 / (4 wo.m) of the reflection cancels the density's wo.m.
        let visibility = self.facets.visibility(wo);
        let pdf = F::splat(0.25) * self.facets.density(m) * (visibility / wo.z);
        let masking = self.facets.masking(wo) / visibility * self.facets.masking(wi);
        let weight = self.specular_reflectance * fresnel::conductor(wo.dot(m), self.eta, self.k) * masking;
        Proposal { wi, weight, pdf, valid: zero.lt(wo.z) & zero.lt(wi.z) & zero.lt(pdf) }
    }
}

impl RoughConductor {
    /// See [`Bsdf::eval_pdf`](super::Bsdf::eval_pdf).
    #[inline(never)]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Spectrum, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        self.value_and_pdf(wo, wi)
    }

    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline(never)]
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        self.propose(wo, u).into_sample()
    }
}
