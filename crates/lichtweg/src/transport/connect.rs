//! The ways to make a path of two walks: one function for each, which gives the path's value over its density, and its
//! weight among all.
//!
//! What still has to be looked at waits in a [`ShadowQueue`]; of connections that are worth little, only some do.

use lichtweg_montecarlo::Sampler;
use lichtweg_ray::Ray;
use lichtweg_ray::wide::Float;

use super::bidirectional::{Bidirectional, Contribution, ContributionSink, Pair, Route};
use super::fault::{Fault, is_seeded};
use super::light_end::{LightEnd, LightStart, NextEvent, others_of_escape, others_of_hit};
use super::mis;
use super::sensor::Sensor;
use super::vertex::{Departure, Trail, Vertex};
use super::visibility::{self, Candidate, End, ShadowQueue, Way};
use crate::bsdf::Mode;
use crate::light::Receiver;
use crate::scene::{RayCounts, Scene};

/// A connection whose weighted value is this part of what the pixel will show is surely looked at.
const LARGE: f32 = 0.15;

/// Which connections of a weighted value `worth` to look at, by a uniform number, and the factor that makes up for those that are not:
/// what is small beside the noise that the pixel has anyway is not worth a ray (Veach 1997, section 10.4.1, efficiency-optimized
/// Russian roulette, with the threshold as a constant share of the pixel's mean).
#[inline(always)]
pub(super) fn keep<F: Float>(expected: F, worth: F, u: F) -> (F::Mask, F) {
    let one = F::splat(1.0);
    let probability = worth / (F::splat(LARGE) * expected);
    // NaN is looked at, too: it has to be told.
    let surely = !probability.lt(one);
    (surely | u.lt(probability), one.select(surely, one / probability))
}

/// Joins the walks of some pairs.
pub(super) struct Joiner<'p, 'a, S> {
    pub settings: &'p Bidirectional,
    pub scene: &'a Scene,
    pub sensor: &'p Sensor<'p>,
    pub pairs: &'p [Pair],
    pub queue: &'p mut ShadowQueue,
    pub sink: &'p mut S,
}

impl<S: ContributionSink> Joiner<'_, '_, S> {
    pub fn pair(&self, walk: u32) -> &Pair {
        &self.pairs[walk as usize]
    }

    /// A path to be looked at.
    #[inline]
    fn look(&mut self, ray: Ray, candidate: Candidate, way: impl FnOnce() -> Way) {
        let way = S::ROUTES.then(|| self.queue.keep(way()));
        self.queue.push(ray, Candidate { way, ..candidate });
    }

