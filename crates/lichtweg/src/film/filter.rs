//! Reconstruction filters by importance sampling (Ernst, Stamminger and Greiner 2006).
//!
//! A pixel's value is the integral of radiance times the filter about the pixel's centre, over the filter's integral. The
//! offset of each sample is drawn in proportion to the filter's magnitude, so that its weight is a constant but for the
//! sign that filters with negative lobes have; samples never belong to more than one pixel.

use lichtweg_montecarlo::distribution::Discrete;
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Wide};

use crate::lanes::warp;
use crate::scene::description::{FilterDescription, FilterKind};

/// A separable filter, ready to draw offsets from.
#[derive(Debug)]
pub struct Filter {
    axes: [Axis; 2],
}

/// One factor of the product.
#[derive(Debug)]
enum Axis {
    /// Constant over [-radius, radius].
    Box { radius: f32 },
    /// Linear to zero at the radius.
    Tent { radius: f32 },
    /// Anything else, as strips over [-radius, radius] on which it is taken as constant.
    Tabulated { radius: f32, strips: Discrete, signs: Vec<bool>, weight: f32, values: Vec<f32> },
}

/// Strips of a tabulated filter: the error this makes in a pixel's value is far below what 10^6 samples resolve.
const STRIPS: usize = 1024;

impl Filter {
    /// From a description. `None` where a radius is not positive and finite, or the filter has no positive integral.
    pub fn new(description: &FilterDescription) -> Option<Self> {
        let [x, y] = description.radius.map(|radius| Axis::new(description.kind, radius));
        Some(Self { axes: [x?, y?] })
    }

    /// Offset from the pixel's centre in pixels, and the sample's weight, from a uniform pair.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let (x, wx) = self.axes[0].sample(u[0]);
        let (y, wy) = self.axes[1].sample(u[1]);
        ([x, y], wx * wy)
    }

    /// [`Filter::sample`] of sixteen pairs.
    #[inline(always)]
    pub(crate) fn sample_lanes<W: Wide>(&self, u: [W::F32; 2]) -> ([W::F32; 2], W::F32) {
        let (x, wx) = self.axes[0].sample_lanes::<W>(u[0]);
        let (y, wy) = self.axes[1].sample_lanes::<W>(u[1]);
        ([x, y], wx * wy)
    }

    /// Half its extent in pixels, in x and in y.
    pub fn radius(&self) -> [f32; 2] {
        [self.axes[0].radius(), self.axes[1].radius()]
    }

    /// Its value at offsets from the pixel's centre along an axis (0: x, 1: y), normalised: the product over both axes
    /// integrates to one.
    #[inline]
    pub fn along(&self, axis: usize, offset: f32) -> f32 {
        self.axes[axis].value(offset)
    }

    /// Calls `f` with every pixel of a window (x, y, width, height) that responds to a place on the film: its number, row by row,
    /// and the filter's value there.
    #[inline]
    pub fn cover(&self, place: [f32; 2], window: [u32; 4], mut f: impl FnMut(usize, f32)) {
        let [x0, y0, width, height] = window;
        for row in self.covered(1, place[1], y0, height) {
            let along_y = self.along(1, place[1] - (y0 + row) as f32 - 0.5);
            for column in self.covered(0, place[0], x0, width) {
                let weight = along_y * self.along(0, place[0] - (x0 + column) as f32 - 0.5);
                f((row * width + column) as usize, weight);
            }
        }
    }

    /// The pixels along an axis, from `start` on, whose filters may cover a place.
    #[inline]
    fn covered(&self, axis: usize, place: f32, start: u32, size: u32) -> std::ops::Range<u32> {
        let (start, size, radius) = (start as f32, size as f32, self.axes[axis].radius());
        // Pixel i has its centre at i + 1/2. Casts take NaN to 0.
        let first = (place - radius - start - 0.5).max(0.0).floor().min(size);
        let last = (place + radius - start - 0.5).floor() + 1.0;
        first as u32..last.clamp(first, size) as u32
    }
}

