//! Light tracing: walks from the lights, seen at every vertex (Arvo 1986; Dutré, Lafortune and Willems 1993).
//!
//! A light is chosen, a point on it, and a direction; the walk carries the light's power. At every surface a number decides
//! whether to reflect, to transmit or to absorb, and the surface is connected to a point on the lens: this is the one strategy
//! t = 1 of bidirectional path tracing, for all s, with weight one. What is seen in mirrors and through smooth glass is missing,
//! since no connection can be made there.

use lichtweg_montecarlo::Sampler;

use super::WalkCounts;
use super::bidirectional::{Bidirectional, Contribution, ContributionSink, END_DIMENSION, Pair, Workspace};
use super::connect::Joiner;
use super::sensor::Sensor;
use super::vertex::{Departure, Trail, Vertex};
use super::walk::{Crowd, Survival, Walk, WalkVisitor};
use crate::bsdf::Mode;
use crate::scene::Scene;
use crate::scene::description::{Heuristic, IntegratorDescription};

/// Light tracing.
#[derive(Clone, Copy, Debug)]
pub struct LightTracer {
    settings: Bidirectional,
}

/// Looks at every vertex.
struct Watched<'j, 'p, 'a, S>(&'j mut Joiner<'p, 'a, S>);

impl<S: ContributionSink> WalkVisitor for Watched<'_, '_, '_, S> {
    #[inline]
    fn arrives(&mut self, _: &Departure, trail: Trail<'_, '_>, sampler: &mut Sampler) {
        self.0.connect_to_lens(trail, sampler);
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

    /// A walk from a light for each pair, and what the camera sees of it.
    pub fn follow<'a>(
        &self,
        scene: &'a Scene,
        sensor: &Sensor<'_>,
        pairs: &[Pair],
        workspace: &mut Workspace<'a>,
        counts: &mut WalkCounts,
        sink: &mut impl ContributionSink,
    ) {
        let Bidirectional { max_depth, hide_emitters, .. } = self.settings;
        if max_depth == 0 {
            return;
        }
        workspace.start_from_lights(scene, pairs, &self.settings);
        let Workspace { crowd, starts, light, queue, .. } = workspace;
        let sink = &mut Unweighted(sink);
        let mut joiner = Joiner { settings: &self.settings, scene, sensor, pairs, queue, sink };
        if !hide_emitters {
            for (walk, pair) in (0..).zip(pairs) {
                joiner.connect_ends(walk, &mut pair.light.at_dimension(END_DIMENSION));
            }
        }
        walk_analog(scene, crowd, max_depth - 1, counts, light, &mut Watched(&mut joiner));
        joiner.flush(light, &[], starts, &mut counts.rays);
    }
}

/// Walks from lights that carry their power on to where it is absorbed, over so many surfaces at most.
pub fn walk_analog<'a>(
    scene: &'a Scene,
    crowd: &mut Crowd,
    max_vertices: u32,
    counts: &mut WalkCounts,
    path: &mut Vec<Vertex<'a>>,
    visitor: &mut impl WalkVisitor,
) {
    let walk = Walk {
        scene,
        mode: Mode::Importance,
        heuristic: Heuristic::Balance,
        survival: Survival::Analog,
        max_vertices: max_vertices as usize,
        leaves_last: false,
    };
    walk.run(crowd, counts, path, visitor);
}
