//! Jobs whose samples fall anywhere on the film: light tracing and bidirectional path tracing.
//!
//! For every sample of a pixel of the window a walk starts from a light. What falls on the film is kept in lists, one for each
//! tile and sample index, and is added in the order of the sample index and then of the tiles, so that the image is the same
//! bits for any number of threads and any cut into passes.
//!
//! Limit: a crop is not the same bits as that part of the whole image, as walks from the lights know no crop.

use std::ops::Range;

use super::pass::Panic;
use super::*;
use crate::film::{Splat, SplatFilm};
use crate::scene::description::EstimatorKind;
use crate::transport::{
    Bidirectional, Contribution, ContributionSink, CountingSort, LightTracer, Pair, Sensor, Workspace,
};

/// An estimator whose samples fall anywhere on the film.
#[derive(Clone, Copy, Debug)]
pub(super) enum Splatting {
    Light(LightTracer),
    Bidirectional(Bidirectional),
}

/// Samples between two merges at most, if a single one of each pixel is not more already: some 10 MB of splats.
const BATCH_SAMPLES: usize = 1 << 17;

/// Walks from the lights have other random numbers than those from the eye.
const LIGHT_SEED: u64 = 0x6c69_6768_7477_6567;

/// Samples that are followed together. More are sorted better, fewer stay in the cache.
const TOGETHER: u32 = 1024;

/// Walks from lights that each walk from the eye is joined with.
const PARTNERS: u32 = 16;

/// The splats of a tile's samples.
#[derive(Default)]
pub(super) struct TileSplats {
    splats: Vec<Splat>,
    /// Where those of each sample index end.
    ends: Vec<usize>,
}

impl TileSplats {
    fn of(&self, sample: usize) -> &[Splat] {
        let start = if sample == 0 { 0 } else { self.ends[sample - 1] };
        &self.splats[start..self.ends[sample]]
    }

    /// Appends the splats of samples of `row` pixels each, by sample.
    fn append(&mut self, splats: &[(u32, Splat)], samples: u32, row: u32) {
        let mut sorted = CountingSort::default();
        sorted.sort((samples * row) as usize, splats.iter().map(|(number, _)| *number as usize));
        let first = self.splats.len();
        self.ends.extend((1..=samples).map(|sample| first + sorted.start((sample * row) as usize)));
        self.splats.extend(sorted.order().iter().map(|&i| splats[i as usize].1));
    }
}

/// Bidirectional path tracing as a description asks for it.
pub(super) fn bidirectional(description: &Description) -> Bidirectional {
    let partners = if description.moves() { 1 } else { PARTNERS };
    Bidirectional::new(&description.integrator).with_partners(partners)
}

impl Splatting {
    /// The estimator that a description asks for, if it is one of these.
    pub fn new(description: &Description) -> Option<Self> {
        let integrator = &description.integrator;
        match integrator.estimator {
            EstimatorKind::Path => None,
            EstimatorKind::Light => Some(Self::Light(LightTracer::new(integrator))),
            EstimatorKind::Bidirectional => Some(Self::Bidirectional(bidirectional(description))),
        }
    }
}

/// What is done to some tiles.
struct Batch<'b> {
    splatting: &'b Splatting,
    scene: &'b Scene,
    sensor: Sensor<'b>,
    samples: Range<u32>,
    progress: &'b Progress,
}

/// Takes the paths of samples.
struct SampleSink {
    size: [u32; 2],
    scale: f32,
    /// Of each sample.
    radiance: Vec<Spectrum>,
    splats: Vec<(u32, Splat)>,
    /// Samples with splats that are none.
    invalid: Vec<u32>,
}

impl ContributionSink for SampleSink {
    #[inline]
    fn add(&mut self, contribution: &Contribution<'_, '_>) {
        let value = contribution.value * contribution.weight;
        match contribution.film {
            None => self.radiance[contribution.sample as usize] += value,
            Some(film) => {
                let splat = Splat::new(film, self.size, value * self.scale);
                if splat.is_valid() {
                    self.splats.push((contribution.sample, splat));
                } else {
                    self.invalid.push(contribution.sample);
                }
            }
        }
    }
}

