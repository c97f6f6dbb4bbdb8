//! Leaves, one by one.

use lichtweg_ray::math::Vec3;

use super::builder::{Builder, Shading};
use super::palette::Material;
use super::random::Random;
use super::solids::perpendicular;

/// A kind of leaves.
#[derive(Clone, Copy, Debug)]
pub struct Foliage {
    /// Their length at detail 1.
    pub size: f32,
    /// How far their normals may depart from the one they lean to.
    pub spread: f32,
    /// Their tones.
    pub tones: [Material; 3],
}

/// A leaf at a place: two triangles that meet in a fold.
pub fn scatter(b: &mut Builder, rng: &mut Random, foliage: &Foliage, place: Vec3, lean: Vec3) {
    let normal = lean + direction(rng) * foliage.spread;
    let normal = normal.try_normalized().unwrap_or(Vec3::Y);
    let size = b.length(foliage.size) * rng.within(0.7..1.25);
    let (across, along) = {
        let across = perpendicular(normal);
        let other = normal.cross(across);
        let (sin, cos) = rng.within(0.0..std::f32::consts::TAU).sin_cos();
        (across * cos + other * sin, other * cos - across * sin)
    };
    let middle = place + along * (0.5 * size);
    let lift = normal * (0.12 * size);
    let half = across * (0.36 * size);
    let tone = foliage.tones[usize::from(rng.below(3))];
    b.add(
        tone,
        Shading::Faceted,
        [place, middle + half + lift, place + along * size, middle - half + lift],
        [[0, 1, 2], [0, 2, 3]],
    );
}

/// Uniform on the unit sphere.
pub fn direction(rng: &mut Random) -> Vec3 {
    Vec3::from_array(lichtweg_montecarlo::warp::uniform_sphere([rng.unit(), rng.unit()]))
}
