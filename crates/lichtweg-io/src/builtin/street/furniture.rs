//! What stands on a pavement: benches, bollards, bins.

use super::builder::Builder;
use super::palette::Material;
use super::random::Random;
use super::solids::{cuboid, frustum, lathe, tube, v};

/// A bench along x that faces +z: slats on two bent irons.
pub fn bench(b: &mut Builder) {
    for i in 0..5 {
        let z = -0.2 + 0.1 * i as f32;
        cuboid(b, Material::Wood, [-0.9, 0.43, z], [0.9, 0.465, z + 0.075]);
    }
    b.at(0.0, 0.5, -0.24, |b| {
        b.tilted(-12.0, |b| {
            for i in 0..4 {
                let y = 0.06 + 0.11 * i as f32;
                cuboid(b, Material::Wood, [-0.9, y, -0.03], [0.9, y + 0.08, 0.005]);
            }
        });
    });
    for x in [-0.75, 0.75] {
        let back = [v(x, 0.0, -0.3), v(x, 0.42, -0.22), v(x, 0.55, -0.27), v(x, 0.98, -0.37)];
        tube(b, Material::Iron, &back, |_| 0.024, 6);
        let front = [v(x, 0.0, 0.28), v(x, 0.36, 0.24), v(x, 0.415, 0.15), v(x, 0.415, -0.24)];
        tube(b, Material::Iron, &front, |_| 0.024, 6);
        let rest = [v(x, 0.38, 0.24), v(x, 0.64, 0.26), v(x, 0.67, 0.18), v(x, 0.67, -0.28)];
        tube(b, Material::Iron, &rest, |_| 0.018, 6);
    }
}

/// A short iron post.
pub fn bollard(b: &mut Builder) {
    let profile = [
        [0.11, 0.0],
        [0.11, 0.08],
        [0.07, 0.12],
        [0.055, 0.72],
        [0.08, 0.75],
        [0.08, 0.79],
        [0.05, 0.83],
        [0.07, 0.9],
        [0.05, 0.97],
        [0.0, 0.99],
    ];
    let sides = b.count_along(12.0, 6);
    lathe(b, Material::Iron, &profile, sides);
}

/// A litter bin of staves.
pub fn bin(b: &mut Builder) {
    let sides = b.count_along(14.0, 6);
    lathe(
        b,
        Material::Iron,
        &[[0.0, 0.04], [0.19, 0.04], [0.22, 0.78], [0.24, 0.8], [0.2, 0.84], [0.12, 0.85], [0.1, 0.6]],
        sides,
    );
    for i in 0..16 {
        b.turned(22.5 * i as f32, |b| cuboid(b, Material::Wood, [-0.035, 0.08, 0.2], [0.035, 0.74, 0.245]));
    }
}

/// A tub with a clipped bush is the householder's own: this is only its pot.
pub fn planter(b: &mut Builder, rng: &mut Random) {
    let size = 0.24 + rng.jitter(0.04);
    frustum(b, Material::Clay, [-size, 0.0, -size], [size, 0.42, size], -0.05);
    cuboid(b, Material::Clay, [-size - 0.08, 0.42, -size - 0.08], [size + 0.08, 0.49, size + 0.08]);
}
