//! Pitched roofs with single tiles, ridges, verges, gutters; chimneys.

use super::builder::Builder;
use super::palette::Material;
use super::random::Random;
use super::solids::{ball, cuboid, lathe, prism, tube, v};

/// A gable roof over a rectangle about the origin, its ridge along x.
#[derive(Clone, Copy, Debug)]
pub struct Roof {
    /// Along the ridge.
    pub length: f32,
    /// Across it, between the walls.
    pub span: f32,
    /// From the walls' top to the ridge.
    pub rise: f32,
    /// Beyond the walls at the eaves.
    pub overhang: f32,
    /// First of three neighbouring tones of [`Material::Tile`].
    pub tone: u8,
}

/// Thickness of rafters and battens.
const THICKNESS: f32 = 0.14;

impl Roof {
    /// Builds it, the walls' top being at height 0.
    pub fn build(&self, b: &mut Builder, rng: &mut Random) {
        let half = 0.5 * self.span;
        let pitch = self.rise.atan2(half);
        let slope = (half + self.overhang) / pitch.cos();
        let eave = -self.overhang * pitch.tan();
        for side in [0.0, 180.0] {
            b.turned(side, |b| {
                // From the eave upwards: y along the slope, z off the roof.
                b.at(0.0, eave, half + self.overhang, |b| {
                    b.tilted(pitch.to_degrees() - 90.0, |b| self.slope(b, rng, slope));
                    gutter(b, self.length);
                });
            });
        }
        self.ridge(b, rng);
    }

    fn slope(&self, b: &mut Builder, rng: &mut Random, length: f32) {
        let half = 0.5 * self.length;
        cuboid(b, Material::Trim, [-half, 0.0, 0.0], [half, length, THICKNESS]);
        for x in [-half, half - 0.06] {
            cuboid(b, Material::Trim, [x, -0.02, -0.06], [x + 0.06, length, THICKNESS + 0.07]);
        }
        b.at(0.0, 0.0, THICKNESS, |b| self.tiles(b, rng, length));
    }

    /// Overlapping rows of flat tiles, each row shifted by half a tile, each tile a little askew.
    fn tiles(&self, b: &mut Builder, rng: &mut Random, length: f32) {
        let rows = (length / b.length(0.5)).ceil() as usize;
        let columns = (self.length / b.length(0.46)).ceil() as usize;
        let (height, width) = (length / rows as f32, self.length / columns as f32);
        for row in 0..rows {
            let shift = if row % 2 == 0 { 0.0 } else { -0.5 };
            for column in 0..columns + row % 2 {
                let end =
                    |x: f32| (x * width - 0.5 * self.length).clamp(-0.5 * self.length, 0.5 * self.length);
                let (x0, x1) = (end(column as f32 + shift), end(column as f32 + shift + 1.0));
                let y = row as f32 * height + rng.jitter(0.04 * height);
                let lift = 0.055 + rng.jitter(0.012);
                let lean = rng.jitter(0.008);
                let tile = Material::Tile(self.tone + rng.below(3));
                let [low_left, low_right] = [v(x0, y, lift - lean), v(x1, y, lift + lean)];
                b.quad(
                    tile,
                    [low_left, low_right, v(x1, y + 1.15 * height, 0.01), v(x0, y + 1.15 * height, 0.01)],
                );
                b.quad(tile, [v(x0, y, 0.0), v(x1, y, 0.0), low_right, low_left]);
            }
        }
    }

    fn ridge(&self, b: &mut Builder, rng: &mut Random) {
        let count = (self.length / b.length(0.42)).ceil() as usize;
        let step = self.length / count as f32;
        let sides = b.count_along(8.0, 5);
        for i in 0..count {
            let x = i as f32 * step - 0.5 * self.length;
            let y = self.rise + THICKNESS + 0.03 + rng.jitter(0.008);
            let tile = Material::Tile(self.tone + rng.below(3));
            tube(b, tile, &[v(x, y, 0.0), v(x + 1.08 * step, y, 0.0)], |end| [0.15, 0.125][end], sides);
        }
        for x in [-0.5, 0.5] {
            b.at(x * self.length, self.rise + THICKNESS + 0.03, 0.0, |b| {
                ball(b, Material::Tile(self.tone), 0.155, 8)
            });
        }
    }
}

/// Along the eave at the origin.
fn gutter(b: &mut Builder, length: f32) {
    let half = 0.5 * length;
    tube(b, Material::Zinc, &[v(-half, 0.02, 0.07), v(half, 0.02, 0.07)], |_| 0.065, 8);
}

/// A pipe from the gutter to the ground, in front of a wall at z = 0.
pub fn downpipe(b: &mut Builder, x: f32, height: f32, overhang: f32) {
    let path = [
        v(x, 0.0, 0.07),
        v(x, height - 0.45, 0.07),
        v(x, height - 0.3, 0.10),
        v(x, height - 0.12, overhang),
        v(x, height, overhang + 0.05),
    ];
    tube(b, Material::Zinc, &path, |_| 0.045, 8);
    for y in [0.8, 0.5 * height, height - 0.6] {
        cuboid(b, Material::Zinc, [x - 0.06, y, 0.0], [x + 0.06, y + 0.04, 0.13]);
    }
}

/// A chimney with pots, from `base` to `top`.
pub fn chimney(b: &mut Builder, rng: &mut Random, base: f32, top: f32) {
    let pots = 1 + rng.below(3);
    let half = 0.2 + 0.16 * f32::from(pots);
    let courses = ((top - base) / 0.16) as usize;
    let course = (top - base) / courses as f32;
    for i in 0..courses {
        let y = base + i as f32 * course;
        let [x, z] = [half + rng.jitter(0.006), 0.27 + rng.jitter(0.006)];
        cuboid(b, Material::Brick, [-x, y, -z], [x, y + course - 0.012, z]);
    }
    cuboid(b, Material::Soil, [-half + 0.015, base, -0.255], [half - 0.015, top, 0.255]);
    let ledge =
        [[-half - 0.09, top], [half + 0.09, top], [half + 0.04, top + 0.14], [-half - 0.04, top + 0.14]];
    prism(b, Material::Stone, &ledge, -0.36, 0.36);
    let sides = b.count_along(12.0, 6);
    for pot in 0..pots {
        let x = (f32::from(pot) - 0.5 * f32::from(pots - 1)) * 0.34;
        let height = 0.4 + rng.jitter(0.08);
        let profile = [
            [0.14, 0.0],
            [0.11, height - 0.1],
            [0.145, height - 0.08],
            [0.145, height],
            [0.1, height],
            [0.09, height - 0.2],
        ];
        b.at(x, top + 0.14, 0.0, |b| lathe(b, Material::Clay, &profile, sides));
    }
}
