//! Naive walks, connections and both by multiple importance sampling have the same mean: in every pixel block of scenes
//! that need each of the system's features.
//!
//! Each scene is one family of Welch tests (all pairs of estimators, blocks and channels) with a probability of a false
//! alarm of 0.01 or less.

mod common;

use common::build::{
    Build, SPHERE, chain, checkerboard, cube, facing_down, facing_up, glass, glow, glow_input, metal, placed,
    plastic, rectangle, rough,
};
use common::direct::{Fault, render_direct};
use common::gallery;
use common::judge::assert_pairwise_agreement;
use common::room::{add_ball, add_block, add_walls, room, stage};
use common::run::{Estimator, compile_scene, render_scene};
use lichtweg::scene::description::{
    Description, LightKind, MaterialKind, MicrofacetKind, SpectrumDescription, TextureInput,
};
use lichtweg_ray::math::Affine;

fn assert_agreement(what: &str, description: &Description, estimators: &[Estimator]) {
    gallery::assert_agreement(what, description, estimators, 100);
}

#[test]
fn diffuse_room() {
    let d = gallery::diffuse_room(256);
    assert_agreement("diffuse room", &d, &Estimator::ALL);
}

#[test]
fn rough_conductors() {
    let mut d = room(512);
    let ball = d.material(metal(rough(MicrofacetKind::Ggx, 0.15, 0.4)));
    let block = d.material(metal(rough(MicrofacetKind::Beckmann, 0.3, 0.3)));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    assert_agreement("rough conductors", &d, &Estimator::ALL);
}

#[test]
fn plastics() {
    let mut d = room(512);
    let ball = d.material(plastic([0.2, 0.4, 0.7], None));
    let block = d.material(plastic([0.7, 0.5, 0.2], rough(MicrofacetKind::Beckmann, 0.2, 0.2)));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    assert_agreement("plastics", &d, &Estimator::ALL);
}

#[test]
fn rough_dielectrics() {
    let mut d = room(512);
    d.integrator.max_depth = Some(7);
    let ball = d.material(glass(1.5, rough(MicrofacetKind::Ggx, 0.3, 0.3)));
    let block = d.material(glass(1.33, rough(MicrofacetKind::Beckmann, 0.4, 0.25)));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    assert_agreement("rough dielectrics", &d, &Estimator::ALL);
}

#[test]
fn smooth_glass_and_mirror() {
    let mut d = gallery::smooth_room(512);
    let pane = d.material(MaterialKind::ThinDielectric {
        eta: 1.5,
        specular_reflectance: TextureInput::number(1.0),
        specular_transmittance: TextureInput::rgb([0.5, 0.9, 0.9]),
    });
    d.shape(rectangle(), placed([0.3, 0.2, 0.6], [0.4, 0.4, 1.0]), pane);
    assert_agreement("smooth glass and mirror", &d, &Estimator::ALL);
}

/// A sky with a broad sun, in both mappings at once, over objects that stand free.
#[test]
fn environment_maps() {
    let d = gallery::under_skies(512, plastic([0.3, 0.6, 0.3], None));
    assert_agreement("environment maps", &d, &Estimator::ALL);
}

/// Emission and reflectance that vary over the surface: over triangles, and over the parameters of the quadrics.
#[test]
fn textured_emitters() {
    let mut d = gallery::textured_lamps(2048);
    let reflectance = d.texture(checkerboard([0.9, 0.9, 0.2], [0.1, 0.2, 0.6], 3.0));
    let painted = d.material(MaterialKind::Diffuse { reflectance });
    add_ball(&mut d, painted);
    assert_agreement("textured emitters", &d, &Estimator::ALL);
}

/// A whole sphere seen from outside is sampled by its cone, and its texture must be looked up where the cone meets it.
#[test]
fn textured_sphere() {
    let mut d = stage(512);
    add_walls(&mut d);
    let black = d.diffuse([0.0; 3]);
    let board = d.texture(checkerboard([6.0, 1.0, 1.0], [0.2, 0.5, 3.0], 2.0));
    d.shape(SPHERE, placed([0.1, 0.2, 0.0], [0.4; 3]), black).emission = glow_input(board);
    assert_agreement("textured sphere", &d, &Estimator::ALL);
}

