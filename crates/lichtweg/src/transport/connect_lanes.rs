//! The strategies of a single walk at sixteen vertices at once: [`Joiner::connect_to_light`] and [`Joiner::connect_to_lens`] for surfaces
//! of a single lobe. The formulas are those of one vertex.

use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Mask, Wide, WordLanes};

use super::bidirectional::{Bidirectional, ContributionSink};
use super::connect::{Joiner, keep};
use super::mis;
use super::packets::RayLanes;
use super::vertex_lanes::VertexLanes;
use super::visibility::{Candidate, SHADOW_END};
use super::wave::lights::{LightLanes, lights};
use crate::color::SpectrumLanes;
use crate::lanes::lanes_of;

impl<S: ContributionSink> Joiner<'_, '_, S> {
    /// See [`Joiner::connect_to_light`].
    #[inline(always)]
    pub fn connect_to_lights<W: Wide>(&mut self, vertices: &mut VertexLanes<W>) {
        for number in 0..self.settings.lights {
            let u_light = self.settings.stratified(number, vertices.draws.next_1d());
            self.connect_to_light_each(vertices, u_light);
        }
    }

    #[inline(always)]
    fn connect_to_light_each<W: Wide>(&mut self, vertices: &mut VertexLanes<W>, u_light: W::F32) {
        let splat = W::F32::splat;
        let (u, u_keep) = (vertices.draws.next_2d(), vertices.draws.next_1d());
        let (lobes, points) = (&vertices.lobes, &vertices.points);
        let normal = lobes.materials.frame.normal;
        let light = lights::<W>(self.scene, points.position, normal, u_light, u, vertices.lanes.bits());
        let scattering = lobes.scatter(light.direction);
        let lit = vertices.lanes & light.valid & scattering.value.is_lit();
        if !lit.any() {
            return;
        }
        let Bidirectional { heuristic, lights: count, .. } = *self.settings;
        let once = splat(self.settings.once());
        let pdf = light.probability * light.pdf;
        let hit = splat(0.0).select(light.delta, once * scattering.pdf / pdf);
        let start = self.emitters::<W>(&light, lit.bits()) * light.start;
        let arriving = start * light.leaving * scattering.cos / (pdf * light.spread);
        let others = arriving * vertices.others.root(heuristic, scattering.pdf_back);
        let weight = mis::share(heuristic, splat(self.settings.lit()), hit, others);
        let density = pdf * splat(count as f32);
        let value = vertices.throughput * scattering.value * light.radiance * (splat(1.0) / density);
        let walk = vertices.walk.to_lanes();
        let expected = self.expected(&walk, lit.bits());
        let (kept, compensation) = keep(W::F32::load(&expected), (value * weight).max_element(), u_keep);
        let origin = points.leave(light.direction);
        let rays = RayLanes {
            origin,
            direction: (light.target - origin).select(light.near, light.direction),
            tnear: splat(0.0),
            tfar: splat(1.0 - SHADOW_END).select(light.near, splat(f32::INFINITY)),
            time: vertices.time,
        };
        let (value, weight) = (SpectrumLanes::new(value * compensation), weight.to_lanes());
        let t = vertices.number + 1;
        self.queue.append(&rays, lit & kept, |_, lane| Candidate {
            sample: walk.0[lane],
            s: 1,
            t,
            film: None,
            value: value.get(lane),
            weight: weight.0[lane],
            way: None,
        });
    }

    /// See [`Joiner::connect_to_lens`]; of a camera that does not move.
    #[inline(always)]
    pub fn connect_to_lenses<W: Wide>(&mut self, vertices: &mut VertexLanes<W>) {
        let splat = W::F32::splat;
        let (u_lens, u_keep) = (vertices.draws.next_2d(), vertices.draws.next_1d());
        let (lobes, points) = (&vertices.lobes, &vertices.points);
        let camera = self.sensor.camera;
        let lens = camera.lens_points(u_lens);
        let (look, distance_squared, seen) = self.sensor.looks_at(lens, points.position);
        let seen = seen & vertices.lanes;
        if !seen.any() {
            return;
        }
        let scattering = lobes.scatter(look.to_lens);
        let Bidirectional { heuristic, .. } = *self.settings;
        let once = splat(self.settings.once());
        let from_eye = look.pdf * scattering.cos / distance_squared;
        let others = from_eye * vertices.others.root(heuristic, scattering.pdf_back);
        let hit = match camera.lens_pdf() {
            None => splat(0.0),
            Some(pdf) => once * (scattering.pdf * look.cos / (distance_squared * splat(pdf))),
        };
        let weight = mis::share(heuristic, once, others, hit);
        let value = vertices.throughput * scattering.value * (look.pdf / distance_squared);
        let film = [look.film[0].to_lanes(), look.film[1].to_lanes()];
        let mut expected = Lanes::splat(0.0);
        for lane in lanes_of(seen.bits()) {
            expected.0[lane] = self.sensor.expected([film[0].0[lane], film[1].0[lane]]);
        }
        let (kept, compensation) = keep(W::F32::load(&expected), (value * weight).max_element(), u_keep);
        let (direction, tnear) = look.toward(points);
        let tfar = splat(1.0 - SHADOW_END);
        let rays = RayLanes { origin: lens, direction, tnear, tfar, time: vertices.time };
        let mask = seen & scattering.value.is_lit() & kept;
        let (value, weight) = (SpectrumLanes::new(value * compensation), weight.to_lanes());
        let (walk, s) = (vertices.walk.to_lanes(), vertices.number + 1);
        self.queue.append(&rays, mask, |_, lane| Candidate {
            sample: walk.0[lane],
            s,
            t: 1,
            film: Some([film[0].0[lane], film[1].0[lane]]),
            value: value.get(lane),
            weight: weight.0[lane],
            way: None,
        });
    }

    /// With which probability walks begin at the lights that were chosen.
    #[inline(always)]
    fn emitters<W: Wide>(&self, light: &LightLanes<W>, lanes: u32) -> W::F32 {
        let mut probability = Lanes::splat(0.0);
        for lane in lanes_of(lanes) {
            if let Some(choice) = &light.choices[lane] {
                probability.0[lane] = self.scene.selection().emitter_probability(choice.light);
            }
        }
        W::F32::load(&probability)
    }

    /// What the eyes of walks expect to see.
    #[inline(always)]
    fn expected(&self, walk: &Lanes<u32>, lanes: u32) -> Lanes<f32> {
        let mut expected = Lanes([0.0; LANES]);
        for lane in lanes_of(lanes) {
            expected.0[lane] = self.pair(walk.0[lane]).expected;
        }
        expected
    }
}
