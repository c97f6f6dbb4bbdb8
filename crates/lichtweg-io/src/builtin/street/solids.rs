//! The forms that everything is put together from: boxes, prisms, walls with openings, tubes, turned and skinned surfaces.
//!
//! All are closed or belong to something closed, with their normals outside; lengths in metres.

use std::f32::consts::TAU;

use lichtweg_ray::math::Vec3;

use super::builder::{Builder, Shading};
use super::palette::Material;

/// Shorthand for a point.
pub const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// The box between two corners.
pub fn cuboid(b: &mut Builder, material: Material, low: [f32; 3], high: [f32; 3]) {
    frustum(b, material, low, high, 0.0);
}

/// A box whose top is drawn in on all sides.
pub fn frustum(b: &mut Builder, material: Material, low: [f32; 3], high: [f32; 3], inset: f32) {
    let [x0, y0, z0] = low;
    let [x1, y1, z1] = high;
    let i = inset;
    let corners = [
        v(x0, y0, z0),
        v(x1, y0, z0),
        v(x1, y0, z1),
        v(x0, y0, z1),
        v(x0 + i, y1, z0 + i),
        v(x1 - i, y1, z0 + i),
        v(x1 - i, y1, z1 - i),
        v(x0 + i, y1, z1 - i),
    ];
    b.add(
        material,
        Shading::Faceted,
        corners,
        BOX_FACES.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]),
    );
}

/// Corners as [`frustum`] numbers them.
const BOX_FACES: [[u32; 4]; 6] =
    [[0, 1, 2, 3], [7, 6, 5, 4], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]];

/// A convex polygon, counter-clockwise in x and y, drawn out from `z0` to `z1`.
pub fn prism(b: &mut Builder, material: Material, polygon: &[[f32; 2]], z0: f32, z1: f32) {
    let n = polygon.len() as u32;
    let back = polygon.iter().map(|&[x, y]| v(x, y, z0));
    let positions: Vec<Vec3> = back.chain(polygon.iter().map(|&[x, y]| v(x, y, z1))).collect();
    let caps = (1..n - 1).flat_map(|i| [[0, i + 1, i], [n, n + i, n + i + 1]]);
    let sides = (0..n).flat_map(|i| {
        let j = (i + 1) % n;
        [[i, j, n + j], [i, n + j, n + i]]
    });
    b.add(material, Shading::Faceted, positions, caps.chain(sides));
}

/// The rectangle [x0, x1] x [y0, y1] of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Left.
    pub x0: f32,
    /// Right.
    pub x1: f32,
    /// Bottom.
    pub y0: f32,
    /// Top.
    pub y1: f32,
}

impl Rectangle {
    /// Its middle in x.
    pub fn middle(&self) -> f32 {
        0.5 * (self.x0 + self.x1)
    }

    /// Its width.
    pub fn width(&self) -> f32 {
        self.x1 - self.x0
    }

    /// Its height.
    pub fn height(&self) -> f32 {
        self.y1 - self.y0
    }
}

/// A wall in the plane z = 0 that faces +z, with openings whose reveals are `depth` deep.
pub fn wall(b: &mut Builder, material: Material, whole: Rectangle, openings: &[Rectangle], depth: f32) {
    let cuts = |low: f32, high: f32, ends: fn(&Rectangle) -> [f32; 2]| {
        let mut cuts = vec![low, high];
        cuts.extend(openings.iter().flat_map(ends));
        cuts.sort_by(f32::total_cmp);
        cuts.dedup();
        cuts
    };
    let xs = cuts(whole.x0, whole.x1, |o| [o.x0, o.x1]);
    let ys = cuts(whole.y0, whole.y1, |o| [o.y0, o.y1]);
    let columns = xs.len() as u32;
    let positions = ys.iter().flat_map(|&y| xs.iter().map(move |&x| v(x, y, 0.0)));
    let mut triangles = Vec::new();
    for (j, row) in ys.windows(2).enumerate() {
        for (i, column) in xs.windows(2).enumerate() {
            let open =
                |o: &Rectangle| o.x0 <= column[0] && column[1] <= o.x1 && o.y0 <= row[0] && row[1] <= o.y1;
            if !openings.iter().any(open) {
                let corner = j as u32 * columns + i as u32;
                triangles.push([corner, corner + 1, corner + columns + 1]);
                triangles.push([corner, corner + columns + 1, corner + columns]);
            }
        }
    }
    b.add(material, Shading::Faceted, positions, triangles);
    openings.iter().for_each(|o| reveal(b, material, *o, depth));
}

