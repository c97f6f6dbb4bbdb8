//! Which samples a wave is made of, and their camera rays, sixteen at a time.

use std::ops::Range;

use lichtweg_ray::wide::{FloatLanes, Kernel, LANES, Lanes, Wide, Word, WordLanes};

use super::{Job, Tile};
use crate::transport::{Draws, Wave};

/// Samples of a tile in the order of a pass: all of a pixel, then all of the next. Yields pixel and index.
#[derive(Clone)]
pub(super) struct Samples {
    pixel: u32,
    index: u32,
    of_pixel: Range<u32>,
    left: u32,
}

impl Samples {
    /// Those numbered by a range, where a pass takes the same samples of each pixel.
    pub fn new(of_pixel: Range<u32>, numbers: Range<u32>) -> Self {
        let per_pixel = of_pixel.end - of_pixel.start;
        Self {
            pixel: numbers.start / per_pixel,
            index: of_pixel.start + numbers.start % per_pixel,
            of_pixel,
            left: numbers.end - numbers.start,
        }
    }
}

impl Iterator for Samples {
    type Item = (u32, u32);

    #[inline(always)]
    fn next(&mut self) -> Option<(u32, u32)> {
        self.left = self.left.checked_sub(1)?;
        let sample = (self.pixel, self.index);
        self.index += 1;
        if self.index == self.of_pixel.end {
            (self.pixel, self.index) = (self.pixel + 1, self.of_pixel.start);
        }
        Some(sample)
    }
}

/// Fills an empty wave with the camera rays of samples, and `weights` with those of the filter: [`Job::camera_ray`] of a
/// still camera in lanes.
pub(super) struct StartPaths<'a> {
    pub job: &'a Job,
    pub tile: &'a Tile,
    pub samples: Samples,
    pub wave: &'a mut Wave,
    pub weights: &'a mut Vec<f32>,
}

impl Kernel for StartPaths<'_> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(mut self) {
        let zeros = Lanes::splat(0);
        let (mut last, mut position) = (u32::MAX, [0; 2]);
        while self.samples.left > 0 {
            let count = LANES.min(self.samples.left as usize);
            let (mut x, mut y, mut index) = (zeros, zeros, zeros);
            for lane in 0..count {
                let Some((pixel, i)) = self.samples.next() else { break };
                if pixel != last {
                    (last, position) = (pixel, self.tile.position(pixel));
                }
                ([x.0[lane], y.0[lane]], index.0[lane]) = (position, i);
            }
            self.start::<W>([W::U32::load(&x), W::U32::load(&y)], W::U32::load(&index), count);
        }
    }
}

impl StartPaths<'_> {
    #[inline(always)]
    fn start<W: Wide>(&mut self, [x, y]: [W::U32; 2], index: W::U32, count: usize) {
        let job = self.job;
        let mut draws = Draws::<W>::new(job.sampler, job.seed, y * W::U32::splat(job.size[0]) + x, index);
        let ([dx, dy], weight) = job.filter.sample_lanes::<W>(draws.next_2d());
        let film = job.film_point([x.to_float(), y.to_float()], [dx, dy]);
        let lens = draws.next_2d();
        // The time, which is that of all.
        draws.skip(1);
        let rays = job.camera.rays(film, lens);
        self.wave.push_lanes(&rays, &draws, count);
        self.weights.extend_from_slice(&weight.to_lanes().0[..count]);
    }
}

#[cfg(test)]
mod tests {
    use lichtweg_montecarlo::SamplerKind;
    use lichtweg_ray::wide;

    use super::*;
    use crate::render::LayerSelection;
    use crate::scene::description::{Description, Diagnostics, FilterDescription, FilterKind};

    /// Sixteen camera paths at a time begin as they do one by one, to the bit.
    #[test]
    fn lanes_are_single_camera_rays() {
        let filters = [
            FilterDescription::BOX,
            FilterDescription::new(FilterKind::Tent, 1.0),
            FilterDescription::default(),
        ];
        for filter in filters {
            for (kind, aperture) in [(SamplerKind::Independent, 0.0), (SamplerKind::Sobol, 0.3)] {
                let mut description = Description::default();
                (description.film.width, description.film.height) = (37, 21);
                description.film.filter = filter;
                description.sampler.kind = kind;
                (description.camera.aperture_radius, description.camera.focus_distance) = (aperture, 2.0);
                let mut diagnostics = Diagnostics::default();
                let job =
                    Job::compile(&description, LayerSelection::default(), None, &mut diagnostics).unwrap();
                for tile in job.tiles() {
                    let samples = || Samples::new(3..7, 5..5 + 4 * LANES as u32);
                    let (mut wave, mut weights) = (Wave::new(kind), Vec::new());
                    wide::dispatch(StartPaths {
                        job: &job,
                        tile: &tile,
                        samples: samples(),
                        wave: &mut wave,
                        weights: &mut weights,
                    });
                    let (mut single, mut single_weights) = (Wave::new(kind), Vec::new());
                    for (pixel, index) in samples() {
                        let (ray, sampler, weight) = job.camera_ray(tile.position(pixel), index);
                        single.push(&ray, sampler);
                        single_weights.push(weight);
                    }
                    assert_eq!(weights, single_weights);
                    assert!(format!("{wave:?}") == format!("{single:?}"), "{filter:?} {kind:?}");
                }
            }
        }
    }
}
