//! Jobs whose samples fall anywhere on the film: light tracing and bidirectional path tracing.
//!
//! For every sample of a pixel of the window a walk starts from a light. What falls on the film is kept in lists, one for each
//! tile and sample index, and is added in the order of the sample index and then of the tiles, so that the image is the same
//! bits for any number of threads and any cut into passes.
//!
//! Limit: a crop is not the same bits as that part of the whole image, as walks from the lights know no crop.

use super::*;
use crate::film::{Splat, SplatFilm};
use crate::scene::description::EstimatorKind;
use crate::transport::{Bidirectional, Contribution, ContributionSink, LightTracer, Sensor, Workspace};

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

/// The splats of a tile's samples.
#[derive(Default)]
struct TileSplats {
    splats: Vec<Splat>,
    /// Where those of each sample index end.
    ends: Vec<usize>,
}

impl TileSplats {
    fn of(&self, sample: usize) -> &[Splat] {
        let start = if sample == 0 { 0 } else { self.ends[sample - 1] };
        &self.splats[start..self.ends[sample]]
    }
}

impl Splatting {
    /// The estimator that a description asks for, if it is one of these.
    pub fn new(description: &Description) -> Option<Self> {
        let integrator = &description.integrator;
        match integrator.estimator {
            EstimatorKind::Path => None,
            EstimatorKind::Light => Some(Self::Light(LightTracer::new(integrator))),
            EstimatorKind::Bidirectional => Some(Self::Bidirectional(Bidirectional::new(integrator))),
        }
    }
}

/// Takes the paths of one sample.
struct SampleSink<'t> {
    size: [u32; 2],
    scale: f32,
    radiance: Spectrum,
    splats: &'t mut Vec<Splat>,
    invalid: bool,
}