impl Job {
    /// See [`Job::render`].
    pub(super) fn render_splatting(
        &self,
        splatting: &Splatting,
        scene: &Scene,
        progress: &Progress,
    ) -> Result<Rendering, RenderError> {
        let start = Instant::now();
        let mut tiles = self.tiles();
        let mut film = SplatFilm::new(self.window);
        let area = self.window[2] as usize * self.window[3] as usize;
        let most = (BATCH_SAMPLES / area).max(1) as u32;
        let (mut done, mut passes, mut pass_samples) = (0, 0, 1);
        let (mut expectation, mut panic) = (None, None);
        while done < self.samples_per_pixel && !progress.is_stopped() {
            let pass_start = Instant::now();
            // What is expected changes where the number of samples doubles, wherever passes are cut.
            if done.is_power_of_two() && matches!(splatting, Splatting::Bidirectional(_)) {
                expectation = Some(self.expectation(&tiles, &film, done));
            }
            let doubled = (done + 1).checked_next_power_of_two().unwrap_or(u32::MAX);
            let end = done.saturating_add(pass_samples).min(self.samples_per_pixel).min(doubled);
            let sensor = Sensor::new(&self.camera, self.size, self.window, self.filter.radius())
                .expecting(expectation.as_ref());
            let batch = Batch { splatting, scene, sensor, samples: done..end, progress };
            // Where one sample of each pixel is a batch already, so many tiles are one.
            let together = if most > 1 { tiles.len() } else { BATCH_SAMPLES / (TILE * TILE) as usize };
            let taken = end - done;
            let ends = || self.cuts(taken, pass_start, start, progress);
            for tiles in tiles.chunks_mut(together) {
                panic = self.render_batch(&batch, tiles, &mut film, ends);
                if panic.is_some() {
                    break;
                }
            }
            if panic.is_some() || tiles.iter().any(|tile| tile.samples < end) {
                break;
            }
            done = end;
            passes += 1;
            progress.pass_done();
            let Some(next) = self.next_pass(pass_start.elapsed(), start.elapsed(), taken) else {
                break;
            };
            pass_samples = next.min(most);
        }
        let walks: u64 = tiles.iter().map(|tile| tile.pixels.len() as u64 * u64::from(tile.samples)).sum();
        self.finish(tiles, start, passes, panic, |image| {
            film.join(&mut image.pixels, walks as f64 / area as f64)
        })
    }

