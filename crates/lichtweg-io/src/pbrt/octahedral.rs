//! The equal-area octahedral map of the sphere (Clarberg 2008, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD"; pbrt-v4
//! `util/math.cpp`, `EqualAreaSquareToSphere`), and what light it sends down.

use lichtweg::color::luminance;
use lichtweg::scene::description::{Image, Pixels};

/// The direction of the point (u, v) of the unit square; +z is its centre.
pub(super) fn direction(u: f64, v: f64) -> [f64; 3] {
    let (u, v) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let signed_distance = 1.0 - (u.abs() + v.abs());
    let r = 1.0 - signed_distance.abs();
    let quarter = if r == 0.0 { 1.0 } else { (v.abs() - u.abs()) / r + 1.0 };
    let phi = quarter * std::f64::consts::FRAC_PI_4;
    let z = (1.0 - r * r).copysign(signed_distance);
    let radius = r * (2.0 - r * r).max(0.0).sqrt();
    [phi.cos().copysign(u) * radius, phi.sin().copysign(v) * radius, z]
}

/// The illuminance (of CIE Y) that an upward surface at z = 0 gets from a map of the surroundings.
pub(super) fn upward_illuminance(image: &Image) -> f64 {
    let (width, height) = (image.width as usize, image.height as usize);
    let mut sum = 0.0;
    for y in 0..height {
        for x in 0..width {
            let [_, _, cosine] = direction((x as f64 + 0.5) / width as f64, (y as f64 + 0.5) / height as f64);
            if cosine > 0.0 {
                sum += cosine * f64::from(luminance(linear_pixel(image, y * width + x)));
            }
        }
    }
    // Half of the pixels are upward, and each has 4 pi / n steradians; pbrt's sum weighs them with 2 pi / n
    // (`lights.cpp`, `Light::Create`), and so do its images.
    sum * std::f64::consts::TAU / (width * height) as f64
}

/// A pixel as linear RGB.
fn linear_pixel(image: &Image, index: usize) -> [f32; 3] {
    let channels = image.channels as usize;
    let read = |c: usize| {
        let at = index * channels + c;
        let value = match &image.pixels {
            Pixels::U8(v) => f32::from(v[at]) / 255.0,
            Pixels::U16(v) => f32::from(v[at]) / 65535.0,
            Pixels::F32(v) => v[at],
        };
        if image.srgb { srgb_to_linear(value) } else { value }
    };
    if channels < 3 { [read(0); 3] } else { [read(0), read(1), read(2)] }
}

/// IEC 61966-2-1.
fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centre_is_up_and_corners_are_down() {
        assert_eq!(direction(0.5, 0.5)[2], 1.0);
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            assert!((direction(u, v)[2] + 1.0).abs() < 1e-12);
        }
        let [x, y, z] = direction(1.0, 0.5);
        assert!((x - 1.0).abs() < 1e-12 && y.abs() < 1e-12 && z.abs() < 1e-12);
    }

    /// Equal areas: the mean of z^2 over the square is 1/3, of each direction 0.
    #[test]
    fn areas_are_equal() {
        let n = 200;
        let mut mean = [0.0; 3];
        let mut mean_square = 0.0;
        for i in 0..n * n {
            let d = direction(((i % n) as f64 + 0.5) / n as f64, ((i / n) as f64 + 0.5) / n as f64);
            assert!((d.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-9);
            for (m, c) in mean.iter_mut().zip(d) {
                *m += c / (n * n) as f64;
            }
            mean_square += d[2] * d[2] / (n * n) as f64;
        }
        assert!(mean.iter().all(|m| m.abs() < 1e-9));
        assert!((mean_square - 1.0 / 3.0).abs() < 1e-4);
    }
}
