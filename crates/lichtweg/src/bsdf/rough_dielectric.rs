//! A rough interface between dielectrics: microfacets that reflect and refract.
//!
//! Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces", equations 20 and 21, with eta the
//! index on the far side over that on the side of wo, and m the normal of the facet that turns wi into wo:
//!
//! - reflection: f |cos_i| = F D G / (4 |cos_o|);
//! - transmission: f |cos_i| = (1 - F) D G |wo.m| |wi.m| eta^2 / (|cos_o| (wo.m + eta wi.m)^2), times 1/eta^2 for radiance.
//!
//! Limits: an interface of (all but) equal indices has no half vector; light passes it straight.

use lichtweg_ray::math::Vec3;

use super::{BsdfSample, Mode, fresnel, microfacet::Microfacets, reflect};
use crate::color::Spectrum;

/// Indices this close are equal: the half vector of refraction, of length |eta - 1| at least, is lost in rounding, and light
/// is deflected by less than a thousandth of a degree.
const MATCHED: f32 = 1e-5;

/// A rough interface between two dielectrics; both sides are legal.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric {
    /// Distribution of facet normals.
    pub facets: Microfacets,
    /// Index of refraction inside over outside; the normal points outside.
    pub eta: f32,
    /// Factor on reflection (1 is physical).
    pub specular_reflectance: Spectrum,
    /// Factor on transmission (1 is physical).
    pub specular_transmittance: Spectrum,
}

impl RoughDielectric {
    /// Whether the interface is optically absent.
    #[inline]
    pub fn is_matched(&self) -> bool {
        (self.eta - 1.0).abs() < MATCHED
    }

    /// The relative index as seen from the side of `wo`, and the sign that brings `wo` above the surface. D and G are even,
    /// so everything else can go on as if it were there.
    #[inline]
    fn seen_from(&self, wo: Vec3) -> (f32, f32) {
        if wo.z > 0.0 { (self.eta, 1.0) } else { (1.0 / self.eta, -1.0) }
    }

    /// See [`Bsdf::eval_pdf`](super::Bsdf::eval_pdf).
    #[inline(never)]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3, mode: Mode) -> (Spectrum, f32) {
        const NONE: (Spectrum, f32) = (Spectrum::ZERO, 0.0);
        if wo.z == 0.0 || wi.z == 0.0 || self.is_matched() {
            return NONE;
        }
        let (eta, side) = self.seen_from(wo);
        let (wo, wi) = (wo * side, wi * side);
        let reflected = wi.z > 0.0;
        let half = (wo + wi * if reflected { 1.0 } else { eta }).normalized();
        let m = half * 1.0f32.copysign(half.z);
        let (cos_o, cos_i) = (wo.dot(m), wi.dot(m));
        // A facet is seen from its front alone. Written so that NaN, of a half vector of no length, fails too.
        if !(cos_o > 0.0 && cos_i * wi.z > 0.0) {
            return NONE;
        }
        let density = self.facets.density(m);
        // G1 vanishes with its cosine: their quotient stays finite where 1 / cos alone would not.
        let masking = self.facets.masking(wo) / wo.z * self.facets.masking(wi);
        let visibility = self.facets.visibility(wo) / wo.z;
        let fresnel = fresnel::dielectric(cos_o, eta).reflectance;
        if reflected {
            let common = 0.25 * fresnel * density;
            (self.specular_reflectance * (common * masking), common * visibility)
        } else {
            let common = (1.0 - fresnel) * density * cos_o * refraction_jacobian(cos_o, cos_i, eta);
            (self.specular_transmittance * (common * masking * compression(eta, mode)), common * visibility)
        }
    }

    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline(never)]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], mode: Mode) -> Option<BsdfSample> {
        if self.is_matched() {
            return Some(BsdfSample::straight(wo, self.specular_transmittance, 1.0));
        }
        if wo.z == 0.0 {
            return None;
        }
        let (eta, side) = self.seen_from(wo);
        let wo = wo * side;
        let m = self.facets.sample_visible(wo, u);
        let cos_o = wo.dot(m);
        let fresnel = fresnel::dielectric(cos_o, eta);
        let visibility = self.facets.visibility(wo);
        // What remains of the value over the density: masking, seen from both directions over that the sampling knew.
        let weight = |wi: Vec3| self.facets.masking(wo) / visibility * self.facets.masking(wi);
        let visible = self.facets.density(m) * (visibility / wo.z);

        if u_lobe < fresnel.reflectance {
            let wi = reflect(wo, m);
            let pdf = 0.25 * fresnel.reflectance * visible;
            return (wi.z > 0.0 && pdf > 0.0)
                .then(|| BsdfSample::reflection(wi * side, self.specular_reflectance * weight(wi), pdf));
        }
        let wi = m * (fresnel.eta_ti * cos_o + fresnel.cos_theta_t) - wo * fresnel.eta_ti;
        let jacobian = refraction_jacobian(cos_o, fresnel.cos_theta_t, eta);
        let pdf = (1.0 - fresnel.reflectance) * visible * cos_o * jacobian;
        (wi.z < 0.0 && pdf > 0.0).then(|| BsdfSample {
            wi: wi * side,
            weight: self.specular_transmittance * (weight(wi) * compression(eta, mode)),
            pdf,
            delta: false,
            eta,
        })
    }
}

/// |dm / dwi|: solid angle of facet normals per solid angle of refracted directions (Walter et al. 2007, equation 17).
#[inline]
fn refraction_jacobian(cos_o: f32, cos_i: f32, eta: f32) -> f32 {
    let half_length = cos_o + eta * cos_i;
    eta * eta * cos_i.abs() / (half_length * half_length)
}

/// What crossing into a medium of relative index `eta` does to the quantity carried (Veach 1997, section 5.2).
#[inline]
fn compression(eta: f32, mode: Mode) -> f32 {
    match mode {
        Mode::Radiance => 1.0 / (eta * eta),
        Mode::Importance => 1.0,
    }
}
