//! Walks that begin at a light: choose a light, a point x on it by p(x), and a direction by p(direction | x); the weight is
//! then the light's power, but for what its texture and the choice of lights leave.
//!
//! Densities with which a walk begins come in two factors ([`EmissionDensity`]). A light at a finite place first has a point,
//! then a direction. A light infinitely far away first has a direction, then a point on the disk across that direction that
//! covers the scene (Veach 1997, section 8.2.2.1, and Pharr, Jakob and Humphreys 2023, section 12.5.3): what is chosen first is
//! thus measured per solid angle, what follows per area.

use std::f32::consts::PI;

use lichtweg_montecarlo::warp;
use lichtweg_ray::Ray;
use lichtweg_ray::math::Vec3;
use lichtweg_ray::wide::Float;

use super::{AreaLight, Light, LightSample};
use crate::bsdf::Frame;
use crate::color::Spectrum;
use crate::lanes;
use crate::scene::{Scene, SurfacePoint};

/// The densities with which walks begin at a light in a given way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionDensity {
    /// Of the point, per area; of the direction, per solid angle, where the light is infinitely far. 1 for the only point or
    /// direction of a delta light. Without the probability of the light.
    pub start: f32,
    /// Of the direction, per solid angle; of the ray's place, per area across it, where the light is infinitely far.
    pub leaving: f32,
}

/// The beginning of a walk.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// The ray of light; for a light infinitely far it starts outside of the scene.
    pub ray: Ray,
    /// Radiance times cosine over both densities: the power that the walk carries.
    pub power: Spectrum,
    /// With which densities.
    pub density: EmissionDensity,
    /// The point on the light, if it is a shape.
    pub point: Option<SurfacePoint>,
}

/// A sphere around everything that light can meet.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// Its centre.
    pub center: Vec3,
    /// Its radius.
    pub radius: f32,
}

impl Surroundings {
    /// Density per area of points on the disk across a direction.
    #[inline]
    pub fn disk_pdf(&self) -> f32 {
        warp::UNIFORM_DISK_PDF / (self.radius * self.radius)
    }

    /// A ray in a direction, from a point on the disk before the scene.
    fn ray(&self, direction: Vec3, u: [f32; 2]) -> Ray {
        let [x, y] = warp::uniform_disk(u);
        let across = Frame::from_normal(direction).to_world(Vec3::new(x, y, -1.0));
        Ray::new(self.center + across * self.radius, direction)
    }
}

