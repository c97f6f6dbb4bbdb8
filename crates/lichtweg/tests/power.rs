//! The tests can fail: each kind is put to results that are wrong on purpose, and has to notice.
//!
//! The judges are the very functions that the other tests use, at about the same numbers of samples; seeds are fixed.
//! Closed forms are put to errors of one percent where they are tested.

mod common;

use common::build::{Build, SPHERE, glow, metal, placed, rough};
use common::direct::{Fault, render_direct};
use common::judge::{ALPHA, compare, expectation};
use common::probe::{probe, reflected};
use common::room::{add_ball, add_block, room};
use common::run::{Estimator, compile_scene, render, render_scene};
use lichtweg::render::RenderedImage;
use lichtweg::scene::description::{Description, LightKind, MicrofacetKind, SpectrumDescription};
use lichtweg_montecarlo::hypothesis::{DensityTest, binomial_survival};
use lichtweg_montecarlo::{Sampler, warp};
use lichtweg_ray::math::Vec3;

/// Comparisons in a family like those of the agreement tests.
const FAMILY: usize = 6;

/// A room with two lights, as the agreement tests have.
fn lit_room(samples_per_pixel: u32) -> Description {
    let mut d = room(samples_per_pixel);
    let ball = d.material(metal(rough(MicrofacetKind::Ggx, 0.3, 0.3)));
    let block = d.diffuse([0.4, 0.5, 0.6]);
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    let black = d.diffuse([0.0; 3]);
    d.shape(SPHERE, placed([0.5, 0.4, 0.3], [0.15; 3]), black).emission = glow([3.0, 6.0, 9.0]);
    d
}

fn by(estimator: Estimator, seed: u64, description: &Description) -> RenderedImage {
    let mut d = description.clone();
    d.sampler.seed = seed;
    estimator.choose(&mut d);
    render(&d)
}

/// All the faults of the separate program for direct light, and none of its correct form.
#[test]
fn seeded_faults_are_found() {
    let mut d = lit_room(512);
    d.integrator.max_depth = Some(2);
    let scene = compile_scene(&d);
    let truth = render_scene(&scene, &d);
    d.sampler.seed = 1;
    assert!(!compare(&truth, &render_direct(&scene, &d, Fault::None)).rejects_among(FAMILY));
    for fault in Fault::ALL {
        let comparison = compare(&truth, &render_direct(&scene, &d, fault));
        assert!(comparison.rejects_among(FAMILY), "{fault:?} goes unnoticed: {comparison:?}");
    }
}

#[test]
fn one_percent_of_light_too_much_is_found() {
    let mut d = lit_room(1024);
    let truth = by(Estimator::MisPower, 1, &d);
    assert!(!compare(&truth, &by(Estimator::Nee, 2, &d)).rejects_among(FAMILY));
    d.film.scale = 1.01;
    assert!(compare(&truth, &by(Estimator::Nee, 2, &d)).rejects_among(FAMILY));
}

#[test]
fn one_bounce_too_many_is_found() {
    let mut d = lit_room(1024);
    d.integrator.max_depth = Some(4);
    let truth = by(Estimator::MisPower, 1, &d);
    for depth in [3, 5] {
        d.integrator.max_depth = Some(depth);
        assert!(compare(&truth, &by(Estimator::MisPower, 2, &d)).rejects_among(FAMILY), "depth {depth}");
    }
}

/// A fifth too much in a block of 4 x 4 of 1024 pixels hardly shows in the mean of the image, but in the block.
#[test]
fn a_wrong_corner_is_found() {
    let d = lit_room(512);
    let truth = by(Estimator::MisPower, 1, &d);
    let mut image = by(Estimator::MisPower, 2, &d);
    assert!(!compare(&truth, &image).rejects_among(FAMILY));
    for i in 0..16 {
        let pixel = &mut image.pixels[(20 + i / 4) * 32 + 20 + i % 4];
        pixel.sum = pixel.sum.map(|v| 1.2 * v);
        pixel.sum_squares = pixel.sum_squares.map(|v| 1.2 * 1.2 * v);
    }
    let comparison = compare(&truth, &image);
    assert!(comparison.rejects_among(FAMILY) && comparison.place.0 == Some([5, 5]), "{comparison:?}");
}

#[test]
fn nan_is_found() {
    let d = lit_room(8);
    let truth = by(Estimator::MisPower, 1, &d);
    let mut image = truth.clone();
    assert!(!compare(&truth, &image).rejects_among(1));
    image.pixels[77].sum[1] = f64::NAN;
    assert!(compare(&truth, &image).rejects_among(1));
}

