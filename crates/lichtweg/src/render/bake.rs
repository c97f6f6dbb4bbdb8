//! Illumination maps (Arvo 1986, "Backward Ray Tracing"): walks from the lights leave their power in the texels of the surfaces'
//! charts, and its sum over a texel's area is the irradiance there.
//!
//! Light on either side of a surface counts. The chart of a shape is its (u, v) in [0, 1]^2; what lies outside is wrapped round, and
//! triangles that share texels share their light. A scene has to be compiled with its texture coordinates
//! ([`Description::keep_coordinates`](crate::scene::description::Description::keep_coordinates)).

mod area;

use lichtweg_montecarlo::{Sampler, SamplerKind};
use lichtweg_ray::math::Vec2;
use rayon::prelude::*;

use super::Progress;
use crate::scene::Scene;
use crate::transport::{
    Crowd, Departure, LightStart, Trail, Traveller, Vertex, WalkCounts, WalkVisitor, walk_analog,
};

/// When a walk leaves power on a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deposit {
    /// At every hit: what arrives.
    EveryHit,
    /// Where it is absorbed: what arrives, over the probability of ending there: noisy on surfaces that absorb little.
    Absorption,
}

/// How to make illumination maps.
#[derive(Clone, Copy, Debug)]
pub struct BakeSettings {
    /// Walks from the lights.
    pub walks: u64,
    /// Texels in a row, and rows.
    pub resolution: u32,
    /// When to leave power.
    pub deposit: Deposit,
    /// Of the random numbers.
    pub seed: u64,
    /// Largest number of edges from the light on.
    pub max_depth: u32,
}

/// The irradiance on a shape.
#[derive(Clone, Debug)]
pub struct IlluminationMap {
    /// Which shape.
    pub shape: u32,
    /// In W / m^2, the row of largest v first; 0 where the chart is empty.
    pub irradiance: Vec<[f32; 3]>,
}

/// Walks between two merges.
const BATCH: u64 = 1 << 16;

/// Walks of a list.
const CHUNK: u64 = 1 << 11;

/// Power left in a texel.
struct Left {
    shape: u32,
    texel: u32,
    power: [f32; 3],
}

struct Depositor<'d> {
    settings: &'d BakeSettings,
    list: &'d mut Vec<Left>,
}

impl Depositor<'_> {
    fn leave(&mut self, vertex: &Vertex<'_>, factor: f32) {
        self.list.push(Left {
            shape: vertex.point.shape,
            texel: texel(vertex.point.uv, self.settings.resolution),
            power: (vertex.throughput * factor).to_rgb(),
        });
    }
}

impl WalkVisitor for Depositor<'_> {
    fn arrives(&mut self, _: &Departure, trail: Trail<'_, '_>, _: &mut Sampler) {
        if let (Deposit::EveryHit, Some(vertex)) = (self.settings.deposit, trail.last()) {
            self.leave(vertex, 1.0);
        }
    }

    fn ends(&mut self, vertex: &Vertex<'_>, probability: f32) {
        if self.settings.deposit == Deposit::Absorption {
            self.leave(vertex, 1.0 / probability);
        }
    }
}

/// The number of the texel at surface coordinates.
fn texel(uv: Vec2, resolution: u32) -> u32 {
    let along = |c: f32| (((c - c.floor()) * resolution as f32) as u32).min(resolution - 1);
    (resolution - 1 - along(uv.y)) * resolution + along(uv.x)
}

/// Makes the maps of all shapes, on the threads of the pool this is called in; the same bits for any number of them. Ends early,
/// with the walks so far, if asked to.
pub fn bake(scene: &Scene, settings: &BakeSettings, progress: &Progress) -> Vec<IlluminationMap> {
    let texels = (settings.resolution * settings.resolution) as usize;
    let mut power = vec![vec![[0.0_f64; 3]; texels]; scene.shape_count()];
    let mut done = 0;
    while done < settings.walks && !progress.is_stopped() {
        let end = settings.walks.min(done + BATCH);
        let chunks: Vec<u64> = (done..end).step_by(CHUNK as usize).collect();
        let lists: Vec<Vec<Left>> = chunks
            .par_iter()
            .map(|&first| walk(scene, settings, first..end.min(first + CHUNK), progress))
            .collect();
        for left in lists.iter().flatten() {
            let sum = &mut power[left.shape as usize][left.texel as usize];
            sum.iter_mut().zip(left.power).for_each(|(s, p)| *s += f64::from(p));
        }
        done = end;
        progress.pass_done();
    }
    let walks = done.max(1) as f64;
    let map = |(shape, power): (usize, Vec<[f64; 3]>)| {
        let areas = area::texel_areas(scene.form(shape as u32), shape as u32, settings.resolution);
        let irradiance = power.iter().zip(areas).map(|(power, area)| {
            if area > 0.0 { power.map(|p| (p / (walks * area)) as f32) } else { [0.0; 3] }
        });
        IlluminationMap { shape: shape as u32, irradiance: irradiance.collect() }
    };
    power.into_par_iter().enumerate().map(map).collect()
}

fn walk(
    scene: &Scene,
    settings: &BakeSettings,
    walks: std::ops::Range<u64>,
    progress: &Progress,
) -> Vec<Left> {
    let (mut list, mut path, mut counts) = (Vec::new(), Vec::new(), WalkCounts::default());
    let number = walks.end - walks.start;
    let mut crowd = Crowd::default();
    for walk in walks {
        let mut sampler = Sampler::new(SamplerKind::Independent, settings.seed, walk >> 32, walk as u32);
        if let Some(start) = LightStart::sample(scene, &mut sampler) {
            let departure = start.depart(0.0, 1.0);
            crowd.push(Traveller::new(0, departure, sampler));
        }
    }
    let mut depositor = Depositor { settings, list: &mut list };
    walk_analog(scene, &mut crowd, settings.max_depth, &mut counts, &mut path, &mut depositor);
    progress.add(number, counts.rays.closest);
    list
}
