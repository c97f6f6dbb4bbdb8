//! Walks from the lights, from both ends, and from the eye have the same mean.
//!
//! Each scene is one family of Welch tests (all pairs of estimators, blocks and channels) with a probability of a false
//! alarm of 0.01 or less. Light tracing sees nothing in mirrors or through smooth glass, and is left out where that is in
//! view.

mod common;

use std::sync::Arc;

use common::build::{
    Build, SPHERE, chain, checkerboard, cube, facing_down, glass, glow, glow_input, grid, metal, placed,
    plastic, rectangle, rough,
};
use common::gallery;
use common::room::{add_ball, add_block, add_light, add_walls, room, stage};
use common::run::{Estimator, compile_scene, render_scene};
use lichtweg::scene::description::{
    Description, FilterDescription, InstanceDescription, LightKind, MaterialKind, MicrofacetKind, Span,
    SpectrumDescription, TextureInput,
};
use lichtweg_montecarlo::Moments;
use lichtweg_montecarlo::hypothesis::{sidak, welch_t_test};
use lichtweg_ray::Placement;
use lichtweg_ray::math::{Affine, Motion, Vec3};

/// Paths from the eye, with which the others are compared.
const EYE: Estimator = Estimator::MisPower;
/// All.
const ALL: [Estimator; 4] =
    [EYE, Estimator::Light, Estimator::BidirectionalBalance, Estimator::BidirectionalPower];
/// Where what is in view can hardly be connected to the lens.
const SPECULAR: [Estimator; 3] = [EYE, Estimator::BidirectionalBalance, Estimator::BidirectionalPower];

fn assert_agreement(what: &str, description: &Description, estimators: &[Estimator]) {
    gallery::assert_agreement(what, description, estimators, 300);
}

/// <We, L> = <W, Le>: what the whole film receives, once as the eye's responsivity We over the radiance L that walks from the eye
/// find, and once as the importance W that walks from the lights carry over the emission Le. One family of Welch tests at 0.01, of
/// the channels and of scenes whose scattering is its own adjoint, and is not.
#[test]
fn forward_and_adjoint_measurements_agree() {
    const SEEDS: u64 = 24;
    for mut d in [gallery::diffuse_room(8), gallery::tilted_room(8)] {
        let scene = compile_scene(&d);
        let mut measure = |estimator: Estimator, first: u64| {
            let mut totals = [Moments::default(); 3];
            for seed in first..first + SEEDS {
                estimator.choose(&mut d);
                d.sampler.seed = seed;
                let image = render_scene(&scene, &d);
                let pixels = image.pixels.len() as f64;
                for (channel, total) in totals.iter_mut().enumerate() {
                    total.push(image.pixels.iter().map(|p| p.mean()[channel]).sum::<f64>() / pixels);
                }
            }
            totals
        };
        let [forward, adjoint] = [measure(EYE, 1), measure(Estimator::Light, 1001)];
        for (l, w) in forward.iter().zip(&adjoint) {
            let estimate = |m: &Moments| (m.mean(), m.variance_of_mean(), (SEEDS - 1) as f64);
            assert!(l.mean() > 0.01);
            // The film as a whole is known to a hundredth: a lost cosine or normal would show.
            assert!(w.standard_error() < 0.01 * w.mean(), "{}", w.standard_error());
            let outcome = welch_t_test(estimate(l), estimate(w));
            assert!(!outcome.rejects(sidak(0.01, 6)), "{} and {}: {outcome:?}", l.mean(), w.mean());
        }
    }
}

#[test]
fn diffuse_room() {
    let d = gallery::diffuse_room(128);
    assert_agreement("diffuse room", &d, &ALL);
}

#[test]
fn glossy() {
    let mut d = room(128);
    let ball = d.material(metal(rough(MicrofacetKind::Ggx, 0.15, 0.4)));
    let block = d.material(plastic([0.7, 0.5, 0.2], rough(MicrofacetKind::Beckmann, 0.2, 0.2)));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    assert_agreement("glossy", &d, &ALL);
}

#[test]
fn rough_glass() {
    let mut d = room(128);
    d.integrator.max_depth = Some(7);
    let ball = d.material(glass(1.5, rough(MicrofacetKind::Ggx, 0.3, 0.3)));
    let block = d.material(glass(1.33, rough(MicrofacetKind::Beckmann, 0.4, 0.25)));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    // Light tracing finds what is seen through the glass in few, large samples, whose spread says nothing of their mean's.
    assert_agreement("rough glass", &d, &SPECULAR);
}

