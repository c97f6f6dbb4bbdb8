//! The ground: a cambered roadway of cobbles, gutters, kerbs, slabs of the pavement, lawns.

use super::builder::{Builder, Shading};
use super::palette::Material;
use super::random::Random;
use super::solids::{cuboid, v};

/// Half the width of the roadway.
pub const ROAD: f32 = 4.2;
/// From the middle of the road to the far side of the pavement.
pub const PAVEMENT: f32 = 7.4;
/// Height of the pavement above the gutter.
pub const KERB: f32 = 0.13;

/// A stone's bed: from (x, z) on, and its size.
#[derive(Clone, Copy, Debug)]
struct Bed {
    x: f32,
    z: f32,
    width: f32,
    length: f32,
}

/// The roadway from `near` to `far`, down the -z axis.
pub fn roadway(b: &mut Builder, rng: &mut Random, near: f32, far: f32) {
    plain(b, [-150.0, 150.0], [-210.0, 50.0], -0.06);
    let rows = ((far - near) / b.length(0.34)).round() as usize;
    let length = (far - near) / rows as f32;
    for row in 0..rows {
        let z = -near - row as f32 * length;
        let mut x = -ROAD;
        while x < ROAD {
            let mut width = b.length(0.46) * rng.within(0.8..1.25);
            if x + width > ROAD - b.length(0.2) {
                width = ROAD - x;
            }
            let middle = (x + 0.5 * width) / ROAD;
            let bed = Bed { x, z: z + rng.jitter(0.02 * length), width, length };
            stone(b, rng, Material::Cobble, 3, bed, 0.1 * (1.0 - middle * middle), 0.012);
            x += width;
        }
    }
}

/// Kerb, slabs and front gardens of one side, in its frame: x along the street, the middle of the road at z = 0, houses
/// at -z.
pub fn pavement(b: &mut Builder, rng: &mut Random, from: f32, to: f32) {
    let stones = (to - from) as usize;
    for i in 0..stones {
        let x = from + i as f32;
        let top = KERB + rng.jitter(0.006);
        cuboid(
            b,
            Material::Stone,
            [x + 0.006, -0.1, -ROAD - 0.2],
            [x + 0.994, top, -ROAD + rng.jitter(0.006)],
        );
    }
    let columns = ((to - from) / b.length(0.8)) as usize;
    let rows = ((PAVEMENT - ROAD - 0.2) / b.length(0.6)).round() as usize;
    let [width, length] = [(to - from) / columns as f32, (PAVEMENT - ROAD - 0.2) / rows as f32];
    for row in 0..rows {
        for column in 0..columns {
            let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
            let x = from + (column as f32 + shift) * width;
            let bed = Bed { x, z: -ROAD - 0.2 - row as f32 * length, width, length };
            stone(b, rng, Material::Slab, 2, bed, KERB, 0.006);
        }
    }
    plain(b, [from, to], [-PAVEMENT - 30.0, -PAVEMENT + 0.01], 0.08);
}

/// Bare ground in squares: single large triangles would overlap everything, and every ray would have to ask them.
fn plain(b: &mut Builder, [x0, x1]: [f32; 2], [z0, z1]: [f32; 2], y: f32) {
    const SQUARE: f32 = 10.0;
    let count = |low: f32, high: f32| ((high - low) / SQUARE).ceil() as u32;
    let (columns, rows) = (count(x0, x1), count(z0, z1));
    let at = |low: f32, high: f32, i: u32, n: u32| low + (high - low) * i as f32 / n as f32;
    let positions = (0..=rows)
        .flat_map(|j| (0..=columns).map(move |i| v(at(x0, x1, i, columns), y, at(z1, z0, j, rows))));
    let triangles = (0..rows * columns).flat_map(|cell| {
        let a = cell / columns * (columns + 1) + cell % columns;
        let c = a + columns + 2;
        [[a, a + 1, c], [a, c, c - 1]]
    });
    b.add(Material::Soil, Shading::Faceted, positions, triangles);
}

/// A stone with bevelled edges, a little askew, reaching from z down to z - length; it has no bottom.
fn stone(
    b: &mut Builder,
    rng: &mut Random,
    tone: fn(u8) -> Material,
    tones: u8,
    bed: Bed,
    height: f32,
    unevenness: f32,
) {
    let gap = 0.025 * bed.width.min(bed.length);
    let bevel = 0.09 * bed.width.min(bed.length);
    let corner = |x: f32, z: f32, inset: f32, y: f32| {
        let [x0, x1] = [bed.x + inset, bed.x + bed.width - inset];
        v(x0 + (x1 - x0) * x, y, bed.z - inset - (bed.length - 2.0 * inset) * z)
    };
    let [tilt_x, tilt_z, lift] = [0; 3].map(|_| rng.jitter(unevenness));
    let top = |x: f32, z: f32| {
        let y = height + lift + tilt_x * (x - 0.5) + tilt_z * (z - 0.5);
        corner(x, z, gap + bevel, y)
    };
    let plan = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let foot = plan.map(|(x, z)| corner(x, z, gap, height - 0.5 * bevel));
    let head = plan.map(|(x, z)| top(x, z));
    let sides = (0..4).flat_map(|i| {
        let j = (i + 1) % 4;
        [[i, j, 4 + j], [i, 4 + j, 4 + i]]
    });
    let material = tone(rng.below(tones));
    b.add(material, Shading::Faceted, foot.into_iter().chain(head), sides.chain([[4, 5, 6], [4, 6, 7]]));
}

/// Blades of grass on the rectangle [x0, x1] x [z0, z1] at height `y`.
pub fn lawn(b: &mut Builder, rng: &mut Random, [x0, x1]: [f32; 2], [z0, z1]: [f32; 2], y: f32) {
    let ground = [v(x0, y, z1), v(x1, y, z1), v(x1, y, z0), v(x0, y, z0)];
    b.quad(Material::Grass(0), ground);
    let width = b.length(0.03);
    for _ in 0..b.count((x1 - x0) * (z1 - z0) * 30.0) {
        let foot = v(rng.within(x0..x1), y - 0.005, rng.within(z0..z1));
        let (sin, cos) = rng.within(0.0..std::f32::consts::TAU).sin_cos();
        let side = v(cos, 0.0, sin) * width;
        let tip = foot + v(rng.jitter(0.06), rng.within(0.06..0.16), rng.jitter(0.06));
        b.add(Material::Grass(rng.below(2)), Shading::Faceted, [foot - side, foot + side, tip], [[0, 1, 2]]);
    }
}
