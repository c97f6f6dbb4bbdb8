//! Metals, smooth and rough: reflection with the colour of a complex index of refraction, on the front side only.

use lichtweg_ray::math::Vec3;

use super::{BsdfSample, fresnel, microfacet::Microfacets, reflect};
use crate::color::Spectrum;

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
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor {
    /// Distribution of facet normals.
    pub facets: Microfacets,
    /// Real part of the index, relative to the outside.
    pub eta: Spectrum,
    /// Imaginary part.
    pub k: Spectrum,
    /// Factor on reflection (1 is physical).
    pub specular_reflectance: Spectrum,
}

impl RoughConductor {
    /// See [`Bsdf::eval_pdf`](super::Bsdf::eval_pdf).
    #[inline(never)]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Spectrum, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let m = (wo + wi).normalized();
        let density = 0.25 * self.facets.density(m);
        // G1 vanishes with its cosine: their quotient stays finite where 1 / cos alone would not.
        let masking = self.facets.masking(wo) / wo.z * self.facets.masking(wi);
        // The minimum rids of NaN, where both directions graze so much that their bisector has no length.
        let cos = wo.dot(m).min(1.0);
        let fresnel = self.specular_reflectance * fresnel::conductor(cos, self.eta, self.k);
        (fresnel * (density * masking), density * (self.facets.visibility(wo) / wo.z))
    }

    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline(never)]
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let m = self.facets.sample_visible(wo, u);
        let wi = reflect(wo, m);
        // The Jacobian 1 / (4 wo.m) of the reflection cancels the density's wo.m.
        let visibility = self.facets.visibility(wo);
        let pdf = 0.25 * self.facets.density(m) * (visibility / wo.z);
        if wi.z <= 0.0 || pdf <= 0.0 {
            return None;
        }
        let masking = self.facets.masking(wo) / visibility * self.facets.masking(wi);
        let weight = self.specular_reflectance * fresnel::conductor(wo.dot(m), self.eta, self.k) * masking;
        Some(BsdfSample::reflection(wi, weight, pdf))
    }
}
