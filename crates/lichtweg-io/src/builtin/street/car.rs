//! Parked cars: a skin over cross-sections, with windows, wheels, lamps and bumpers.

use lichtweg_ray::math::Vec3;

use super::builder::{Builder, Shading};
use super::palette::{LACQUERS, Material};
use super::random::Random;
use super::solids::{ball, cuboid, lathe, skin, v};

/// A cross-section: its place along the car, and height and half-width of sill, waist and top.
type Section = [f32; 7];

/// A small saloon, from the back to the front.
const SALOON: [Section; 10] = [
    [-2.10, 0.42, 0.62, 0.66, 0.66, 0.74, 0.54],
    [-2.04, 0.30, 0.76, 0.82, 0.78, 0.88, 0.64],
    [-1.62, 0.25, 0.80, 0.87, 0.82, 0.96, 0.66],
    [-1.02, 0.23, 0.82, 0.90, 0.84, 1.37, 0.57],
    [-0.30, 0.23, 0.83, 0.90, 0.85, 1.45, 0.58],
    [0.32, 0.23, 0.83, 0.90, 0.85, 1.40, 0.56],
    [0.98, 0.23, 0.82, 0.90, 0.84, 0.96, 0.68],
    [1.60, 0.24, 0.80, 0.81, 0.82, 0.89, 0.62],
    [1.98, 0.28, 0.75, 0.68, 0.75, 0.76, 0.56],
    [2.10, 0.40, 0.62, 0.56, 0.64, 0.62, 0.46],
];

/// A hatchback: the roof goes on to the back.
const HATCHBACK: [Section; 10] = [
    [-1.86, 0.42, 0.64, 0.66, 0.68, 0.74, 0.56],
    [-1.80, 0.30, 0.77, 0.82, 0.79, 0.90, 0.66],
    [-1.72, 0.25, 0.81, 0.90, 0.83, 0.97, 0.68],
    [-1.32, 0.23, 0.82, 0.92, 0.84, 1.40, 0.58],
    [-0.45, 0.23, 0.83, 0.92, 0.85, 1.49, 0.60],
    [0.30, 0.23, 0.83, 0.91, 0.85, 1.44, 0.58],
    [0.95, 0.23, 0.82, 0.90, 0.84, 0.98, 0.68],
    [1.42, 0.24, 0.80, 0.82, 0.82, 0.90, 0.62],
    [1.78, 0.28, 0.76, 0.68, 0.76, 0.77, 0.56],
    [1.90, 0.40, 0.64, 0.56, 0.66, 0.62, 0.46],
];

/// The sections between which side windows lie.
const CABIN: std::ops::Range<usize> = 2..6;
/// Points around half a section, without the one on the middle.
const HALF: usize = 6;

/// A car whose front looks along +x, its wheels on y = 0.
pub fn car(b: &mut Builder, rng: &mut Random) {
    let sections = if rng.chance(0.5) { &SALOON } else { &HATCHBACK };
    let paint = Material::Lacquer(rng.below(LACQUERS));
    body(b, sections, paint);
    let [rear, front] = [sections[0][0], sections[9][0]];
    cuboid(b, Material::Rubber, [rear + 0.15, 0.2, -0.7], [front - 0.15, 0.6, 0.7]);
    for x in [rear + 0.78, front - 0.78] {
        for turn in [0.0, 180.0] {
            b.turned(turn, |b| b.at(if turn == 0.0 { x } else { -x }, 0.31, 0.74, wheel));
        }
    }
    for (x, y) in [(front - 0.06, 0.44), (rear - 0.06, 0.5)] {
        cuboid(b, Material::Zinc, [x, y - 0.06, -0.74], [x + 0.12, y + 0.05, 0.74]);
        cuboid(b, Material::Trim, [x - 0.01, y - 0.02, -0.24], [x + 0.13, y + 0.09, 0.24]);
    }
    for z in [-0.55, 0.55] {
        b.at(front - 0.13, 0.64, z, |b| ball(b, Material::Opal, 0.11, 12));
        cuboid(b, Material::Tail, [rear - 0.01, 0.6, z - 0.12], [rear + 0.2, 0.72, z + 0.12]);
        let mirror = z.signum() * 0.93;
        cuboid(
            b,
            paint,
            [sections[6][0] - 0.32, 0.93, mirror - 0.1],
            [sections[6][0] - 0.22, 1.05, mirror + 0.1],
        );
    }
}

