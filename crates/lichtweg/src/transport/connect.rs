//! The ways to make a path of two walks: one function for each, which gives the path's value over its density, and its
//! weight among all.

use lichtweg_montecarlo::Sampler;

use super::bidirectional::{Contribution, ContributionSink, LensHit, Pair};
use super::fault::{Fault, is_seeded};
use super::light_end::{LightEnd, LightStart, NextEvent, others_of_escape, others_of_hit};
use super::mis::raise;
use super::vertex::{Departure, Vertex};
use super::visibility;
use crate::bsdf::Mode;
use crate::color::Spectrum;

/// Weight of a strategy, given the sums over the others.
#[inline]
fn weight(light: f64, eye: f64) -> f32 {
    (1.0 / (1.0 + light + eye)) as f32
}

/// A connection whose weighted value is this part of what the pixel will show is surely looked at.
const LARGE: f32 = 0.15;

impl<'a> Pair<'_, 'a> {
    /// Whether to look if a connection of a weighted value is free: the factor that makes up for those that are not looked at.
    /// What is small beside the noise that the pixel has anyway is not worth a ray (Veach 1997, section 10.4.1, efficiency-optimized
    /// Russian roulette, with the threshold as a constant share of the pixel's mean).
    #[inline]
    fn worth(&self, weighted: Spectrum, sampler: &mut Sampler) -> Option<f32> {
        let probability = weighted.max_element() / (LARGE * self.expected);
        if probability >= 1.0 || probability.is_nan() {
            return Some(1.0);
        }
        (sampler.next_1d() < probability).then(|| 1.0 / probability)
    }

    /// s = 0: the last vertex lies on a light.
    pub fn run_into_light<S: ContributionSink>(&mut self, eye: &[Vertex<'a>], sink: &mut S) {
        let Some((vertex, before)) = eye.split_last() else { return };
        let Some((light, area_light)) = self.scene.area_light(&vertex.point) else { return };
        let radiance = area_light.radiance(&vertex.point, vertex.wo, self.scene.textures());
        if radiance.is_zero() {
            return;
        }
        let weight = match before.last() {
            None => self.direct_weight(),
            Some(_) if is_seeded(Fault::Weights) => 1.0,
            Some(receiver) => weight(
                0.0,
                others_of_hit(self.scene, light, vertex, &receiver.point, self.settings.heuristic),
            ),
        };
        sink.add(&Contribution {
            s: 0,
            t: eye.len() as u32 + 1,
            film: None,
            value: vertex.throughput * radiance,
            weight,
            end: LightEnd::hit(light, vertex),
            lens: self.lens,
            light: &[],
            eye,
        });
    }

    /// s = 0: the walk left the scene, towards the lights around it.
    pub fn run_out_of_scene<S: ContributionSink>(
        &mut self,
        departure: &Departure,
        eye: &[Vertex<'a>],
        sink: &mut S,
    ) {
        let direction = departure.ray.direction;
        for (light, environment) in self.scene.environments() {
            let radiance = environment.radiance(direction);
            if radiance.is_zero() {
                continue;
            }
            let heuristic = self.settings.heuristic;
            let weight = match eye.last() {
                None => self.direct_weight(),
                Some(_) => {
                    let pdf = environment.pdf(direction);
                    weight(0.0, others_of_escape(self.scene, light, departure, pdf, heuristic))
                }
            };
            sink.add(&Contribution {
                s: 0,
                t: eye.len() as u32 + 2,
                film: None,
                value: departure.throughput * radiance,
                weight,
                end: LightEnd::escaped(light, direction),
                lens: self.lens,
                light: &[],
                eye,
            });
        }
    }

    /// Of emitters that the camera sees directly.
    fn direct_weight(&self) -> f32 {
        if self.settings.hide_emitters { 0.0 } else { 1.0 }
    }

    /// s = 1: the last vertex and a point on a light that is chosen for it.
    pub fn connect_to_light<S: ContributionSink>(
        &mut self,
        eye: &[Vertex<'a>],
        sampler: &mut Sampler,
        sink: &mut S,
    ) {
        let Some(vertex) = eye.last().filter(|v| v.scatterer.bsdf.connects()) else { return };
        let Some(event) = NextEvent::sample(self.scene, vertex.point.position, sampler) else { return };
        let scattering = vertex.scatter(event.sample.direction, Mode::Radiance);
        if scattering.value.is_zero() {
            return;
        }
        let heuristic = self.settings.heuristic;
        let light = match event.sample.delta {
            true => 0.0,
            false => raise(heuristic, scattering.pdf / event.pdf()),
        };
        let arriving = event.emission_over_connection(scattering.cos);
        let weight = weight(light, vertex.others.sum(heuristic, arriving, scattering.pdf_back));
        let value = vertex.throughput * scattering.value * event.sample.radiance * (1.0 / event.pdf());
        let Some(compensation) = self.worth(value * weight, sampler) else { return };
        let visible =
            visibility::from_light(self.scene, &vertex.point, &event.sample, self.time, self.counts);
        if visible == 0.0 {
            return;
        }
        sink.add(&Contribution {
            s: 1,
            t: eye.len() as u32 + 1,
            film: None,
            value: value * (visible * compensation),
            weight,
            end: event.end,
            lens: self.lens,
            light: &[],
            eye,
        });
    }

    /// t = 1: the last vertex and a point on the lens.
    pub fn connect_to_lens<S: ContributionSink>(
        &mut self,
        light: &[Vertex<'a>],
        start: &LightStart,
        sampler: &mut Sampler,
        sink: &mut S,
    ) {
        let Some(vertex) = light.last().filter(|v| v.scatterer.bsdf.connects()) else { return };
        let lens = self.sensor.camera.lens_point(sampler.next_2d());
        let Some((look, distance_squared)) = self.sensor.look_at(lens, vertex.point.position) else { return };
        let scattering = vertex.scatter(look.to_lens, Mode::Importance);
        if scattering.value.is_zero() {
            return;
        }
        let visible = look.transmittance(&vertex.point, self.time, self.scene, self.counts);
        if visible == 0.0 {
            return;
        }
        let heuristic = self.settings.heuristic;
        let from_eye = look.pdf * scattering.cos / distance_squared;
        let light_sum = vertex.others.sum(heuristic, from_eye, scattering.pdf_back);
        // t = 0: the walk goes on into the lens.
        let eye_sum = self.sensor.camera.lens_pdf().map_or(0.0, |lens_pdf| {
            raise(heuristic, scattering.pdf * look.cos / (distance_squared * lens_pdf))
        });
        sink.add(&Contribution {
            s: light.len() as u32 + 1,
            t: 1,
            film: Some(look.film),
            value: vertex.throughput * scattering.value * (visible * look.pdf / distance_squared),
            weight: weight(light_sum, eye_sum),
            end: start.end,
            lens,
            light,
            eye: &[],
        });
    }

    /// t = 0: the walk from the light runs into the lens.
    pub(super) fn run_into_lens<S: ContributionSink>(
        &mut self,
        hit: &LensHit,
        start: &LightStart,
        light: &[Vertex<'a>],
        sink: &mut S,
    ) {
        let departure = &hit.departure;
        let Some(look) = self.sensor.look(hit.lens, -departure.ray.direction) else { return };
        let Some(lens_pdf) = self.sensor.camera.lens_pdf() else { return };
        // A walk's first edge leads straight from the light to the lens: seen, but for its variance.
        let direct = light.is_empty();
        if direct && !S::UNWEIGHTED {
            return;
        }
        let distance_squared = (hit.lens - departure.position).length_squared();
        let visible = match light.last() {
            Some(vertex) if self.sensor.look_at(hit.lens, vertex.point.position).is_some() => {
                look.transmittance(&vertex.point, self.time, self.scene, self.counts)
            }
            Some(_) => 0.0,
            None => match start.emission.point {
                Some(point) => look.transmittance(&point, self.time, self.scene, self.counts),
                None if departure.infinite => look.transmittance_from_far(self.time, self.scene, self.counts),
                None => 0.0,
            },
        };
        if visible == 0.0 {
            return;
        }
        let (there, back) = match departure.infinite {
            true => (look.cos, 1.0),
            false => (look.cos / distance_squared, departure.cos / distance_squared),
        };
        let heuristic = self.settings.heuristic;
        let (others, _) = departure.arrive(heuristic, there, back);
        let weight = if direct { 0.0 } else { weight(others.sum(heuristic, lens_pdf, look.pdf), 0.0) };
        sink.add(&Contribution {
            s: light.len() as u32 + 2,
            t: 0,
            film: Some(look.film),
            value: departure.throughput * (visible * lens_pdf * look.pdf / look.cos),
            weight,
            end: start.end,
            lens: hit.lens,
            light,
            eye: &[],
        });
    }

    /// s, t >= 2: the last vertices of both walks.
    pub fn connect<S: ContributionSink>(
        &mut self,
        light: &[Vertex<'a>],
        eye: &[Vertex<'a>],
        start: &LightStart,
        sampler: &mut Sampler,
        sink: &mut S,
    ) {
        let (Some(y), Some(z)) = (light.last(), eye.last()) else { return };
        if !y.scatterer.bsdf.connects() || !z.scatterer.bsdf.connects() {
            return;
        }
        let along = y.point.position - z.point.position;
        let distance_squared = along.length_squared();
        let direction = along / distance_squared.sqrt();
        let at_eye = z.scatter(direction, Mode::Radiance);
        if at_eye.value.is_zero() {
            return;
        }
        let at_light = y.scatter(-direction, Mode::Importance);
        if at_light.value.is_zero() {
            return;
        }
        let heuristic = self.settings.heuristic;
        let per_area = 1.0 / distance_squared;
        let light_sum = y.others.sum(heuristic, at_eye.pdf * at_light.cos * per_area, at_light.pdf_back);
        let eye_sum = z.others.sum(heuristic, at_light.pdf * at_eye.cos * per_area, at_eye.pdf_back);
        let weight = weight(light_sum, eye_sum);
        let value = z.throughput * at_eye.value * (y.throughput * at_light.value) * per_area;
        let Some(compensation) = self.worth(value * weight, sampler) else { return };
        let visible = visibility::between(self.scene, &z.point, &y.point, direction, self.time, self.counts);
        if visible == 0.0 {
            return;
        }
        sink.add(&Contribution {
            s: light.len() as u32 + 1,
            t: eye.len() as u32 + 1,
            film: None,
            value: value * (visible * compensation),
            weight,
            end: start.end,
            lens: self.lens,
            light,
            eye,
        });
    }

    /// s = t = 1: a point on the lens and one on a light, of weight zero; none of a light at a point or in a direction.
    pub fn connect_ends<S: ContributionSink>(&mut self, sampler: &mut Sampler, sink: &mut S) {
        let lens = self.sensor.camera.lens_point(sampler.next_2d());
        let Some(event) = NextEvent::sample(self.scene, lens, sampler).filter(|e| !e.sample.delta) else {
            return;
        };
        let Some(look) = self.sensor.look(lens, event.sample.direction) else { return };
        let visible = match event.end.point {
            Some(point) if self.sensor.look_at(lens, point.position).is_some() => {
                look.transmittance(&point, self.time, self.scene, self.counts)
            }
            Some(_) => 0.0,
            None => look.transmittance_from_far(self.time, self.scene, self.counts),
        };
        let value = event.sample.radiance * (visible * look.pdf / event.pdf());
        if !value.is_zero() {
            let (end, film) = (event.end, Some(look.film));
            sink.add(&Contribution { s: 1, t: 1, film, value, weight: 0.0, end, lens, light: &[], eye: &[] });
        }
    }
}
