//! Where everything stands.
//!
//! The street runs down the -z axis. Each side is laid out in a frame of its own: the middle of the road at z = 0, houses
//! at negative z facing +z, x along the street. `s` is the distance into the picture.

use lichtweg_ray::math::Vec3;

use super::builder::Builder;
use super::car::car;
use super::fence::{bush, hedge, low_wall, pickets, railing};
use super::furniture::{bench, bin, bollard, planter};
use super::ground::{KERB, PAVEMENT, ROAD, lawn, pavement, roadway};
use super::house::House;
use super::lamp::lamp;
use super::palette::Material;
use super::random::Random;
use super::solids::{cuboid, v};
use super::tower::church;
use super::tree::{tree, tree_pit};
use super::wires::{HEIGHT, INSULATORS, pole, wire};

/// The street begins behind the camera and ends at a square.
const NEAR: f32 = -13.0;
const FAR: f32 = 72.0;
/// From the middle of the road to the fronts of the houses.
const FRONT: f32 = 10.0;
/// Between telegraph poles.
const SPAN: f32 = 26.0;

/// A side of the street, seen from the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

impl Side {
    fn degrees(self) -> f32 {
        if self == Self::Left { 90.0 } else { -90.0 }
    }

    /// The x of the side's frame at a distance into the picture.
    fn along(self, s: f32) -> f32 {
        if self == Self::Left { s } else { -s }
    }
}

/// Builds all of it.
pub fn street(b: &mut Builder, rng: &mut Random) {
    roadway(b, &mut rng.fork(), NEAR, FAR + 6.0);
    for side in [Side::Left, Side::Right] {
        let rng = &mut rng.fork();
        b.turned(side.degrees(), |b| {
            let ends = [side.along(NEAR), side.along(FAR)];
            pavement(b, &mut rng.fork(), ends[0].min(ends[1]), ends[0].max(ends[1]));
            houses(b, &mut rng.fork(), side);
            kerbside(b, &mut rng.fork(), side);
            cars(b, &mut rng.fork(), side);
        });
    }
    telegraph(b);
    b.at(0.0, 0.0, -FAR - 22.0, |b| church(b, &mut rng.fork()));
    for x in [-21.0, -12.5, 12.5, 21.0] {
        let rng = &mut rng.fork();
        b.at(x, KERB, -FAR - 18.0, |b| House::new(rng, 8.4).build(b, rng));
    }
    for (x, z) in [(-7.2, 12.0), (7.4, 11.0), (-16.0, 10.0), (16.5, 10.5)] {
        let rng = &mut rng.fork();
        b.at(x, 0.0, -FAR - z, |b| tree(b, rng, 7.5, 2200.0));
    }
}

/// Houses wall to wall, with a gap now and then, and the gardens in front of them.
fn houses(b: &mut Builder, rng: &mut Random, side: Side) {
    let mut s = NEAR + rng.within(0.0..3.0);
    while s < FAR - 6.0 {
        let width = rng.within(7.6..11.4);
        let middle = side.along(s + 0.5 * width);
        let house = House::new(rng, width);
        b.at(middle, KERB, -FRONT - rng.jitter(0.25), |b| house.build(b, &mut rng.fork()));
        b.at(middle, 0.0, -PAVEMENT, |b| garden(b, &mut rng.fork(), &house));
        s += width;
        if rng.chance(if side == Side::Left { 0.4 } else { 0.6 }) {
            let gap = rng.within(2.8..4.6);
            let x = side.along(s + 0.5 * gap);
            b.at(x - 0.5 * gap, KERB, -FRONT, |b| low_wall(b, &mut rng.fork(), gap));
            b.at(x, 0.0, -FRONT - 3.0, |b| tree(b, &mut rng.fork(), 6.0, 1300.0));
            s += gap;
        }
    }
}

