//! Trees: a trunk that parts into branches three times over, and leaves about the ends.

use lichtweg_ray::math::Vec3;

use super::builder::Builder;
use super::foliage::{Foliage, direction, scatter};
use super::palette::Material;
use super::random::Random;
use super::solids::{cuboid, perpendicular, tube, v};

/// A branch in growing.
#[derive(Clone, Copy, Debug)]
struct Branch {
    start: Vec3,
    direction: Vec3,
    length: f32,
    radius: f32,
    /// How often it will part.
    order: u8,
}

/// A tree at the origin with about this number of leaves at detail 1.
pub fn tree(b: &mut Builder, rng: &mut Random, height: f32, leaves: f32) {
    let trunk = Branch {
        start: v(0.0, -0.1, 0.0),
        direction: v(rng.jitter(0.05), 1.0, rng.jitter(0.05)).normalized(),
        length: 0.5 * height,
        radius: 0.024 * height,
        order: 3,
    };
    let mut ends = Vec::new();
    grow(b, rng, trunk, &mut ends);
    let warm = rng.chance(0.4);
    let foliage = Foliage {
        size: 0.21,
        spread: 0.9,
        tones: if warm { [0, 1, 1] } else { [0, 1, 2] }.map(Material::Leaf),
    };
    let each = b.count(leaves / ends.len() as f32);
    for end in ends {
        for _ in 0..each {
            let offset = direction(rng) * (0.1 * height * rng.unit().sqrt());
            let place = end + v(offset.x, 0.8 * offset.y, offset.z);
            scatter(
                b,
                rng,
                &foliage,
                place,
                offset.try_normalized().unwrap_or(Vec3::Y) * 0.5 + Vec3::Y * 0.5,
            );
        }
    }
}

/// Four iron bars about a square of soil at a tree's foot.
pub fn tree_pit(b: &mut Builder) {
    cuboid(b, Material::Soil, [-0.6, -0.1, -0.6], [0.6, 0.012, 0.6]);
    for (low, high) in [
        ([-0.66, -0.1, -0.66], [0.66, 0.03, -0.6]),
        ([-0.66, -0.1, 0.6], [0.66, 0.03, 0.66]),
        ([-0.66, -0.1, -0.6], [-0.6, 0.03, 0.6]),
        ([0.6, -0.1, -0.6], [0.66, 0.03, 0.6]),
    ] {
        cuboid(b, Material::Iron, low, high);
    }
}

/// Draws a branch as a bent tube, and lets others grow from its upper part.
fn grow(b: &mut Builder, rng: &mut Random, branch: Branch, ends: &mut Vec<Vec3>) {
    let steps = [2, 3, 5, 6][usize::from(branch.order)];
    let mut path = vec![branch.start];
    let mut heading = branch.direction;
    for _ in 0..steps {
        let bend = if branch.order == 3 { 0.06 } else { 0.22 };
        heading = (heading + direction(rng) * bend + v(0.0, 0.05, 0.0)).normalized();
        path.push(path[path.len() - 1] + heading * (branch.length / steps as f32));
    }
    let taper = |i: usize| branch.radius * (1.0 - 0.6 * i as f32 / steps as f32);
    let flare = |i: usize| if branch.order == 3 && i == 0 { 1.5 } else { 1.0 };
    let sides = b.count_along([3.0, 4.0, 6.0, 10.0][usize::from(branch.order)], 3);
    tube(b, Material::Bark, &path, |i| taper(i) * flare(i), sides);
    if branch.order == 0 {
        ends.extend([path[steps - 1], path[steps]]);
        return;
    }
    let children = [3, 4, 6][usize::from(branch.order) - 1];
    let turn = rng.within(0.0..std::f32::consts::TAU);
    for child in 0..children {
        // The last one carries on where the branch ends.
        let t = if child == children - 1 { 1.0 } else { rng.within(0.62..1.0) };
        let place = (t * steps as f32).round() as usize;
        let along = (path[place] - path[place - 1]).normalized();
        let across = perpendicular(along);
        let (sin, cos) = (turn + child as f32 * 2.4).sin_cos();
        let outward = across * cos + along.cross(across) * sin;
        let open = if child == children - 1 { 0.2 } else { rng.within(0.6..1.1) };
        let next = Branch {
            start: path[place],
            direction: (along + outward * open).normalized(),
            length: branch.length * rng.within(0.5..0.72),
            radius: taper(place) * 0.72,
            order: branch.order - 1,
        };
        grow(b, rng, next, ends);
    }
}
