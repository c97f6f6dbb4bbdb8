//! Passes over tiles.
//!
//! The image is cut into tiles, a pass takes the next few samples of every pixel, and threads take tiles as they come. A
//! pixel's samples are functions of its position and their index, and are added up in the order of the index, so that the
//! image is the same bits for any number of threads and any cut into passes.

mod camera_paths;
mod expectation;
mod pass;
mod paths;
mod pyramid;
mod splatting;

use std::time::{Duration, Instant};

use lichtweg_montecarlo::{Sampler, SamplerKind};
use lichtweg_ray::Ray;
use lichtweg_ray::wide::{self, Float};
use rayon::prelude::*;

use self::camera_paths::{Samples, StartPaths};
pub use self::paths::FoundPath;
pub use self::pyramid::{Pyramid, StrategyImage};
use self::splatting::{Splatting, TileSplats, bidirectional};
use super::{Progress, RenderedImage};
use crate::camera::Camera;
use crate::color::Spectrum;
use crate::film::{AuxiliarySums, Filter, Pixel};
use crate::scene::description::{Description, Diagnostic, Diagnostics};
use crate::scene::{Scatterer, Scene, SurfacePoint};
use crate::transport::{PathObserver, PathTracer, WalkCounts, Wave};

/// Side of a block of pixels whose rays go together.
const BLOCK: u32 = 4;
/// Side of a tile in pixels.
const TILE: u32 = 16;

/// How long a pass may take before the next one is made shorter, or it is cut: what Ctrl-C has to wait for.
const PASS_SECONDS: f64 = 0.5;

/// Images of more pixels than this are refused rather than run out of memory.
const MAX_PIXELS: u64 = 1 << 30;

/// Everything that decides an image, but the scene.
#[derive(Debug)]
pub struct Job {
    camera: Camera,
    filter: Filter,
    tracer: PathTracer,
    /// Takes its place, if the samples fall anywhere on the film.
    splatting: Option<Splatting>,
    sampler: SamplerKind,
    seed: u64,
    samples_per_pixel: u32,
    film_scale: f32,
    /// Full film size.
    size: [u32; 2],
    /// The part that is rendered: x, y, width, height.
    window: [u32; 4],
    /// Record albedo, normals and depth.
    auxiliary: bool,
    /// Stop after this time.
    time_limit: Option<Duration>,
}

/// What to record besides radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerSelection {
    /// Variance of the mean.
    pub variance: bool,
    /// Albedo of what the camera sees first.
    pub albedo: bool,
    /// Its shading normal.
    pub normal: bool,
    /// Its distance.
    pub depth: bool,
}

/// Why nothing was rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// Stopped before any pixel was complete.
    #[error("stopped before the first pass over the image was complete")]
    Stopped,
}

/// Exact counts over a job.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Samples of each pixel, at least.
    pub samples_per_pixel: u32,
    /// Samples of those pixels that have most: more where the last pass was cut short.
    pub most_samples_per_pixel: u32,
    /// Camera paths.
    pub paths: u64,
    /// What the paths counted.
    pub walks: WalkCounts,
    /// Samples left out because they were not finite or negative.
    pub dropped: u64,
    /// One of those: pixel and sample index, to replay it.
    pub first_dropped: Option<([u32; 2], u32)>,
    /// Passes over the image.
    pub passes: u32,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// A finished, or interrupted, image.
#[derive(Debug)]
pub struct Rendering {
    /// The pixels.
    pub image: RenderedImage,
    /// The counts.
    pub statistics: Statistics,
    /// What a thread panicked with, if one did: the image is what was done before.
    pub panic: Option<String>,
}

struct Tile {
    /// Position in the film and size.
    window: [u32; 4],
    /// Of each pixel.
    samples: u32,
    pixels: Vec<Pixel>,
    auxiliary: Vec<AuxiliarySums>,
    counts: WalkCounts,
    dropped: u64,
    first_dropped: Option<([u32; 2], u32)>,
    /// Of the pass, where samples fall anywhere.
    splats: TileSplats,
}

