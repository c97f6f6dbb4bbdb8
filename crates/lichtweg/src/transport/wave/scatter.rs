//! Sixteen walks at their vertices: [`PathTracer::arrive`](super::PathTracer) for surfaces of a single lobe.
//!
//! The formulas are those that walks alone go by, for any width; what is here is their order.

use lichtweg_ray::HitPacket;
use lichtweg_ray::wide::{Float, FloatLanes, Mask, Wide, Word, WordLanes};

use super::draws::Draws;
use super::lights::lights;
use super::points::{Arrivals, Materials, Points};
use super::queue::{ConnectionLanes, NO_PDF, WalkLanes};
use super::{PathObserver, Step, lanes_of, lanes_of_vector, vec3};
use crate::scene::description::LightStrategy;
use crate::scene::offset::offset;
use crate::transport::mis;
use crate::transport::path::SHADOW_END;

impl<O: PathObserver> Step<'_, O> {
    /// Deals with the walks that have hit simple surfaces, or nothing; which lanes these are.
    #[inline(always)]
    pub(super) fn simple_vertices<W: Wide>(
        &mut self,
        walks: WalkLanes<W::F32>,
        active: u32,
        hits: &HitPacket,
    ) -> u32 {
        let scene = self.scene;
        let mut arrivals = Arrivals::new(scene, active, hits);
        if arrivals.gone != 0 && !scene.is_dark_outside() {
            self.escaped::<W>(&walks, arrivals.gone);
        }
        let last = self.depth >= self.tracer.max_depth();
        if arrivals.lanes == 0 || last && arrivals.emitting == 0 {
            return arrivals.lanes | arrivals.gone;
        }
        let points = arrivals.points::<W>(walks.origin, walks.direction);
        if arrivals.emitting != 0 {
            arrivals.lanes &= !self.emitted::<W>(&arrivals, &walks, &points);
        }
        if !last && arrivals.lanes != 0 {
            let materials = arrivals.materials::<W>(points.shading_normal, -walks.direction);
            self.scatter::<W>(walks, &points, &materials, W::Mask::from_bits(arrivals.lanes));
        }
        arrivals.lanes | arrivals.gone
    }

    /// Connects sixteen walks to lights, and sends them on.
    #[inline(always)]
    fn scatter<W: Wide>(
        &mut self,
        mut walks: WalkLanes<W::F32>,
        points: &Points<W>,
        materials: &Materials<W>,
        lanes: W::Mask,
    ) {
        let splat = W::F32::splat;
        let tracer = self.tracer;
        let wo = materials.frame.to_local(-walks.direction);
        let mut draws = Draws::<W> {
            kind: self.wave.paths.kind(),
            key: [
                W::U32::gather(&self.wave.paths.key[0], walks.path),
                W::U32::gather(&self.wave.paths.key[1], walks.path),
            ],
            index: W::U32::gather(&self.wave.paths.index, walks.path),
            dimension: walks.dimension,
        };
        let connects = tracer.light != LightStrategy::Naive;
        if connects {
            let (u_light, u) = (draws.next_1d(), draws.next_2d());
            let light =
                lights::<W>(self.scene, points.position, materials.frame.normal, u_light, u, lanes.bits());
            let wi = materials.frame.to_local(light.direction);
            let (scattering, pdf_bsdf) = materials.value_and_pdf(wo, wi);
            let pdf = light.probability * light.pdf;
            let one = splat(1.0);
            let weight = match tracer.light {
                LightStrategy::Mis => one.select(light.delta, mis::weight(tracer.heuristic, pdf, pdf_bsdf)),
                _ => one,
            };
            let contribution = walks.throughput * (scattering * light.radiance * (weight / pdf));
            let origin = offset(points.position, points.error, points.geometric_normal, light.direction);
            let connection = ConnectionLanes {
                origin,
                direction: (light.target - origin).select(light.near, light.direction),
                tfar: splat(1.0 - SHADOW_END).select(light.near, splat(f32::INFINITY)),
                contribution,
                path: walks.path,
            };
            let mask = lanes & light.valid & scattering.is_lit();
            self.wave.connections.append::<W>(&connection, mask);
        }
        // No model of a single lobe asks which.
        draws.skip(1);
        let proposal = materials.propose(wo, draws.next_2d());
        let wi = materials.frame.to_world(proposal.wi);
        let mut throughput = walks.throughput * proposal.weight;
        let mut alive = lanes & proposal.valid & throughput.is_lit();
        if self.depth >= tracer.roulette.start_depth {
            let eta = W::F32::gather(&self.wave.paths.eta, walks.path);
            let survival = (throughput.max_element() * eta * eta)
                .max(splat(0.0))
                .min(splat(tracer.roulette.max_survival));
            let plays = survival.lt(splat(1.0));
            let before = draws.dimension;
            let u = draws.next_1d();
            draws.dimension = draws.dimension.select(plays, before);
            alive = alive.and_not(plays & survival.le(u));
            throughput = (throughput * (splat(1.0) / survival)).select(plays, throughput);
        }
        walks.origin = offset(points.position, points.error, points.geometric_normal, wi);
        walks.direction = wi;
        walks.throughput = throughput;
        walks.departure = points.position;
        walks.departure_pdf = if connects { proposal.pdf } else { splat(NO_PDF) };
        walks.dimension = draws.dimension;
        if self.scene.selection().is_by_place() {
            let normals = lanes_of_vector(materials.frame.normal);
            let path = walks.path.to_lanes();
            for lane in lanes_of(alive.bits()) {
                self.wave.paths.normal[path.0[lane] as usize] = vec3(&normals, lane);
            }
        }
        self.wave.next.append::<W>(&walks, alive);
    }
}
