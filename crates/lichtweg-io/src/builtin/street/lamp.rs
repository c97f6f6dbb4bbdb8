//! Street lamps: a fluted foot, a post, two curved arms, and a globe on each.

use super::builder::Builder;
use super::palette::Material;
use super::solids::{ball, cuboid, lathe, tube, v};

/// A lamp whose arms reach along x.
pub fn lamp(b: &mut Builder) {
    let sides = b.count_along(14.0, 6);
    let post = [
        [0.22, 0.0],
        [0.22, 0.18],
        [0.17, 0.24],
        [0.14, 0.8],
        [0.17, 0.86],
        [0.09, 0.95],
        [0.055, 3.4],
        [0.09, 3.45],
        [0.09, 3.52],
        [0.05, 3.58],
        [0.04, 4.35],
        [0.075, 4.42],
        [0.03, 4.5],
        [0.012, 4.75],
        [0.0, 4.78],
    ];
    lathe(b, Material::Iron, &post, sides);
    cuboid(b, Material::Iron, [-0.45, 3.46, -0.025], [0.45, 3.51, 0.025]);
    for side in [0.0, 180.0] {
        b.turned(side, |b| arm(b, sides));
    }
}

/// A bow from the post to the lantern that hangs at its end.
fn arm(b: &mut Builder, sides: usize) {
    let steps = b.count_along(10.0, 4);
    let path: Vec<_> = (0..=steps)
        .map(|i| {
            let (sin, cos) = (i as f32 / steps as f32 * 3.4).sin_cos();
            v(0.36 - 0.36 * cos, 4.1 + 0.3 * sin, 0.0)
        })
        .collect();
    tube(b, Material::Iron, &path, |_| 0.022, 6);
    let end = path[steps];
    b.at(end.x, end.y, 0.0, |b| {
        let cap = [[0.2, -0.14], [0.17, -0.08], [0.07, -0.02], [0.03, 0.05], [0.0, 0.06]];
        lathe(b, Material::Iron, &cap, sides);
        lathe(b, Material::Iron, &[[0.0, -0.141], [0.2, -0.14]], sides);
        b.at(0.0, -0.26, 0.0, |b| ball(b, Material::Opal, 0.17, sides));
        b.at(0.0, -0.45, 0.0, |b| ball(b, Material::Iron, 0.03, 6));
    });
}
