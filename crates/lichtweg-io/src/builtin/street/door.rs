//! Front doors: panels, a fanlight, a frame, a canopy, steps, a knob.

use super::builder::Builder;
use super::palette::Material;
use super::random::Random;
use super::solids::{Rectangle, ball, cuboid, frustum, prism, v};

/// Fills an opening of the wall z = 0, whose foot may be above the ground at y = 0.
pub fn door(b: &mut Builder, rng: &mut Random, opening: Rectangle, paint: Material, stone: Material) {
    let (half, height) = (0.5 * opening.width(), opening.height());
    b.at(opening.middle(), opening.y0, 0.0, |b| {
        leaf(b, half, height - 0.5, paint);
        fanlight(b, half, height);
        for x in [-half - 0.16, half] {
            cuboid(b, stone, [x, -opening.y0, 0.0], [x + 0.16, height, 0.07]);
        }
        cuboid(b, stone, [-half - 0.16, height, 0.0], [half + 0.16, height + 0.18, 0.07]);
        if rng.chance(0.6) {
            canopy(b, half, height + 0.18, stone);
        }
        steps(b, half, opening.y0);
    });
}

fn leaf(b: &mut Builder, half: f32, height: f32, paint: Material) {
    cuboid(b, paint, [-half, 0.0, -0.2], [half, height, -0.14]);
    for (x0, x1) in [(-half + 0.1, -0.06), (0.06, half - 0.1)] {
        for (y0, y1) in [(0.15, 0.75), (0.9, 1.25), (1.4, height - 0.12)] {
            b.at(0.0, 0.0, -0.14, |b| {
                b.tilted(90.0, |b| frustum(b, paint, [x0, 0.0, -y1], [x1, 0.025, -y0], 0.04));
            });
        }
    }
    b.at(half - 0.06, 1.05, -0.1, |b| ball(b, Material::Zinc, 0.035, 8));
}

fn fanlight(b: &mut Builder, half: f32, height: f32) {
    let (low, z) = (height - 0.5, -0.17);
    cuboid(b, Material::Trim, [-half, low, -0.2], [half, low + 0.07, -0.1]);
    cuboid(b, Material::Trim, [-half, height - 0.06, -0.2], [half, height, -0.12]);
    for i in 0..5 {
        let x = -half + (2.0 * half - 0.05) * i as f32 / 4.0;
        cuboid(b, Material::Trim, [x, low + 0.07, -0.2], [x + 0.05, height - 0.06, -0.13]);
    }
    b.quad(Material::Glass(0), [v(-half, low, z), v(half, low, z), v(half, height, z), v(-half, height, z)]);
}

fn canopy(b: &mut Builder, half: f32, y: f32, stone: Material) {
    let wide = half + 0.35;
    cuboid(b, stone, [-wide, y, 0.0], [wide, y + 0.1, 0.7]);
    prism(b, stone, &[[-wide, y + 0.1], [wide, y + 0.1], [0.0, y + 0.45]], 0.0, 0.66);
    let bracket = [[0.0, y - 0.5], [0.1, y - 0.45], [0.5, y], [0.0, y]];
    for x in [-half - 0.14, half + 0.04] {
        b.turned(-90.0, |b| prism(b, stone, &bracket, -x - 0.1, -x));
    }
}

fn steps(b: &mut Builder, half: f32, height: f32) {
    const COUNT: usize = 3;
    for i in 0..COUNT {
        let reach = 0.3 * (COUNT - i) as f32 + 0.1;
        let rise = height / COUNT as f32;
        let wide = half + 0.16 + 0.1 * (COUNT - i) as f32;
        cuboid(b, Material::Stone, [-wide, i as f32 * rise - 0.1, 0.0], [wide, (i + 1) as f32 * rise, reach]);
    }
}
