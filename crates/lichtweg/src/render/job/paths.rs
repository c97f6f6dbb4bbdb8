//! The paths of one sample, written out.

use super::*;
use crate::transport::{Bidirectional, Contribution, ContributionSink, ExplicitPath, Sensor, Workspace};

/// A path of a sample.
#[derive(Clone, Debug)]
pub struct FoundPath {
    /// Its factors and densities.
    pub path: ExplicitPath,
    /// Value over density, as the estimator computed it.
    pub value: [f32; 3],
    /// Its weight, as the estimator computed it.
    pub weight: f32,
    /// Where it falls on the film, in pixels; nothing where it belongs to the sample's pixel.
    pub place: Option<[f32; 2]>,
}

struct Finder<'f> {
    scene: &'f Scene,
    sensor: &'f Sensor<'f>,
    tracer: &'f Bidirectional,
    size: [u32; 2],
    found: Vec<FoundPath>,
}

impl ContributionSink for Finder<'_> {
    const ROUTES: bool = true;

    fn add(&mut self, c: &Contribution<'_, '_>) {
        if let Some(path) = ExplicitPath::new(c, self.scene, self.sensor, self.tracer) {
            self.found.push(FoundPath {
                path,
                value: c.value.to_rgb(),
                weight: c.weight,
                place: c.film.map(|[x, y]| [x * self.size[0] as f32, y * self.size[1] as f32]),
            });
        }
    }
}

impl Job {
    /// The paths that bidirectional path tracing makes of one sample of a pixel, joined with its own walk from a light alone, and the
    /// weight of the reconstruction filter.
    pub fn paths(
        &self,
        description: &Description,
        scene: &Scene,
        pixel: [u32; 2],
        index: u32,
    ) -> (Vec<FoundPath>, f32) {
        let (pair, weight) = self.pair(pixel, index, 0.0);
        let camera = self.camera.at(pair.ray.time);
        let sensor = Sensor::new(&camera, self.size, self.window, self.filter.radius());
        let tracer = Bidirectional::new(&description.integrator);
        let mut finder =
            Finder { scene, sensor: &sensor, tracer: &tracer, size: self.size, found: Vec::new() };
        let (mut workspace, mut counts) = (Workspace::default(), WalkCounts::default());
        tracer.follow(scene, &sensor, &[pair], 1, &mut workspace, &mut counts, &mut finder);
        (finder.found, weight)
    }
}
