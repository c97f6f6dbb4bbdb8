//! Light tracing: walks from the lights, seen at every vertex (Arvo 1986; Dutré, Lafortune and Willems 1993).
//!
//! A light is chosen, a point on it, and a direction; the walk carries the light's power. At every surface a number decides
//! whether to reflect, to transmit or to absorb, and the surface is connected to a point on the lens: this is the one strategy
//! t = 1 of bidirectional path tracing, for all s, with weight one. What is seen in mirrors and through smooth glass is missing,
//! since no connection can be made there.

use lichtweg_montecarlo::Sampler;

use super::WalkCounts;
use super::bidirectional::{Bidirectional, Contribution, ContributionSink, Pair, Workspace};
use super::light_end::LightStart;
use super::sensor::Sensor;
use super::vertex::{Departure, Vertex};
use super::walk::{Survival, Walk, WalkVisitor};
use crate::bsdf::Mode;
use crate::scene::description::IntegratorDescription;
use crate::scene::{Scene, SurfacePoint};

/// Light tracing.
#[derive(Clone, Copy, Debug)]
pub struct LightTracer {
    settings: Bidirectional,
}

/// Nothing but the walk counts.
struct Silent;

impl WalkVisitor for Silent {
    fn first_link(&mut self, _: &SurfacePoint) -> f64 {
        0.0
    }
}

/// Gives all paths weight one.
struct Unweighted<'s, S>(&'s mut S);

impl<S: ContributionSink> ContributionSink for Unweighted<'_, S> {
    const UNWEIGHTED: bool = true;

    fn add(&mut self, contribution: &Contribution<'_, '_>) {
        self.0.add(&Contribution { weight: 1.0, ..*contribution });
    }
}

impl LightTracer {
    /// From a scene's wishes.
    pub fn new(description: &IntegratorDescription) -> Self {
        Self { settings: Bidirectional::new(description) }
    }

    /// One walk from a light, at a time, and what the camera sees of it.
    #[allow(clippy::too_many_arguments, reason = "the two ends, their numbers, and where things go")]
    pub fn sample<'a>(
        &self,
        scene: &'a Scene,
        sensor: &Sensor<'_>,
        time: f32,
        sampler: &mut Sampler,
        workspace: &mut Workspace<'a>,
        counts: &mut WalkCounts,
        sink: &mut impl ContributionSink,
    ) {
        let Bidirectional { max_depth, hide_emitters, heuristic, .. } = self.settings;
        if max_depth == 0 {
            return;
        }
        let camera = sensor.camera.at(time);
        let sensor = &Sensor { camera: &camera, ..*sensor };
        let lens = sensor.camera.lens_point([0.5; 2]);
        let light = workspace.light();
        let sink = &mut Unweighted(sink);
        let start = LightStart::sample(scene, sampler);
        if let Some(start) = &start {
            walk_analog(
                scene,
                start.depart(time, heuristic),
                max_depth - 1,
                sampler,
                counts,
                light,
                &mut Silent,
            );
        }
        let mut pair = Pair { settings: &self.settings, scene, sensor, time, lens, expected: 0.0, counts };
        if !hide_emitters {
            pair.connect_ends(sampler, sink);
        }
        if let Some(start) = &start {
            for n in 1..=light.len() {
                pair.connect_to_lens(&light[..n], start, sampler, sink);
            }
        }
    }
}

/// A walk from a light that carries its power on to where it is absorbed, over so many surfaces at most.
pub fn walk_analog<'a>(
    scene: &'a Scene,
    start: Departure,
    max_vertices: u32,
    sampler: &mut Sampler,
    counts: &mut WalkCounts,
    path: &mut Vec<Vertex<'a>>,
    visitor: &mut impl WalkVisitor,
) -> Option<Departure> {
    let walk = Walk {
        scene,
        mode: Mode::Importance,
        heuristic: crate::scene::description::Heuristic::Balance,
        survival: Survival::Analog,
        max_vertices: max_vertices as usize,
        leaves_last: false,
    };
    walk.run(start, sampler, counts, path, visitor)
}
