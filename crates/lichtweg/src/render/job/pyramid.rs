//! The image of every strategy of bidirectional path tracing, for all path lengths: the pyramid of Veach and Guibas (1995,
//! figure 2; Veach 1997, figure 10.3).

use super::*;
use crate::transport::{Contribution, Sensor, Teller, Workspace};

/// All strategies' images.
#[derive(Clone, Debug)]
pub struct Pyramid {
    /// The part of the film that was rendered: x, y, width, height.
    pub window: [u32; 4],
    /// Full film size.
    pub size: [u32; 2],
    /// By path length, then by s.
    pub strategies: Vec<StrategyImage>,
    /// Samples of each pixel.
    pub samples_per_pixel: u32,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// The image of one strategy, row by row from the top left corner of the window.
#[derive(Clone, Debug)]
pub struct StrategyImage {
    /// Vertices of the walk from the light.
    pub s: u32,
    /// Vertices of the walk from the eye.
    pub t: u32,
    /// What it contributes to the image.
    pub weighted: Vec<[f64; 3]>,
    /// What it would be alone, with weight one.
    pub unweighted: Vec<[f64; 3]>,
    /// Estimated variance of the mean of `weighted`.
    pub variance: Vec<[f64; 3]>,
    /// Estimated variance of the mean of `unweighted`.
    pub variance_unweighted: Vec<[f64; 3]>,
}

/// Sums of values and of their squares.
#[derive(Clone, Copy, Default)]
struct Sums {
    value: [f64; 3],
    squares: [f64; 3],
}

impl Sums {
    fn add(&mut self, value: [f32; 3], factor: f32) {
        for (lane, value) in value.into_iter().enumerate() {
            let v = f64::from(value) * f64::from(factor);
            self.value[lane] += v;
            self.squares[lane] += v * v;
        }
    }

    fn mean(&self, n: f64) -> [f64; 3] {
        self.value.map(|v| v / n)
    }

