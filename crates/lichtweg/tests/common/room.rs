//! A room to put things in: floor, ceiling, back and coloured side walls of a 2 x 2 x 2 cube, open to the camera, with a
//! large light under the ceiling.

use lichtweg::scene::description::{Description, IntegratorDescription, MaterialId};
use lichtweg_ray::math::Affine;

use super::build::{Build, SPHERE, chain, cube, facing_down, facing_up, glow, placed, rectangle};
use super::run::{camera, film};

/// An empty scene looked at from the open side: 32 x 32 pixels, `samples_per_pixel` samples, paths of at most five edges.
pub fn stage(samples_per_pixel: u32) -> Description {
    let mut d = Description {
        camera: camera([0.0, 0.0, 3.6], [0.0, 0.0, 0.0], 42.0),
        film: film(32, 32),
        integrator: IntegratorDescription { max_depth: Some(5), ..Default::default() },
        ..Default::default()
    };
    d.sampler.samples_per_pixel = samples_per_pixel;
    d
}

/// The walls.
pub fn add_walls(d: &mut Description) {
    let [white, red, green] =
        [[0.7, 0.7, 0.7], [0.6, 0.1, 0.1], [0.1, 0.5, 0.15]].map(|color| d.diffuse(color));
    let wall = |turn: Affine| chain(&[turn, Affine::translation(0.0, 0.0, -1.0)]);
    d.shape(rectangle(), wall(facing_up()), white);
    d.shape(rectangle(), wall(facing_down()), white);
    d.shape(rectangle(), wall(Affine::IDENTITY), white);
    d.shape(rectangle(), wall(Affine::rotation([0.0, 1.0, 0.0], 90.0)), red);
    d.shape(rectangle(), wall(Affine::rotation([0.0, 1.0, 0.0], -90.0)), green);
}

/// The light, half as wide as the ceiling.
pub fn add_light(d: &mut Description) {
    let black = d.diffuse([0.0; 3]);
    let place = chain(&[Affine::translation(0.0, 0.98, 0.0), facing_down(), Affine::scaling(0.5, 0.5, 1.0)]);
    d.shape(rectangle(), place, black).emission = glow([4.0, 3.5, 3.0]);
}

/// Walls and light.
pub fn room(samples_per_pixel: u32) -> Description {
    let mut d = stage(samples_per_pixel);
    add_walls(&mut d);
    add_light(&mut d);
    d
}

/// A ball on the left, in front.
pub fn add_ball(d: &mut Description, material: MaterialId) {
    d.shape(SPHERE, placed([-0.42, -0.55, 0.2], [0.45; 3]), material);
}

/// A cube on the right, turned.
pub fn add_block(d: &mut Description, material: MaterialId) {
    let turn = Affine::rotation([0.0, 1.0, 0.0], 25.0);
    let place = chain(&[Affine::translation(0.42, -0.6, -0.2), turn, Affine::scaling(0.35, 0.4, 0.35)]);
    d.shape(cube(), place, material);
}
