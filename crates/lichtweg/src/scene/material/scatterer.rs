//! A BSDF at a surface point, in its frame.

use lichtweg_ray::math::Vec3;

use crate::bsdf::{Bsdf, BsdfSample, Frame, Mode};
use crate::color::Spectrum;

/// A BSDF and the frame it lives in. Directions of its methods are in the world.
#[derive(Clone, Copy, Debug)]
pub struct Scatterer<'a> {
    /// The shading frame; left-handed on the back of a two-sided surface, which mirrors the material's front.
    pub frame: Frame,
    /// What scatters there.
    pub bsdf: Bsdf<'a>,
    /// The shading normal before bump and normal maps, if any tilted it: directions on different sides of the two normals
    /// carry nothing, or light would leak through the surface.
    pub(super) untilted: Option<Vec3>,
}

impl Scatterer<'_> {
    /// f |cos| and the density of sampling `wi` per solid angle, without delta lobes.
    #[inline]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3, mode: Mode) -> (Spectrum, f32) {
        let (local_wo, local_wi) = (self.frame.to_local(wo), self.frame.to_local(wi));
        if !self.consistent(wo, local_wo) || !self.consistent(wi, local_wi) {
            return (Spectrum::ZERO, 0.0);
        }
        self.bsdf.eval_pdf(local_wo, local_wi, mode)
    }

    /// Density per solid angle of sampling `wi`, without delta lobes. `wo` may be on another side than the one the scatterer was
    /// made for: walks that come the other way take the same material.
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.eval_pdf(wo, wi, Mode::Radiance).1
    }

    /// A direction in the world ([`BsdfSample::wi`] is then in the world too).
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], mode: Mode) -> Option<BsdfSample> {
        let local_wo = self.frame.to_local(wo);
        if !self.consistent(wo, local_wo) {
            return None;
        }
        let sample = self.bsdf.sample(local_wo, u_lobe, u, mode)?;
        let wi = self.frame.to_world(sample.wi);
        self.consistent(wi, sample.wi).then_some(BsdfSample { wi, ..sample })
    }

    /// The normal of the side that all light comes from which it scatters towards where it was looked at from; zero if light may come
    /// from either side.
    #[inline]
    pub fn receiving_normal(&self) -> Vec3 {
        if self.bsdf.transmits() { Vec3::ZERO } else { self.frame.normal }
    }

    /// The albedo, where this is Lambert's reflector with its shading normal as it was.
    #[inline]
    pub(crate) fn lambert(&self) -> Option<Spectrum> {
        match self.bsdf {
            Bsdf::Diffuse(diffuse) if self.untilted.is_none() => Some(diffuse.reflectance),
            _ => None,
        }
    }

    #[inline]
    fn consistent(&self, world: Vec3, local: Vec3) -> bool {
        self.untilted.is_none_or(|n| n.dot(world) * local.z > 0.0)
    }
}
