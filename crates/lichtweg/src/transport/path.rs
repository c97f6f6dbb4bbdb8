//! Path tracing from the eye (Kajiya 1986), in the lecture's three stages.
//!
//! A walk starts at the camera with throughput one, follows directions that the BSDF proposes, and multiplies its throughput
//! by their weights. Light joins it in one of three ways ([`LightStrategy`]):
//!
//! - *naive*: by running into a light. Lights at a point or in a single direction are never hit, and so are missing.
//! - *nee*: next-event estimation. Every vertex is connected to a point chosen on a light; a light that the walk runs into
//!   counts only where no connection could have found it: as seen by the camera, or after a delta scattering.
//! - *mis*: both, each weighted by the densities with which the two would have made the same path (Veach and Guibas 1995).
//!
//! Surfaces with holes are matters of visibility, not of scattering: passing through one adds no edge to the path, and
//! connections see through holes, too.

use lichtweg_montecarlo::{Roulette, Sampler};
use lichtweg_ray::Ray;
use lichtweg_ray::math::Vec3;

use super::{PathObserver, mis};
use crate::bsdf::Mode;
use crate::color::Spectrum;
use crate::light::LightSample;
use crate::scene::description::{Heuristic, IntegratorDescription, LightStrategy};
use crate::scene::{RayCounts, Scatterer, Scene, SurfacePoint};

/// Path tracing from the eye.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer {
    light: LightStrategy,
    heuristic: Heuristic,
    max_depth: u32,
    roulette: Roulette,
    hide_emitters: bool,
}

/// What a walk has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WalkCounts {
    /// Ray queries.
    pub rays: RayCounts,
    /// Edges of eye paths, the last one to a light or out of the scene included.
    pub edges: u64,
}

impl WalkCounts {
    /// Adds those of another thread.
    pub fn merge(&mut self, other: &Self) {
        self.rays.merge(&other.rays);
        self.edges += other.edges;
    }
}

/// The last scattering of a walk, for what it runs into next.
#[derive(Clone, Copy)]
struct Departure {
    position: Vec3,
    /// Density per solid angle of the direction taken; `None` where no connection could have taken it.
    pdf: Option<f32>,
}

/// A point at which a walk scatters.
#[derive(Clone, Copy)]
struct Vertex<'a> {
    point: &'a SurfacePoint,
    /// The direction the walk came from.
    wo: Vec3,
    scatterer: &'a Scatterer<'a>,
    time: f32,
}

impl PathTracer {
    /// From a scene's wishes.
    pub fn new(description: &IntegratorDescription) -> Self {
        Self {
            light: description.light,
            heuristic: description.heuristic,
            max_depth: description.max_depth.unwrap_or(u32::MAX),
            roulette: match description.roulette.start_depth {
                Some(start_depth) => Roulette { start_depth, ..Roulette::default() },
                None => Roulette::OFF,
            },
            hide_emitters: description.hide_emitters,
        }
    }

    /// An estimate of the radiance that arrives along a camera ray of unit direction.
    pub fn radiance(
        &self,
        scene: &Scene,
        mut ray: Ray,
        sampler: &mut Sampler,
        counts: &mut WalkCounts,
        observer: &mut impl PathObserver,
    ) -> Spectrum {
        let mut radiance = Spectrum::ZERO;
        if self.max_depth == 0 {
            return radiance;
        }
        let mut throughput = Spectrum::ONE;
        // Product of the relative indices of refraction: undoes, for roulette, the scaling of radiance that refraction out of
        // the medium will undo anyway.
        let mut eta = 1.0;
        let mut departure = Departure { position: ray.origin, pdf: None };
        for depth in 1.. {
            counts.edges += 1;
            let hidden = depth == 1 && self.hide_emitters;
            let Some(point) = scene.intersect(&ray, &mut counts.rays, || sampler.next_1d()) else {
                if !hidden {
                    radiance += throughput * self.escaped(scene, ray.direction, &departure);
                }
                break;
            };
            let wo = -ray.direction;
            if !hidden {
                radiance += throughput * self.emitted(scene, &point, wo, &departure);
            }
            if depth >= self.max_depth {
                break;
            }
            let scatterer = scene.scatterer(&point, wo);
            observer.scatters(depth, &point, &scatterer, (point.position - departure.position).length());
            let connects = self.light != LightStrategy::Naive && scatterer.bsdf.connects();
            if connects {
                let vertex = Vertex { point: &point, wo, scatterer: &scatterer, time: ray.time };
                radiance += throughput * self.connected(scene, &vertex, sampler, counts);
            }
            let (u_lobe, u) = (sampler.next_1d(), sampler.next_2d());
            let Some(sample) = scatterer.sample(wo, u_lobe, u, Mode::Radiance) else { break };
            throughput *= sample.weight;
            if throughput.is_zero() {
                break;
            }
            eta *= sample.eta;
            let survival = self.roulette.survival_probability(depth, throughput.max_element() * eta * eta);
            if survival < 1.0 {
                if sampler.next_1d() >= survival {
                    break;
                }
                throughput *= 1.0 / survival;
            }
            departure = Departure {
                position: point.position,
                pdf: (connects && !sample.delta).then_some(sample.pdf),
            };
            ray = Ray { time: ray.time, ..Ray::new(point.leave(sample.wi), sample.wi) };
        }
        radiance
    }