impl Light {
    /// Whether it is infinitely far away.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Directional(_) | Self::Environment(_))
    }

    /// Begins a walk by two uniform pairs: for the place and for the direction. `None` where nothing is emitted.
    pub fn emit(&self, u_place: [f32; 2], u_direction: [f32; 2], scene: &Scene) -> Option<Emission> {
        let delta = |position: Vec3, direction: Vec3, intensity: Spectrum, pdf: f32| Emission {
            ray: Ray::new(position, direction),
            power: intensity / pdf,
            density: EmissionDensity { start: 1.0, leaving: pdf },
            point: None,
        };
        let surroundings = scene.surroundings();
        let infinite = |direction: Vec3, radiance: Spectrum, pdf: f32| Emission {
            ray: surroundings.ray(direction, u_place),
            power: radiance / (pdf * surroundings.disk_pdf()),
            density: EmissionDensity { start: pdf, leaving: surroundings.disk_pdf() },
            point: None,
        };
        let emission = match self {
            Self::Area(light) => light.emit(u_place, u_direction, scene)?,
            Self::Point(light) => {
                let direction = Vec3::from_array(warp::uniform_sphere(u_direction));
                delta(light.position, direction, light.intensity, warp::UNIFORM_SPHERE_PDF)
            }
            Self::Spot(light) => {
                let local = Vec3::from_array(warp::uniform_cone(u_direction, light.one_minus_cos_cutoff()));
                let direction = Frame::from_normal(light.axis).to_world(local);
                let pdf = warp::uniform_cone_pdf(light.one_minus_cos_cutoff());
                delta(light.position, direction, light.intensity * light.falloff(local.z), pdf)
            }
            Self::Directional(light) => infinite(light.direction, light.irradiance, 1.0),
            Self::Environment(light) => {
                let sample = light.sample(u_direction)?;
                infinite(-sample.direction, sample.radiance, sample.pdf)
            }
        };
        (!emission.power.is_zero()).then_some(emission)
    }

    /// The densities with which [`Light::emit`] begins a walk that reaches a receiver as `sample` does, whose point on the
    /// light, if it is a shape, is `point`.
    #[inline]
    pub fn emission_density(
        &self,
        sample: &LightSample,
        point: Option<&SurfacePoint>,
        scene: &Scene,
    ) -> EmissionDensity {
        match (self, point) {
            (Self::Area(light), Some(point)) => light.emission_density(point, -sample.direction, scene),
            (Self::Environment(_), _) => {
                EmissionDensity { start: sample.pdf, leaving: scene.surroundings().disk_pdf() }
            }
            _ => self.delta_emission_density(scene),
        }
    }

    /// The same of a light at a single point or in a single direction.
    #[inline]
    pub fn delta_emission_density(&self, scene: &Scene) -> EmissionDensity {
        let leaving = match self {
            Self::Area(_) | Self::Environment(_) => 0.0,
            Self::Point(_) => warp::UNIFORM_SPHERE_PDF,
            Self::Spot(light) => warp::uniform_cone_pdf(light.one_minus_cos_cutoff()),
            Self::Directional(_) => scene.surroundings().disk_pdf(),
        };
        EmissionDensity { start: 1.0, leaving }
    }
}

impl AreaLight {
    /// See [`Light::emit`]: a point even over the area, a direction by the cosine to the geometric normal.
    fn emit(&self, u_place: [f32; 2], [mut u, v]: [f32; 2], scene: &Scene) -> Option<Emission> {
        let (point, pdf_area) = self.point_by_area(u_place, scene.form(self.shape))?;
        let mut normal = point.geometric_normal;
        if self.two_sided {
            if u >= 0.5 {
                normal = -normal;
            }
            u = 2.0 * u % 1.0;
        }
        let local = Vec3::from_array(warp::cosine_hemisphere([u, v]));
        let direction = Frame::from_normal(normal).to_world(local);
        let leaving = self.pdf_leaving(local.z);
        if leaving <= 0.0 {
            return None;
        }
        let radiance =
            self.radiance(&point, direction, scene.textures()) * scene.opacity_at(&point, direction);
        Some(Emission {
            ray: Ray::new(point.leave(direction), direction),
            // The cosine and the density leave pi, or 2 pi where there are two sides.
            power: radiance * (local.z / (leaving * pdf_area)),
            density: EmissionDensity { start: pdf_area, leaving },
            point: Some(point),
        })
    }

    /// The densities with which walks begin at a point on this light in a direction.
    #[inline]
    pub fn emission_density(&self, point: &SurfacePoint, direction: Vec3, scene: &Scene) -> EmissionDensity {
        EmissionDensity {
            start: self.pdf_area(point, scene.form(self.shape)),
            leaving: self.pdf_leaving(point.geometric_normal.dot(direction)),
        }
    }

    #[inline]
    fn pdf_leaving(&self, cos: f32) -> f32 {
        pdf_leaving(self.two_sided, cos)
    }
}

/// Density per solid angle with which walks leave an area light in a direction at an angle to the outside normal whose cosine is
/// given.
#[inline(always)]
pub(crate) fn pdf_leaving<F: Float>(two_sided: F::Mask, cos: F) -> F {
    (cos.abs() * F::splat(0.5 / PI)).select(two_sided, lanes::warp::cosine_hemisphere_pdf(cos))
}
