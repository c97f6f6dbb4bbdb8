//! Bidirectional path tracing (Lafortune and Willems 1993; Veach and Guibas 1994; Veach 1997, chapter 10).
//!
//! One sample is a pair of walks, one from the eye and one from a light, and all the ways to join them: the first s vertices of
//! the walk from the light with the first t of the walk from the eye, each weighted against all others that make a path of the
//! same vertices (see [`super::vertex`]).
//!
//! - s = 0: the walk from the eye runs into a light.
//! - s = 1: a vertex of the walk from the eye is connected to a point on a light that is chosen for it.
//! - t = 1: a vertex of the walk from the light is connected to a point on the lens; falls anywhere on the film.
//! - t = 0: the walk from the light runs into the lens, if that has an area; falls anywhere on the film.
//!
//! Many pairs are followed together (see [`Walk::run`] and [`super::join`]); what comes of a pair does not depend on those that it
//! shares no walks with.
//!
//! Emitters that the camera sees directly (paths of one edge) are left to s = 0 alone, which sees them without any variance but
//! that of their edges. Lights at a point or in a direction are not seen directly, by any strategy.

use lichtweg_montecarlo::{Roulette, Sampler};
use lichtweg_ray::Ray;
use lichtweg_ray::math::Vec3;
use lichtweg_ray::wide::{Float, FloatLanes, Lanes, Mask, Wide, WordLanes};

use super::WalkCounts;
use super::connect::Joiner;
use super::join::{Connection, Ends};
use super::joint::Joints;
use super::light_end::{LightEnd, LightStart};
use super::partners::Partners;
use super::sensor::Sensor;
use super::traveller::Traveller;
use super::vertex::{Departure, Trail, Vertex};
use super::vertex_lanes::VertexLanes;
use super::visibility::ShadowQueue;
use super::walk::{Crowd, Survival, Walk, WalkVisitor};
use crate::bsdf::Mode;
use crate::color::Spectrum;
use crate::lanes::BELOW_ONE;
use crate::lanes::{lanes_of, lanes_of_vector, vec3};
use crate::light::Receiver;
use crate::scene::Scene;
use crate::scene::description::{Heuristic, IntegratorDescription};

/// Bidirectional path tracing.
#[derive(Clone, Copy, Debug)]
pub struct Bidirectional {
    pub(super) heuristic: Heuristic,
    pub(super) max_depth: u32,
    roulette: Roulette,
    pub(super) hide_emitters: bool,
    /// Walks from lights that a walk from the eye is joined with.
    pub(super) partners: u32,
    /// Points on lights that each vertex of a walk from the eye is connected with.
    pub(super) lights: u32,
}

/// A path that one strategy made.
#[derive(Debug)]
pub struct Contribution<'p, 'a> {
    /// Number of the pair among those that are followed together.
    pub sample: u32,
    /// Vertices of the walk from the light.
    pub s: u32,
    /// Vertices of the walk from the eye.
    pub t: u32,
    /// Where it falls on the film, in [0, 1]^2; nothing where it belongs to the pixel that the walk from the eye began at.
    pub film: Option<[f32; 2]>,
    /// Value over density, that of all paths which the strategy makes for a walk from the eye.
    pub value: Spectrum,
    /// Its weight among the strategies.
    pub weight: f32,
    /// Where it leads along: told where [`ContributionSink::ROUTES`] asks for it.
    pub route: Option<Route<'p, 'a>>,
}

/// Where a path leads along.
#[derive(Clone, Copy, Debug)]
pub struct Route<'p, 'a> {
    /// The point on the light.
    pub end: &'p LightEnd,
    /// The point on the lens.
    pub lens: Vec3,
    /// Surface vertices that the walk from the light made, from the light on.
    pub light: Trail<'p, 'a>,
    /// Surface vertices that the walk from the eye made, from the eye on; with s = 0 the last may be the point on the light.
    pub eye: Trail<'p, 'a>,
}

/// Takes the paths of samples. Those of one sample come in an order that does not depend on what is followed with it.
pub trait ContributionSink {
    /// Whether it wants to see paths of weight zero, too: those of one edge, in other ways than by walks from the eye.
    const UNWEIGHTED: bool = false;

    /// Whether it wants to know where paths lead along: every walk then goes alone.
    const ROUTES: bool = false;

    /// A path was made.
    fn add(&mut self, contribution: &Contribution<'_, '_>);
}

