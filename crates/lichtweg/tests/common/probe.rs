//! A probe: a small diffuse square at the origin facing +y, and a camera that sees a spot of it.
//!
//! The spot is so small that the light falling on it is that of one point; its radiance is then albedo / pi times the
//! irradiance there, for which many lights have closed forms.

use std::f64::consts::PI;

use lichtweg::scene::description::{Description, IntegratorDescription};
use lichtweg_ray::math::Affine;

use super::build::{Build, chain, facing_up, rectangle};
use super::run::{camera, film};

/// Of the probe, different in every channel.
pub const ALBEDO: [f32; 3] = [0.8, 0.5, 0.25];

/// A scene of the probe alone, for light that comes straight from the lights.
pub fn probe(samples_per_pixel: u32, seed: u64) -> Description {
    let mut d = Description {
        camera: camera([0.3, 0.4, -0.5], [0.0; 3], 0.01),
        film: film(32, 32),
        integrator: IntegratorDescription { max_depth: Some(2), ..Default::default() },
        ..Default::default()
    };
    d.sampler.samples_per_pixel = samples_per_pixel;
    d.sampler.seed = seed;
    let material = d.diffuse(ALBEDO);
    d.shape(rectangle(), chain(&[Affine::scaling(0.01, 0.01, 0.01), facing_up()]), material);
    d
}

/// The radiance of the probe under an irradiance that is the same in every channel.
pub fn reflected(irradiance: f64) -> [f64; 3] {
    ALBEDO.map(|a| f64::from(a) / PI * irradiance)
}