/// Surfaces with holes pass eye paths by chance and connections by their transmittance.
#[test]
fn masks() {
    let mut d = room(512);
    let white = d.diffuse([0.7, 0.6, 0.8]);
    let sieve = d.texture(checkerboard([1.0; 3], [0.0; 3], 2.0));
    let sieve = d.material(MaterialKind::Mask { opacity: sieve, nested: white });
    let sieve = d.two_sided(sieve);
    let veil = d.material(MaterialKind::Mask { opacity: TextureInput::number(0.5), nested: white });
    let veil = d.two_sided(veil);
    add_ball(&mut d, sieve);
    add_block(&mut d, veil);
    let awning = chain(&[Affine::translation(0.0, 0.4, 0.0), facing_up(), Affine::scaling(0.6, 0.6, 1.0)]);
    d.shape(rectangle(), awning, sieve);
    assert_agreement("masks", &d, &Estimator::ALL);
}

/// A light with holes shines where it is.
#[test]
fn masked_emitter() {
    let mut d = stage(512);
    add_walls(&mut d);
    let black = d.diffuse([0.0; 3]);
    let opacity = d.texture(checkerboard([1.0; 3], [0.25; 3], 1.0));
    let sieve = d.material(MaterialKind::Mask { opacity, nested: black });
    let place = chain(&[Affine::translation(0.0, 0.9, 0.0), facing_down(), Affine::scaling(0.6, 0.6, 1.0)]);
    d.shape(rectangle(), place, sieve).emission = glow([4.0, 3.0, 2.0]);
    let white = d.diffuse([0.7; 3]);
    add_ball(&mut d, white);
    assert_agreement("masked emitter", &d, &Estimator::ALL);
}

/// Normals that are not the surface's: interpolated, tilted by a height field, and read from a map.
#[test]
fn shading_normals() {
    let d = gallery::tilted_room(512);
    assert_agreement("shading normals", &d, &Estimator::ALL);
}

#[test]
fn thin_lens() {
    let mut d = room(512);
    d.camera.aperture_radius = 0.25;
    d.camera.focus_distance = 3.4;
    let ball = d.material(metal(rough(MicrofacetKind::Beckmann, 0.2, 0.2)));
    add_ball(&mut d, ball);
    assert_agreement("thin lens", &d, &Estimator::ALL);
}

/// Different materials on the two sides, and lights that shine from one side or both.
#[test]
fn two_sides() {
    let d = gallery::two_sides(512);
    assert_agreement("two sides", &d, &Estimator::ALL);
}

/// Sixty lights of all shapes, sizes and powers, some outshone, some turned away.
#[test]
fn many_lights() {
    let d = gallery::many_lights(512, 60, 0.0);
    assert_agreement("many lights", &d, &Estimator::ALL);
}

/// Emitters that reflect, and that stand in each other's light.
#[test]
fn reflecting_emitters() {
    let mut d = stage(512);
    add_walls(&mut d);
    let white = d.diffuse([0.6; 3]);
    let gloss = d.material(plastic([0.3; 3], rough(MicrofacetKind::Ggx, 0.2, 0.2)));
    d.shape(SPHERE, placed([-0.5, 0.2, 0.0], [0.35; 3]), gloss).emission = glow([1.0, 2.0, 3.0]);
    d.shape(cube(), placed([0.4, -0.3, 0.0], [0.25, 0.5, 0.25]), white).emission = glow([2.0, 1.0, 0.5]);
    assert_agreement("reflecting emitters", &d, &Estimator::ALL);
}

/// Lights that no walk runs into, with others that it does: connections alone and with multiple importance sampling.
#[test]
fn delta_lights() {
    let d = gallery::delta_room(256);
    assert_agreement("delta lights", &d, &Estimator::CONNECTING);
}

/// The path tracer's direct light, and that of the separate estimator in the tests.
#[test]
fn two_programs() {
    let mut d = room(512);
    d.integrator.max_depth = Some(2);
    let ball = d.material(metal(rough(MicrofacetKind::Ggx, 0.3, 0.3)));
    let block = d.diffuse([0.4, 0.5, 0.6]);
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    let black = d.diffuse([0.0; 3]);
    d.shape(SPHERE, placed([0.5, 0.4, 0.3], [0.15; 3]), black).emission = glow([3.0, 6.0, 9.0]);
    d.light(LightKind::Constant { radiance: SpectrumDescription::Constant(0.2) });
    let scene = compile_scene(&d);
    let path = render_scene(&scene, &d);
    d.sampler.seed = 1;
    let direct = render_direct(&scene, &d, Fault::None);
    assert_pairwise_agreement("two programs", &[("path".into(), path), ("direct".into(), direct)]);
}