impl Axis {
    fn new(kind: FilterKind, radius: f32) -> Option<Self> {
        if !(radius > 0.0 && radius.is_finite()) {
            return None;
        }
        match kind {
            FilterKind::Box => Some(Self::Box { radius }),
            FilterKind::Tent => Some(Self::Tent { radius }),
            _ => {
                let value = |i: usize| {
                    let x = ((i as f64 + 0.5) / STRIPS as f64 * 2.0 - 1.0) * f64::from(radius);
                    evaluate(kind, f64::from(radius), x)
                };
                let values: Vec<f64> = (0..STRIPS).map(value).collect();
                let magnitudes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
                let integral: f64 = values.iter().sum();
                let strips = Discrete::new(&magnitudes).ok()?;
                let weight = (magnitudes.iter().sum::<f64>() / integral) as f32;
                let signs = values.iter().map(|&v| v < 0.0).collect();
                let per_pixel = STRIPS as f64 / (2.0 * f64::from(radius) * integral);
                let values = values.iter().map(|v| (v * per_pixel) as f32).collect();
                (integral > 0.0).then_some(Self::Tabulated { radius, strips, signs, weight, values })
            }
        }
    }

    #[inline]
    fn sample(&self, u: f32) -> (f32, f32) {
        match self {
            Self::Box { radius } => ((2.0 * u - 1.0) * radius, 1.0),
            Self::Tent { radius } => (lichtweg_montecarlo::warp::tent(u, *radius), 1.0),
            Self::Tabulated { radius, strips, signs, weight, .. } => {
                let pick = strips.sample(u);
                let x = (pick.index as f32 + pick.remapped) * (2.0 / STRIPS as f32) - 1.0;
                (x * radius, if signs[pick.index] { -weight } else { *weight })
            }
        }
    }

    #[inline(always)]
    fn sample_lanes<W: Wide>(&self, u: W::F32) -> (W::F32, W::F32) {
        let splat = W::F32::splat;
        match self {
            Self::Box { radius } => return ((splat(2.0) * u - splat(1.0)) * splat(*radius), splat(1.0)),
            Self::Tent { radius } => return (warp::tent(u, *radius), splat(1.0)),
            Self::Tabulated { .. } => {}
        }
        let u = u.to_lanes();
        let (mut offset, mut weight) = (Lanes::splat(0.0), Lanes::splat(0.0));
        for lane in 0..LANES {
            (offset.0[lane], weight.0[lane]) = self.sample(u.0[lane]);
        }
        (W::F32::load(&offset), W::F32::load(&weight))
    }

    fn radius(&self) -> f32 {
        match self {
            Self::Box { radius } | Self::Tent { radius } | Self::Tabulated { radius, .. } => *radius,
        }
    }

    /// Value at an offset, integrating to one.
    #[inline]
    fn value(&self, x: f32) -> f32 {
        match self {
            // Half open, so that a point belongs to one pixel where the filter is one pixel wide.
            Self::Box { radius } => {
                if x >= -radius && x < *radius {
                    0.5 / radius
                } else {
                    0.0
                }
            }
            Self::Tent { radius } => lichtweg_montecarlo::warp::tent_pdf(x, *radius),
            Self::Tabulated { radius, values, .. } => {
                let strip = ((x / radius + 1.0) * (0.5 * STRIPS as f32)).floor();
                if strip >= 0.0 { values.get(strip as usize).copied().unwrap_or(0.0) } else { 0.0 }
            }
        }
    }
}

/// The filter at `x`, up to a constant factor.
fn evaluate(kind: FilterKind, radius: f64, x: f64) -> f64 {
    let x = x.abs();
    match kind {
        FilterKind::Box => 1.0,
        FilterKind::Tent => 1.0 - x / radius,
        FilterKind::Gaussian { standard_deviation } => {
            let alpha = -0.5 / f64::from(standard_deviation).powi(2);
            ((alpha * x * x).exp() - (alpha * radius * radius).exp()).max(0.0)
        }
        FilterKind::Mitchell { b, c } => cubic(f64::from(b), f64::from(c), 2.0 * x / radius),
        FilterKind::CatmullRom => cubic(0.0, 0.5, 2.0 * x / radius),
        FilterKind::Lanczos { lobes } => sinc(x) * sinc(x / f64::from(lobes)),
    }
}

