//! From sums to layers.

use super::LayerSelection;
use crate::film::{AuxiliarySums, Pixel};

/// The pixels of a rendering, row by row from the top left corner of its window.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderedImage {
    /// Full film size.
    pub size: [u32; 2],
    /// The part that was rendered: x, y, width, height.
    pub window: [u32; 4],
    /// Sums of radiance.
    pub pixels: Vec<Pixel>,
    /// Sums of what the camera saw first; empty where not recorded.
    pub auxiliary: Vec<AuxiliarySums>,
}

/// A named group of channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Empty for radiance itself.
    pub name: &'static str,
    /// Of each channel, such as `R`, `G`, `B`.
    pub channels: &'static [&'static str],
    /// Interleaved values.
    pub data: Vec<f32>,
}

const RGB: &[&str] = &["R", "G", "B"];

impl RenderedImage {
    /// Radiance, and the layers that were asked for and recorded; how many samples each pixel has, where they are not all the same.
    pub fn layers(&self, selection: LayerSelection) -> Vec<Layer> {
        let of_pixels = |f: fn(&Pixel) -> [f64; 3]| {
            self.pixels.iter().flat_map(|p| f(p).map(|v| v as f32)).collect::<Vec<f32>>()
        };
        let mut layers = vec![Layer { name: "", channels: RGB, data: of_pixels(Pixel::mean) }];
        if selection.variance {
            layers.push(Layer { name: "variance", channels: RGB, data: of_pixels(Pixel::variance_of_mean) });
        }
        let count = |p: &Pixel| p.count;
        if self.pixels.iter().map(count).min() != self.pixels.iter().map(count).max() {
            let data = self.pixels.iter().map(|p| p.count as f32).collect();
            layers.push(Layer { name: "samples", channels: &["N"], data });
        }
        if self.auxiliary.is_empty() {
            return layers;
        }
        // Averaged over all samples for the albedo, over those that hit for the rest.
        let of_sums = |f: &dyn Fn(&AuxiliarySums, f32) -> [f32; 3]| {
            let samples = |i: usize| self.pixels[i].count.max(1) as f32;
            self.auxiliary.iter().enumerate().flat_map(|(i, a)| f(a, samples(i))).collect::<Vec<f32>>()
        };
        if selection.albedo {
            let data = of_sums(&|a, samples| a.albedo.map(|v| v / samples));
            layers.push(Layer { name: "albedo", channels: RGB, data });
        }
        if selection.normal {
            let data = of_sums(&|a, _| a.normal.map(|v| v / a.hits.max(1) as f32));
            layers.push(Layer { name: "normal", channels: &["X", "Y", "Z"], data });
        }
        if selection.depth {
            let depth = |a: &AuxiliarySums| if a.hits > 0 { a.depth / a.hits as f32 } else { f32::INFINITY };
            let data = self.auxiliary.iter().map(depth).collect();
            layers.push(Layer { name: "depth", channels: &["Z"], data });
        }
        layers
    }

    /// Mean radiance over the image, and the standard error of that mean.
    pub fn mean(&self) -> ([f64; 3], [f64; 3]) {
        let n = self.pixels.len() as f64;
        let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
        for pixel in &self.pixels {
            let (m, v) = (pixel.mean(), pixel.variance_of_mean());
            for i in 0..3 {
                mean[i] += m[i] / n;
                variance[i] += v[i] / (n * n);
            }
        }
        (mean, variance.map(f64::sqrt))
    }
}
