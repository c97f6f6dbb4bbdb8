//! The ways to make a path of two walks: one function for each, which gives the path's value over its density, and its
//! weight among all.
//!
//! What still has to be looked at waits in a [`ShadowQueue`]; of connections that are worth little, only some do.

use lichtweg_montecarlo::Sampler;

use super::bidirectional::{Bidirectional, Contribution, ContributionSink, Pair};
use super::fault::{Fault, is_seeded};
use super::light_end::{LightEnd, LightStart, NextEvent, others_of_escape, others_of_hit};
use super::mis::raise;
use super::sensor::Sensor;
use super::vertex::{Departure, Trail, Vertex};
use super::visibility::{self, Candidate, End, ShadowQueue};
use crate::bsdf::Mode;
use crate::color::Spectrum;
use crate::scene::{RayCounts, Scene};

/// Weight of a strategy with a factor c, given the sums over the others.
#[inline]
fn weight(own: f64, light: f64, eye: f64) -> f32 {
    (own / (own + light + eye)) as f32
}

/// A connection whose weighted value is this part of what the pixel will show is surely looked at.
const LARGE: f32 = 0.15;

/// Decides which connections to look at: what is small beside the noise that the pixel has anyway is not worth a ray (Veach 1997,
/// section 10.4.1, efficiency-optimized Russian roulette, with the threshold as a constant share of the pixel's mean). Connections of
/// one vertex are chosen together by one random number, so that their number varies by less than one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Selection {
    /// Worth that surely deserves a ray.
    sure: f32,
    /// The sum of probabilities so far, modulo one.
    position: f32,
}

impl Selection {
    /// For a vertex that contributes to a pixel of about this radiance, by a uniform number.
    #[inline]
    pub fn new(expected: f32, u: impl FnOnce() -> f32) -> Self {
        let sure = LARGE * expected;
        Self { sure, position: if sure > 0.0 { u() } else { 0.0 } }
    }

