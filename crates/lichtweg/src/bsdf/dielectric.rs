//! Smooth boundaries of dielectrics: a plane interface that reflects and refracts, and a thin slab that does not bend.
//!
//! Both scatter into two directions only, with the probabilities of Fresnel's equations: sampling chooses the lobe in
//! proportion to its flux, so that the weight of a lossless interface is 1. Refraction compresses solid angles by eta^2, and
//! radiance grows with them; the walk from the eye therefore scales by 1/eta^2, the walk from a light does not (Veach 1997,
//! section 5.2).

use lichtweg_ray::math::Vec3;

use super::{BsdfSample, Mode, fresnel};
use crate::color::Spectrum;

/// A smooth interface between two dielectrics; both sides are legal.
#[derive(Clone, Copy, Debug)]
pub struct SmoothDielectric {
    /// Index of refraction inside over outside; the normal points outside.
    pub eta: f32,
    /// Factor on reflection (1 is physical).
    pub specular_reflectance: Spectrum,
    /// Factor on transmission (1 is physical).
    pub specular_transmittance: Spectrum,
}

impl SmoothDielectric {
    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, mode: Mode) -> Option<BsdfSample> {
        let f = fresnel::dielectric(wo.z, self.eta);
        if u_lobe < f.reflectance {
            return Some(BsdfSample::mirror(wo, self.specular_reflectance, f.reflectance));
        }
        let scale = match mode {
            Mode::Radiance => f.eta_ti * f.eta_ti,
            Mode::Importance => 1.0,
        };
        Some(BsdfSample {
            wi: Vec3::new(-f.eta_ti * wo.x, -f.eta_ti * wo.y, f.cos_theta_t),
            weight: self.specular_transmittance * scale,
            pdf: 1.0 - f.reflectance,
            delta: true,
            eta: f.eta_it,
        })
    }
}

/// A slab of dielectric with parallel sides, thin enough for light to leave where it entered.
///
/// Light bounces inside any number of times: with R the reflectance of one side, the slab reflects
/// R + T^2 R + T^2 R^3 + ... = 2 R / (1 + R) and passes on the rest without a bend.
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectric {
    /// Index of refraction of the slab over its surroundings.
    pub eta: f32,
    /// Factor on reflection (1 is physical).
    pub specular_reflectance: Spectrum,
    /// Factor on transmission (1 is physical).
    pub specular_transmittance: Spectrum,
}

impl ThinDielectric {
    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32) -> Option<BsdfSample> {
        let one_side = fresnel::dielectric(wo.z.abs(), self.eta).reflectance;
        let reflectance = 2.0 * one_side / (1.0 + one_side);
        if u_lobe < reflectance {
            return Some(BsdfSample::mirror(wo, self.specular_reflectance, reflectance));
        }
        Some(BsdfSample::straight(wo, self.specular_transmittance, 1.0 - reflectance))
    }
}