/// The family of cubics of Mitchell and Netravali 1988, with support [-2, 2].
fn cubic(b: f64, c: f64, x: f64) -> f64 {
    let (x2, x3) = (x * x, x * x * x);
    if x < 1.0 {
        (12.0 - 9.0 * b - 6.0 * c) * x3 + (-18.0 + 12.0 * b + 6.0 * c) * x2 + (6.0 - 2.0 * b)
    } else if x < 2.0 {
        (-b - 6.0 * c) * x3 + (6.0 * b + 30.0 * c) * x2 + (-12.0 * b - 48.0 * c) * x + (8.0 * b + 24.0 * c)
    } else {
        0.0
    }
}

/// sin(pi x) / (pi x).
fn sinc(x: f64) -> f64 {
    let y = std::f64::consts::PI * x;
    if y < 1e-5 { 1.0 } else { y.sin() / y }
}

#[cfg(test)]
mod tests {
    use lichtweg_montecarlo::{Moments, Sampler, SamplerKind};

    use super::*;

    fn all() -> Vec<FilterDescription> {
        vec![
            FilterDescription::BOX,
            FilterDescription::new(FilterKind::Tent, 1.0),
            FilterDescription::default(),
            FilterDescription::new(FilterKind::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }, 2.0),
            FilterDescription::new(FilterKind::CatmullRom, 2.0),
            FilterDescription::new(FilterKind::Lanczos { lobes: 3.0 }, 3.0),
        ]
    }

    /// The mean weight is 1, and the weighted second moment is that of the filter, within 4.5 standard errors each
    /// (probability of a false alarm below 1e-4).
    #[test]
    fn moments_are_those_of_the_filter() {
        for description in all() {
            let filter = Filter::new(&description).unwrap();
            let (mut weights, mut squares) = (Moments::default(), Moments::default());
            for i in 0..200_000 {
                let mut sampler = Sampler::new(SamplerKind::Independent, 1, 2, i);
                let ([x, _], w) = filter.sample(sampler.next_2d());
                weights.push(f64::from(w));
                squares.push(f64::from(w * x * x));
            }
            let radius = f64::from(description.radius[0]);
            let n = 4000;
            let at = |i: i32| ((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0) * radius;
            let integral = |f: &dyn Fn(f64) -> f64| (0..n).map(|i| f(at(i))).sum::<f64>();
            let norm = integral(&|x| evaluate(description.kind, radius, x));
            let second = integral(&|x| x * x * evaluate(description.kind, radius, x)) / norm;
            assert!((weights.mean() - 1.0).abs() <= 4.5 * weights.standard_error() + 1e-6, "{description:?}");
            assert!(
                (squares.mean() - second).abs() < 4.5 * squares.standard_error() + 1e-5,
                "{description:?}"
            );
        }
    }

    /// The values are those of the density that offsets are drawn by, times the weights: their histograms agree within 5
    /// standard errors in each of 40 cells a filter (false alarms below 2e-4).
    #[test]
    fn values_are_densities_times_weights() {
        const CELLS: usize = 40;
        const SAMPLES: u32 = 200_000;
        for description in all() {
            let filter = Filter::new(&description).unwrap();
            let radius = filter.radius()[0];
            let mut cells = vec![Moments::default(); CELLS];
            for i in 0..SAMPLES {
                let u = Sampler::new(SamplerKind::Independent, 4, 5, i).next_1d();
                let (x, w) = filter.axes[0].sample(u);
                let cell = (((x / radius + 1.0) * 0.5 * CELLS as f32) as usize).min(CELLS - 1);
                cells
                    .iter_mut()
                    .enumerate()
                    .for_each(|(j, m)| m.push(if j == cell { f64::from(w) } else { 0.0 }));
            }
            let width = 2.0 * radius / CELLS as f32;
            for (j, cell) in cells.iter().enumerate() {
                let at = |k: usize| filter.along(0, ((j as f32 + (k as f32 + 0.5) / 64.0) * width) - radius);
                let integral = (0..64).map(|k| f64::from(at(k) * width / 64.0)).sum::<f64>();
                let error = (cell.mean() - integral).abs();
                assert!(error < 5.0 * cell.standard_error() + 1e-4, "{description:?}, cell {j}: {error}");
            }
            assert_eq!([filter.along(0, -1.1 * radius), filter.along(0, 1.1 * radius)], [0.0; 2]);
        }
    }

    #[test]
    fn impossible_filters_are_refused() {
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(Filter::new(&FilterDescription::new(FilterKind::Box, radius)).is_none());
        }
    }
}
