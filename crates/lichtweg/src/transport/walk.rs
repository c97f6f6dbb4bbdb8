//! Random walks from either end: the same code for the eye and for the lights.
//!
//! A walk starts with a [`Departure`] from its end, and goes from surface to surface in directions that the BSDFs propose. It
//! ends where it is absorbed, leaves the scene, has as many vertices as it may, or loses a game of roulette.
//!
//! Many walks go together, vertex by vertex: their rays are sorted by direction and traced as packets, and where a visitor can,
//! vertices on surfaces of a single lobe are dealt with sixteen at a time ([`VertexLanes`]). A walk's arithmetic and random numbers are
//! its own, so that it is the same whatever goes with it, and whether it goes in lanes or not.

use lichtweg_montecarlo::{Roulette, Sampler, SamplerKind};
use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{self, Float, Kernel, Mask, Wide, Word};
use lichtweg_ray::{HitPacket, Ray};

use super::WalkCounts;
use super::fault::{self, Fault, is_seeded};
use super::packets::Order;
use super::traveller::{Traveller, TravellerLanes, TravellerRows};
use super::vertex::{Departure, Onward, Others, Trail, Vertex};
use super::vertex_lanes::{LobeLanes, VertexLanes};
use super::visibility::ShadowPoint;
use super::wave::points::Arrivals;
use crate::bsdf::Mode;
use crate::color::Spectra;
use crate::lanes::lanes_of;
use crate::light::Receiver;
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

/// Is told what happens on walks.
pub trait WalkVisitor {
    /// Whether vertices on lights are told one by one in any case.
    const LIGHTS_ALONE: bool = false;

    /// Whether last vertices, from which walks do not go on, matter where they do not lie on lights.
    const LAST_MATTER: bool = true;

    /// Whether it can deal with simple vertices sixteen at a time, rather than to be told of each. Those that cannot need no kernels.
    const WIDE: bool = false;

    /// Whether one that can does so here.
    #[inline(always)]
    fn is_wide(&self) -> bool {
        true
    }

    /// c of a walk's first surface vertex, 1 unless the end is connected to it otherwise than it was sampled.
    fn first_link(&mut self, walk: u32, receiver: &Receiver) -> f32 {
        let _ = (walk, receiver);
        1.0
    }

    /// The same of sixteen walks.
    #[inline(always)]
    fn first_links<W: Wide>(&mut self, vertices: &VertexLanes<W>) -> W::F32 {
        let _ = vertices;
        W::F32::splat(1.0)
    }

    /// A walk leaves its end or the last vertex of its trail; only those are told that ask for it.
    #[inline]
    fn departs(&mut self, traveller: &Traveller, trail: Trail<'_, '_>) {
        let _ = (traveller, trail);
    }

    /// Whether to tell of departures.
    #[inline]
    fn watches_departures(&self) -> bool {
        false
    }

    /// A walk came to a surface, from its latest vertex or its end. It goes on with what is left of the random numbers.
    #[inline]
    fn arrives(&mut self, from: &Departure, trail: Trail<'_, '_>, sampler: &mut Sampler) {
        let _ = (from, trail, sampler);
    }

    /// Sixteen walks did. Draws as many random numbers as [`WalkVisitor::arrives`].
    #[inline(always)]
    fn arrive_together<W: Wide>(&mut self, vertices: &mut VertexLanes<W>) {
        let _ = vertices;
    }

    /// A walk ended at a vertex with this probability: by roulette if it is below 1, else as nothing was left.
    #[inline]
    fn ends(&mut self, vertex: &Vertex<'_>, probability: f32) {
        let _ = (vertex, probability);
    }

    /// A walk left the scene, after so many vertices.
    #[inline]
    fn escapes(&mut self, traveller: &Traveller, trail: Trail<'_, '_>, vertices: u32) {
        let _ = (traveller, trail, vertices);
    }
}

/// Walks that go together. Made once a thread and used again.
#[derive(Debug)]
pub struct Crowd {
    kind: SamplerKind,
    /// On their way.
    travellers: Vec<TravellerRows>,
    next: Vec<TravellerRows>,
    order: Order,
}

impl Default for Crowd {
    fn default() -> Self {
        let (travellers, next) = (Vec::new(), Vec::new());
        Self { kind: SamplerKind::Independent, travellers, next, order: Order::default() }
    }
}

impl Crowd {
    /// Adds a walk; all must have random numbers of the same kind.
    #[inline]
    pub fn push(&mut self, traveller: Traveller) {
        self.kind = traveller.sampler.kind();
        self.travellers.push(traveller.rows());
    }

    /// Forgets all walks.
    pub fn clear(&mut self) {
        self.travellers.clear();
    }
}

