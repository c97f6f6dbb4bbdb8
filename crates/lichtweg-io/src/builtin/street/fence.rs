//! What parts front gardens from the pavement: railings, pickets, low walls, hedges. All run along x from 0, at z = 0.

use super::builder::Builder;
use super::foliage::{Foliage, direction, scatter};
use super::palette::Material;
use super::random::Random;
use super::solids::{cuboid, prism, v};

/// Iron bars with points on a low wall.
pub fn railing(b: &mut Builder, length: f32) {
    cuboid(b, Material::Brick, [0.0, -0.1, -0.12], [length, 0.35, 0.12]);
    cuboid(b, Material::Stone, [-0.03, 0.35, -0.16], [length + 0.03, 0.42, 0.16]);
    for y in [0.55, 1.15] {
        cuboid(b, Material::Iron, [0.0, y, -0.018], [length, y + 0.035, 0.018]);
    }
    let count = (length / 0.17) as usize;
    let step = length / count as f32;
    for i in 0..count {
        let x = (i as f32 + 0.5) * step;
        let bar = [[x - 0.011, 0.42], [x + 0.011, 0.42], [x + 0.011, 1.24], [x, 1.36], [x - 0.011, 1.24]];
        prism(b, Material::Iron, &bar, -0.011, 0.011);
    }
}

/// Painted boards with points.
pub fn pickets(b: &mut Builder, rng: &mut Random, length: f32) {
    for y in [0.3, 0.8] {
        cuboid(b, Material::Trim, [0.0, y, -0.06], [length, y + 0.08, -0.02]);
    }
    let count = (length / 0.145) as usize;
    let step = length / count as f32;
    for i in 0..count {
        let x = i as f32 * step + 0.02;
        let top = 0.98 + rng.jitter(0.012);
        let board = [[x, 0.06], [x + 0.09, 0.06], [x + 0.09, top], [x + 0.045, top + 0.08], [x, top]];
        prism(b, Material::Trim, &board, -0.02, 0.006);
    }
}

/// Courses of brick under a coping.
pub fn low_wall(b: &mut Builder, rng: &mut Random, length: f32) {
    let height = 0.85;
    cuboid(b, Material::Soil, [0.012, -0.1, -0.11], [length - 0.012, height, 0.11]);
    let rows = 6;
    for row in 0..rows {
        let y = 0.02 + row as f32 * (height - 0.02) / rows as f32;
        let count = (length / 0.3) as usize;
        let step = length / count as f32;
        for i in 0..count {
            let shift = if row % 2 == 0 { 0.0 } else { 0.5 * step };
            let x = i as f32 * step + shift;
            let face = 0.12 + rng.jitter(0.005);
            let end = (x + step - 0.012).min(length);
            cuboid(b, Material::Brick, [x, y, -face], [end, y + 0.125, face]);
        }
    }
    let coping =
        [[0.18, height], [0.18, height + 0.05], [0.0, height + 0.1], [-0.18, height + 0.05], [-0.18, height]];
    b.turned(-90.0, |b| prism(b, Material::Stone, &coping, -length - 0.03, 0.03));
}

/// A clipped hedge: leaves about a dark core.
pub fn hedge(b: &mut Builder, rng: &mut Random, length: f32, height: f32) {
    let deep = 0.32;
    cuboid(b, Material::Bark, [0.08, -0.1, -deep + 0.1], [length - 0.08, height - 0.1, deep - 0.1]);
    let foliage = Foliage { size: 0.12, spread: 0.8, tones: [0, 2, 0].map(Material::Leaf) };
    let half = v(0.5 * length, 0.5 * height, deep);
    for _ in 0..b.count(260.0 * length * height) {
        // A point on the box's hull, rounded at the edges.
        let d = direction(rng);
        let along = rng.jitter(half.x - 0.2);
        let scale = (d.y.abs() / half.y).max(d.z.abs() / half.z).max(0.4);
        let end = if rng.chance(0.08) { d.x.signum() * half.x } else { along };
        let place = v(half.x + end, half.y + d.y / scale, d.z / scale) + direction(rng) * 0.05;
        let lean = v(if end == along { 0.0 } else { d.x }, d.y.max(0.0) + 0.2, d.z);
        scatter(b, rng, &foliage, place, lean);
    }
}

/// A clipped ball of leaves about the origin.
pub fn bush(b: &mut Builder, rng: &mut Random, radius: f32) {
    let foliage = Foliage { size: 0.09, spread: 0.7, tones: [0, 2, 1].map(Material::Leaf) };
    for _ in 0..b.count(700.0 * radius * radius + 60.0) {
        let d = direction(rng);
        let place = d * (radius * rng.within(0.75..1.0));
        scatter(b, rng, &foliage, place, d);
    }
}