    /// Adds the paths that nothing is in the way of.
    pub fn flush(
        &mut self,
        light: &[Vertex<'_>],
        eye: &[Vertex<'_>],
        starts: &[Option<LightStart>],
        counts: &mut RayCounts,
    ) {
        self.queue.trace(self.scene, counts);
        for (candidate, visible) in self.queue.visible() {
            let &Candidate { sample, s, t, film, weight, .. } = candidate;
            let route = self.queue.way(candidate).and_then(|way| {
                let end = match &way.end {
                    End::Chosen(end) => end,
                    End::Start(walk) => &starts[*walk as usize].as_ref()?.end,
                };
                let (light, eye) = (Trail::new(light, way.light), Trail::new(eye, way.eye));
                Some(Route { end, lens: way.lens, light, eye })
            });
            self.sink.add(&Contribution {
                sample,
                s,
                t,
                film,
                value: candidate.value * visible,
                weight,
                route,
            });
        }
        self.queue.clear();
    }

    /// s = 0: the last vertex lies on a light.
    pub fn run_into_light(&mut self, from: &Departure, eye: Trail<'_, '_>) {
        let Some(vertex) = eye.last() else { return };
        let Some((light, area_light)) = self.scene.area_light(&vertex.point) else { return };
        let radiance = area_light.radiance(&vertex.point, vertex.wo, self.scene.textures());
        if radiance.is_zero() {
            return;
        }
        let Bidirectional { heuristic, .. } = *self.settings;
        let weight = if vertex.number == 1 {
            self.direct_weight()
        } else if is_seeded(Fault::Weights) {
            1.0
        } else {
            let once = self.settings.once();
            let lit = self.settings.lit();
            let others = others_of_hit(self.scene, light, vertex, &from.receiver(), heuristic, lit);
            mis::share(heuristic, once, 0.0, others)
        };
        let lens = self.pair(vertex.walk).ray.origin;
        self.sink.add(&Contribution {
            sample: vertex.walk,
            s: 0,
            t: vertex.number + 1,
            film: None,
            value: vertex.throughput * radiance,
            weight,
            route: Some(Route { end: &LightEnd::hit(light, vertex), lens, light: Trail::EMPTY, eye }),
        });
    }

    /// s = 0: the walk left the scene, towards the lights around it, after so many vertices.
    pub fn run_out_of_scene(&mut self, walk: u32, departure: &Departure, eye: Trail<'_, '_>, vertices: u32) {
        let direction = departure.ray.direction;
        for (light, environment) in self.scene.environments() {
            let seen = environment.seen(direction);
            let radiance = seen.radiance;
            if radiance.is_zero() {
                continue;
            }
            let Bidirectional { heuristic, .. } = *self.settings;
            let weight = match vertices {
                0 => self.direct_weight(),
                _ => {
                    let (pdf, once) = (seen.pdf(), self.settings.once());
                    let lit = self.settings.lit();
                    let others = others_of_escape(self.scene, light, departure, pdf, heuristic, lit);
                    mis::share(heuristic, once, 0.0, others)
                }
            };
            let lens = self.pair(walk).ray.origin;
            let end = &LightEnd::escaped(light, direction);
            self.sink.add(&Contribution {
                sample: walk,
                s: 0,
                t: vertices + 2,
                film: None,
                value: departure.throughput * radiance,
                weight,
                route: Some(Route { end, lens, light: Trail::EMPTY, eye }),
            });
        }
    }

    /// Of emitters that the camera sees directly.
    fn direct_weight(&self) -> f32 {
        if self.settings.hide_emitters { 0.0 } else { 1.0 }
    }

    /// s = 1: the last vertex and points on lights that are chosen for it.
    pub fn connect_to_light(&mut self, eye: Trail<'_, '_>, sampler: &mut Sampler) {
        let Some(vertex) = eye.last().filter(|v| v.scatterer.bsdf.connects()) else { return };
        for number in 0..self.settings.lights {
            let u_light = self.settings.stratified(number, sampler.next_1d());
            self.connect_to_one_light(eye, vertex, u_light, sampler);
        }
    }

    fn connect_to_one_light(
        &mut self,
        eye: Trail<'_, '_>,
        vertex: &Vertex<'_>,
        u_light: f32,
        sampler: &mut Sampler,
    ) {
        let (u, u_keep) = (sampler.next_2d(), sampler.next_1d());
        let Some(event) = NextEvent::sample(self.scene, &vertex.receiver(), u_light, u) else { return };
        let scattering = vertex.scatter(event.sample.direction, Mode::Radiance);
        if scattering.value.is_zero() {
            return;
        }
        let heuristic = self.settings.heuristic;
        let once = self.settings.once();
        let light = match event.sample.delta {
            true => 0.0,
            false => once * scattering.pdf / event.pdf(),
        };
        let arriving = event.emission_over_connection(scattering.cos);
        let others = arriving * vertex.others.root(heuristic, scattering.pdf_back);
        let weight = mis::share(heuristic, self.settings.lit(), light, others);
        let density = event.pdf() * self.settings.lights as f32;
        let value = vertex.throughput * scattering.value * event.sample.radiance * (1.0 / density);
        let &Pair { ref ray, expected, .. } = self.pair(vertex.walk);
        let (kept, compensation) = keep(expected, (value * weight).max_element(), u_keep);
        if !kept {
            return;
        }
        let lens = ray.origin;
        let ray = visibility::to_light(&vertex.point, &event.sample, ray.time);
        let candidate = Candidate {
            sample: vertex.walk,
            s: 1,
            t: vertex.number + 1,
            film: None,
            value: value * compensation,
            weight,
            way: None,
        };
        let way = || Way { lens, end: End::Chosen(event.end), light: Trail::NONE, eye: eye.index() };
        self.look(ray, candidate, way);
    }

    /// t = 1: the last vertex and a point on the lens.
    pub fn connect_to_lens(&mut self, light: Trail<'_, '_>, sampler: &mut Sampler) {
        let Some(vertex) = light.last().filter(|v| v.scatterer.bsdf.connects()) else { return };
        let time = self.pair(vertex.walk).ray.time;
        let camera = self.sensor.camera.at(time);
        let sensor = self.sensor.with(&camera);
        let (u_lens, u_keep) = (sampler.next_2d(), sampler.next_1d());
        let lens = camera.lens_point(u_lens);
        let Some((look, distance_squared)) = sensor.look_at(lens, vertex.point.position) else { return };
        let scattering = vertex.scatter(look.to_lens, Mode::Importance);
        if scattering.value.is_zero() {
            return;
        }
        let heuristic = self.settings.heuristic;
        let from_eye = look.pdf * scattering.cos / distance_squared;
        let others = from_eye * vertex.others.root(heuristic, scattering.pdf_back);
        // t = 0: the walk goes on into the lens.
        let once = self.settings.once();
        let hit = camera
            .lens_pdf()
            .map_or(0.0, |lens_pdf| once * (scattering.pdf * look.cos / (distance_squared * lens_pdf)));
        let weight = mis::share(heuristic, once, others, hit);
        let value = vertex.throughput * scattering.value * (look.pdf / distance_squared);
        let expected = sensor.expected(look.film);
        let (kept, compensation) = keep(expected, (value * weight).max_element(), u_keep);
        if !kept {
            return;
        }
        let candidate = Candidate {
            sample: vertex.walk,
            s: vertex.number + 1,
            t: 1,
            film: Some(look.film),
            value: value * compensation,
            weight,
            way: None,
        };
        let way = || Way { lens, end: End::Start(vertex.walk), light: light.index(), eye: Trail::NONE };
        self.look(look.shadow_ray(&vertex.point, time), candidate, way);
    }

    /// t = 0: the walk from the light may run into the lens, after so many vertices.
    pub fn run_into_lens(
        &mut self,
        walk: u32,
        start: &LightStart,
        departure: &Departure,
        light: Trail<'_, '_>,
    ) {
        let time = departure.ray.time;
        let camera = self.sensor.camera.at(time);
        let sensor = self.sensor.with(&camera);
        let Some(lens_pdf) = camera.lens_pdf() else { return };
        let Some(lens) = camera.hit_lens(&departure.ray) else { return };
        let Some(look) = sensor.look(lens, -departure.ray.direction) else { return };
        // A walk's first edge leads straight from the light to the lens: seen, but for its variance.
        let direct = light.is_empty();
        if direct && !S::UNWEIGHTED {
            return;
        }
        let ray = match (light.last(), start.emission.point) {
            (Some(vertex), _) if sensor.look_at(lens, vertex.point.position).is_some() => {
                look.shadow_ray(&vertex.point, time)
            }
            (None, Some(point)) => look.shadow_ray(&point, time),
            (None, None) if departure.infinite => look.shadow_ray_from_far(time),
            _ => return,
        };
        let distance_squared = (lens - departure.position).length_squared();
        let (there, back) = match departure.infinite {
            true => (look.cos, 1.0),
            false => (look.cos / distance_squared, departure.cos / distance_squared),
        };
        let Bidirectional { heuristic, .. } = *self.settings;
        let mut others = departure.arrive(there, back);
        let once = self.settings.once();
        others.connected *= once;
        let weight = match direct {
            true => 0.0,
            false => mis::share(heuristic, once, lens_pdf * others.root(heuristic, look.pdf), 0.0),
        };
        let candidate = Candidate {
            sample: walk,
            s: light.len() + 2,
            t: 0,
            film: Some(look.film),
            value: departure.throughput * (lens_pdf * look.pdf / look.cos),
            weight,
            way: None,
        };
        let way = || Way { lens, end: End::Start(walk), light: light.index(), eye: Trail::NONE };
        self.look(ray, candidate, way);
    }

    /// s = t = 1: a point on the lens and one on a light, of weight zero; none of a light at a point or in a direction.
    pub fn connect_ends(&mut self, walk: u32, sampler: &mut Sampler) {
        let time = self.pair(walk).ray.time;
        let camera = self.sensor.camera.at(time);
        let sensor = self.sensor.with(&camera);
        let lens = camera.lens_point(sampler.next_2d());
        let (u_light, u) = (sampler.next_1d(), sampler.next_2d());
        let event = NextEvent::sample(self.scene, &Receiver::open(lens), u_light, u);
        let Some(event) = event.filter(|e| !e.sample.delta) else { return };
        let Some(look) = sensor.look(lens, event.sample.direction) else { return };
        let ray = match event.end.point {
            Some(point) if sensor.look_at(lens, point.position).is_some() => look.shadow_ray(&point, time),
            Some(_) => return,
            None => look.shadow_ray_from_far(time),
        };
        let value = event.sample.radiance * (look.pdf / event.pdf());
        if value.is_zero() {
            return;
        }
        let candidate =
            Candidate { sample: walk, s: 1, t: 1, film: Some(look.film), value, weight: 0.0, way: None };
        let way = || Way { lens, end: End::Chosen(event.end), light: Trail::NONE, eye: Trail::NONE };
        self.look(ray, candidate, way);
    }
}
