//! What is remembered of the samples of one pixel.

use crate::color::Spectrum;

/// Sums over the samples of a pixel, in f64: exact enough for any number of samples, and enough for an error estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Sum of the weighted radiance.
    pub sum: [f64; 3],
    /// Sum of its squares.
    pub sum_squares: [f64; 3],
    /// Sum of the weighted radiance of the samples of odd index: with `sum`, two independent halves.
    pub sum_odd: [f64; 3],
    /// Samples in `sum`.
    pub count: u32,
    /// Samples in `sum_odd`.
    pub count_odd: u32,
}

impl Pixel {
    /// Adds a sample of a given index, times its filter weight.
    #[inline]
    pub fn add(&mut self, index: u32, radiance: Spectrum, weight: f32) {
        let odd = index & 1;
        for (lane, value) in radiance.to_rgb().into_iter().enumerate() {
            let value = f64::from(value * weight);
            self.sum[lane] += value;
            self.sum_squares[lane] += value * value;
            self.sum_odd[lane] += f64::from(odd) * value;
        }
        self.count += 1;
        self.count_odd += odd;
    }

    /// The estimate.
    pub fn mean(&self) -> [f64; 3] {
        self.sum.map(|s| s / f64::from(self.count.max(1)))
    }

    /// Estimated variance of [`Pixel::mean`], from the spread of the samples; infinite for fewer than two.
    pub fn variance_of_mean(&self) -> [f64; 3] {
        let n = f64::from(self.count);
        std::array::from_fn(|i| {
            if self.count < 2 {
                return f64::INFINITY;
            }
            let mean = self.sum[i] / n;
            ((self.sum_squares[i] / n - mean * mean) / (n - 1.0)).max(0.0)
        })
    }

    /// The means of the samples of even and of odd index.
    pub fn halves(&self) -> [[f64; 3]; 2] {
        let even = f64::from((self.count - self.count_odd).max(1));
        let odd = f64::from(self.count_odd.max(1));
        [
            std::array::from_fn(|i| (self.sum[i] - self.sum_odd[i]) / even),
            std::array::from_fn(|i| self.sum_odd[i] / odd),
        ]
    }
}

/// Sums of what the camera saw first, for denoisers and for looking at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AuxiliarySums {
    /// Albedo.
    pub albedo: [f32; 3],
    /// Shading normal in the world.
    pub normal: [f32; 3],
    /// Distance along the ray, over the samples that hit.
    pub depth: f32,
    /// Samples that hit a surface.
    pub hits: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_variance_and_halves() {
        let mut p = Pixel::default();
        for (i, v) in [1.0, 2.0, 4.0, 9.0].into_iter().enumerate() {
            p.add(i as u32, Spectrum::splat(v), 1.0);
        }
        assert_eq!(p.mean()[0], 4.0);
        // Sample variance 38/3 over 4.
        assert!((p.variance_of_mean()[1] - 38.0 / 12.0).abs() < 1e-12);
        assert_eq!(p.halves(), [[2.5; 3], [5.5; 3]]);
        assert_eq!(Pixel::default().variance_of_mean(), [f64::INFINITY; 3]);
    }
}