impl Job {
    /// The job that a description asks for; reports what is wrong with it.
    pub fn compile(
        description: &Description,
        layers: LayerSelection,
        time_limit: Option<Duration>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        let film = &description.film;
        let mut fault = |message: String, help: &str| {
            diagnostics.push(Diagnostic::error("bad-film", message).at(film.span, "stated here").help(help));
            None
        };
        let (width, height) = (film.width, film.height);
        if width == 0 || height == 0 {
            return fault(
                format!("an image of {width}x{height} pixels has none"),
                "both sizes must be at least 1",
            );
        }
        if u64::from(width) * u64::from(height) > MAX_PIXELS {
            return fault(format!("an image of {width}x{height} pixels is too large"), "at most 2^30 pixels");
        }
        let window = film.crop.unwrap_or([0, 0, width, height]);
        let [x, y, w, h] = window.map(u64::from);
        if w == 0 || h == 0 || x + w > u64::from(width) || y + h > u64::from(height) {
            return fault(
                format!("the crop {x},{y},{w},{h} does not lie in an image of {width}x{height} pixels"),
                "give x, y, width and height in pixels from the top left corner",
            );
        }
        let Some(filter) = Filter::new(&film.filter) else {
            return fault(
                format!("the reconstruction filter {:?} cannot be used", film.filter),
                "its radius must be positive",
            );
        };
        if !(film.scale >= 0.0 && film.scale.is_finite()) {
            return fault(
                "the film's scale must be finite and not negative".into(),
                "check iso and exposure time",
            );
        }
        let samples_per_pixel = description.sampler.samples_per_pixel;
        if samples_per_pixel == 0 {
            let span = description.sampler.span;
            diagnostics.push(
                Diagnostic::error("no-samples", "zero samples per pixel make no image")
                    .at(span, "stated here"),
            );
            return None;
        }
        let camera = Camera::compile(&description.camera, width, height, diagnostics)?;
        Some(Self {
            camera: if description.moves() { camera } else { camera.for_still_scene() },
            filter,
            tracer: PathTracer::new(&description.integrator),
            splatting: Splatting::new(description),
            sampler: description.sampler.kind,
            seed: description.sampler.seed,
            samples_per_pixel,
            film_scale: film.scale,
            size: [width, height],
            window,
            auxiliary: layers.albedo || layers.normal || layers.depth,
            time_limit,
        })
    }

    /// Camera samples that a complete job takes.
    pub fn total_samples(&self) -> u64 {
        u64::from(self.window[2]) * u64::from(self.window[3]) * u64::from(self.samples_per_pixel)
    }

    /// Full film size.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Renders on the threads of the rayon pool this is called in.
    pub fn render(&self, scene: &Scene, progress: &Progress) -> Result<Rendering, RenderError> {
        if let Some(splatting) = &self.splatting {
            return self.render_splatting(splatting, scene, progress);
        }
        let start = Instant::now();
        let mut tiles = self.tiles();
        let (mut done, mut passes, mut pass_samples) = (0, 0, 1);
        let mut panic = None;
        while done < self.samples_per_pixel && !progress.is_stopped() {
            let pass_start = Instant::now();
            let end = done + pass_samples.min(self.samples_per_pixel - done);
            let ends = || self.cuts(pass_samples, pass_start, start, progress);
            panic = pass::run(
                &mut tiles,
                end - done,
                ends,
                || Wave::new(self.sampler),
                |tile, wave| {
                    self.render_tile(scene, tile, wave, done..end, progress);
                },
            );
            if panic.is_some() || tiles.iter().any(|tile| tile.samples < end) {
                break;
            }
            done = end;
            passes += 1;
            progress.pass_done();
            let Some(next) = self.next_pass(pass_start.elapsed(), start.elapsed(), pass_samples) else {
                break;
            };
            pass_samples = next;
        }
        self.finish(tiles, start, passes, panic, |_| ())
    }

    /// Whether a pass of so many samples ends before its next tile: one that can be no shorter may be cut.
    fn cuts(&self, samples: u32, pass_start: Instant, start: Instant, progress: &Progress) -> bool {
        samples == 1
            && pass_start.elapsed().as_secs_f64() > PASS_SECONDS
            && (progress.is_stopped() || self.time_limit.is_some_and(|limit| start.elapsed() >= limit))
    }

