//! What an image is about to show, of the samples so far: by this, connections that are worth little are known.
//!
//! It is looked at where the number of samples doubles, so that it does not depend on where passes are cut. Pixels with few samples
//! are taken together with their neighbours; roots are averaged, so that a single bright path does not hide what is around it.

use super::*;
use crate::film::SplatFilm;
use crate::transport::Expectation;

/// Samples that make a mean.
const ENOUGH: f32 = 64.0;

impl Job {
    /// After a number of samples of all pixels.
    pub(super) fn expectation(&self, tiles: &[Tile], film: &SplatFilm, samples: u32) -> Expectation {
        let [x0, y0, width, height] = self.window;
        let scale = f64::from(samples) * f64::from(self.film_scale);
        let mut sums: Vec<[f64; 3]> = film.sums().collect();
        for tile in tiles {
            for (i, pixel) in (0..).zip(&tile.pixels) {
                let [x, y] = tile.position(i);
                let sum = &mut sums[((y - y0) * width + x - x0) as usize];
                sum.iter_mut().zip(pixel.sum).for_each(|(sum, eye)| *sum += eye);
            }
        }
        let root = |sum: &[f64; 3]| {
            let mean = (sum.iter().copied().fold(0.0, f64::max) / scale) as f32;
            if mean.is_finite() { mean.sqrt() } else { 0.0 }
        };
        let radius = (0.5 * ((ENOUGH / samples as f32).sqrt() - 1.0)).ceil().max(0.0) as usize;
        let roots: Vec<f32> = sums.iter().map(root).collect();
        let rows = blur(&roots, width as usize, radius);
        let columns = blur(&transpose(&rows, width as usize), height as usize, radius);
        let radiance = transpose(&columns, height as usize).into_iter().map(|root| root * root).collect();
        Expectation { size: self.size, window: self.window, radiance }
    }
}

/// Means over the neighbours in rows of a width.
fn blur(values: &[f32], width: usize, radius: usize) -> Vec<f32> {
    let mean = |row: &[f32], x: usize| {
        let near = &row[x.saturating_sub(radius)..width.min(x + radius + 1)];
        near.iter().sum::<f32>() / near.len() as f32
    };
    values.chunks(width).flat_map(|row| (0..width).map(move |x| mean(row, x))).collect()
}

/// Columns as rows.
fn transpose(values: &[f32], width: usize) -> Vec<f32> {
    (0..width).flat_map(|x| values.iter().skip(x).step_by(width).copied()).collect()
}
