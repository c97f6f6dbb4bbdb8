//! Plastic: a diffuse base under a clear dielectric coat, smooth or rough; Mitsuba's `plastic` and `roughplastic`.
//!
//! The coat reflects specularly. What it lets through is scattered by the base, leaves through the coat or is thrown back to the
//! base any number of times. With T(mu) the transmittance of the coat, R_int its mean reflectance from below and rho the
//! albedo of the base, the sum of all these is the diffuse part
//!
//! f cos_i = rho / (1 - rho R_int) / (pi eta^2) T(mu_o) T(mu_i) cos_i.
//!
//! Unless `nonlinear`, the rho of the denominator is taken to be 1, which keeps the hue of the base's texture.
//!
//! Limits: no absorption in the coat, no shift of the point of exit, front side only; the two parts of the rough
//! model share energy only through T.

use lichtweg_montecarlo::warp;
use lichtweg_ray::math::Vec3;

use super::rough_transmittance::RoughTransmittanceTable;
use super::{BsdfSample, fresnel, reflect};
use crate::color::Spectrum;

/// The base and how it is tinted: what both plastics have in common.
#[derive(Clone, Copy, Debug)]
struct Layers {
    /// rho / (1 - rho R_int) / eta^2.
    base: Spectrum,
    specular_reflectance: Spectrum,
    /// Share of the specular part in the choice of lobe, before the coat's reflectance is accounted for.
    specular_weight: f32,
}

impl Layers {
    #[inline]
    fn new(eta: f32, internal: f32, diffuse: Spectrum, specular: Spectrum, nonlinear: bool) -> Self {
        let lost = |rho: f32| if nonlinear { rho * internal } else { internal };
        // An albedo above one must not make an infinite series of reflections diverge.
        let base = diffuse.map(|rho| rho / ((1.0 - lost(rho)).max(1e-3) * eta * eta));
        let (d, s) = (lobe_mean(diffuse), lobe_mean(specular));
        let specular_weight = if s > 0.0 { s / (d + s) } else { 0.0 };
        Self { base, specular_reflectance: specular, specular_weight }
    }

    /// Probability of sampling the specular lobe where the coat reflects the fraction `reflected` and passes `passed`.
    #[inline]
    fn specular_probability(&self, reflected: f32, passed: f32) -> f32 {
        let specular = reflected * self.specular_weight;
        let diffuse = passed * (1.0 - self.specular_weight);
        if specular > 0.0 { specular / (specular + diffuse) } else { 0.0 }
    }
}

/// Mean of the lanes. In RGB mode the last two are both blue, and count once together.
#[inline]
fn lobe_mean(s: Spectrum) -> f32 {
    (s.0[0] + s.0[1] + 0.5 * (s.0[2] + s.0[3])) / 3.0
}

/// A diffuse base under a smooth coat.
#[derive(Clone, Copy, Debug)]
pub struct SmoothPlastic {
    layers: Layers,
    eta: f32,
}

impl SmoothPlastic {
    /// A plastic with a coat of index `eta` over the outside. `internal_reflectance` is that of the coat from below,
    /// [`fresnel::diffuse_reflectance`]\(1 / eta), a property of the material that need not be computed at every point.
    #[inline]
    pub fn new(
        eta: f32,
        internal_reflectance: f32,
        diffuse_reflectance: Spectrum,
        specular_reflectance: Spectrum,
        nonlinear: bool,
    ) -> Self {
        let layers =
            Layers::new(eta, internal_reflectance, diffuse_reflectance, specular_reflectance, nonlinear);
        Self { layers, eta }
    }