/// The four inner sides of an opening.
fn reveal(b: &mut Builder, material: Material, o: Rectangle, depth: f32) {
    let front = [v(o.x0, o.y0, 0.0), v(o.x1, o.y0, 0.0), v(o.x1, o.y1, 0.0), v(o.x0, o.y1, 0.0)];
    let back = front.map(|p| v(p.x, p.y, -depth));
    let sides = (0..4).flat_map(|i| {
        let j = (i + 1) % 4;
        [[i, 4 + j, 4 + i], [i, j, 4 + j]]
    });
    b.add(material, Shading::Faceted, front.into_iter().chain(back), sides);
}

/// A smooth tube along a path; the ends are open.
pub fn tube(b: &mut Builder, material: Material, path: &[Vec3], radius: impl Fn(usize) -> f32, sides: usize) {
    let mut rings = Vec::with_capacity(path.len());
    let mut across = Vec3::ZERO;
    for (i, &centre) in path.iter().enumerate() {
        let along = (path[(i + 1).min(path.len() - 1)] - path[i.saturating_sub(1)]).normalized();
        // Carrying the last direction along keeps the tube from twisting.
        across =
            (across - along * across.dot(along)).try_normalized().unwrap_or_else(|| perpendicular(along));
        let other = across.cross(along);
        let radius = radius(i);
        rings.push(ring(sides, |cos, sin| centre + across * (cos * radius) + other * (sin * radius)));
    }
    skin(b, &rings, true, |_, _| material);
}

/// A smooth surface of revolution about the y axis; the profile of radii and heights goes from bottom to top.
pub fn lathe(b: &mut Builder, material: Material, profile: &[[f32; 2]], sides: usize) {
    let rings: Vec<_> =
        profile.iter().map(|&[r, y]| ring(sides, |cos, sin| v(r * cos, y, r * sin))).collect();
    skin(b, &rings, true, |_, _| material);
}

/// A ball.
pub fn ball(b: &mut Builder, material: Material, radius: f32, sides: usize) {
    let steps = sides / 2;
    let profile = |i: usize| {
        let (sin, cos) = (i as f32 / steps as f32 * 0.5 * TAU).sin_cos();
        [radius * sin, -radius * cos]
    };
    lathe(b, material, &(0..=steps).map(profile).collect::<Vec<_>>(), sides);
}

/// A smooth surface through rows of points, one material for each cell (row, column). Seen from outside, columns grow to the
/// left while rows grow upwards. `closed` joins the last column to the first.
pub fn skin(b: &mut Builder, rows: &[Vec<Vec3>], closed: bool, material: impl Fn(usize, usize) -> Material) {
    let columns = rows[0].len();
    let cells = columns - usize::from(!closed);
    let mut parts: Vec<(Material, Vec<[u32; 3]>)> = Vec::new();
    for row in 0..rows.len() - 1 {
        for column in 0..cells {
            let material = material(row, column);
            let index = |r: usize, c: usize| (r * columns + c % columns) as u32;
            let [p, q] = [index(row, column), index(row + 1, column)];
            let [s, r] = [index(row, column + 1), index(row + 1, column + 1)];
            let part = match parts.iter().position(|part| part.0 == material) {
                Some(part) => part,
                None => {
                    parts.push((material, Vec::new()));
                    parts.len() - 1
                }
            };
            parts[part].1.extend([[p, q, r], [p, r, s]]);
        }
    }
    for (material, triangles) in parts {
        b.add(material, Shading::Smooth, rows.iter().flatten().copied(), triangles);
    }
}

fn ring(sides: usize, point: impl Fn(f32, f32) -> Vec3) -> Vec<Vec3> {
    let at = |i: usize| {
        let (sin, cos) = (i as f32 / sides as f32 * TAU).sin_cos();
        point(cos, sin)
    };
    (0..sides).map(at).collect()
}

/// Any unit vector at a right angle.
pub fn perpendicular(d: Vec3) -> Vec3 {
    let axis = if d.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
    d.cross(axis).normalized()
}
