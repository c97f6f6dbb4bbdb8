//! Lambertian reflection: f = reflectance / pi on the front side, nothing on the back.

use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::Float;

use super::{BsdfSample, Lobe, Proposal};
use crate::color::{Spectra, Spectrum};
use crate::lanes::warp;

/// An ideally diffuse reflector, or as many as `F` has lanes.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse<F = f32> {
    /// Albedo.
    pub reflectance: Spectra<F>,
}

impl<F: Float> Diffuse<F> {
    #[inline(always)]
    fn pdf(wo: Vector<F>, wi: Vector<F>) -> F {
        let zero = F::splat(0.0);
        warp::cosine_hemisphere_pdf(wi.z).select(zero.lt(wo.z), zero)
    }
}

impl<F: Float> Lobe<F> for Diffuse<F> {
    #[inline(always)]
    fn value_and_pdf(&self, wo: Vector<F>, wi: Vector<F>) -> (Spectra<F>, F) {
        let pdf = Self::pdf(wo, wi);
        (self.reflectance * pdf, pdf)
    }

    #[inline(always)]
    fn propose(&self, wo: Vector<F>, u: [F; 2]) -> Proposal<F> {
        // Directions in proportion to the cosine leave the albedo as weight.
        let wi = warp::cosine_hemisphere(u);
        let pdf = Self::pdf(wo, wi);
        Proposal { wi, weight: self.reflectance, pdf, valid: F::splat(0.0).lt(pdf) }
    }
}

impl Diffuse {
    /// See [`Bsdf::eval_pdf`](super::Bsdf::eval_pdf).
    #[inline]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Spectrum, f32) {
        self.value_and_pdf(wo, wi)
    }

    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline]
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        self.propose(wo, u).into_sample()
    }
}
