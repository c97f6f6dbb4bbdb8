//! Random walks from either end: the same code for the eye and for the lights.
//!
//! A walk starts with a [`Departure`] from its end, and goes from surface to surface in directions that the BSDFs propose. It
//! ends where it is absorbed, leaves the scene, has as many vertices as it may, or loses a game of roulette.
//!
//! Many walks go together, vertex by vertex: their rays are sorted by direction and traced as packets. A walk's arithmetic
//! and random numbers are its own, so that it is the same whatever goes with it.

use lichtweg_montecarlo::{Roulette, Sampler};
use lichtweg_ray::Ray;

use super::WalkCounts;
use super::fault::{Fault, is_seeded};
use super::mis::raise;
use super::packets::{self, Order};
use super::vertex::{Departure, Onward, Others, Trail, Vertex};
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

/// A walk on its way to its next vertex.
#[derive(Clone, Copy, Debug)]
pub struct Traveller {
    /// Which of the walks that go together.
    pub walk: u32,
    /// From its end or its latest vertex.
    pub departure: Departure,
    /// What is left of its random numbers.
    pub sampler: Sampler,
    /// Its latest vertex, as [`Trail`] knows it.
    pub(super) last: u32,
    /// Undoes, for roulette, the scaling of radiance that a later refraction will undo anyway.
    eta: f32,
    /// Makes the throughput relative to that at the start.
    scale: f32,
}

impl Traveller {
    /// About to leave its end.
    pub fn new(walk: u32, departure: Departure, sampler: Sampler) -> Self {
        let scale = 1.0 / departure.throughput.max_element();
        Self { walk, departure, sampler, last: Trail::NONE, eta: 1.0, scale }
    }
}

/// Is told what happens on walks.
pub trait WalkVisitor {
    /// c of a walk's first surface vertex, 1 unless the end is connected to it otherwise than it was sampled.
    fn first_link(&mut self, walk: u32, point: &SurfacePoint) -> f64;

    /// A walk leaves its end or the last vertex of its trail.
    #[inline]
    fn departs(&mut self, traveller: &Traveller, trail: Trail<'_, '_>) {
        let _ = (traveller, trail);
    }

    /// A walk came to a surface. It goes on with what is left of the random numbers.
    #[inline]
    fn arrives(&mut self, trail: Trail<'_, '_>, sampler: &mut Sampler) {
        let _ = (trail, sampler);
    }

    /// A walk ended at a vertex with this probability: by roulette if it is below 1, else as nothing was left.
    #[inline]
    fn ends(&mut self, vertex: &Vertex<'_>, probability: f32) {
        let _ = (vertex, probability);
    }

    /// A walk left the scene.
    #[inline]
    fn escapes(&mut self, traveller: &Traveller, trail: Trail<'_, '_>) {
        let _ = (traveller, trail);
    }
}

/// Walks that go together. Made once a thread and used again.
#[derive(Debug, Default)]
pub struct Crowd {
    /// On their way.
    pub travellers: Vec<Traveller>,
    next: Vec<Traveller>,
    order: Order,
}

impl<'a> Walk<'a> {
    /// Sends the travellers of a crowd to the ends of their walks, and appends their surface vertices to an empty `path`.
    pub fn run(
        &self,
        crowd: &mut Crowd,
        counts: &mut WalkCounts,
        path: &mut Vec<Vertex<'a>>,
        visitor: &mut impl WalkVisitor,
    ) {
        let Crowd { travellers, next, order } = crowd;
        for number in 1.. {
            for traveller in travellers.iter() {
                visitor.departs(traveller, Trail::new(path, traveller.last));
            }
            if travellers.is_empty() || number > self.max_vertices {
                break;
            }
            counts.edges += travellers.len() as u64;
            counts.rays.closest += travellers.len() as u64;
            order.sort(travellers.iter().map(|t| t.departure.ray.direction));
            packets::closest(
                self.scene,
                order,
                |i| travellers[i].departure.ray,
                |i, ray, hit| {
                    let mut traveller = travellers[i];
                    let u = || traveller.sampler.next_1d();
                    match hit.and_then(|hit| self.scene.point(ray, &hit, &mut counts.rays, u)) {
                        None => visitor.escapes(&traveller, Trail::new(path, traveller.last)),
                        Some(point) => {
                            if self.arrive(&mut traveller, point, number, path, visitor) {
                                next.push(traveller);
                            }
                        }
                    }
                },
            );
            std::mem::swap(travellers, next);
            next.clear();
        }
        travellers.clear();
    }

