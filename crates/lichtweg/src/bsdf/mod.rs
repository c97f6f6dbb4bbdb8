//! Scattering at a surface point: the factor f_r of a light path.
//!
//! A [`Bsdf`] is a material with its textures already looked up at one point. Directions are unit vectors in
//! the local shading frame, z along the normal, and point away from the surface: `wo` to where the walk came from,
//! `wi` to where it goes. Densities are per solid angle. Three functions must agree, and tests hold every model to it:
//! [`Bsdf::eval`] is f(wo, wi) |cos wi|, [`Bsdf::pdf`] the density with which [`Bsdf::sample`] proposes wi, and a sample's
//! weight is their quotient.
//!
//! The rough models are kept out of line: the walk's own code stays small enough for its registers, and a call is little
//! beside what they compute.
//!
//! Delta lobes (mirrors, smooth glass) exist for `sample` alone: `eval` and `pdf` are zero there, and the sample says
//! [`BsdfSample::delta`].
//!
//! With [`Mode::Importance`] the arguments exchange their roles: eval(wo, wi) is then f(wi -> wo) of Veach's
//! notation (1997, section 3.7.5). For everything but refraction that is the same number; refraction scales radiance by
//! the square of the relative index, and importance not at all (Veach 1997, section 5.2).

mod conductor;
mod dielectric;
mod diffuse;
mod erf;
mod frame;
pub mod fresnel;
pub mod microfacet;
mod plastic;
mod rough_dielectric;
mod rough_transmittance;

use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::Float;

use crate::color::{Spectra, Spectrum};

pub use conductor::{RoughConductor, SmoothConductor};
pub use dielectric::{SmoothDielectric, ThinDielectric};
pub use diffuse::Diffuse;
pub use frame::Frame;
pub use microfacet::{MicrofacetKind, Microfacets};
pub use plastic::{RoughPlastic, SmoothPlastic};
pub use rough_dielectric::RoughDielectric;
pub use rough_transmittance::RoughTransmittanceTable;

/// What is being carried along the walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Radiance, towards the eye: the walk itself goes from the eye.
    Radiance,
    /// Importance, towards the lights: the walk goes from a light.
    Importance,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Where the walk goes on.
    pub wi: Vec3,
    /// f(wo, wi) |cos wi| / pdf; for delta lobes the factor on radiance, divided by the lobe's probability.
    pub weight: Spectrum,
    /// Density of `wi` per solid angle; for delta lobes the probability of the lobe.
    pub pdf: f32,
    /// Whether the direction comes from a delta lobe.
    pub delta: bool,
    /// Index of refraction of the far side over the near side where the walk crossed the surface, else 1.
    pub eta: f32,
}

impl BsdfSample {
    /// A direction on the same side, from a lobe of finite density.
    #[inline]
    fn reflection(wi: Vec3, weight: Spectrum, pdf: f32) -> Self {
        Self { wi, weight, pdf, delta: false, eta: 1.0 }
    }

    /// The mirror direction, chosen with probability `pdf`.
    #[inline]
    fn mirror(wo: Vec3, weight: Spectrum, pdf: f32) -> Self {
        Self { wi: Vec3::new(-wo.x, -wo.y, wo.z), weight, pdf, delta: true, eta: 1.0 }
    }

    /// Straight on, as if nothing were there, chosen with probability `pdf`.
    #[inline]
    fn straight(wo: Vec3, weight: Spectrum, pdf: f32) -> Self {
        Self { wi: -wo, weight, pdf, delta: true, eta: 1.0 }
    }
}

/// A direction proposed by a [`Lobe`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proposal<F: Float> {
    /// See [`BsdfSample::wi`].
    pub wi: Vector<F>,
    /// See [`BsdfSample::weight`].
    pub weight: Spectra<F>,
    /// See [`BsdfSample::pdf`].
    pub pdf: F,
    /// Whether it is not absorbed.
    pub valid: F::Mask,
}

/// A model of one reflecting lobe, written for any width: what walks alone and walks that go together have in common.
pub(crate) trait Lobe<F: Float> {
    /// See [`Bsdf::eval_pdf`].
    fn value_and_pdf(&self, wo: Vector<F>, wi: Vector<F>) -> (Spectra<F>, F);

    /// See [`Bsdf::sample`].
    fn propose(&self, wo: Vector<F>, u: [F; 2]) -> Proposal<F>;
}

impl Proposal<f32> {
    #[inline]
    fn into_sample(self) -> Option<BsdfSample> {
        self.valid.then(|| BsdfSample::reflection(self.wi, self.weight, self.pdf))
    }
}

/// `wo` mirrored about the facet normal `m`.
#[inline(always)]
fn reflect<F: Float>(wo: Vector<F>, m: Vector<F>) -> Vector<F> {
    m * (F::splat(2.0) * wo.dot(m)) - wo
}

