//! The church at the end of the street: a tower with a spire, clock and bell windows, and a nave.

use super::builder::Builder;
use super::palette::Material;
use super::random::Random;
use super::roof::Roof;
use super::solids::{Rectangle, cuboid, frustum, lathe, prism, v, wall};

const HALF: f32 = 3.2;
const HEIGHT: f32 = 17.0;

/// The church, its tower's middle at the origin and its front towards +z.
pub fn church(b: &mut Builder, rng: &mut Random) {
    for turn in [0.0, 90.0, 180.0, 270.0] {
        b.turned(turn, |b| b.at(0.0, 0.0, HALF, face));
    }
    for x in [-HALF, HALF] {
        for z in [-HALF, HALF] {
            for (low, high, out) in [(-0.1, 6.0, 0.55), (6.0, 10.0, 0.4), (10.0, HEIGHT, 0.28)] {
                cuboid(b, Material::Stone, [x - out, low, z - out], [x + out, high, z + out]);
            }
        }
    }
    for (y, out) in [(6.0, 0.12), (10.0, 0.12), (HEIGHT - 0.3, 0.4)] {
        let edge = HALF + out;
        cuboid(b, Material::Stone, [-edge, y, -edge], [edge, y + 0.3, edge]);
    }
    spire(b);
    b.at(0.0, 0.0, -HALF - 9.0, |b| {
        cuboid(b, Material::Plaster(7), [-5.0, -0.1, -9.0], [5.0, 8.0, 9.0]);
        let roof = Roof { length: 18.4, span: 10.0, rise: 6.0, overhang: 0.4, tone: 3 };
        b.at(0.0, 8.0, 0.0, |b| b.turned(90.0, |b| roof.build(b, rng)));
        b.at(0.0, 0.0, 9.0, |b| {
            prism(b, Material::Plaster(7), &[[-5.0, 8.0], [5.0, 8.0], [0.0, 14.0]], -0.2, 0.0)
        });
    });
}

/// One side of the tower.
fn face(b: &mut Builder) {
    let bell = Rectangle { x0: -0.9, x1: 0.9, y0: 10.9, y1: 14.2 };
    let slits = [3.0, 7.0].map(|y| Rectangle { x0: -0.35, x1: 0.35, y0: y, y1: y + 2.0 });
    let whole = Rectangle { x0: -HALF, x1: HALF, y0: -0.1, y1: HEIGHT };
    wall(b, Material::Plaster(7), whole, &[bell, slits[0], slits[1]], 0.5);
    for o in [bell, slits[0], slits[1]] {
        let z = -0.45;
        b.quad(Material::Rubber, [v(o.x0, o.y0, z), v(o.x1, o.y0, z), v(o.x1, o.y1, z), v(o.x0, o.y1, z)]);
        cuboid(b, Material::Stone, [o.x0 - 0.3, o.y0 - 0.2, 0.0], [o.x1 + 0.3, o.y0, 0.15]);
        prism(
            b,
            Material::Stone,
            &[[o.x0 - 0.3, o.y1], [o.x1 + 0.3, o.y1], [o.middle(), o.y1 + 0.7]],
            0.0,
            0.12,
        );
    }
    for i in 0..9 {
        let y = bell.y0 + 0.36 * i as f32;
        b.at(0.0, y, -0.3, |b| {
            b.tilted(35.0, |b| cuboid(b, Material::Wood, [-0.88, 0.0, 0.0], [0.88, 0.04, 0.36]))
        });
    }
    b.at(0.0, 15.6, 0.0, |b| {
        let sides = b.count_along(32.0, 12);
        b.tilted(90.0, |b| {
            lathe(b, Material::Trim, &[[0.85, -0.05], [0.9, 0.1], [0.0, 0.11]], sides);
        });
        for (degrees, length) in [(300.0_f32, 0.5), (60.0, 0.75)] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let (end, side) = (v(sin, cos, 0.0) * length, v(cos, -sin, 0.0) * 0.04);
            let z = v(0.0, 0.0, 0.13);
            b.quad(Material::Iron, [z - side, z + side, end + z + side, end + z - side]);
        }
    });
}

/// An eight-sided spire with a ball and a weathervane.
fn spire(b: &mut Builder) {
    frustum(
        b,
        Material::Tile(3),
        [-HALF - 0.3, HEIGHT, -HALF - 0.3],
        [HALF + 0.3, HEIGHT + 1.6, HALF + 0.3],
        1.2,
    );
    let (rows, step) = (40, 11.0 / 40.0);
    for i in 0..rows {
        let radius = |y: f32| 2.45 * (1.0 - y / 11.2);
        let y = i as f32 * step;
        b.at(0.0, HEIGHT + 1.55 + y, 0.0, |b| {
            b.turned(22.5, |b| {
                let tile = Material::Tile(3 + (i % 3) as u8);
                lathe(b, tile, &[[radius(y) + 0.05, 0.0], [radius(y + step) + 0.02, 1.05 * step]], 8);
            });
        });
    }
    b.at(0.0, HEIGHT + 12.4, 0.0, |b| {
        lathe(
            b,
            Material::Zinc,
            &[[0.05, 0.0], [0.04, 0.6], [0.2, 0.75], [0.2, 0.85], [0.04, 1.0], [0.02, 2.0], [0.0, 2.01]],
            10,
        );
        cuboid(b, Material::Zinc, [-0.4, 1.5, -0.02], [0.5, 1.6, 0.02]);
    });
}
