//! Rays from inside closed meshes: none may get out.

use lichtweg_ray::math::{Affine, Vec3};
use lichtweg_ray::{Accel, Ray};

use super::random::Random;
use super::scenes::Scene;

/// A scene moved by an affine map.
pub fn mapped(mut scene: Scene, map: &Affine) -> Scene {
    scene.positions.iter_mut().for_each(|p| *p = map.point(*p));
    scene
}

/// A ray from near `center` (within `radius`), in turn: anywhere, at a vertex, at a point of an edge,
/// along an axis or a diagonal.
fn ray(random: &mut Random, scene: &Scene, center: Vec3, radius: f32) -> Ray {
    let pick = |random: &mut Random| scene.indices[random.bits() as usize % scene.indices.len()];
    let origin = match random.bits() % 4 {
        0 => center,
        _ => center + random.direction() * (radius * random.unit()),
    };
    let direction = match random.bits() % 4 {
        0 => random.direction(),
        1 => scene.positions[pick(random)[0] as usize] - origin,
        2 => {
            let [a, b, _] = pick(random).map(|i| scene.positions[i as usize]);
            a + (b - a) * random.unit() - origin
        }
        _ => {
            let sign = |r: &mut Random| (r.bits() % 3) as f32 - 1.0;
            Vec3::new(sign(random), sign(random), sign(random))
        }
    };
    if direction == Vec3::ZERO { Ray::new(origin, Vec3::X) } else { Ray::new(origin, direction) }
}

/// How many of `count` rays escape, by either query.
pub fn escapes(scene: &Scene, accel: &Accel, radius: f32, count: u64, seed: u64) -> u64 {
    let mut random = Random(seed);
    let center = accel.bounds().center();
    (0..count)
        .filter(|_| {
            let ray = ray(&mut random, scene, center, radius);
            accel.closest(&ray).is_none() || !accel.occluded(&ray)
        })
        .count() as u64
}
