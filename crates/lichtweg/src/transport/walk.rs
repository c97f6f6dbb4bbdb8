//! Random walks from either end: the same code for the eye and for the lights.
//!
//! A walk starts with a [`Departure`] from its end, and goes from surface to surface in directions that the BSDFs propose. It
//! ends where it is absorbed, leaves the scene, has as many vertices as it may, or loses a game of roulette.

use lichtweg_montecarlo::{Roulette, Sampler};
use lichtweg_ray::Ray;

use super::WalkCounts;
use super::fault::{Fault, is_seeded};
use super::mis::raise;
use super::vertex::{Departure, Onward, Vertex};
use crate::bsdf::Mode;
use crate::scene::description::Heuristic;
use crate::scene::{Scene, SurfacePoint};

/// When walks end by chance.
#[derive(Clone, Copy, Debug)]
pub enum Survival {
    /// By the throughput so far.
    Roulette(Roulette),
    /// At every surface, by its albedo: a number decides whether to reflect, to transmit, or to absorb, and what goes on
    /// carries all of its power on. Where nothing is absorbed, a thousandth is, so that every walk ends.
    Analog,
}

/// How to walk.
#[derive(Clone, Copy, Debug)]
pub struct Walk<'a> {
    /// Where.
    pub scene: &'a Scene,
    /// What is carried: radiance by walks from the eye, importance by walks from the lights.
    pub mode: Mode,
    /// Of the weights.
    pub heuristic: Heuristic,
    /// When to end.
    pub survival: Survival,
    /// Surfaces to visit at most.
    pub max_vertices: usize,
    /// Whether to leave the last of these.
    pub leaves_last: bool,
}

/// Is told what happens on a walk.
pub trait WalkVisitor {
    /// c of a walk's first surface vertex, 1 unless the end is connected to it otherwise than it was sampled.
    fn first_link(&mut self, point: &SurfacePoint) -> f64;

    /// The walk leaves its end (`vertices` is 0 then) or its latest vertex, of so many.
    #[inline]
    fn departs(&mut self, departure: &Departure, vertices: usize) {
        let _ = (departure, vertices);
    }

    /// The walk came to a surface.
    #[inline]
    fn arrives(&mut self, vertex: &Vertex<'_>) {
        let _ = vertex;
    }

    /// The walk ended at a vertex with this probability: by roulette if it is below 1, else as nothing was left.
    #[inline]
    fn ends(&mut self, vertex: &Vertex<'_>, probability: f32) {
        let _ = (vertex, probability);
    }
}

impl<'a> Walk<'a> {
    /// Walks, and appends the surface vertices to an empty `path`; returns the departure that left the scene, if one did.
    pub fn run(
        &self,
        start: Departure,
        sampler: &mut Sampler,
        counts: &mut WalkCounts,
        path: &mut Vec<Vertex<'a>>,
        visitor: &mut impl WalkVisitor,
    ) -> Option<Departure> {
        let mut departure = start;
        // Undoes, for roulette, the scaling of radiance that a later refraction will undo anyway.
        let mut eta = 1.0;
        let scale = 1.0 / start.throughput.max_element();
        loop {
            visitor.departs(&departure, path.len());
            if path.len() >= self.max_vertices {
                return None;
            }
            counts.edges += 1;
            let Some(point) = self.scene.intersect(&departure.ray, &mut counts.rays, || sampler.next_1d())
            else {
                return Some(departure);
            };
            if path.is_empty() {
                departure.link = visitor.first_link(&point);
            }
            let mut vertex = self.arrive(&departure, point)?;
            visitor.arrives(&vertex);
            if path.len() + 1 >= self.max_vertices && !self.leaves_last {
                path.push(vertex);
                return None;
            }
            let (u_lobe, u) = (sampler.next_1d(), sampler.next_2d());
            let mode = if is_seeded(Fault::EtaSquared) { Mode::Radiance } else { self.mode };
            let sample = vertex.scatterer.sample(vertex.wo, u_lobe, u, mode);
            let next = sample.and_then(|sample| {
                if self.mode == Mode::Radiance {
                    eta *= sample.eta;
                }
                let weight = sample.weight * vertex.adjoint_correction(sample.wi, self.mode);
                let onward = Onward {
                    direction: sample.wi,
                    pdf: sample.pdf,
                    delta: sample.delta,
                    weight,
                    survival: 1.0,
                };
                (!(vertex.throughput * weight).is_zero()).then_some(onward)
            });
            let Some(mut onward) = next else {
                path.push(vertex);
                visitor.ends(&vertex, 1.0);
                return None;
            };
            let mut next = self.depart(&vertex, &onward, departure.ray.time);
            let survival = self.survival_probability(path.len() + 1, &vertex, &next, scale * eta * eta);
            onward.survival = survival;
            vertex.onward = Some(onward);
            path.push(vertex);
            if survival < 1.0 {
                if sampler.next_1d() >= survival {
                    visitor.ends(&vertex, 1.0 - survival);
                    return None;
                }
                next.throughput *= 1.0 / survival;
            }
            departure = next;
        }
    }

    /// The vertex at which a departure arrives; `None` where rounding leaves no density.
    #[inline]
    fn arrive(&self, from: &Departure, point: SurfacePoint) -> Option<Vertex<'a>> {
        let wo = -from.ray.direction;
        let cos = point.geometric_normal.dot(wo).abs();
        let per_area = 1.0 / (point.position - from.position).length_squared();
        let (there, back) = if from.infinite { (cos, 1.0) } else { (cos * per_area, from.cos * per_area) };
        let there = if from.infinite && is_seeded(Fault::DistantDensity) { cos * per_area } else { there };
        let (others, pdf_area) = from.arrive(self.heuristic, there, back);
        (others.connected + others.shorter).is_finite().then(|| Vertex {
            scatterer: self.scene.scatterer(&point, wo),
            point,
            wo,
            throughput: from.throughput,
            pdf_area,
            others,
            onward: None,
        })
    }

    /// The departure from a vertex.
    #[inline]
    fn depart(&self, vertex: &Vertex<'_>, onward: &Onward, time: f32) -> Departure {
        let Vertex { point, others, .. } = vertex;
        let wi = onward.direction;
        // A lobe of a single direction is as likely one way as the other.
        let back = if onward.delta { onward.pdf } else { vertex.scatterer.pdf(wi, vertex.wo) };
        let connected = if onward.delta { 0.0 } else { others.connected };
        Departure {
            ray: Ray { time, ..Ray::new(point.leave(wi), wi) },
            position: point.position,
            throughput: vertex.throughput * onward.weight,
            pdf: onward.pdf,
            cos: point.geometric_normal.dot(wi).abs(),
            infinite: false,
            link: if onward.delta { 0.0 } else { 1.0 },
            chain: connected + raise(self.heuristic, back) * others.shorter,
        }
    }

    /// `scale` makes the throughput relative to that at the start.
    #[inline]
    fn survival_probability(&self, depth: usize, vertex: &Vertex<'_>, next: &Departure, scale: f32) -> f32 {
        match self.survival {
            Survival::Roulette(roulette) => {
                roulette.survival_probability(depth as u32, next.throughput.max_element() * scale)
            }
            Survival::Analog => {
                let kept = next.throughput.max_element() / vertex.throughput.max_element();
                kept.min(Roulette::default().max_survival)
            }
        }
    }
}