    /// What was rendered, completed by `complete`.
    fn finish(
        &self,
        tiles: Vec<Tile>,
        start: Instant,
        passes: u32,
        panic: Option<pass::Panic>,
        complete: impl FnOnce(&mut RenderedImage),
    ) -> Result<Rendering, RenderError> {
        let mut statistics = self.statistics(&tiles, passes);
        match panic {
            Some(panic) if statistics.most_samples_per_pixel == 0 => std::panic::resume_unwind(panic),
            None if statistics.most_samples_per_pixel == 0 => return Err(RenderError::Stopped),
            _ => {}
        }
        let mut image = self.assemble(tiles);
        complete(&mut image);
        statistics.seconds = start.elapsed().as_secs_f64();
        Ok(Rendering { image, statistics, panic: panic.as_ref().map(pass::message) })
    }

    fn statistics(&self, tiles: &[Tile], passes: u32) -> Statistics {
        let samples = || tiles.iter().map(|tile| tile.samples);
        let mut statistics = Statistics {
            samples_per_pixel: samples().min().unwrap_or(0),
            most_samples_per_pixel: samples().max().unwrap_or(0),
            paths: tiles.iter().map(|tile| tile.pixels.len() as u64 * u64::from(tile.samples)).sum(),
            passes,
            ..Default::default()
        };
        for tile in tiles {
            statistics.walks.merge(&tile.counts);
            statistics.dropped += tile.dropped;
            statistics.first_dropped = statistics.first_dropped.or(tile.first_dropped);
        }
        statistics
    }

    /// Samples of the next pass: as many as fit into the time of a pass and into what is left; `None` where time is up.
    fn next_pass(&self, pass: Duration, total: Duration, samples: u32) -> Option<u32> {
        let per_sample = pass.as_secs_f64() / f64::from(samples);
        let seconds = match self.time_limit {
            None => PASS_SECONDS,
            Some(limit) if total >= limit => return None,
            Some(limit) => PASS_SECONDS.min((limit - total).as_secs_f64()),
        };
        // At most doubled: the first, short passes say little.
        Some(((seconds / per_sample) as u32).clamp(1, samples.saturating_mul(2)))
    }

    fn tiles(&self) -> Vec<Tile> {
        let [x0, y0, width, height] = self.window;
        let steps = |n: u32| (0..n).step_by(TILE as usize);
        let tile = |(y, x): (u32, u32)| {
            let window = [x0 + x, y0 + y, TILE.min(width - x), TILE.min(height - y)];
            Tile::new(window, self.auxiliary)
        };
        steps(height).flat_map(|y| steps(width).map(move |x| (y, x))).map(tile).collect()
    }

    fn render_tile(
        &self,
        scene: &Scene,
        tile: &mut Tile,
        wave: &mut Wave,
        samples: std::ops::Range<u32>,
        progress: &Progress,
    ) {
        let mut counts = WalkCounts::default();
        let per_pixel = samples.end - samples.start;
        let paths = tile.pixels.len() as u32 * per_pixel;
        let mut weights = Vec::with_capacity(Wave::CAPACITY);
        for first in (0..paths).step_by(Wave::CAPACITY) {
            let numbers = Samples::new(samples.clone(), first..paths.min(first + Wave::CAPACITY as u32));
            wave.clear();
            weights.clear();
            if self.camera.is_still() {
                let samples = numbers.clone();
                wide::dispatch(StartPaths { job: self, tile, samples, wave, weights: &mut weights });
            } else {
                for (pixel, index) in numbers.clone() {
                    let (ray, sampler, weight) = self.camera_ray(tile.position(pixel), index);
                    wave.push(&ray, sampler);
                    weights.push(weight);
                }
            }
            if self.auxiliary {
                let mut observer = FirstSurface { sums: &mut tile.auxiliary, first, per_pixel };
                self.tracer.follow(scene, wave, &mut counts, &mut observer);
            } else {
                self.tracer.follow(scene, wave, &mut counts, &mut ());
            }
            for (((pixel, index), &radiance), &weight) in numbers.zip(wave.radiance()).zip(&weights) {
                tile.add(pixel, index, radiance, self.film_scale, weight);
            }
        }
        tile.counts.merge(&counts);
        progress.add(u64::from(paths), counts.rays.closest + counts.rays.occlusion);
    }