/// Caustics of smooth glass, a mirror and a coat on the walls; these are in view.
#[test]
fn smooth_glass_and_mirror() {
    let mut d = gallery::smooth_room(160);
    let coated = d.material(plastic([0.2, 0.4, 0.7], None));
    d.shape(SPHERE, placed([0.3, 0.3, 0.4], [0.3; 3]), coated);
    assert_agreement("smooth glass and mirror", &d, &SPECULAR);
}

/// The same out of view, so that light tracing sees their caustics on the floor.
#[test]
fn caustics_of_unseen_glass() {
    let mut d = room(160);
    d.integrator.max_depth = Some(6);
    let ball = d.material(glass(1.5, None));
    let mirror = d.material(metal(None));
    let mirror = d.two_sided(mirror);
    d.shape(SPHERE, placed([0.0, 0.3, 1.3], [0.35; 3]), ball);
    let place = chain(&[
        Affine::translation(0.6, -0.2, 1.5),
        Affine::rotation([0.0, 1.0, 0.0], 200.0),
        Affine::scaling(0.4, 0.4, 1.0),
    ]);
    d.shape(rectangle(), place, mirror);
    // The camera looks from between them and the room.
    d.camera = common::run::camera([0.0, -0.3, 0.9], [0.0, -0.9, -0.6], 60.0);
    assert_agreement("caustics of unseen glass", &d, &ALL);
}

/// Normals that are not the surface's: interpolated, tilted by a height field, and read from a map.
#[test]
fn shading_normals() {
    let d = gallery::tilted_room(160);
    assert_agreement("shading normals", &d, &ALL);
}

/// A coarse ball of rough glass with interpolated normals: refraction and shading normals at once.
#[test]
fn smooth_normals_on_glass() {
    let mut d = room(160);
    d.integrator.max_depth = Some(6);
    let glass = d.material(glass(1.5, rough(MicrofacetKind::Ggx, 0.4, 0.4)));
    let lens = grid(5, |x, y| Vec3::new(x, y, 0.4 * (1.0 - 0.5 * (x * x + y * y))), true);
    d.shape(lens, placed([-0.2, -0.2, 0.3], [0.5; 3]), glass);
    assert_agreement("smooth normals on glass", &d, &ALL);
}

#[test]
fn delta_lights() {
    let d = gallery::delta_room(128);
    assert_agreement("delta lights", &d, &ALL);
}

/// A sky with a broad sun in both mappings, and an even one, over objects that stand free.
#[test]
fn environments() {
    let mut d = gallery::under_skies(160, plastic([0.3, 0.6, 0.3], rough(MicrofacetKind::Ggx, 0.3, 0.3)));
    d.light(LightKind::Constant { radiance: SpectrumDescription::Constant(0.1) });
    assert_agreement("environments", &d, &ALL);
}

/// Emission that varies over triangles and over the parameters of quadrics, one of them sampled by its cone.
#[test]
fn textured_emitters() {
    let mut d = gallery::textured_lamps(128);
    let black = d.diffuse([0.0; 3]);
    let board = d.texture(checkerboard([6.0, 1.0, 1.0], [0.2, 0.5, 3.0], 1.5));
    d.shape(SPHERE, placed([0.1, 0.2, 0.0], [0.3; 3]), black).emission = glow_input(board);
    assert_agreement("textured emitters", &d, &ALL);
}

/// A lens that walks from the lights run into, and what it sees in a mirror.
#[test]
fn thin_lens() {
    let mut d = room(160);
    d.camera.aperture_radius = 0.25;
    d.camera.focus_distance = 3.4;
    d.camera.near_clip = 0.1;
    let ball = d.material(metal(rough(MicrofacetKind::Beckmann, 0.2, 0.2)));
    add_ball(&mut d, ball);
    let far = d.clone();
    assert_agreement("thin lens", &far, &ALL);
    // A lens in the room, as large as things are: the walks hit it often.
    d.camera = common::run::camera([0.0, 0.1, 0.85], [0.0, -0.3, -1.0], 60.0);
    d.camera.aperture_radius = 0.4;
    d.camera.focus_distance = 1.2;
    let mirror = d.material(metal(None));
    add_block(&mut d, mirror);
    // With the seed of the others, the eye's paths are 3.9 standard errors off in a block (1 of 65) whose mean over forty seeds is right.
    gallery::assert_agreement("large lens", &d, &SPECULAR, 400);
}

