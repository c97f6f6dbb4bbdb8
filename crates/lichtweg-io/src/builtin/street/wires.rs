//! Telegraph poles, and wires that hang between them.

use lichtweg_ray::math::Vec3;

use super::builder::Builder;
use super::palette::Material;
use super::solids::{cuboid, lathe, tube, v};

/// Where the wires are fixed, from the middle of a pole.
pub const INSULATORS: [f32; 4] = [-0.8, -0.4, 0.4, 0.8];
/// Height of the insulators' tops.
pub const HEIGHT: f32 = 8.05;

/// A pole at the origin whose arm lies along x.
pub fn pole(b: &mut Builder) {
    let sides = b.count_along(10.0, 5);
    lathe(b, Material::Wood, &[[0.13, -0.1], [0.085, 8.3], [0.0, 8.34]], sides);
    cuboid(b, Material::Wood, [-0.95, 7.8, 0.05], [0.95, 7.9, 0.16]);
    for x in INSULATORS {
        b.at(x, 7.9, 0.105, |b| {
            lathe(
                b,
                Material::Opal,
                &[[0.03, 0.0], [0.05, 0.05], [0.03, 0.08], [0.05, 0.1], [0.02, HEIGHT - 7.9]],
                6,
            );
        });
    }
}

/// A wire between two points that sags in the middle, as a parabola.
pub fn wire(b: &mut Builder, from: Vec3, to: Vec3, sag: f32) {
    let steps = b.count_along(18.0, 4);
    let point = |i: usize| {
        let t = i as f32 / steps as f32;
        from + (to - from) * t - v(0.0, 4.0 * sag * t * (1.0 - t), 0.0)
    };
    tube(b, Material::Iron, &(0..=steps).map(point).collect::<Vec<_>>(), |_| 0.011, 4);
}