impl<'a> Walk<'a> {
    /// Sends the travellers of a crowd to the ends of their walks, and appends their surface vertices to an empty `path`; of a visitor
    /// that is [`WalkVisitor::WIDE`] only those that it was told of.
    pub fn run(
        &self,
        crowd: &mut Crowd,
        counts: &mut WalkCounts,
        path: &mut Vec<Vertex<'a>>,
        visitor: &mut impl WalkVisitor,
    ) {
        for number in 1.. {
            if visitor.watches_departures() {
                for rows in &crowd.travellers {
                    let traveller = Traveller::from_rows(rows, crowd.kind);
                    visitor.departs(&traveller, Trail::new(path, traveller.last));
                }
            }
            let walks = crowd.travellers.len();
            if walks == 0 || number > self.max_vertices {
                break;
            }
            counts.edges += walks as u64;
            counts.rays.closest += walks as u64;
            crowd.order.sort(crowd.travellers.iter().map(|[row, _]| row));
            wide::dispatch(Step { walk: self, crowd, number, counts, path, visitor });
            std::mem::swap(&mut crowd.travellers, &mut crowd.next);
            crowd.next.clear();
        }
        crowd.travellers.clear();
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
        let wo = -traveller.departure.ray.direction;
        let scatterer = self.scene.scatterer(&point, wo);
        if number == 1 {
            let normal = scatterer.receiving_normal();
            let receiver = Receiver { position: point.position, normal };
            traveller.departure.link = visitor.first_link(traveller.walk, &receiver);
        }
        let from = &traveller.departure;
        let others = self.others(from, &point);
        if !others.is_finite() {
            return false;
        }
        let last = path.len() as u32;
        path.push(Vertex {
            scatterer,
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
        visitor.arrives(&traveller.departure, Trail::new(path, last), &mut traveller.sampler);
        if self.is_last(number) {
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
        let (eta, scale) = (traveller.eta, traveller.scale);
        let survival = self.survival(number, vertex.throughput, next.throughput, scale * eta * eta);
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

    /// Whether walks end at their vertices of this number.
    #[inline(always)]
    fn is_last(&self, number: usize) -> bool {
        number >= self.max_vertices && !self.leaves_last
    }

    /// What the vertex knows at which a departure arrives.
    #[inline]
    fn others(&self, from: &Departure, point: &SurfacePoint) -> Others {
        let edge = Edge {
            from: from.position,
            to: point.position,
            direction: from.ray.direction,
            cos: from.cos,
            normal: point.geometric_normal,
            infinite: from.infinite,
        };
        let (mut there, back) = edge.per_area();
        if from.infinite && is_seeded(Fault::DistantDensity) {
            there /= (point.position - from.position).length_squared();
        }
        from.arrive(there, back)
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
            chain: Others { connected, ..*others }.root(self.heuristic, back),
            normal: vertex.scatterer.receiving_normal(),
        }
    }

    /// Probability of going on from a vertex of this number; `scale` makes the throughput behind it relative to that at the start.
    #[inline(always)]
    fn survival<F: Float>(&self, number: usize, before: Spectra<F>, after: Spectra<F>, scale: F) -> F {
        match self.survival {
            Survival::Roulette(roulette) if (number as u32) < roulette.start_depth => F::splat(1.0),
            Survival::Roulette(roulette) => {
                let relative = after.max_element() * scale;
                relative.max(F::splat(0.0)).min(F::splat(roulette.max_survival))
            }
            Survival::Analog => {
                let kept = after.max_element() / before.max_element();
                kept.min(F::splat(Roulette::default().max_survival))
            }
        }
    }
}

/// An edge of a walk, or of as many as `F` has lanes.
struct Edge<F: Float> {
    from: Vector<F>,
    to: Vector<F>,
    /// Unit.
    direction: Vector<F>,
    /// |cos| at its beginning.
    cos: F,
    /// Geometric normal at its end.
    normal: Vector<F>,
    /// Whether it begins infinitely far.
    infinite: F::Mask,
}

impl<F: Float> Edge<F> {
    /// What turns densities per solid angle into those per area at its end and, seen from there, at its beginning.
    #[inline(always)]
    fn per_area(&self) -> (F, F) {
        let one = F::splat(1.0);
        let cos = self.normal.dot(self.direction).abs();
        let per_area = one / (self.to - self.from).length_squared();
        let there = cos.select(self.infinite, cos * per_area);
        (there, one.select(self.infinite, self.cos * per_area))
    }
}

/// One edge of every walk.
struct Step<'w, 'a, V> {
    walk: &'w Walk<'a>,
    crowd: &'w mut Crowd,
    /// That of the vertices at its end.
    number: usize,
    counts: &'w mut WalkCounts,
    path: &'w mut Vec<Vertex<'a>>,
    visitor: &'w mut V,
}

impl<V: WalkVisitor> Kernel for Step<'_, '_, V> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(mut self) {
        let wide = self.visitor.is_wide() && !fault::is_any_seeded();
        let order = std::mem::take(&mut self.crowd.order);
        for numbers in order.groups() {
            let travellers = TravellerLanes::<W::F32>::load(&self.crowd.travellers, numbers);
            let active = (1 << numbers.len()) - 1;
            let rays = travellers.ray.packet();
            let hits = self.walk.scene.accel().closest_packet(&rays, active);
            let done = if V::WIDE && W::REGISTERS && wide {
                self.together::<W>(travellers, active, &hits)
            } else {
                0
            };
            for lane in lanes_of(active & !done) {
                self.alone(numbers[lane] as usize, &hits, lane);
            }
        }
        self.crowd.order = order;
    }
}

impl<V: WalkVisitor> Step<'_, '_, V> {
    /// What one walk does.
    fn alone(&mut self, number: usize, hits: &HitPacket, lane: usize) {
        let Self { walk, crowd, counts, path, visitor, .. } = self;
        let mut traveller = Traveller::from_rows(&crowd.travellers[number], crowd.kind);
        let ray = traveller.departure.ray;
        let u = || traveller.sampler.next_1d();
        match hits.get(lane).and_then(|hit| walk.scene.point(&ray, &hit, &mut counts.rays, u)) {
            None => {
                let trail = Trail::new(path, traveller.last);
                visitor.escapes(&traveller, trail, self.number as u32 - 1);
            }
            Some(point) => {
                if walk.arrive(&mut traveller, point, self.number, path, *visitor) {
                    crowd.next.push(traveller.rows());
                }
            }
        }
    }

    /// What sixteen walks do; which of them have been dealt with.
    #[inline(always)]
    fn together<W: Wide>(&mut self, mut from: TravellerLanes<W::F32>, active: u32, hits: &HitPacket) -> u32 {
        let (walk, number) = (self.walk, self.number);
        let mut arrivals = Arrivals::new(walk.scene, active, hits);
        if V::LIGHTS_ALONE {
            arrivals.lanes &= !arrivals.emitting;
        }
        // Those that leave a lit scene go one by one.
        let gone = if walk.scene.is_dark_outside() { arrivals.gone } else { 0 };
        let done = arrivals.lanes | gone;
        let last = walk.is_last(number);
        if arrivals.lanes == 0 || last && !V::LAST_MATTER {
            return done;
        }
        let points = arrivals.points::<W>(from.ray.origin, from.ray.direction);
        let wo = -from.ray.direction;
        let materials = arrivals.materials::<W>(points.shading_normal, wo);
        let zero = W::F32::splat(0.0);
        let mut vertices = VertexLanes {
            lanes: W::Mask::from_bits(arrivals.lanes),
            walk: from.walk,
            number: number as u32,
            lobes: LobeLanes::new(materials, points.geometric_normal, wo, walk.mode),
            points: ShadowPoint {
                position: points.position,
                error: points.error,
                geometric_normal: points.geometric_normal,
            },
            throughput: from.throughput,
            others: Others { connected: zero, shorter: zero },
            time: from.ray.time,
            draws: from.draws(self.crowd.kind),
        };
        if number == 1 {
            from.link = self.visitor.first_links(&vertices);
        }
        let edge = Edge {
            from: from.position,
            to: vertices.points.position,
            direction: from.ray.direction,
            cos: from.cos,
            normal: vertices.points.geometric_normal,
            infinite: !from.infinite.equal(zero),
        };
        let (there, back) = edge.per_area();
        vertices.others = Others::arrive(from.pdf, from.chain, from.link, there, back);
        vertices.lanes = vertices.lanes & vertices.others.is_finite();
        self.visitor.arrive_together(&mut vertices);
        if !last {
            self.leave(&vertices, from);
        }
        done
    }

    /// Sends sixteen walks on.
    #[inline(always)]
    fn leave<W: Wide>(&mut self, vertices: &VertexLanes<W>, from: TravellerLanes<W::F32>) {
        let splat = W::F32::splat;
        let mut draws = vertices.draws;
        // No model of a single lobe asks which.
        draws.skip(1);
        let proposal = vertices.lobes.materials.propose(vertices.lobes.local_wo, draws.next_2d());
        let wi = vertices.lobes.materials.frame.to_world(proposal.wi);
        let weight = proposal.weight * vertices.lobes.adjoint_correction(wi);
        let mut throughput = vertices.throughput * weight;
        let mut alive = vertices.lanes & proposal.valid & throughput.is_lit();
        let scale = from.scale * from.eta * from.eta;
        let survival = self.walk.survival(self.number, vertices.throughput, throughput, scale);
        let plays = survival.lt(splat(1.0));
        if plays.any() {
            let before = draws.dimension;
            let u = draws.next_1d();
            draws.dimension = draws.dimension.select(plays, before);
            alive = alive.and_not(plays & survival.le(u));
            throughput = (throughput * (splat(1.0) / survival)).select(plays, throughput);
        }
        let mut next = from;
        next.ray.origin = vertices.points.leave(wi);
        next.ray.direction = wi;
        next.ray.tnear = splat(0.0);
        next.ray.tfar = splat(f32::INFINITY);
        next.throughput = throughput;
        next.pdf = proposal.pdf;
        next.cos = vertices.points.geometric_normal.dot(wi).abs();
        next.infinite = splat(0.0);
        next.position = vertices.points.position;
        next.normal = vertices.lobes.materials.frame.normal;
        next.link = splat(1.0);
        next.chain = vertices.others.root(self.walk.heuristic, vertices.lobes.pdf_back(wi));
        next.dimension = draws.dimension;
        let [a, b] = next.rows();
        self.crowd.next.extend(lanes_of(alive.bits()).map(|lane| [a[lane], b[lane]]));
    }
}