/// Different materials on the two sides, and lights that shine from one side or both.
#[test]
fn two_sides() {
    let d = gallery::two_sides(128);
    assert_agreement("two sides", &d, &ALL);
}

/// Surfaces with holes, one of them a light.
#[test]
fn masks() {
    let mut d = room(128);
    let white = d.diffuse([0.7, 0.6, 0.8]);
    let sieve = d.texture(checkerboard([1.0; 3], [0.0; 3], 2.0));
    let sieve = d.material(MaterialKind::Mask { opacity: sieve, nested: white });
    let veil = d.material(MaterialKind::Mask { opacity: TextureInput::number(0.5), nested: white });
    let (two_sided_sieve, two_sided_veil) = (d.two_sided(sieve), d.two_sided(veil));
    add_ball(&mut d, two_sided_sieve);
    add_block(&mut d, two_sided_veil);
    let place = chain(&[Affine::translation(0.4, 0.5, 0.3), facing_down(), Affine::scaling(0.3, 0.3, 1.0)]);
    d.shape(rectangle(), place, veil).emission = glow([4.0, 3.0, 2.0]);
    assert_agreement("masks", &d, &ALL);
}

/// Many lights of all shapes, and emitters that reflect.
#[test]
fn many_lights() {
    let d = gallery::many_lights(128, 40, 0.4);
    assert_agreement("many lights", &d, &ALL);
}

/// Instances of a group, one of them moving while the shutter is open: the two walks of a sample see the same moment.
#[test]
fn instances_and_motion() {
    let mut d = room(160);
    d.camera.shutter = [0.0, 1.0];
    let painted = d.diffuse([0.7, 0.5, 0.3]);
    let glossy = d.material(metal(rough(MicrofacetKind::Ggx, 0.3, 0.3)));
    let group = d.add_group();
    d.shape(cube(), placed([0.0, -0.2, 0.0], [0.2, 0.3, 0.2]), painted).group = Some(group);
    d.shape(SPHERE, placed([0.0, 0.35, 0.0], [0.25; 3]), glossy).group = Some(group);
    let at = |x: f64, turn: f32| {
        chain(&[Affine::translation(x, -0.5, 0.1), Affine::rotation([0.0, 0.0, 1.0], f64::from(turn))])
    };
    let moving = Motion::new([(0.0, at(0.3, 0.0)), (1.0, at(0.6, 60.0))]).expect("a motion");
    for to_world in [Placement::Fixed(at(-0.5, -20.0)), Placement::Moving(Arc::new(moving))] {
        d.instances.push(InstanceDescription { span: Span::default(), group, to_world });
    }
    assert_agreement("instances and motion", &d, &ALL);
}

/// Filters wider than a pixel, one with negative lobes, on a crop: splats fall on every pixel that they cover.
#[test]
fn filters_and_crops() {
    use lichtweg::scene::description::FilterKind;
    for filter in
        [FilterDescription::default(), FilterDescription::new(FilterKind::Mitchell { b: 0.2, c: 0.5 }, 2.0)]
    {
        let mut d = room(512);
        d.film.filter = filter;
        d.film.crop = Some([5, 9, 20, 16]);
        d.camera.principal_point_offset = [0.05, -0.1];
        let shiny = d.material(metal(rough(MicrofacetKind::Ggx, 0.2, 0.2)));
        add_ball(&mut d, shiny);
        assert_agreement("filters and crops", &d, &ALL);
    }
}

/// Early roulette, no limit of length, and no emitters in view.
#[test]
fn roulette() {
    let mut d = stage(160);
    add_walls(&mut d);
    add_light(&mut d);
    d.integrator.max_depth = None;
    d.integrator.roulette.start_depth = Some(2);
    d.integrator.hide_emitters = true;
    let shiny = d.material(metal(rough(MicrofacetKind::Ggx, 0.2, 0.2)));
    add_ball(&mut d, shiny);
    assert_agreement("roulette", &d, &ALL);
}
