//! Samples that fall anywhere on the film.
//!
//! A walk from a light reaches the film where it will, and contributes to every pixel whose filter covers the place: pixel j
//! receives the value times h_j(place). Sums in floating point depend on their order; splats are therefore kept in lists, and
//! added list by list in an order that no thread decides.

use rayon::prelude::*;

use super::{Filter, Pixel};
use crate::color::Spectrum;

/// A sample's share that belongs to a place on the film rather than to its own pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// In pixels from the film's top left corner.
    pub place: [f32; 2],
    /// Radiance per filter value.
    pub value: [f32; 3],
}

/// Sums of splats over a window of the film.
#[derive(Clone, Debug)]
pub struct SplatFilm {
    /// x, y, width, height.
    window: [u32; 4],
    sums: Vec<SplatSum>,
}

/// What is remembered of the splats of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct SplatSum {
    sum: [f64; 3],
    sum_squares: [f64; 3],
    sum_odd: [f64; 3],
}

impl SplatFilm {
    /// Black.
    pub fn new(window: [u32; 4]) -> Self {
        Self { window, sums: vec![SplatSum::default(); window[2] as usize * window[3] as usize] }
    }

    /// Adds the splats of samples, list by list, each with its samples' index. Threads share the film's rows among them, and
    /// every pixel sees the splats in the order of the lists.
    pub fn add(&mut self, lists: &[(u32, &[Splat])], filter: &Filter) {
        let [x0, y0, width, height] = self.window;
        let rows = height.div_ceil(2 * rayon::current_num_threads() as u32).max(1);
        let bands = self.sums.par_chunks_mut((rows * width) as usize).enumerate();
        bands.for_each(|(i, sums)| {
            let top = y0 + i as u32 * rows;
            let mut band = Band { origin: [x0, top], size: [width, sums.len() as u32 / width], sums };
            for (index, splats) in lists {
                splats.iter().for_each(|splat| band.add(splat, index & 1, filter));
            }
        });
    }

    /// The sum of each pixel, row by row.
    pub fn sums(&self) -> impl Iterator<Item = [f64; 3]> {
        self.sums.iter().map(|s| s.sum)
    }

    /// Joins the sums of splats with those of the eye's samples of the same pixels; `samples` of each pixel have splatted, in the mean
    /// over all.
    ///
    /// The variance of the sum of splats is taken to be that of rare, independent events: the sum of their squares (a bound
    /// from above, as for a Poisson process). The joined sum of squares is the one that gives the sum of both variances.
    pub fn join(&self, pixels: &mut [Pixel], samples: f64) {
        for (pixel, splats) in pixels.iter_mut().zip(&self.sums) {
            let eye = if pixel.count > 1 { pixel.variance_of_mean() } else { [0.0; 3] };
            pixel.count = pixel.count.max(1);
            let n = f64::from(pixel.count);
            // One, unless the last samples of some pixels are missing.
            let share = n / samples;
            for (lane, eye) in eye.into_iter().enumerate() {
                pixel.sum[lane] += splats.sum[lane] * share;
                pixel.sum_odd[lane] += splats.sum_odd[lane] * share;
                let mean = pixel.sum[lane] / n;
                let variance =
                    if pixel.count > 1 { eye + splats.sum_squares[lane] / (samples * samples) } else { 0.0 };
                pixel.sum_squares[lane] = n * ((n - 1.0) * variance + mean * mean);
            }
        }
    }
}

/// Some rows of the film.
struct Band<'a> {
    origin: [u32; 2],
    size: [u32; 2],
    sums: &'a mut [SplatSum],
}

impl Band<'_> {
    fn add(&mut self, splat: &Splat, odd: u32, filter: &Filter) {
        let window = [self.origin[0], self.origin[1], self.size[0], self.size[1]];
        filter.cover(splat.place, window, |pixel, weight| {
            let sum = &mut self.sums[pixel];
            for (lane, value) in splat.value.into_iter().enumerate() {
                let value = f64::from(value) * f64::from(weight);
                sum.sum[lane] += value;
                sum.sum_squares[lane] += value * value;
                sum.sum_odd[lane] += f64::from(odd) * value;
            }
        });
    }
}

impl Splat {
    /// A value at a place in [0, 1]^2 of a film of a size in pixels.
    pub fn new(film: [f32; 2], size: [u32; 2], value: Spectrum) -> Self {
        Self { place: [film[0] * size[0] as f32, film[1] * size[1] as f32], value: value.to_rgb() }
    }

    /// Whether it is finite and not negative.
    pub fn is_valid(&self) -> bool {
        self.value.iter().all(|v| (0.0..f32::INFINITY).contains(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{FilterDescription, FilterKind};

    /// Filters integrate to one: over all pixels a splat keeps its value, but for the grid's ripple.
    #[test]
    fn splats_keep_their_value() {
        for (description, tolerance) in [
            (FilterDescription::BOX, 1e-6),
            (FilterDescription::new(FilterKind::Tent, 1.0), 1e-5),
            (FilterDescription::default(), 0.03),
            (FilterDescription::new(FilterKind::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }, 2.0), 0.03),
        ] {
            let filter = Filter::new(&description).unwrap();
            for place in [[7.0, 7.0], [7.5, 8.25], [9.99, 6.01]] {
                let mut film = SplatFilm::new([2, 2, 12, 12]);
                let splat = Splat { place, value: [1.0, 2.0, 3.0] };
                film.add(&[(0, &[splat])], &filter);
                let total: f64 = film.sums.iter().map(|s| s.sum[1]).sum();
                assert!((total - 2.0).abs() < 2.0 * tolerance, "{description:?} {place:?} {total}");
            }
        }
    }

    /// Where a pass was cut, pixels have different numbers of samples, and the splats are those of all samples.
    #[test]
    fn splats_join_pixels_of_different_counts() {
        let filter = Filter::new(&FilterDescription::BOX).unwrap();
        let mut film = SplatFilm::new([0, 0, 3, 1]);
        let splat = |x: f32| Splat { place: [x, 0.5], value: [3.0; 3] };
        film.add(&[(0, &[splat(0.5), splat(1.5), splat(2.5)])], &filter);
        let mut pixels = [Pixel::default(); 3];
        for (pixel, count) in pixels.iter_mut().zip([2, 1, 0]) {
            (0..count).for_each(|i| pixel.add(i, Spectrum::splat(5.0), 1.0));
        }
        film.join(&mut pixels, 1.5);
        assert_eq!(pixels.map(|p| p.mean()[0]), [7.0, 7.0, 2.0]);
        // No spread from the eye, one event of 3 among 1.5 samples.
        assert!((pixels[0].variance_of_mean()[0] - 4.0).abs() < 1e-9);
    }

    #[test]
    fn places_off_the_window_are_left_out() {
        let filter = Filter::new(&FilterDescription::BOX).unwrap();
        let mut film = SplatFilm::new([2, 3, 2, 2]);
        let value = [1.0; 3];
        for place in [[1.9, 3.5], [4.0, 3.5], [2.5, 2.9], [3.5, 5.0], [-1e30, 3.5], [f32::NAN, 3.5]] {
            film.add(&[(0, &[Splat { place, value }])], &filter);
        }
        assert!(film.sums.iter().all(|s| s.sum == [0.0; 3]));
        film.add(&[(1, &[Splat { place: [3.5, 3.0], value }])], &filter);
        assert_eq!(film.sums[1].sum_odd, [1.0; 3]);
    }
}
