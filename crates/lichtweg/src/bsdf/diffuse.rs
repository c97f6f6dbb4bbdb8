//! Lambertian reflection: f = reflectance / pi on the front side, nothing on the back.

use lichtweg_montecarlo::warp;
use lichtweg_ray::math::Vec3;

use super::BsdfSample;
use crate::color::Spectrum;

/// An ideally diffuse reflector.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    /// Albedo.
    pub reflectance: Spectrum,
}

impl Diffuse {
    /// See [`Bsdf::eval_pdf`](super::Bsdf::eval_pdf).
    #[inline]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Spectrum, f32) {
        let pdf = if wo.z > 0.0 { warp::cosine_hemisphere_pdf(wi.z) } else { 0.0 };
        (self.reflectance * pdf, pdf)
    }

    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline]
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        // Directions in proportion to the cosine leave the albedo as weight.
        let wi = Vec3::from_array(warp::cosine_hemisphere(u));
        let pdf = if wo.z > 0.0 { warp::cosine_hemisphere_pdf(wi.z) } else { 0.0 };
        (pdf > 0.0).then_some(BsdfSample::reflection(wi, self.reflectance, pdf))
    }
}