    /// Takes samples of the pixels of some tiles, and merges what they splat; of tiles that were not begun, or in which a thread
    /// panicked, nothing.
    fn render_batch<'a>(
        &self,
        batch: &Batch<'a>,
        tiles: &mut [Tile],
        film: &mut SplatFilm,
        ends: impl Fn() -> bool + Sync,
    ) -> Option<Panic> {
        let Range { start, end } = batch.samples;
        let action = |tile: &mut Tile, workspace: &mut Workspace<'a>| {
            tile.splats = self.render_splatting_tile(batch, tile, workspace);
        };
        let panic = pass::run(tiles, end - start, ends, Workspace::default, action);
        let whole = || tiles.iter().filter(|tile| tile.samples == end);
        let lists: Vec<(u32, &[Splat])> = batch
            .samples
            .clone()
            .enumerate()
            .flat_map(|(i, sample)| whole().map(move |tile| (sample, tile.splats.of(i))))
            .collect();
        film.add(&lists, &self.filter);
        tiles.iter_mut().for_each(|tile| tile.splats = TileSplats::default());
        panic
    }

    fn render_splatting_tile<'a>(
        &self,
        batch: &Batch<'a>,
        tile: &mut Tile,
        workspace: &mut Workspace<'a>,
    ) -> TileSplats {
        let Range { start, end } = batch.samples;
        let mut splats = TileSplats::default();
        let mut counts = WalkCounts::default();
        let row = tile.pixels.len() as u32;
        let most = (TOGETHER / row).max(1);
        for first in (start..end).step_by(most as usize) {
            let samples = first..end.min(first.saturating_add(most));
            self.take_samples(batch, tile, samples, workspace, &mut counts, &mut splats);
        }
        tile.counts.merge(&counts);
        batch.progress.add(u64::from(row * (end - start)), counts.rays.closest + counts.rays.occlusion);
        splats
    }

    /// Takes some samples of all pixels of a tile.
    fn take_samples<'a>(
        &self,
        batch: &Batch<'a>,
        tile: &mut Tile,
        samples: Range<u32>,
        workspace: &mut Workspace<'a>,
        counts: &mut WalkCounts,
        splats: &mut TileSplats,
    ) {
        let Batch { splatting, scene, sensor, .. } = batch;
        let row = tile.pixels.len();
        let (mut pairs, mut weights) = (Vec::new(), Vec::new());
        for index in samples.clone() {
            for i in 0..row {
                let [x, y] = tile.position(i as u32);
                let center = [(x as f32 + 0.5) / self.size[0] as f32, (y as f32 + 0.5) / self.size[1] as f32];
                let (pair, weight) = self.pair([x, y], index, sensor.expected(center));
                pairs.push(pair);
                weights.push(weight);
            }
        }
        let mut sink = SampleSink {
            size: self.size,
            scale: self.film_scale,
            radiance: vec![Spectrum::ZERO; pairs.len()],
            splats: Vec::new(),
            invalid: Vec::new(),
        };
        match splatting {
            Splatting::Light(tracer) => tracer.follow(scene, sensor, &pairs, workspace, counts, &mut sink),
            Splatting::Bidirectional(tracer) => {
                tracer.follow(scene, sensor, &pairs, row, workspace, counts, &mut sink);
            }
        }
        let SampleSink { radiance, splats: splatted, invalid, .. } = sink;
        for (number, (&radiance, &weight)) in radiance.iter().zip(&weights).enumerate() {
            let (i, index) = (number % row, samples.start + (number / row) as u32);
            tile.add(i as u32, index, radiance, self.film_scale, weight);
            if let Some(sums) = tile.auxiliary.get_mut(i) {
                look(scene, &pairs[number], sums);
            }
        }
        for number in invalid {
            let position = tile.position(number % row as u32);
            tile.dropped += 1;
            tile.first_dropped.get_or_insert((position, samples.start + number / row as u32));
        }
        splats.append(&splatted, samples.end - samples.start, row as u32);
    }

    /// A pair of walks for a sample of a pixel, and the weight of the reconstruction filter.
    pub(super) fn pair(&self, position: [u32; 2], index: u32, expected: f32) -> (Pair, f32) {
        let (ray, eye, weight) = self.camera_ray(position, index);
        let [x, y] = position;
        // The walks of one sample of all pixels are one sequence: stratified over the lights together.
        let number = y * self.size[0] + x;
        let light = Sampler::new(self.sampler, self.seed ^ LIGHT_SEED, u64::from(index), number);
        (Pair { ray, eye, light, expected }, weight)
    }
}

/// Records what the camera sees first.
fn look(scene: &Scene, pair: &Pair, sums: &mut AuxiliarySums) {
    let Pair { ray, mut eye, .. } = *pair;
    let mut counts = WalkCounts::default();
    if let Some(point) = scene.intersect(&ray, &mut counts.rays, || eye.next_1d()) {
        let scatterer = scene.scatterer(&point, -ray.direction);
        let sums = std::slice::from_mut(sums);
        let mut observer = FirstSurface { sums, first: 0, per_pixel: 1 };
        observer.scatters(0, 1, &point, &scatterer, (point.position - ray.origin).length());
    }
}