    /// See [`Bsdf::eval_pdf`](super::Bsdf::eval_pdf); the specular part is a delta lobe.
    #[inline(never)]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Spectrum, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let reflected_o = fresnel::dielectric(wo.z, self.eta).reflectance;
        let reflected_i = fresnel::dielectric(wi.z, self.eta).reflectance;
        let passed_o = 1.0 - reflected_o;
        let cosine = warp::cosine_hemisphere_pdf(wi.z);
        let p_diffuse = 1.0 - self.layers.specular_probability(reflected_o, passed_o);
        (self.layers.base * (cosine * passed_o * (1.0 - reflected_i)), cosine * p_diffuse)
    }

    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline(never)]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let reflected = fresnel::dielectric(wo.z, self.eta).reflectance;
        let p_specular = self.layers.specular_probability(reflected, 1.0 - reflected);
        if u_lobe < p_specular {
            let weight = self.layers.specular_reflectance * (reflected / p_specular);
            return Some(BsdfSample::mirror(wo, weight, p_specular));
        }
        let wi = Vec3::from_array(warp::cosine_hemisphere(u));
        let (value, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::reflection(wi, value / pdf, pdf))
    }

    /// Albedo as seen along the normal, roughly.
    pub(super) fn albedo_hint(&self) -> Spectrum {
        let reflected = fresnel::dielectric(1.0, self.eta).reflectance;
        let mean_passed = 1.0 - fresnel::diffuse_reflectance(self.eta);
        self.layers.base * ((1.0 - reflected) * mean_passed) + self.layers.specular_reflectance * reflected
    }
}

/// A diffuse base under a rough coat.
#[derive(Clone, Copy, Debug)]
pub struct RoughPlastic<'a> {
    layers: Layers,
    coat: &'a RoughTransmittanceTable,
}

impl<'a> RoughPlastic<'a> {
    /// A plastic with the coat that `coat` was made for.
    #[inline]
    pub fn new(
        coat: &'a RoughTransmittanceTable,
        diffuse_reflectance: Spectrum,
        specular_reflectance: Spectrum,
        nonlinear: bool,
    ) -> Self {
        let (eta, internal) = (coat.eta(), coat.internal_reflectance());
        Self {
            layers: Layers::new(eta, internal, diffuse_reflectance, specular_reflectance, nonlinear),
            coat,
        }
    }

    /// See [`Bsdf::eval_pdf`](super::Bsdf::eval_pdf).
    #[inline(never)]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Spectrum, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let facets = self.coat.facets();
        let m = (wo + wi).normalized();
        let density = 0.25 * facets.density(m);
        // G1 vanishes with its cosine: their quotient stays finite where 1 / cos alone would not.
        let masking = facets.masking(wo) / wo.z * facets.masking(wi);
        // The minimum rids of NaN, where both directions graze so much that their bisector has no length.
        let cos = wo.dot(m).min(1.0);
        let fresnel = fresnel::dielectric(cos, self.coat.eta()).reflectance;
        let specular = self.layers.specular_reflectance * (fresnel * density * masking);

        let (passed_o, passed_i) = (self.coat.transmittance(wo.z), self.coat.transmittance(wi.z));
        let cosine = warp::cosine_hemisphere_pdf(wi.z);
        let diffuse = self.layers.base * (cosine * passed_o * passed_i);

        let p_specular = self.layers.specular_probability(1.0 - passed_o, passed_o);
        let pdf = p_specular * density * (facets.visibility(wo) / wo.z) + (1.0 - p_specular) * cosine;
        (specular + diffuse, pdf)
    }

    /// See [`Bsdf::sample`](super::Bsdf::sample).
    #[inline(never)]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let passed = self.coat.transmittance(wo.z);
        let wi = if u_lobe < self.layers.specular_probability(1.0 - passed, passed) {
            reflect(wo, self.coat.facets().sample_visible(wo, u))
        } else {
            Vec3::from_array(warp::cosine_hemisphere(u))
        };
        let (value, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample::reflection(wi, value / pdf, pdf))
    }

    /// Albedo as seen along the normal, roughly.
    pub(super) fn albedo_hint(&self) -> Spectrum {
        let passed = self.coat.transmittance(1.0);
        self.layers.base * (passed * self.coat.mean_transmittance())
            + self.layers.specular_reflectance * (1.0 - passed)
    }
}
