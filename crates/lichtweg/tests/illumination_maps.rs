//! Illumination maps, as textures: what walks from the lights leave on a floor is what walks from the eye see there.
//!
//! The camera looks straight down on the floor and on nothing else, so that a pixel is a texel of the floor's chart. What it sees of
//! the lit floor is compared with what it sees of a black floor whose emission is the map, times albedo over pi: blocks of pixels,
//! each with several independent maps and renders, by Welch's test. All blocks and channels together have a probability of a false
//! alarm of 0.001.

mod common;

use std::f32::consts::PI;

use common::build::{Build, bitmap, chain, facing_up, glow, glow_input, rectangle};
use common::room::stage;
use common::run::{camera, compile_scene, film, render};
use lichtweg::render::{BakeSettings, Deposit, Progress, RenderedImage, bake};
use lichtweg::scene::description::{Description, TextureFilter};
use lichtweg_montecarlo::Moments;
use lichtweg_montecarlo::hypothesis::welch_t_test;
use lichtweg_ray::math::Affine;

/// Pixels a side, which are texels.
const SIDE: u32 = 16;
/// Pixels a side of a block.
const BLOCK: u32 = 4;
const BLOCKS: usize = ((SIDE / BLOCK) * (SIDE / BLOCK)) as usize;
/// Independent maps, and renders.
const REPEATS: u64 = 12;
const ALPHA: f64 = 1e-3;
const ALBEDO: [f32; 3] = [0.6, 0.5, 0.3];

fn floor() -> Affine {
    facing_up()
}

/// The camera that sees the floor alone.
fn above(samples_per_pixel: u32) -> Description {
    let mut d = stage(samples_per_pixel);
    d.film = film(SIDE, SIDE);
    d.camera = camera([0.0, 2.0, 0.0], [0.0, 0.0, 0.0], 2.0 * 0.5_f32.atan().to_degrees());
    d
}

/// A floor, a lamp and a coloured wall beside the camera's view, so that light comes straight and by way of the wall.
fn lit(samples_per_pixel: u32) -> Description {
    let mut d = above(samples_per_pixel);
    let white = d.diffuse(ALBEDO);
    d.shape(rectangle(), floor(), white);
    let red = d.diffuse([0.8, 0.4, 0.1]);
    let wall = chain(&[Affine::translation(-1.2, 0.5, 0.0), Affine::rotation([0.0, 1.0, 0.0], 90.0)]);
    d.shape(rectangle(), wall, red);
    let black = d.diffuse([0.0; 3]);
    let turn = Affine::rotation([0.0, 1.0, 0.3], -90.0);
    let lamp = chain(&[Affine::translation(1.5, 0.8, 0.4), turn, Affine::scaling(0.3, 0.2, 1.0)]);
    d.shape(rectangle(), lamp, black).emission = glow([9.0, 10.0, 12.0]);
    d.integrator.max_depth = Some(4);
    d.keep_coordinates = true;
    d
}

/// The irradiance of the floor, by so many walks.
fn irradiance(d: &Description, deposit: Deposit, seed: u64) -> Vec<[f32; 3]> {
    // The last edge, to the eye, is none of the walks'.
    let settings = BakeSettings { walks: 200_000, resolution: SIDE, deposit, seed, max_depth: 3 };
    bake(&compile_scene(d), &settings, &Progress::default()).swap_remove(0).irradiance
}

/// What the camera sees of a black floor with this emission.
fn shown(radiance: &[[f32; 3]]) -> RenderedImage {
    let mut d = above(4);
    let black = d.diffuse([0.0; 3]);
    let map = d.texture(bitmap(SIDE, radiance, TextureFilter::Nearest));
    d.shape(rectangle(), floor(), black).emission = glow_input(map);
    d.integrator.max_depth = Some(1);
    render(&d)
}

/// The moments of blocks, by block and channel.
type BlockMoments = Vec<[Moments; 3]>;

fn collect(values: impl Iterator<Item = Vec<[f64; 3]>>) -> BlockMoments {
    let mut all = vec![[Moments::default(); 3]; BLOCKS];
    for pixels in values {
        let mut sums = [[0.0; 3]; BLOCKS];
        for (i, pixel) in (0..).zip(pixels) {
            let block = (i / SIDE / BLOCK) * (SIDE / BLOCK) + i % SIDE / BLOCK;
            sums[block as usize].iter_mut().zip(pixel).for_each(|(s, p)| *s += p / f64::from(BLOCK * BLOCK));
        }
        for (moments, sums) in all.iter_mut().zip(sums) {
            moments.iter_mut().zip(sums).for_each(|(m, s)| m.push(s));
        }
    }
    all
}

fn pixels(image: &RenderedImage) -> Vec<[f64; 3]> {
    image.pixels.iter().map(|p| p.sum.map(|s| s / f64::from(p.count))).collect()
}

fn by_maps(d: &Description, deposit: Deposit, albedo: [f32; 3]) -> BlockMoments {
    collect((0..REPEATS).map(|seed| {
        let map = irradiance(d, deposit, seed);
        let radiance: Vec<[f32; 3]> =
            map.iter().map(|e| std::array::from_fn(|c| e[c] * albedo[c] / PI)).collect();
        pixels(&shown(&radiance))
    }))
}

/// Whether the means differ.
fn differ(a: &BlockMoments, b: &BlockMoments) -> bool {
    let triple = |m: &Moments| (m.mean(), m.variance_of_mean(), REPEATS as f64 - 1.0);
    let mut pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.any(|(a, b)| welch_t_test(triple(a), triple(b)).rejects(ALPHA / (3.0 * BLOCKS as f64)))
}

#[test]
fn maps_show_what_the_eye_sees() {
    let mut d = lit(32);
    let seen = collect((0..REPEATS).map(|seed| {
        d.sampler.seed = 100 + seed;
        pixels(&render(&d))
    }));
    let maps = by_maps(&d, Deposit::EveryHit, ALBEDO);
    assert!(!differ(&seen, &maps), "{seen:?}\n{maps:?}");
    // Power: three percent too bright, upside down, or mirrored would show.
    assert!(differ(&seen, &by_maps(&d, Deposit::EveryHit, ALBEDO.map(|a| 1.03 * a))));
    let side = (SIDE / BLOCK) as usize;
    let turned = |place: &dyn Fn(usize, usize) -> usize| {
        (0..BLOCKS).map(|i| maps[place(i / side, i % side)]).collect::<BlockMoments>()
    };
    assert!(differ(&seen, &turned(&|row, column| (side - 1 - row) * side + column)));
    assert!(differ(&seen, &turned(&|row, column| row * side + side - 1 - column)));
}

/// Whether power is left at every hit or where it is absorbed, it is the same.
#[test]
fn both_ways_to_deposit_agree() {
    let d = lit(1);
    let [hits, absorbed] = [Deposit::EveryHit, Deposit::Absorption].map(|way| by_maps(&d, way, ALBEDO));
    assert!(!differ(&hits, &absorbed), "{hits:?}\n{absorbed:?}");
    assert!(differ(&hits, &by_maps(&d, Deposit::Absorption, ALBEDO.map(|a| 1.05 * a))));
}
