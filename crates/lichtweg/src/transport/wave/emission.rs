//! Sixteen walks that run into lights: [`PathTracer::arrive`](super::PathTracer)'s first half.

use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Mask, Wide, WordLanes};

use super::points::{Arrivals, Points};
use super::queue::{NO_PDF, WalkLanes};
use super::{PathObserver, Step, lanes_of, load_vector, set_vector};
use crate::color::{Spectra, SpectrumLanes};
use crate::light::{Cone, Receiver, Sight};
use crate::scene::description::LightStrategy;
use crate::transport::mis;

impl<O: PathObserver> Step<'_, O> {
    /// Adds the radiance around the scene to the walks that leave it.
    #[inline(always)]
    pub(super) fn escaped<W: Wide>(&mut self, walks: &WalkLanes<W::F32>, lanes: u32) {
        let (tracer, scene) = (self.tracer, self.scene);
        if self.depth == 1 && tracer.hide_emitters {
            return;
        }
        let splat = W::F32::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let departed = !walks.departure_pdf.equal(splat(NO_PDF));
        let mut sum = Spectra([zero; 4]);
        for (light, environment) in scene.environments() {
            let weighed = if tracer.light == LightStrategy::Mis { lanes & departed.bits() } else { 0 };
            let (radiance, pdf) = environment.seen_lanes::<W>(walks.direction, lanes, weighed);
            let weight = match tracer.light {
                LightStrategy::Naive => one,
                LightStrategy::Nee => zero.select(departed, one),
                LightStrategy::Mis => {
                    let pdf_light = splat(scene.selection().probability_around(light)) * pdf;
                    mis::weight(tracer.heuristic, walks.departure_pdf, pdf_light).select(departed, one)
                }
            };
            sum += radiance * weight;
        }
        let emitted = SpectrumLanes::new(walks.throughput * sum);
        let path = walks.path.to_lanes();
        for lane in lanes_of(lanes) {
            self.wave.radiance[path.0[lane] as usize] += emitted.get(lane);
        }
    }

    /// Adds the radiance of lights to the walks that hit them; which lanes are left to be dealt with one by one, since they
    /// come from inside a sphere that emits.
    #[inline(always)]
    pub(super) fn emitted<W: Wide>(
        &mut self,
        arrivals: &Arrivals,
        walks: &WalkLanes<W::F32>,
        points: &Points<W>,
    ) -> u32 {
        let tracer = self.tracer;
        if self.depth == 1 && tracer.hide_emitters {
            return 0;
        }
        let splat = W::F32::splat;
        let zero = splat(0.0);
        let wo = -walks.direction;
        let [r, g, b, c, inverse_area, two_sided, ..] = W::F32::columns(&arrivals.emission);
        let radiance = Spectra([r, g, b, c]);
        let cos = points.geometric_normal.dot(wo);
        let shines = zero.lt(two_sided) | zero.lt(cos);
        let mut lit = W::Mask::from_bits(arrivals.emitting) & shines & radiance.is_lit();
        let departed = !walks.departure_pdf.equal(splat(NO_PDF));
        let mut weight = splat(1.0);
        let mut left = 0;
        match tracer.light {
            LightStrategy::Naive => {}
            LightStrategy::Nee => weight = zero.select(departed, weight),
            LightStrategy::Mis => {
                let weighed = lit & departed;
                if weighed.any() {
                    let to = points.position - walks.departure;
                    let sight = Sight { direction: wo, distance_squared: to.length_squared(), cos };
                    let mut pdf = sight.per_solid_angle(inverse_area);
                    let on_sphere = arrivals.on_sphere::<W>();
                    if (weighed & on_sphere).any() {
                        let cone = Cone::new(&arrivals.spheres::<W>(), walks.departure);
                        pdf = cone.pdf().select(on_sphere, pdf);
                        left = (weighed & on_sphere).and_not(cone.valid).bits();
                    }
                    let probability = self.probabilities::<W>(arrivals, walks, weighed.bits());
                    let pdf_light = probability * pdf;
                    let mis = mis::weight(tracer.heuristic, walks.departure_pdf, pdf_light);
                    weight = mis.select(departed, weight);
                }
            }
        }
        lit = lit.and_not(W::Mask::from_bits(left));
        let emitted = SpectrumLanes::new(walks.throughput * (radiance * weight));
        let paths = walks.path.to_lanes();
        for lane in lanes_of(lit.bits()) {
            self.wave.radiance[paths.0[lane] as usize] += emitted.get(lane);
        }
        left
    }

    /// With which probability connections from the departures would have chosen the lights.
    #[inline(always)]
    fn probabilities<W: Wide>(&self, arrivals: &Arrivals, walks: &WalkLanes<W::F32>, lanes: u32) -> W::F32 {
        let selection = self.scene.selection();
        let mut normals = [Lanes([0.0; LANES]); 3];
        if selection.is_by_place() {
            let path = walks.path.to_lanes();
            for lane in lanes_of(lanes) {
                set_vector(&mut normals, lane, self.wave.paths.normal[path.0[lane] as usize]);
            }
        }
        let receiver = Receiver { position: walks.departure, normal: load_vector::<W>(&normals) };
        selection.probability_lanes::<W>(&receiver, &arrivals.light, arrivals.primitives(), lanes)
    }
}