impl ContributionSink for SampleSink<'_> {
    #[inline]
    fn add(&mut self, contribution: &Contribution<'_, '_>) {
        let value = contribution.value * contribution.weight;
        match contribution.film {
            None => self.radiance += value,
            Some(film) => {
                let splat = Splat::new(film, self.size, value * self.scale);
                if splat.is_valid() {
                    self.splats.push(splat);
                } else {
                    self.invalid = true;
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
        while done < self.samples_per_pixel && !progress.is_stopped() {
            let pass_start = Instant::now();
            let end = done + pass_samples.min(self.samples_per_pixel - done);
            // Where one sample of each pixel is a batch already, so many tiles are one.
            let batch = if most > 1 { tiles.len() } else { BATCH_SAMPLES / (TILE * TILE) as usize };
            for tiles in tiles.chunks_mut(batch) {
                self.render_batch(splatting, scene, tiles, done..end, &mut film, progress);
            }
            tiles.iter_mut().for_each(|tile| tile.samples = end);
            done = end;
            passes += 1;
            progress.pass_done();
            let Some(next) = self.next_pass(pass_start.elapsed(), start.elapsed(), pass_samples) else {
                break;
            };
            pass_samples = next.min(most);
        }
        if done == 0 {
            return Err(RenderError::Stopped);
        }
        let mut statistics = self.statistics(&tiles, passes);
        let mut image = self.assemble(tiles);
        film.join(&mut image.pixels, done);
        statistics.seconds = start.elapsed().as_secs_f64();
        Ok(Rendering { image, statistics, panic: None })
    }

    /// Takes samples of the pixels of some tiles, and merges what they splat.
    fn render_batch(
        &self,
        splatting: &Splatting,
        scene: &Scene,
        tiles: &mut [Tile],
        samples: std::ops::Range<u32>,
        film: &mut SplatFilm,
        progress: &Progress,
    ) {
        let splats: Vec<TileSplats> = tiles
            .par_iter_mut()
            .map(|tile| self.render_splatting_tile(splatting, scene, tile, samples.clone(), progress))
            .collect();
        let lists: Vec<(u32, &[Splat])> = samples
            .enumerate()
            .flat_map(|(i, sample)| splats.iter().map(move |tile| (sample, tile.of(i))))
            .collect();
        film.add(&lists, &self.filter);
    }

    fn render_splatting_tile(
        &self,
        splatting: &Splatting,
        scene: &Scene,
        tile: &mut Tile,
        samples: std::ops::Range<u32>,
        progress: &Progress,
    ) -> TileSplats {
        let sensor = Sensor::new(&self.camera, self.size, self.window, self.filter.radius());
        let mut workspace = Workspace::default();
        let mut splats = TileSplats::default();
        let mut counts = WalkCounts::default();
        for index in samples.clone() {
            for i in 0..tile.pixels.len() {
                let position = tile.position(i as u32);
                let mut sink = SampleSink {
                    size: self.size,
                    scale: self.film_scale,
                    radiance: Spectrum::ZERO,
                    splats: &mut splats.splats,
                    invalid: false,
                };
                let CameraSample { ray, weight, mut sampler, mut light_sampler } =
                    CameraSample::new(self, position, index);
                match splatting {
                    Splatting::Light(tracer) => tracer.sample(
                        scene,
                        &sensor,
                        ray.time,
                        &mut light_sampler,
                        &mut workspace,
                        &mut counts,
                        &mut sink,
                    ),
                    Splatting::Bidirectional(tracer) => tracer.sample(
                        scene,
                        &sensor,
                        ray,
                        [&mut sampler, &mut light_sampler],
                        expected(&tile.pixels[i], self.film_scale),
                        &mut workspace,
                        &mut counts,
                        &mut sink,
                    ),
                }
                let SampleSink { radiance, invalid, .. } = sink;
                if invalid {
                    tile.dropped += 1;
                    tile.first_dropped.get_or_insert((position, index));
                }
                tile.add(i as u32, index, radiance, self.film_scale, weight);
                if let Some(sums) = tile.auxiliary.get_mut(i) {
                    look(scene, &ray, &mut sampler, sums);
                }
            }
            splats.ends.push(splats.splats.len());
        }
        tile.counts.merge(&counts);
        let paths = tile.pixels.len() as u64 * u64::from(samples.end - samples.start);
        progress.add(paths, counts.rays.closest + counts.rays.occlusion);
        splats
    }
}

/// The radiance that a pixel has shown so far, about; 0 where nothing is known of it.
fn expected(pixel: &Pixel, film_scale: f32) -> f32 {
    let [r, g, b] = pixel.mean().map(|v| v as f32 / film_scale);
    let mean = r.max(g).max(b);
    if pixel.count >= 4 && mean.is_finite() { mean.max(0.0) } else { 0.0 }
}

/// The ray of a sample of a pixel.
pub(super) struct CameraSample {
    pub ray: Ray,
    /// Of the reconstruction filter.
    pub weight: f32,
    /// What is left of its random numbers.
    pub sampler: Sampler,
    /// The random numbers of its walk from a light.
    pub light_sampler: Sampler,
}

impl CameraSample {
    pub fn new(job: &Job, position: [u32; 2], index: u32) -> Self {
        let (ray, sampler, weight) = job.camera_ray(position, index);
        let [x, y] = position;
        // The walks of one sample of all pixels are one sequence: stratified over the lights together.
        let number = y * job.size[0] + x;
        let light_sampler = Sampler::new(job.sampler, job.seed ^ LIGHT_SEED, u64::from(index), number);
        Self { ray, weight, sampler, light_sampler }
    }
}

/// Records what the camera sees first.
fn look(scene: &Scene, ray: &Ray, sampler: &mut Sampler, sums: &mut AuxiliarySums) {
    let mut counts = WalkCounts::default();
    if let Some(point) = scene.intersect(ray, &mut counts.rays, || sampler.next_1d()) {
        let scatterer = scene.scatterer(&point, -ray.direction);
        let sums = std::slice::from_mut(sums);
        let mut observer = FirstSurface { sums, first: 0, per_pixel: 1 };
        observer.scatters(0, 1, &point, &scatterer, (point.position - ray.origin).length());
    }
}
