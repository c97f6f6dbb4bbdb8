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
use crate::light::{LightSample, Receiver};
use crate::scene::description::{Heuristic, IntegratorDescription, LightStrategy};
use crate::scene::{RayCounts, Scatterer, Scene, SurfacePoint};

/// Path tracing from the eye.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer {
    pub(super) light: LightStrategy,
    pub(super) heuristic: Heuristic,
    max_depth: u32,
    pub(super) roulette: Roulette,
    pub(super) hide_emitters: bool,
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
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure {
    pub position: Vec3,
    /// The normal there, as the choice of lights sees it.
    pub normal: Vec3,
    /// Density per solid angle of the direction taken; `None` where no connection could have taken it.
    pub pdf: Option<f32>,
}

/// A walk on its way to its next vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    pub ray: Ray,
    pub throughput: Spectrum,
    /// Product of the relative indices of refraction: undoes, for roulette, the scaling of radiance that refraction out
    /// of the medium will undo anyway.
    pub eta: f32,
    pub departure: Departure,
    pub sampler: Sampler,
}

/// A light chosen at a vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Connection {
    /// From the vertex to the light.
    pub ray: Ray,
    /// What it adds to the walk's radiance where nothing is in the way.
    pub contribution: Spectrum,
}

/// What a vertex brings.
pub(super) struct Arrival {
    /// What the walk adds by having run into a light.
    pub emitted: Spectrum,
    pub connection: Option<Connection>,
    /// Whether the walk goes on.
    pub goes_on: bool,
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

impl Departure {
    fn receiver(&self) -> Receiver {
        Receiver { position: self.position, normal: self.normal }
    }
}

impl Walk {
    /// A walk along a camera ray.
    pub fn new(ray: Ray, sampler: Sampler) -> Self {
        Self {
            ray,
            throughput: Spectrum::ONE,
            eta: 1.0,
            departure: Departure { position: ray.origin, normal: Vec3::ZERO, pdf: None },
            sampler,
        }
    }
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

    /// Edges that a path may have.
    pub(super) fn max_depth(&self) -> u32 {
        self.max_depth
    }

    /// An estimate of the radiance that arrives along a camera ray of unit direction.
    pub fn radiance(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: Sampler,
        counts: &mut WalkCounts,
        observer: &mut impl PathObserver,
    ) -> Spectrum {
        let mut radiance = Spectrum::ZERO;
        let mut walk = Walk::new(ray, sampler);
        for depth in 1..=self.max_depth {
            counts.edges += 1;
            let u = || walk.sampler.next_1d();
            let point = if depth < self.max_depth {
                scene.intersect(&walk.ray, &mut counts.rays, u)
            } else {
                let (hit, lit) = scene.light_hit(&walk.ray, &mut counts.rays);
                if !lit {
                    break;
                }
                hit.and_then(|hit| scene.point(&walk.ray, &hit, &mut counts.rays, u))
            };
            let arrival = self.arrive(scene, 0, depth, &mut walk, point.as_ref(), observer);
            radiance += arrival.emitted;
            if let Some(connection) = arrival.connection {
                radiance += connection.contribution * scene.transmittance(&connection.ray, &mut counts.rays);
            }
            if !arrival.goes_on {
                break;
            }
        }
        radiance
    }

    /// What walk number `path` does where its edge number `depth` ends: at a point, or out of the scene. Where it goes on, `walk` is
    /// on its way to the next vertex.
    pub(super) fn arrive(
        &self,
        scene: &Scene,
        path: u32,
        depth: u32,
        walk: &mut Walk,
        point: Option<&SurfacePoint>,
        observer: &mut impl PathObserver,
    ) -> Arrival {
        let mut arrival = Arrival { emitted: Spectrum::ZERO, connection: None, goes_on: false };
        let hidden = depth == 1 && self.hide_emitters;
        let Some(point) = point else {
            if !hidden {
                arrival.emitted = walk.throughput * self.escaped(scene, walk.ray.direction, &walk.departure);
            }
            return arrival;
        };
        let wo = -walk.ray.direction;
        if !hidden {
            arrival.emitted = walk.throughput * self.emitted(scene, point, wo, &walk.departure);
        }
        if depth >= self.max_depth {
            return arrival;
        }
        let scatterer = scene.scatterer(point, wo);
        observer.scatters(
            path,
            depth,
            point,
            &scatterer,
            (point.position - walk.departure.position).length(),
        );
        let connects = self.light != LightStrategy::Naive && scatterer.bsdf.connects();
        if connects {
            let vertex = Vertex { point, wo, scatterer: &scatterer, time: walk.ray.time };
            arrival.connection = self.connect(scene, &vertex, walk);
        }
        let (u_lobe, u) = (walk.sampler.next_1d(), walk.sampler.next_2d());
        let Some(sample) = scatterer.sample(wo, u_lobe, u, Mode::Radiance) else { return arrival };
        walk.throughput *= sample.weight;
        if walk.throughput.is_zero() {
            return arrival;
        }
        walk.eta *= sample.eta;
        let survival =
            self.roulette.survival_probability(depth, walk.throughput.max_element() * walk.eta * walk.eta);
        if survival < 1.0 {
            if walk.sampler.next_1d() >= survival {
                return arrival;
            }
            walk.throughput *= 1.0 / survival;
        }
        walk.departure = Departure {
            position: point.position,
            normal: scatterer.receiving_normal(),
            pdf: (connects && !sample.delta).then_some(sample.pdf),
        };
        walk.ray = Ray { time: walk.ray.time, ..Ray::new(point.leave(sample.wi), sample.wi) };
        arrival.goes_on = true;
        arrival
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
            scene.selection().probability(&departure.receiver(), index, point.primitive) * pdf
        });
        radiance * weight
    }

    /// Radiance from around the scene, for a walk that left it.
    #[inline]
    fn escaped(&self, scene: &Scene, direction: Vec3, departure: &Departure) -> Spectrum {
        scene.environments().fold(Spectrum::ZERO, |sum, (index, environment)| {
            let seen = environment.seen(direction);
            let weight =
                self.hit_weight(departure, || scene.selection().probability_around(index) * seen.pdf());
            sum + seen.radiance * weight
        })
    }

    /// A light chosen for a vertex, if it can give anything.
    #[inline]
    fn connect(&self, scene: &Scene, vertex: &Vertex<'_>, walk: &mut Walk) -> Option<Connection> {
        let Vertex { point, wo, scatterer, time } = *vertex;
        let (u_light, u) = (walk.sampler.next_1d(), walk.sampler.next_2d());
        let receiver = Receiver { position: point.position, normal: scatterer.receiving_normal() };
        let choice = scene.selection().sample(&receiver, u_light)?;
        let light = &scene.lights()[choice.light as usize];
        let (sample, _) = light.sample_part(point.position, choice.triangle, u, scene)?;
        let (scattering, pdf_bsdf) = scatterer.eval_pdf(wo, sample.direction, Mode::Radiance);
        if scattering.is_zero() {
            return None;
        }
        let pdf = choice.probability * sample.pdf;
        let weight = match self.light {
            LightStrategy::Mis if !sample.delta => mis::weight(self.heuristic, pdf, pdf_bsdf),
            _ => 1.0,
        };
        let contribution = walk.throughput * (scattering * sample.radiance * (weight / pdf));
        Some(Connection { ray: shadow_ray(point, &sample, time), contribution })
    }
}

/// Part of a shadow ray's length left out at its end, where the light itself is.
pub(super) const SHADOW_END: f32 = 1e-5;

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