/// Tells a function of every path, those of weight zero, too. All that look at paths so share one compilation of the walks.
pub struct Teller<'f>(pub &'f mut dyn FnMut(&Contribution<'_, '_>));

impl ContributionSink for Teller<'_> {
    const UNWEIGHTED: bool = true;

    fn add(&mut self, contribution: &Contribution<'_, '_>) {
        (self.0)(contribution);
    }
}

/// The random numbers of paths of one edge stand behind all those that a walk can use.
pub(super) const END_DIMENSION: u32 = 1 << 29;

/// A pair of walks to be made, from the eye and from a light.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// The camera ray, of unit direction.
    pub ray: Ray,
    /// Random numbers of the walk from the eye.
    pub eye: Sampler,
    /// Random numbers of the walk from a light.
    pub light: Sampler,
    /// About the radiance that the eye will see: connections of much smaller value are looked at by chance only. Any number that does
    /// not depend on the walks is right, and 0 looks at all.
    pub expected: f32,
}

/// What is used again for one set of pairs after the other.
#[derive(Debug, Default)]
pub struct Workspace<'a> {
    pub(super) crowd: Crowd,
    pub(super) starts: Vec<Option<LightStart>>,
    /// Vertices of walks that went alone.
    pub(super) light: Vec<Vertex<'a>>,
    eye: Vec<Vertex<'a>>,
    /// Vertices that wait for connections, of walks from the lights and from the eye.
    joints: [Joints; 2],
    pub(super) queue: ShadowQueue,
    connections: Vec<Connection>,
    partners: Partners,
}

impl Workspace<'_> {
    /// Begins a walk from a light for each pair that finds one.
    pub(super) fn start_from_lights(&mut self, scene: &Scene, pairs: &[Pair], settings: &Bidirectional) {
        self.light.clear();
        self.starts.clear();
        self.crowd.clear();
        for (walk, pair) in (0..).zip(pairs) {
            let mut sampler = pair.light;
            let start = LightStart::sample(scene, &mut sampler);
            if let Some(start) = &start {
                let departure = start.depart(pair.ray.time, settings.once());
                self.crowd.push(Traveller::new(walk, departure, sampler));
            }
            self.starts.push(start);
        }
    }

    /// Begins a walk from the eye for each pair.
    fn start_from_eye(&mut self, sensor: &Sensor<'_>, pairs: &[Pair], settings: &Bidirectional) {
        self.eye.clear();
        self.crowd.clear();
        for (walk, pair) in (0..).zip(pairs) {
            let camera = sensor.camera.at(pair.ray.time);
            let departure = sensor.with(&camera).depart(pair.ray, settings.once());
            self.crowd.push(Traveller::new(walk, departure, pair.eye));
        }
    }
}

/// Walks from the eye run into lights, and every vertex is connected to one.
struct FromEye<'j, 'p, 'a, S> {
    joiner: &'j mut Joiner<'p, 'a, S>,
    joints: &'j mut Joints,
}

impl<S: ContributionSink> WalkVisitor for FromEye<'_, '_, '_, S> {
    const LIGHTS_ALONE: bool = true;
    const LAST_MATTER: bool = false;
    const WIDE: bool = !S::ROUTES;

    fn first_link(&mut self, _: u32, _: &Receiver) -> f32 {
        self.joiner.settings.once()
    }

    #[inline(always)]
    fn first_links<W: Wide>(&mut self, _: &VertexLanes<W>) -> W::F32 {
        W::F32::splat(self.joiner.settings.once())
    }

    #[inline]
    fn arrives(&mut self, from: &Departure, trail: Trail<'_, '_>, sampler: &mut Sampler) {
        self.joiner.run_into_light(from, trail);
        if trail.last().is_some_and(|vertex| vertex.number < self.joiner.settings.max_depth) {
            self.joiner.connect_to_light(trail, sampler);
        }
    }

    #[inline(always)]
    fn arrive_together<W: Wide>(&mut self, vertices: &mut VertexLanes<W>) {
        self.joiner.connect_to_lights(vertices);
        if self.joiner.settings.joins(vertices.number) {
            self.joints.append(vertices, self.joiner.settings.heuristic);
        }
    }

    fn escapes(&mut self, traveller: &Traveller, trail: Trail<'_, '_>, vertices: u32) {
        self.joiner.run_out_of_scene(traveller.walk, &traveller.departure, trail, vertices);
    }
}