/// Of a hundred pairs of honest images, no more are rejected than the level allows: more than five would be so with a
/// probability below 0.001.
#[test]
fn the_comparison_keeps_its_level() {
    const PAIRS: u64 = 100;
    let mut d = lit_room(64);
    (d.film.width, d.film.height) = (16, 16);
    let rejected = (0..PAIRS)
        .filter(|i| {
            let pair = [2 * i, 2 * i + 1].map(|seed| by(Estimator::MisPower, seed, &d));
            compare(&pair[0], &pair[1]).rejects_among(1)
        })
        .count();
    assert!(binomial_survival(6, PAIRS, ALPHA) < 1e-3);
    assert!(rejected <= 5, "{rejected} of {PAIRS} rejected");
}

/// Lambert's cosine at the receiver, and the square of the distance: a closed form with either forgotten is rejected.
#[test]
fn wrong_closed_forms_are_found() {
    let mut d = probe(16, 1);
    let position = Vec3::new(0.8, 1.0, 0.0);
    d.light(LightKind::Point { position, intensity: SpectrumDescription::Constant(1.0) });
    let image = render(&d);
    let distance_squared = 1.64_f64;
    let cosine = 1.0 / distance_squared.sqrt();
    let rejected = |irradiance: f64| {
        expectation(&image, reflected(irradiance), 2e-4).iter().all(|(_, o)| o.rejects(1e-6))
    };
    assert!(!rejected(cosine / distance_squared));
    assert!(
        rejected(1.0 / distance_squared) && rejected(cosine) && rejected(cosine / distance_squared.sqrt())
    );
}

/// Densities that are nearly right: a ball's cone with the area's density, a sphere without its sine, a lens that
/// crowds the centre.
#[test]
fn wrong_densities_are_found() {
    let test = DensityTest { samples: 200_000, ..DensityTest::default() };
    let rejects_sphere = |sample: fn([f32; 2]) -> [f32; 3], pdf: &dyn Fn([f32; 3]) -> f32| {
        test.sphere(|s: &mut Sampler| Some(sample(s.next_2d())), pdf).expect("testable").rejects(ALPHA)
    };
    // A ball of radius 0.6 at distance 1: even over the cone of directions, not over its near side.
    const HEIGHT: f32 = 0.2;
    let cone = |u| warp::uniform_cone(u, HEIGHT);
    let inside = |w: [f32; 3]| w[2] >= 1.0 - HEIGHT;
    assert!(!rejects_sphere(cone, &|w| if inside(w) { warp::uniform_cone_pdf(HEIGHT) } else { 0.0 }));
    let near_side = |w: [f32; 3]| {
        // Per area of the near cap, 2 pi r (r - r^2 / 1), times d^2 / cos.
        let (r, cos) = (0.6_f32, w[2]);
        let root = (r * r - (1.0 - cos * cos)).max(1e-6).sqrt();
        let distance = cos - root;
        if inside(w) {
            distance * distance * r / (root * std::f32::consts::TAU * r * (r - r * r))
        } else {
            0.0
        }
    };
    assert!(rejects_sphere(cone, &near_side));

    let even_in_angles = |u: [f32; 2]| {
        let (sin, cos) = (std::f32::consts::PI * u[0]).sin_cos();
        let (y, x) = (std::f32::consts::TAU * u[1]).sin_cos();
        [sin * x, sin * y, cos]
    };
    assert!(rejects_sphere(even_in_angles, &|_| warp::UNIFORM_SPHERE_PDF));

    let crowded = |s: &mut Sampler| {
        let [r, phi] = s.next_2d();
        let (y, x) = (std::f32::consts::TAU * phi).sin_cos();
        Some([r * x, r * y])
    };
    let disk = |[x, y]: [f32; 2]| if x * x + y * y <= 1.0 { warp::UNIFORM_DISK_PDF } else { 0.0 };
    assert!(test.rectangle([-1.0; 2], [1.0; 2], crowded, disk).expect("testable").rejects(ALPHA));
    // One sample in a hundred thrown away.
    let leaky = |s: &mut Sampler| {
        let p = warp::uniform_disk(s.next_2d());
        (s.next_1d() >= 0.01).then_some(p)
    };
    assert!(test.rectangle([-1.0; 2], [1.0; 2], leaky, disk).expect("testable").rejects(ALPHA));
}