    /// A walk comes to a surface point, its vertex of this number; whether it goes on.
    #[inline]
    fn arrive(
        &self,
        traveller: &mut Traveller,
        point: SurfacePoint,
        number: usize,
        path: &mut Vec<Vertex<'a>>,
        visitor: &mut impl WalkVisitor,
    ) -> bool {
        if number == 1 {
            traveller.departure.link = visitor.first_link(traveller.walk, &point);
        }
        let (from, wo) = (&traveller.departure, -traveller.departure.ray.direction);
        let others = self.others(from, &point);
        if !(others.connected + others.shorter).is_finite() {
            // By rounding, there is no density.
            return false;
        }
        let last = path.len() as u32;
        path.push(Vertex {
            scatterer: self.scene.scatterer(&point, wo),
            point,
            wo,
            throughput: from.throughput,
            others,
            onward: None,
            walk: traveller.walk,
            number: number as u32,
            before: traveller.last,
        });
        traveller.last = last;
        visitor.arrives(Trail::new(path, last), &mut traveller.sampler);
        if number >= self.max_vertices && !self.leaves_last {
            return false;
        }
        let (vertex, sampler) = (&mut path[last as usize], &mut traveller.sampler);
        let (u_lobe, u) = (sampler.next_1d(), sampler.next_2d());
        let mode = if is_seeded(Fault::EtaSquared) { Mode::Radiance } else { self.mode };
        let sample = vertex.scatterer.sample(vertex.wo, u_lobe, u, mode);
        let onward = sample.and_then(|sample| {
            if self.mode == Mode::Radiance {
                traveller.eta *= sample.eta;
            }
            let weight = sample.weight * vertex.adjoint_correction(sample.wi, self.mode);
            let onward =
                Onward { direction: sample.wi, pdf: sample.pdf, delta: sample.delta, weight, survival: 1.0 };
            (!(vertex.throughput * weight).is_zero()).then_some(onward)
        });
        let Some(mut onward) = onward else {
            visitor.ends(vertex, 1.0);
            return false;
        };
        let mut next = self.depart(vertex, &onward, traveller.departure.ray.time);
        let scale = traveller.scale * traveller.eta * traveller.eta;
        let survival = self.survival_probability(number, vertex, &next, scale);
        onward.survival = survival;
        vertex.onward = Some(onward);
        if survival < 1.0 {
            if sampler.next_1d() >= survival {
                visitor.ends(vertex, 1.0 - survival);
                return false;
            }
            next.throughput *= 1.0 / survival;
        }
        traveller.departure = next;
        true
    }

    /// What the vertex knows at which a departure arrives.
    #[inline]
    fn others(&self, from: &Departure, point: &SurfacePoint) -> Others {
        let cos = point.geometric_normal.dot(from.ray.direction).abs();
        let per_area = 1.0 / (point.position - from.position).length_squared();
        let (there, back) = if from.infinite { (cos, 1.0) } else { (cos * per_area, from.cos * per_area) };
        let there = if from.infinite && is_seeded(Fault::DistantDensity) { cos * per_area } else { there };
        from.arrive(self.heuristic, there, back)
    }

    /// The departure from a vertex.
    #[inline]
    fn depart(&self, vertex: &Vertex<'_>, onward: &Onward, time: f32) -> Departure {
        let Vertex { point, others, .. } = vertex;
        let wi = onward.direction;
        // A lobe of a single direction is as likely one way as the other.
        let back = if onward.delta { onward.pdf } else { vertex.pdf_back(wi) };
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