/// Walks from a light run into the lens, and every vertex is connected to it.
struct FromLight<'j, 'p, 'a, S> {
    joiner: &'j mut Joiner<'p, 'a, S>,
    joints: &'j mut Joints,
    starts: &'j [Option<LightStart>],
    has_lens: bool,
}

impl<S> FromLight<'_, '_, '_, S> {
    #[inline]
    fn link(&self, walk: u32, receiver: &Receiver) -> f32 {
        let Joiner { scene, settings, .. } = *self.joiner;
        let start = self.starts[walk as usize].as_ref();
        settings.lit() * start.map_or(0.0, |start| start.first_link(receiver, scene))
    }
}

impl<S: ContributionSink> WalkVisitor for FromLight<'_, '_, '_, S> {
    const WIDE: bool = !S::ROUTES;

    #[inline(always)]
    fn is_wide(&self) -> bool {
        !self.has_lens && self.joiner.sensor.camera.is_fixed()
    }

    fn first_link(&mut self, walk: u32, receiver: &Receiver) -> f32 {
        self.link(walk, receiver)
    }

    #[inline(always)]
    fn first_links<W: Wide>(&mut self, vertices: &VertexLanes<W>) -> W::F32 {
        let (position, normal) = (vertices.points.position, vertices.lobes.materials.frame.normal);
        let (position, normal) = (lanes_of_vector(position), lanes_of_vector(normal));
        let walk = vertices.walk.to_lanes();
        let mut links = Lanes::splat(0.0);
        for lane in lanes_of(vertices.lanes.bits()) {
            let receiver = Receiver { position: vec3(&position, lane), normal: vec3(&normal, lane) };
            links.0[lane] = self.link(walk.0[lane], &receiver);
        }
        W::F32::load(&links)
    }

    #[inline]
    fn watches_departures(&self) -> bool {
        self.has_lens
    }

    #[inline]
    fn departs(&mut self, traveller: &Traveller, trail: Trail<'_, '_>) {
        let Traveller { walk, departure, .. } = traveller;
        if let Some(start) = self.starts[*walk as usize].as_ref() {
            self.joiner.run_into_lens(*walk, start, departure, trail);
        }
    }

    #[inline]
    fn arrives(&mut self, _: &Departure, trail: Trail<'_, '_>, sampler: &mut Sampler) {
        self.joiner.connect_to_lens(trail, sampler);
    }

    #[inline(always)]
    fn arrive_together<W: Wide>(&mut self, vertices: &mut VertexLanes<W>) {
        self.joiner.connect_to_lenses(vertices);
        if self.joiner.settings.joins(vertices.number) {
            self.joints.append(vertices, self.joiner.settings.heuristic);
        }
    }
}

impl Bidirectional {
    /// From a scene's wishes.
    pub fn new(description: &IntegratorDescription) -> Self {
        Self {
            heuristic: description.heuristic,
            max_depth: description.max_depth.unwrap_or(u32::MAX),
            roulette: match description.roulette.start_depth {
                Some(start_depth) => Roulette { start_depth, ..Roulette::default() },
                None => Roulette::OFF,
            },
            hide_emitters: description.hide_emitters,
            partners: 1,
            lights: 1,
        }
    }

    /// Joins each walk from the eye with so many walks from lights. Where things move, walks at different times must not meet: one it
    /// has to be then.
    pub fn with_partners(self, partners: u32) -> Self {
        Self { partners: partners.max(1), ..self }
    }

    /// Connects each vertex of a walk from the eye with so many points on lights.
    pub fn with_lights(self, lights: u32) -> Self {
        Self { lights: lights.max(1), ..self }
    }

    /// c of the strategies of which there is one path for each pair, where those that join two walks have `partners` (Veach 1997,
    /// section 9.2.1: the weights are of densities times numbers of samples).
    #[inline]
    pub(super) fn once(&self) -> f32 {
        1.0 / self.partners as f32
    }

    /// c of the strategies with a single vertex chosen on a light, of which there are `lights` for each walk from the eye.
    #[inline]
    pub(super) fn lit(&self) -> f32 {
        self.lights as f32 * self.once()
    }

    /// The random number that chooses a light, for one after the other of those that a vertex is connected with: they are stratified.
    #[inline(always)]
    pub(super) fn stratified<F: Float>(&self, number: u32, u: F) -> F {
        ((F::splat(number as f32) + u) * F::splat(1.0 / self.lights as f32)).min(F::splat(BELOW_ONE))
    }

