//! Shoots many rays from inside closed meshes and counts those that get out.
//!
//! `cargo run --release -p lichtweg-ray --example escape -- [millions of rays a mesh]`

#[path = "../benches/support/mod.rs"]
mod support;

use lichtweg_ray::math::Affine;
use support::escape::{escapes, mapped};
use support::rays::accel;
use support::scenes::{cube, displaced_sphere};

fn main() {
    let millions = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(10_u64);
    let flat = Affine::rotation([1.0, 2.0, 3.0], 40.0).after(&Affine::scaling(1.0, 100.0, 1e-3));
    let turned = Affine::rotation([0.3, 1.0, 0.2], 33.0);
    for (scene, radius) in [
        (displaced_sphere(707), 0.8),
        (mapped(cube(100), &turned), 0.9),
        (mapped(displaced_sphere(100), &flat), 1e-4),
    ] {
        let accel = accel(&scene);
        let out = escapes(&scene, &accel, radius, millions * 1_000_000, 2);
        println!("{}: {out} of {millions} million rays escaped", scene.name);
    }
}