    /// Variance of the mean. What falls anywhere on the film comes as rare, independent events; what belongs to a pixel comes once
    /// a sample.
    fn variance(&self, n: f64, anywhere: bool) -> [f64; 3] {
        std::array::from_fn(|i| {
            let mean = self.value[i] / n;
            let spread = if anywhere { self.squares[i] / n } else { self.squares[i] / n - mean * mean };
            (spread / (n - 1.0)).max(0.0)
        })
    }
}

/// A path that was made.
struct Item {
    strategy: usize,
    /// The pixel whose sample it is, or where it falls on the film.
    place: Result<usize, [f32; 2]>,
    value: [f32; 3],
    weight: f32,
    /// Of the reconstruction filter.
    filter: f32,
}

struct Collector {
    max_depth: u32,
    /// The pixel of each sample, and its weight of the reconstruction filter.
    pixels: Vec<(usize, f32)>,
    scale: f32,
    items: Vec<Item>,
}

impl Collector {
    fn add(&mut self, c: &Contribution<'_, '_>) {
        let value = c.value * self.scale;
        if c.s + c.t <= self.max_depth + 1 && value.is_valid_radiance() && !value.is_zero() {
            let (pixel, filter) = self.pixels[c.sample as usize];
            self.items.push(Item {
                strategy: number(c.s, c.t),
                place: c.film.map_or(Ok(pixel), Err),
                value: value.to_rgb(),
                weight: c.weight,
                filter,
            });
        }
    }
}

/// The place of a strategy in the list: by path length, then by s.
fn number(s: u32, t: u32) -> usize {
    let edges = (s + t - 1) as usize;
    // Rows of 3, 4, 5, ... strategies come before.
    edges * (edges + 3) / 2 - 2 + s as usize
}

/// Tiles whose paths are in memory at a time.
const BATCH: usize = 64;

impl Job {
    /// Renders the images of all strategies for paths of up to `max_depth` edges, with the job's samples; stops early, at whole
    /// samples of all pixels, if asked to.
    pub fn render_pyramid(
        &self,
        description: &Description,
        max_depth: u32,
        scene: &Scene,
        progress: &Progress,
    ) -> Pyramid {
        let start = Instant::now();
        let mut description = description.clone();
        description.integrator.max_depth = Some(max_depth);
        let tracer = bidirectional(&description);
        let [x0, y0, width, height] = self.window;
        let area = width as usize * height as usize;
        let strategies: Vec<(u32, u32)> =
            (1..=max_depth).flat_map(|k| (0..=k + 1).map(move |s| (s, k + 1 - s))).collect();
        let mut sums = vec![[vec![Sums::default(); area], vec![Sums::default(); area]]; strategies.len()];
        let sensor = Sensor::new(&self.camera, self.size, self.window, self.filter.radius());
        let tiles = self.tiles();
        let mut done = 0;
        while done < self.samples_per_pixel && !progress.is_stopped() {
            for tiles in tiles.chunks(BATCH) {
                let lists: Vec<Vec<Item>> = tiles
                    .par_iter()
                    .map(|tile| {
                        let row = tile.pixels.len();
                        let (mut pairs, mut pixels) = (Vec::with_capacity(row), Vec::with_capacity(row));
                        for i in 0..row as u32 {
                            let position = tile.position(i);
                            let (pair, filter) = self.pair(position, done, 0.0);
                            pairs.push(pair);
                            let [x, y] = [position[0] - x0, position[1] - y0];
                            pixels.push(((y * width + x) as usize, filter));
                        }
                        let mut sink =
                            Collector { max_depth, pixels, scale: self.film_scale, items: Vec::new() };
                        let (mut workspace, mut counts) = (Workspace::default(), WalkCounts::default());
                        let mut collect = |c: &Contribution<'_, '_>| sink.add(c);
                        let mut teller = Teller(&mut collect);
                        tracer.follow(scene, &sensor, &pairs, row, &mut workspace, &mut counts, &mut teller);
                        progress.add(row as u64, counts.rays.closest + counts.rays.occlusion);
                        sink.items
                    })
                    .collect();
                // Each strategy takes its own, in the order of the lists.
                sums.par_iter_mut().enumerate().for_each(|(strategy, sums)| {
                    lists.iter().flatten().filter(|item| item.strategy == strategy).for_each(|item| {
                        self.add_item(item, sums);
                    });
                });
            }
            done += 1;
            progress.pass_done();
        }
        let n = f64::from(done);
        let image = |((s, t), sums): ((u32, u32), [Vec<Sums>; 2])| {
            let [weighted, unweighted] = &sums;
            let mean = |sums: &[Sums]| sums.iter().map(|s| s.mean(n)).collect();
            let variance = |sums: &[Sums]| sums.iter().map(|s| s.variance(n, t < 2)).collect();
            StrategyImage {
                s,
                t,
                weighted: mean(weighted),
                unweighted: mean(unweighted),
                variance: variance(weighted),
                variance_unweighted: variance(unweighted),
            }
        };
        Pyramid {
            window: self.window,
            size: self.size,
            strategies: strategies.into_iter().zip(sums).map(image).collect(),
            samples_per_pixel: done,
            seconds: start.elapsed().as_secs_f64(),
        }
    }

    fn add_item(&self, item: &Item, [weighted, unweighted]: &mut [Vec<Sums>; 2]) {
        let mut add = |pixel: usize, filter: f32| {
            weighted[pixel].add(item.value, filter * item.weight);
            unweighted[pixel].add(item.value, filter);
        };
        match item.place {
            Ok(pixel) => add(pixel, item.filter),
            Err([x, y]) => {
                let place = [x * self.size[0] as f32, y * self.size[1] as f32];
                self.filter.cover(place, self.window, add);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn strategies_are_numbered_by_length_and_s() {
        let all = (1..=5).flat_map(|k| (0..=k + 1).map(move |s| (s, k + 1 - s)));
        assert!(all.enumerate().all(|(i, (s, t))| number(s, t) == i));
    }
}
