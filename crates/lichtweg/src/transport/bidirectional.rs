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
//! Emitters that the camera sees directly (paths of one edge) are left to s = 0 alone, which sees them without any variance but
//! that of their edges. Lights at a point or in a direction are not seen directly, by any strategy.

use lichtweg_montecarlo::{Roulette, Sampler};
use lichtweg_ray::Ray;
use lichtweg_ray::math::Vec3;

use super::WalkCounts;
use super::light_end::{LightEnd, LightStart};
use super::sensor::Sensor;
use super::vertex::{Departure, Vertex};
use super::walk::{Survival, Walk, WalkVisitor};
use crate::bsdf::Mode;
use crate::color::Spectrum;
use crate::scene::description::{Heuristic, IntegratorDescription};
use crate::scene::{Scene, SurfacePoint};

/// Bidirectional path tracing.
#[derive(Clone, Copy, Debug)]
pub struct Bidirectional {
    pub(super) heuristic: Heuristic,
    pub(super) max_depth: u32,
    roulette: Roulette,
    pub(super) hide_emitters: bool,
}

/// A path that one strategy made.
#[derive(Debug)]
pub struct Contribution<'p, 'a> {
    /// Vertices of the walk from the light.
    pub s: u32,
    /// Vertices of the walk from the eye.
    pub t: u32,
    /// Where it falls on the film, in [0, 1]^2; nothing where it belongs to the pixel that the walk from the eye began at.
    pub film: Option<[f32; 2]>,
    /// Value over density.
    pub value: Spectrum,
    /// Its weight among the strategies.
    pub weight: f32,
    /// The point on the light.
    pub end: LightEnd,
    /// The point on the lens.
    pub lens: Vec3,
    /// Surface vertices that the walk from the light made, from the light on.
    pub light: &'p [Vertex<'a>],
    /// Surface vertices that the walk from the eye made, from the eye on; with s = 0 the last may be the point on the light.
    pub eye: &'p [Vertex<'a>],
}

/// Takes the paths of samples.
pub trait ContributionSink {
    /// Whether it wants to see paths of weight zero, too: those of one edge, in other ways than by walks from the eye.
    const UNWEIGHTED: bool = false;

    /// A path was made.
    fn add(&mut self, contribution: &Contribution<'_, '_>);
}

/// What is used again for one sample after the other.
#[derive(Debug, Default)]
pub struct Workspace<'a> {
    eye: Vec<Vertex<'a>>,
    light: Vec<Vertex<'a>>,
    lens_hits: Vec<LensHit>,
}

impl<'a> Workspace<'a> {
    /// Room for the vertices of a walk from a light, empty.
    pub(super) fn light(&mut self) -> &mut Vec<Vertex<'a>> {
        self.light.clear();
        &mut self.light
    }
}

/// A walk from a light that ran into the lens.
#[derive(Clone, Copy, Debug)]
pub(super) struct LensHit {
    pub departure: Departure,
    /// Surface vertices before.
    pub vertices: usize,
    pub lens: Vec3,
}

/// Walks from the eye have nothing to tell.
struct FromEye;

impl WalkVisitor for FromEye {
    fn first_link(&mut self, _: &SurfacePoint) -> f64 {
        1.0
    }
}

/// Walks from a light look out for the lens.
struct FromLight<'p> {
    scene: &'p Scene,
    sensor: &'p Sensor<'p>,
    heuristic: Heuristic,
    start: &'p LightStart,
    lens_hits: &'p mut Vec<LensHit>,
}

impl WalkVisitor for FromLight<'_> {
    fn first_link(&mut self, point: &SurfacePoint) -> f64 {
        self.start.first_link(point, self.scene, self.heuristic)
    }

    #[inline]
    fn departs(&mut self, departure: &Departure, vertices: usize) {
        if let Some(lens) = self.sensor.camera.hit_lens(&departure.ray) {
            self.lens_hits.push(LensHit { departure: *departure, vertices, lens });
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
        }
    }

    /// One pair of walks, from the eye along a camera ray of unit direction and from a light, and all that comes of them.
    ///
    /// `expected` is about the radiance that the eye will see: connections of much smaller value are looked at by chance only. Any
    /// number is right, and 0 looks at all.
    #[allow(clippy::too_many_arguments, reason = "the two ends, their numbers, and where things go")]
    pub fn sample<'a>(
        &self,
        scene: &'a Scene,
        sensor: &Sensor<'_>,
        ray: Ray,
        [eye_sampler, light_sampler]: [&mut Sampler; 2],
        expected: f32,
        workspace: &mut Workspace<'a>,
        counts: &mut WalkCounts,
        sink: &mut impl ContributionSink,
    ) {
        if self.max_depth == 0 {
            return;
        }
        let camera = sensor.camera.at(ray.time);
        let sensor = &Sensor { camera: &camera, ..*sensor };
        let mut pair =
            Pair { settings: self, scene, sensor, time: ray.time, lens: ray.origin, expected, counts };
        let Workspace { eye, light, lens_hits } = workspace;
        eye.clear();
        light.clear();
        lens_hits.clear();
        let start = LightStart::sample(scene, light_sampler);
        if let Some(start) = &start {
            pair.walk_from_light(start, light_sampler, light, lens_hits);
        }
        let escape = pair.walk_from_eye(ray, eye_sampler, eye);
        pair.join_eye(eye, escape.as_ref(), eye_sampler, sink);
        if let Some(start) = &start {
            pair.join_light(start, light, lens_hits, light_sampler, sink);
            pair.join_both(start, light, eye, eye_sampler, sink);
        }
    }
}