    /// The ray of one sample of one pixel, what is left of its random numbers, and its filter weight.
    #[inline]
    fn camera_ray(&self, [x, y]: [u32; 2], index: u32) -> (Ray, Sampler, f32) {
        let stream = u64::from(y) * u64::from(self.size[0]) + u64::from(x);
        let mut sampler = Sampler::new(self.sampler, self.seed, stream, index);
        let ([dx, dy], weight) = self.filter.sample(sampler.next_2d());
        let film = self.film_point([x as f32, y as f32], [dx, dy]);
        let (lens, time) = (sampler.next_2d(), sampler.next_1d());
        (self.camera.ray(film, lens, time), sampler, weight)
    }

    /// Where a pixel's centre, moved by an offset in pixels, lies on the film, which is [0, 1]^2.
    #[inline(always)]
    fn film_point<F: Float>(&self, [x, y]: [F; 2], [dx, dy]: [F; 2]) -> [F; 2] {
        let half = F::splat(0.5);
        let [width, height] = self.size;
        [(x + half + dx) / F::splat(width as f32), (y + half + dy) / F::splat(height as f32)]
    }

    /// Copies the tiles into an image, and frees each.
    fn assemble(&self, tiles: Vec<Tile>) -> RenderedImage {
        let [x0, y0, width, height] = self.window;
        let area = width as usize * height as usize;
        let mut image = RenderedImage {
            size: self.size,
            window: self.window,
            pixels: vec![Pixel::default(); area],
            auxiliary: vec![AuxiliarySums::default(); if self.auxiliary { area } else { 0 }],
        };
        for tile in tiles {
            for (i, pixel) in tile.pixels.iter().enumerate() {
                let [x, y] = tile.position(i as u32);
                let to = (y - y0) as usize * width as usize + (x - x0) as usize;
                image.pixels[to] = *pixel;
                if self.auxiliary {
                    image.auxiliary[to] = tile.auxiliary[i];
                }
            }
        }
        image
    }
}

impl Tile {
    fn new(window: [u32; 4], auxiliary: bool) -> Self {
        let pixels = (window[2] * window[3]) as usize;
        Self {
            window,
            samples: 0,
            pixels: vec![Pixel::default(); pixels],
            auxiliary: vec![AuxiliarySums::default(); if auxiliary { pixels } else { 0 }],
            counts: WalkCounts::default(),
            dropped: 0,
            first_dropped: None,
            splats: TileSplats::default(),
        }
    }

    /// Film position of a pixel. Pixels are numbered block by block, so that neighbours in a packet of rays are
    /// neighbours in the image.
    #[inline]
    fn position(&self, pixel: u32) -> [u32; 2] {
        let [x, y, width, height] = self.window;
        let (band, pixel) = (pixel / (BLOCK * width), pixel % (BLOCK * width));
        let rows = BLOCK.min(height - BLOCK * band);
        let (block, pixel) = (pixel / (BLOCK * rows), pixel % (BLOCK * rows));
        let columns = BLOCK.min(width - BLOCK * block);
        [x + BLOCK * block + pixel % columns, y + BLOCK * band + pixel / columns]
    }

    /// Adds a sample to a pixel, or counts it as dropped where it is no radiance.
    #[inline]
    fn add(&mut self, pixel: u32, index: u32, radiance: Spectrum, scale: f32, weight: f32) {
        if radiance.is_valid_radiance() {
            self.pixels[pixel as usize].add(index, radiance * scale, weight);
        } else {
            self.dropped += 1;
            let position = self.position(pixel);
            self.first_dropped.get_or_insert((position, index));
        }
    }
}

/// Records what the camera sees first.
struct FirstSurface<'a> {
    /// Of each pixel.
    sums: &'a mut [AuxiliarySums],
    /// Number of the first path.
    first: u32,
    /// Paths of each pixel.
    per_pixel: u32,
}

impl PathObserver for FirstSurface<'_> {
    fn watches(&self, depth: u32) -> bool {
        depth == 1
    }

    fn scatters(
        &mut self,
        path: u32,
        depth: u32,
        point: &SurfacePoint,
        scatterer: &Scatterer<'_>,
        distance: f32,
    ) {
        if depth > 1 {
            return;
        }
        let sums = &mut self.sums[((self.first + path) / self.per_pixel) as usize];
        let add = |to: &mut [f32; 3], value: [f32; 3]| to.iter_mut().zip(value).for_each(|(a, b)| *a += b);
        add(&mut sums.albedo, scatterer.bsdf.albedo_hint().to_rgb());
        add(&mut sums.normal, point.shading_normal.to_array());
        sums.depth += distance;
        sums.hits += 1;
    }
}