/// A scattering function at one surface point. The lifetime is that of the scene, whose tables it may refer to.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<'a> {
    /// Lambert's.
    Diffuse(Diffuse),
    /// A smooth interface between dielectrics.
    SmoothDielectric(SmoothDielectric),
    /// A thin slab of dielectric.
    ThinDielectric(ThinDielectric),
    /// A rough interface between dielectrics.
    RoughDielectric(RoughDielectric),
    /// A smooth metal.
    SmoothConductor(SmoothConductor),
    /// A rough metal.
    RoughConductor(RoughConductor),
    /// A diffuse base under a smooth coat.
    SmoothPlastic(SmoothPlastic),
    /// A diffuse base under a rough coat.
    RoughPlastic(RoughPlastic<'a>),
}

impl Bsdf<'_> {
    /// Whether there is anything but delta lobes, so that a connection to another vertex can carry light.
    #[inline]
    pub fn connects(&self) -> bool {
        !self.is_delta_only()
    }

    /// Whether all lobes are delta lobes.
    #[inline]
    pub fn is_delta_only(&self) -> bool {
        match self {
            Self::SmoothDielectric(_) | Self::ThinDielectric(_) | Self::SmoothConductor(_) => true,
            Self::RoughDielectric(m) => m.is_matched(),
            Self::Diffuse(_) | Self::RoughConductor(_) | Self::SmoothPlastic(_) | Self::RoughPlastic(_) => {
                false
            }
        }
    }

    /// Whether light may come from behind. Where it may not, it comes from in front, along the normal: the back is black.
    #[inline]
    pub fn transmits(&self) -> bool {
        match self {
            Self::SmoothDielectric(_) | Self::ThinDielectric(_) | Self::RoughDielectric(_) => true,
            Self::Diffuse(_)
            | Self::SmoothConductor(_)
            | Self::RoughConductor(_)
            | Self::SmoothPlastic(_)
            | Self::RoughPlastic(_) => false,
        }
    }

    /// f(wo, wi) |cos wi|, without delta lobes.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: Mode) -> Spectrum {
        self.eval_pdf(wo, wi, mode).0
    }

    /// Density per solid angle with which `sample` proposes `wi`, without delta lobes.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        // The density is the same in both modes; the optimiser drops the value.
        self.eval_pdf(wo, wi, Mode::Radiance).1
    }

    /// `eval` and `pdf` in one, for less than the two.
    #[inline]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3, mode: Mode) -> (Spectrum, f32) {
        match self {
            Self::Diffuse(m) => m.eval_pdf(wo, wi),
            Self::SmoothDielectric(_) | Self::ThinDielectric(_) | Self::SmoothConductor(_) => {
                (Spectrum::ZERO, 0.0)
            }
            Self::RoughDielectric(m) => m.eval_pdf(wo, wi, mode),
            Self::RoughConductor(m) => m.eval_pdf(wo, wi),
            Self::SmoothPlastic(m) => m.eval_pdf(wo, wi),
            Self::RoughPlastic(m) => m.eval_pdf(wo, wi),
        }
    }

    /// A direction from uniform numbers: `u_lobe` chooses the lobe, `u` the direction in it. `None` absorbs.
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], mode: Mode) -> Option<BsdfSample> {
        match self {
            Self::Diffuse(m) => m.sample(wo, u),
            Self::SmoothDielectric(m) => m.sample(wo, u_lobe, mode),
            Self::ThinDielectric(m) => m.sample(wo, u_lobe),
            Self::RoughDielectric(m) => m.sample(wo, u_lobe, u, mode),
            Self::SmoothConductor(m) => m.sample(wo),
            Self::RoughConductor(m) => m.sample(wo, u),
            Self::SmoothPlastic(m) => m.sample(wo, u_lobe, u),
            Self::RoughPlastic(m) => m.sample(wo, u_lobe, u),
        }
    }

    /// A colour in [0, 1] for the albedo layer that denoisers take: the reflected and transmitted fraction under light along
    /// the normal, without the energy that rough facets lose.
    pub fn albedo_hint(&self) -> Spectrum {
        let blend = |eta, reflected: Spectrum, transmitted: Spectrum| {
            let r = fresnel::dielectric(1.0, eta).reflectance;
            reflected * r + transmitted * (1.0 - r)
        };
        match self {
            Self::Diffuse(m) => m.reflectance,
            Self::SmoothDielectric(m) => blend(m.eta, m.specular_reflectance, m.specular_transmittance),
            Self::ThinDielectric(m) => blend(m.eta, m.specular_reflectance, m.specular_transmittance),
            Self::RoughDielectric(m) => blend(m.eta, m.specular_reflectance, m.specular_transmittance),
            Self::SmoothConductor(m) => m.specular_reflectance * fresnel::conductor(1.0, m.eta, m.k),
            Self::RoughConductor(m) => m.specular_reflectance * fresnel::conductor(1.0, m.eta, m.k),
            Self::SmoothPlastic(m) => m.albedo_hint(),
            Self::RoughPlastic(m) => m.albedo_hint(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closures_stay_small() {
        // They are copied to every path vertex.
        assert!(size_of::<Bsdf<'_>>() <= 96, "{}", size_of::<Bsdf<'_>>());
    }
}