    /// Weight of a light that the walk ran into, given the density with which a connection would have found it.
    #[inline]
    fn hit_weight(&self, departure: &Departure, pdf_light: impl FnOnce() -> f32) -> f32 {
        match departure.pdf {
            None => 1.0,
            Some(_) if self.light == LightStrategy::Nee => 0.0,
            Some(pdf) => mis::weight(self.heuristic, pdf, pdf_light()),
        }
    }

    /// Radiance of the surface that the walk hit.
    #[inline]
    fn emitted(&self, scene: &Scene, point: &SurfacePoint, wo: Vec3, departure: &Departure) -> Spectrum {
        let Some((index, light)) = scene.area_light(point) else { return Spectrum::ZERO };
        let radiance = light.radiance(point, wo, scene.textures());
        if radiance.is_zero() {
            return radiance;
        }
        let weight = self.hit_weight(departure, || {
            let pdf = light.pdf(departure.position, point, wo, scene.form(point.shape));
            scene.selection().probability(index) * pdf
        });
        radiance * weight
    }

    /// Radiance from around the scene, for a walk that left it.
    #[inline]
    fn escaped(&self, scene: &Scene, direction: Vec3, departure: &Departure) -> Spectrum {
        scene.environments().fold(Spectrum::ZERO, |sum, (index, environment)| {
            let weight = self
                .hit_weight(departure, || scene.selection().probability(index) * environment.pdf(direction));
            sum + environment.radiance(direction) * weight
        })
    }

    /// Light that reaches the vertex straight from a light chosen for it, scattered towards where the walk came from.
    #[inline]
    fn connected(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        sampler: &mut Sampler,
        counts: &mut WalkCounts,
    ) -> Spectrum {
        let Vertex { point, wo, scatterer, time } = *vertex;
        let (u_light, u) = (sampler.next_1d(), sampler.next_2d());
        let Some((index, probability, _)) = scene.selection().sample(u_light) else { return Spectrum::ZERO };
        let Some(sample) = scene.lights()[index as usize].sample(point.position, u, scene) else {
            return Spectrum::ZERO;
        };
        let (scattering, pdf_bsdf) = scatterer.eval_pdf(wo, sample.direction, Mode::Radiance);
        if scattering.is_zero() {
            return Spectrum::ZERO;
        }
        let transmittance = scene.transmittance(&shadow_ray(point, &sample, time), &mut counts.rays);
        if transmittance == 0.0 {
            return Spectrum::ZERO;
        }
        let pdf = probability * sample.pdf;
        let weight = match self.light {
            LightStrategy::Mis if !sample.delta => mis::weight(self.heuristic, pdf, pdf_bsdf),
            _ => 1.0,
        };
        scattering * sample.radiance * (transmittance * weight / pdf)
    }
}

/// Part of a shadow ray's length left out at its end, where the light itself is.
const SHADOW_END: f32 = 1e-5;

/// The ray from a vertex to a point on a light.
#[inline]
fn shadow_ray(point: &SurfacePoint, sample: &LightSample, time: f32) -> Ray {
    let origin = point.leave(sample.direction);
    let ray = match sample.target {
        Some(target) => Ray { tfar: 1.0 - SHADOW_END, ..Ray::new(origin, target - origin) },
        None => Ray::new(origin, sample.direction),
    };
    Ray { time, ..ray }
}