/// The skin: sections refined in both directions by Catmull-Rom splines, so that windows keep their places.
fn body(b: &mut Builder, sections: &[Section], paint: Material) {
    let fine = b.count_along(3.0, 1);
    let coarse: Vec<Vec<Vec3>> = sections.iter().map(outline).collect();
    let rings: Vec<Vec<Vec3>> = coarse.iter().map(|ring| refine(ring, fine, spline)).collect();
    let columns = rings[0].len();
    let along: Vec<Vec<Vec3>> =
        (0..columns).map(|c| refine(&rings.iter().map(|r| r[c]).collect::<Vec<_>>(), fine, spline)).collect();
    let rows: Vec<Vec<Vec3>> =
        (0..along[0].len()).map(|r| along.iter().map(|line| line[r]).collect()).collect();
    skin(b, &rows, false, |row, column| {
        let (section, place) = (row / fine, column / fine);
        // Sides of the cabin, or the panes before and behind it.
        let side = place == 3 || place == 2 * HALF - 4;
        let over = (4..2 * HALF - 4).contains(&place);
        let pane = CABIN.contains(&section) && (side || over && [2, 5].contains(&section));
        // The pillars between.
        let post = side && section == 4 && row % fine == 0 || over && (column % fine == 0 && place == 4);
        if pane && !post { Material::Glass(0) } else { paint }
    });
    for (ring, end) in [(&rows[0], 0), (&rows[rows.len() - 1], 1)] {
        let n = ring.len() as u32;
        let fan = (1..n - 1).map(|i| if end == 0 { [0, i, i + 1] } else { [0, i + 1, i] });
        b.add(paint, Shading::Faceted, ring.iter().copied(), fan);
    }
}

/// A section's points from the sill on the right (+z) over the top to the sill on the left.
fn outline(&[x, sill, sill_half, waist, waist_half, top, top_half]: &Section) -> Vec<Vec3> {
    let half = [
        [sill_half - 0.08, sill],
        [sill_half, sill + 0.05],
        [waist_half + 0.015, 0.5 * (sill + waist)],
        [waist_half, waist],
        [top_half + 0.03, top - 0.05],
        [0.62 * top_half, top],
    ];
    let right = half.iter().map(|&[z, y]| v(x, y, z));
    let left = half.iter().rev().map(|&[z, y]| v(x, y, -z));
    right.chain([v(x, top + 0.012, 0.0)]).chain(left).collect()
}

/// Splits every interval of a line of points into `count`.
fn refine(line: &[Vec3], count: usize, between: impl Fn([Vec3; 4], f32) -> Vec3) -> Vec<Vec3> {
    let last = line.len() - 1;
    let mut fine = Vec::with_capacity(last * count + 1);
    for i in 0..last {
        let around = [line[i.saturating_sub(1)], line[i], line[i + 1], line[(i + 2).min(last)]];
        fine.extend((0..count).map(|j| between(around, j as f32 / count as f32)));
    }
    fine.push(line[last]);
    fine
}

/// Catmull and Rom's cubic through the middle two of four points.
fn spline([a, b, c, d]: [Vec3; 4], t: f32) -> Vec3 {
    let linear = (c - a) * 0.5;
    let square = a - b * 2.5 + c * 2.0 - d * 0.5;
    let cube = (d - a) * 0.5 + (b - c) * 1.5;
    b + (linear + (square + cube * t) * t) * t
}

/// A wheel about the z axis, its outer side towards +z, in a dark arch.
fn wheel(b: &mut Builder) {
    let sides = b.count_along(16.0, 8);
    b.tilted(90.0, |b| {
        lathe(b, Material::Rubber, &[[0.0, -0.1], [0.38, -0.1], [0.38, 0.118], [0.0, 0.118]], sides);
        let tyre = [[0.26, -0.06], [0.30, -0.07], [0.31, 0.0], [0.31, 0.1], [0.29, 0.14], [0.2, 0.145]];
        lathe(b, Material::Rubber, &tyre, sides);
        let hub = [[0.21, 0.14], [0.2, 0.147], [0.17, 0.13], [0.12, 0.14], [0.06, 0.15], [0.0, 0.155]];
        lathe(b, Material::Zinc, &hub, sides);
    });
}