/// One sample in the making.
pub(super) struct Pair<'p, 'a> {
    pub settings: &'p Bidirectional,
    pub scene: &'a Scene,
    pub sensor: &'p Sensor<'p>,
    pub time: f32,
    /// Where the walk from the eye begins.
    pub lens: Vec3,
    /// See [`Bidirectional::sample`].
    pub expected: f32,
    pub counts: &'p mut WalkCounts,
}

impl<'a> Pair<'_, 'a> {
    fn walk(&self, mode: Mode, max_vertices: u32) -> Walk<'a> {
        Walk {
            scene: self.scene,
            mode,
            heuristic: self.settings.heuristic,
            survival: Survival::Roulette(self.settings.roulette),
            max_vertices: max_vertices as usize,
            leaves_last: false,
        }
    }

    /// Walks from the light; as far as the lens can be connected to, or a step further if it can be hit.
    fn walk_from_light(
        &mut self,
        start: &LightStart,
        sampler: &mut Sampler,
        path: &mut Vec<Vertex<'a>>,
        lens_hits: &mut Vec<LensHit>,
    ) {
        // Every vertex is connected to all those of the other walk: vertices that carry little cost too much to play late.
        let roulette = match self.settings.roulette {
            Roulette::OFF => Roulette::OFF,
            roulette => Roulette { start_depth: 1, ..roulette },
        };
        let walk = Walk {
            survival: Survival::Roulette(roulette),
            leaves_last: self.sensor.camera.lens_pdf().is_some(),
            ..self.walk(Mode::Importance, self.settings.max_depth - 1)
        };
        let heuristic = self.settings.heuristic;
        let mut visitor = FromLight { scene: self.scene, sensor: self.sensor, heuristic, start, lens_hits };
        // Edges are counted of walks from the eye.
        let mut counts = WalkCounts::default();
        walk.run(start.depart(self.time, heuristic), sampler, &mut counts, path, &mut visitor);
        self.counts.rays.merge(&counts.rays);
    }

    /// Walks from the eye; the departure that left the scene, if one did.
    fn walk_from_eye(
        &mut self,
        ray: Ray,
        sampler: &mut Sampler,
        path: &mut Vec<Vertex<'a>>,
    ) -> Option<Departure> {
        let walk = self.walk(Mode::Radiance, self.settings.max_depth);
        let start = self.sensor.depart(ray, self.settings.heuristic);
        walk.run(start, sampler, self.counts, path, &mut FromEye)
    }

    /// All that a walk from the eye meets, and the lights its vertices are connected to.
    fn join_eye<S: ContributionSink>(
        &mut self,
        eye: &[Vertex<'a>],
        escape: Option<&Departure>,
        sampler: &mut Sampler,
        sink: &mut S,
    ) {
        if S::UNWEIGHTED {
            self.connect_ends(sampler, sink);
        }
        for n in 1..=eye.len() {
            self.run_into_light(&eye[..n], sink);
            if n < self.settings.max_depth as usize {
                self.connect_to_light(&eye[..n], sampler, sink);
            }
        }
        if let Some(departure) = escape {
            self.run_out_of_scene(departure, eye, sink);
        }
    }

    /// All ways of a walk from a light to the lens.
    fn join_light<S: ContributionSink>(
        &mut self,
        start: &LightStart,
        light: &[Vertex<'a>],
        lens_hits: &[LensHit],
        sampler: &mut Sampler,
        sink: &mut S,
    ) {
        for hit in lens_hits {
            self.run_into_lens(hit, start, &light[..hit.vertices], sink);
        }
        for n in 1..=light.len() {
            self.connect_to_lens(&light[..n], start, sampler, sink);
        }
    }

    /// Every vertex of one walk with every vertex of the other.
    fn join_both<S: ContributionSink>(
        &mut self,
        start: &LightStart,
        light: &[Vertex<'a>],
        eye: &[Vertex<'a>],
        sampler: &mut Sampler,
        sink: &mut S,
    ) {
        for m in 1..=eye.len() {
            // Edges are one more than surface vertices.
            let longest = (self.settings.max_depth as usize).saturating_sub(m + 1).min(light.len());
            for n in 1..=longest {
                self.connect(&light[..n], &eye[..m], start, sampler, sink);
            }
        }
    }
}