/// Behind the pavement: a fence of some kind with a gap before the door, a path, grass, and bushes.
fn garden(b: &mut Builder, rng: &mut Random, house: &House) {
    let (half, way) = (0.5 * house.width, 0.7);
    let kind = rng.below(4);
    cuboid(b, Material::Stone, [house.door - way, 0.0, PAVEMENT - FRONT], [house.door + way, KERB, 0.0]);
    for [x, end] in [[-half, house.door - way], [house.door + way, half]] {
        let length = end - x;
        if length < 1.0 {
            continue;
        }
        b.at(x, KERB, -0.2, |b| match kind {
            0 => railing(b, length),
            1 => pickets(b, rng, length),
            2 => low_wall(b, rng, length),
            _ => b.at(0.0, 0.0, -0.3, |b| hedge(b, rng, length, 1.0)),
        });
        lawn(b, rng, [x, end], [PAVEMENT - FRONT - 0.2, -0.3], KERB);
        let radius = rng.within(0.3..0.55);
        let place = rng.within(x + 0.4..end - 0.4);
        b.at(place, KERB + 0.8 * radius, PAVEMENT - FRONT + 0.55, |b| bush(b, rng, radius));
        if rng.chance(0.5) {
            let place = if end < house.door { end - 0.5 } else { x + 0.5 };
            b.at(place, KERB, -1.2, |b| {
                planter(b, rng);
                b.at(0.0, 0.75, 0.0, |b| bush(b, rng, 0.34));
            });
        }
    }
}

/// Along the kerb: trees, lamps between them, benches and bollards.
fn kerbside(b: &mut Builder, rng: &mut Random, side: Side) {
    let offset = if side == Side::Left { 6.5 } else { 10.5 };
    let mut s = NEAR + 3.0 + offset;
    let mut turn = 0;
    while s < FAR - 3.0 {
        b.at(side.along(s), KERB, -ROAD - 0.9, |b| match turn % 3 {
            1 => {
                tree_pit(b);
                let height = rng.within(6.4..7.8);
                tree(b, &mut rng.fork(), height, 2200.0);
            }
            _ => lamp(b),
        });
        let beside = side.along(s + 2.6);
        match turn % 4 {
            0 => b.at(beside, KERB, -PAVEMENT + 0.5, bench),
            1 => b.at(beside, KERB, -ROAD - 0.6, bin),
            _ => {
                for i in 0..3 {
                    b.at(beside + 1.1 * i as f32, KERB, -ROAD - 0.45, bollard);
                }
            }
        }
        s += 6.8;
        turn += 1;
    }
}

/// Cars at the kerb, in the direction of driving, with free places between.
fn cars(b: &mut Builder, rng: &mut Random, side: Side) {
    let mut s = NEAR + rng.within(1.0..4.0);
    while s < FAR - 8.0 {
        if rng.chance(0.5) {
            let degrees = 180.0 + rng.jitter(2.0);
            b.at(side.along(s), 0.03, -ROAD + 1.15, |b| b.turned(degrees, |b| car(b, &mut rng.fork())));
        }
        s += rng.within(5.2..6.6);
    }
}

/// Poles on the right, wires between them and across to the houses on the left.
fn telegraph(b: &mut Builder) {
    let x = ROAD + 0.55;
    let place = |i: usize| -NEAR - SPAN * i as f32 - 3.0;
    let count = 5;
    for i in 0..count {
        b.at(x, KERB, place(i), pole);
        for (k, dx) in INSULATORS.into_iter().enumerate() {
            let at = |i: usize| v(x + dx, KERB + HEIGHT, place(i) + 0.105);
            if i + 1 < count {
                wire(b, at(i), at(i + 1), 0.55 + 0.06 * k as f32);
            }
        }
        for dz in [-5.0, 4.0].into_iter().filter(|_| i > 1) {
            let from: Vec3 = v(x - 0.8, KERB + HEIGHT, place(i) + 0.105);
            wire(b, from, v(-FRONT, 6.6, place(i) + dz), 0.35);
        }
    }
}