    /// Whether to look if a connection of a weighted value is free: the factor that makes up for those that are not looked at.
    #[inline]
    pub fn keep(&mut self, worth: f32) -> Option<f32> {
        let probability = worth / self.sure;
        if probability >= 1.0 || probability.is_nan() {
            return Some(1.0);
        }
        self.position += probability;
        (self.position >= 1.0).then(|| {
            self.position -= 1.0;
            1.0 / probability
        })
    }
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
    fn pair(&self, walk: u32) -> &Pair {
        &self.pairs[walk as usize]
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
            let &Candidate { sample, s, t, film, weight, lens, .. } = candidate;
            let end = match candidate.end {
                End::Chosen(number) => self.queue.chosen(number),
                End::Start(walk) => match &starts[walk as usize] {
                    Some(start) => &start.end,
                    None => continue,
                },
            };
            self.sink.add(&Contribution {
                sample,
                s,
                t,
                film,
                value: candidate.value * visible,
                weight,
                end,
                lens,
                light: Trail::new(light, candidate.light),
                eye: Trail::new(eye, candidate.eye),
            });
        }
        self.queue.clear();
    }

    /// s = 0: the last vertex lies on a light.
    pub fn run_into_light(&mut self, eye: Trail<'_, '_>) {
        let Some(vertex) = eye.last() else { return };
        let Some((light, area_light)) = self.scene.area_light(&vertex.point) else { return };
        let radiance = area_light.radiance(&vertex.point, vertex.wo, self.scene.textures());
        if radiance.is_zero() {
            return;
        }
        let Bidirectional { heuristic, .. } = *self.settings;
        let weight = match eye.before().last() {
            None => self.direct_weight(),
            Some(_) if is_seeded(Fault::Weights) => 1.0,
            Some(receiver) => {
                let once = self.settings.once();
                let others = others_of_hit(self.scene, light, vertex, &receiver.point, heuristic, once);
                weight(once, 0.0, others)
            }
        };
        self.sink.add(&Contribution {
            sample: vertex.walk,
            s: 0,
            t: eye.len() + 1,
            film: None,
            value: vertex.throughput * radiance,
            weight,
            end: &LightEnd::hit(light, vertex),
            lens: self.pair(vertex.walk).ray.origin,
            light: Trail::EMPTY,
            eye,
        });
    }

    /// s = 0: the walk left the scene, towards the lights around it.
    pub fn run_out_of_scene(&mut self, walk: u32, departure: &Departure, eye: Trail<'_, '_>) {
        let direction = departure.ray.direction;
        for (light, environment) in self.scene.environments() {
            let radiance = environment.radiance(direction);
            if radiance.is_zero() {
                continue;
            }
            let Bidirectional { heuristic, .. } = *self.settings;
            let weight = match eye.last() {
                None => self.direct_weight(),
                Some(_) => {
                    let (pdf, once) = (environment.pdf(direction), self.settings.once());
                    weight(once, 0.0, others_of_escape(self.scene, light, departure, pdf, heuristic, once))
                }
            };
            self.sink.add(&Contribution {
                sample: walk,
                s: 0,
                t: eye.len() + 2,
                film: None,
                value: departure.throughput * radiance,
                weight,
                end: &LightEnd::escaped(light, direction),
                lens: self.pair(walk).ray.origin,
                light: Trail::EMPTY,
                eye,
            });
        }
    }

    /// Of emitters that the camera sees directly.
    fn direct_weight(&self) -> f32 {
        if self.settings.hide_emitters { 0.0 } else { 1.0 }
    }

    /// s = 1: the last vertex and a point on a light that is chosen for it.
    pub fn connect_to_light(&mut self, eye: Trail<'_, '_>, sampler: &mut Sampler) {
        let Some(vertex) = eye.last().filter(|v| v.scatterer.bsdf.connects()) else { return };
        let Some(event) = NextEvent::sample(self.scene, vertex.point.position, sampler) else { return };
        let scattering = vertex.scatter(event.sample.direction, Mode::Radiance);
        if scattering.value.is_zero() {
            return;
        }
        let heuristic = self.settings.heuristic;
        let once = self.settings.once();
        let light = match event.sample.delta {
            true => 0.0,
            false => once * raise(heuristic, scattering.pdf / event.pdf()),
        };
        let arriving = event.emission_over_connection(scattering.cos);
        let weight = weight(once, light, vertex.others.sum(heuristic, arriving, scattering.pdf_back));
        let value = vertex.throughput * scattering.value * event.sample.radiance * (1.0 / event.pdf());
        let pair = self.pair(vertex.walk);
        let mut selection = Selection::new(pair.expected, || sampler.next_1d());
        let Some(compensation) = selection.keep((value * weight).max_element()) else { return };
        let ray = visibility::to_light(&vertex.point, &event.sample, pair.ray.time);
        let candidate = Candidate {
            sample: vertex.walk,
            s: 1,
            t: eye.len() + 1,
            film: None,
            value: value * compensation,
            weight,
            lens: pair.ray.origin,
            end: self.queue.choose(event.end),
            light: Trail::NONE,
            eye: eye.index(),
        };
        self.queue.push(ray, candidate);
    }

    /// t = 1: the last vertex and a point on the lens.
    pub fn connect_to_lens(&mut self, light: Trail<'_, '_>, sampler: &mut Sampler) {
        let Some(vertex) = light.last().filter(|v| v.scatterer.bsdf.connects()) else { return };
        let time = self.pair(vertex.walk).ray.time;
        let camera = self.sensor.camera.at(time);
        let sensor = self.sensor.with(&camera);
        let lens = camera.lens_point(sampler.next_2d());
        let Some((look, distance_squared)) = sensor.look_at(lens, vertex.point.position) else { return };
        let scattering = vertex.scatter(look.to_lens, Mode::Importance);
        if scattering.value.is_zero() {
            return;
        }
        let heuristic = self.settings.heuristic;
        let from_eye = look.pdf * scattering.cos / distance_squared;
        let light_sum = vertex.others.sum(heuristic, from_eye, scattering.pdf_back);
        // t = 0: the walk goes on into the lens.
        let once = self.settings.once();
        let eye_sum = camera.lens_pdf().map_or(0.0, |lens_pdf| {
            let ratio = scattering.pdf * look.cos / (distance_squared * lens_pdf);
            once * raise(heuristic, ratio)
        });
        let weight = weight(once, light_sum, eye_sum);
        let value = vertex.throughput * scattering.value * (look.pdf / distance_squared);
        let mut selection = Selection::new(sensor.expected(look.film), || sampler.next_1d());
        let Some(compensation) = selection.keep((value * weight).max_element()) else { return };
        let candidate = Candidate {
            sample: vertex.walk,
            s: light.len() + 1,
            t: 1,
            film: Some(look.film),
            value: value * compensation,
            weight,
            lens,
            end: End::Start(vertex.walk),
            light: light.index(),
            eye: Trail::NONE,
        };
        self.queue.push(look.shadow_ray(&vertex.point, time), candidate);
    }

    /// t = 0: the walk from the light may run into the lens.
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
        let mut others = departure.arrive(heuristic, there, back);
        let once = self.settings.once();
        others.connected *= once;
        let weight = match direct {
            true => 0.0,
            false => weight(once, others.sum(heuristic, lens_pdf, look.pdf), 0.0),
        };
        let candidate = Candidate {
            sample: walk,
            s: light.len() + 2,
            t: 0,
            film: Some(look.film),
            value: departure.throughput * (lens_pdf * look.pdf / look.cos),
            weight,
            lens,
            end: End::Start(walk),
            light: light.index(),
            eye: Trail::NONE,
        };
        self.queue.push(ray, candidate);
    }

    /// s, t >= 2: a vertex of each walk. The value, for all the walks that the walk from the eye is joined with, and the weight; `None`
    /// where nothing goes from one to the other.
    pub fn connect(&self, y: &Vertex<'_>, z: &Vertex<'_>) -> Option<(Spectrum, f32)> {
        let along = y.point.position - z.point.position;
        let distance_squared = along.length_squared();
        let direction = along / distance_squared.sqrt();
        let at_eye = z.scatter(direction, Mode::Radiance);
        if at_eye.value.is_zero() {
            return None;
        }
        let at_light = y.scatter(-direction, Mode::Importance);
        if at_light.value.is_zero() {
            return None;
        }
        let heuristic = self.settings.heuristic;
        let per_area = 1.0 / distance_squared;
        let light_sum = y.others.sum(heuristic, at_eye.pdf * at_light.cos * per_area, at_light.pdf_back);
        let eye_sum = z.others.sum(heuristic, at_light.pdf * at_eye.cos * per_area, at_eye.pdf_back);
        let weight = (1.0 / (1.0 + light_sum + eye_sum)) as f32;
        let share = per_area / self.settings.partners as f32;
        let value = z.throughput * at_eye.value * (y.throughput * at_light.value) * share;
        Some((value, weight))
    }

    /// The path that a connection of two vertices makes, to be looked at.
    #[inline]
    pub fn look(&mut self, y: Trail<'_, '_>, z: Trail<'_, '_>, value: Spectrum, weight: f32) {
        let (Some(at_light), Some(at_eye)) = (y.last(), z.last()) else { return };
        let pair = self.pair(at_eye.walk);
        let direction = (at_light.point.position - at_eye.point.position).normalized();
        let ray = visibility::between(&at_eye.point, &at_light.point, direction, pair.ray.time);
        let candidate = Candidate {
            sample: at_eye.walk,
            s: y.len() + 1,
            t: z.len() + 1,
            film: None,
            value,
            weight,
            lens: pair.ray.origin,
            end: End::Start(at_light.walk),
            light: y.index(),
            eye: z.index(),
        };
        self.queue.push(ray, candidate);
    }

    /// s = t = 1: a point on the lens and one on a light, of weight zero; none of a light at a point or in a direction.
    pub fn connect_ends(&mut self, walk: u32, sampler: &mut Sampler) {
        let time = self.pair(walk).ray.time;
        let camera = self.sensor.camera.at(time);
        let sensor = self.sensor.with(&camera);
        let lens = camera.lens_point(sampler.next_2d());
        let Some(event) = NextEvent::sample(self.scene, lens, sampler).filter(|e| !e.sample.delta) else {
            return;
        };
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
        let candidate = Candidate {
            sample: walk,
            s: 1,
            t: 1,
            film: Some(look.film),
            value,
            weight: 0.0,
            lens,
            end: self.queue.choose(event.end),
            light: Trail::NONE,
            eye: Trail::NONE,
        };
        self.queue.push(ray, candidate);
    }
}