    /// Whether vertices of this number are joined with those of the other walk.
    #[inline]
    fn joins(&self, number: u32) -> bool {
        number.saturating_add(2) <= self.max_depth
    }

    /// Makes pairs of walks, and all that comes of them. Pairs come in rows of a length, the last of which may not be cut short: those
    /// of a row may share their walks from lights.
    #[allow(clippy::too_many_arguments, reason = "the two ends, their numbers, and where things go")]
    pub fn follow<'a, S: ContributionSink>(
        &self,
        scene: &'a Scene,
        sensor: &Sensor<'_>,
        pairs: &[Pair],
        row: usize,
        workspace: &mut Workspace<'a>,
        counts: &mut WalkCounts,
        sink: &mut S,
    ) {
        if self.max_depth == 0 {
            return;
        }
        workspace.start_from_lights(scene, pairs, self);
        workspace.joints.iter_mut().for_each(Joints::clear);
        let Workspace { crowd, starts, light, joints: [joints, _], queue, .. } = workspace;
        let mut joiner = Joiner { settings: self, scene, sensor, pairs, queue, sink };
        self.walk_from_lights(&mut joiner, crowd, starts, light, joints, counts);
        workspace.start_from_eye(sensor, pairs, self);
        let Workspace { crowd, starts, light, eye, joints, queue, connections, partners } = workspace;
        let mut joiner = Joiner { settings: self, scene, sensor, pairs, queue, sink };
        if S::UNWEIGHTED {
            for (walk, pair) in (0..).zip(pairs) {
                joiner.connect_ends(walk, &mut pair.eye.at_dimension(END_DIMENSION));
            }
        }
        let walk = self.walk(scene, Mode::Radiance, self.max_depth);
        let [light_joints, eye_joints] = joints;
        let mut visitor = FromEye { joiner: &mut joiner, joints: eye_joints };
        walk.run(crowd, counts, eye, &mut visitor);
        joiner.flush(light, eye, starts, &mut counts.rays);
        self.wait(light, light_joints, Mode::Importance);
        self.wait(eye, eye_joints, Mode::Radiance);
        let light = Ends { joints: light_joints, alone: light };
        let eye = Ends { joints: eye_joints, alone: eye };
        joiner.join(partners, connections, row, [light, eye], starts, &mut counts.rays);
    }

    /// Lets the vertices of walks that went alone wait for connections.
    fn wait(&self, alone: &[Vertex<'_>], joints: &mut Joints, mode: Mode) {
        for (i, vertex) in (0..).zip(alone) {
            if self.joins(vertex.number) {
                joints.push(vertex, i, mode, self.heuristic);
            }
        }
    }

    fn walk<'a>(&self, scene: &'a Scene, mode: Mode, max_vertices: u32) -> Walk<'a> {
        Walk {
            scene,
            mode,
            heuristic: self.heuristic,
            survival: Survival::Roulette(self.roulette),
            max_vertices: max_vertices as usize,
            leaves_last: false,
        }
    }

    /// Walks from the lights; as far as the lens can be connected to, or a step further if it can be hit.
    fn walk_from_lights<'a, S: ContributionSink>(
        &self,
        joiner: &mut Joiner<'_, 'a, S>,
        crowd: &mut Crowd,
        starts: &[Option<LightStart>],
        light: &mut Vec<Vertex<'a>>,
        joints: &mut Joints,
        counts: &mut WalkCounts,
    ) {
        // Every vertex is connected to all those of the other walk: vertices that carry little cost too much to play late.
        let roulette = match self.roulette {
            Roulette::OFF => Roulette::OFF,
            roulette => Roulette { start_depth: 1, ..roulette },
        };
        let has_lens = joiner.sensor.camera.lens_pdf().is_some();
        let walk = Walk {
            survival: Survival::Roulette(roulette),
            leaves_last: has_lens,
            ..self.walk(joiner.scene, Mode::Importance, self.max_depth - 1)
        };
        // Edges are counted of walks from the eye.
        let mut of_lights = WalkCounts::default();
        walk.run(crowd, &mut of_lights, light, &mut FromLight { joiner, joints, starts, has_lens });
        joiner.flush(light, &[], starts, &mut of_lights.rays);
        counts.rays.merge(&of_lights.rays);
    }
}
