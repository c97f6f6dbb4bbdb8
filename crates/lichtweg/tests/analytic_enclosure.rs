//! Enclosures whose radiance is known: bounces of a geometric series.
//!
//! In a closed diffuse sphere every point sees every other alike, so that each bounce multiplies an even radiance by the
//! albedo. Sums over at most d path edges are then L (1 - rho^d) / (1 - rho). Where every path of an estimator
//! gives exactly this, the variance is zero and only f32 rounding is allowed for; elsewhere z tests, with a
//! probability of a false alarm of 0.01 for each function here.

mod common;

use common::build::{Build, SPHERE, glass, glow, rough};
use common::judge::{assert_expectation, assert_pairwise_agreement, expectation};
use common::run::{Estimator, camera, film, render};
use lichtweg::scene::description::{
    Description, FovAxis, LightKind, MaterialKind, MicrofacetKind, RouletteDescription, SpectrumDescription,
};
use lichtweg_ray::math::{Affine, Vec3};

/// A camera in the unit sphere, off its centre, and walls of a given albedo that face inwards.
fn enclosure(albedo: f32, emission: Option<f32>) -> Description {
    let mut d = Description {
        camera: camera([0.2, -0.3, 0.4], [0.0, 1.0, 0.3], 80.0),
        film: film(16, 16),
        ..Default::default()
    };
    d.sampler.samples_per_pixel = 16;
    d.integrator.roulette = RouletteDescription { start_depth: None };
    let wall = d.diffuse([albedo; 3]);
    let shape = d.shape(SPHERE, Affine::IDENTITY, wall);
    shape.flip_normals = true;
    shape.emission = emission.and_then(|e| glow([e; 3]));
    d
}

fn add_point_light(d: &mut Description, intensity: f32) {
    d.light(LightKind::Point { position: Vec3::ZERO, intensity: SpectrumDescription::Constant(intensity) });
}

/// Every pixel, not the mean alone.
fn assert_every_pixel(what: &str, d: &Description, expected: f64) {
    for (i, pixel) in render(d).pixels.iter().enumerate() {
        let mean = pixel.mean()[0];
        assert!((mean / expected - 1.0).abs() < 2e-5, "{what}, pixel {i}: {mean} instead of {expected}");
    }
}

/// The light of intensity pi gives the walls an irradiance of pi, albedo 1/2 makes it a radiance of 1/2, and the bounces
/// sum to 1.
#[test]
fn central_point_light() {
    for estimator in Estimator::CONNECTING {
        for depth in [1, 2, 3, 4, 8, 40] {
            let mut d = enclosure(0.5, None);
            add_point_light(&mut d, std::f32::consts::PI);
            d.integrator.max_depth = Some(depth);
            estimator.choose(&mut d);
            let expected = 1.0 - 0.5_f64.powi(depth as i32 - 1);
            if depth == 1 {
                assert_eq!(render(&d).mean().0, [0.0; 3]);
            } else {
                assert_every_pixel(&format!("{estimator:?}, depth {depth}"), &d, expected);
            }
        }
    }
}

#[test]
fn central_point_light_without_limit() {
    let mut d = enclosure(0.5, None);
    add_point_light(&mut d, std::f32::consts::PI);
    d.integrator.roulette = RouletteDescription::default();
    d.sampler.samples_per_pixel = 2048;
    let image = render(&d);
    assert_expectation("roulette", &image, [1.0; 3], 1e-5, 1);
    let error = image.mean().1[0];
    assert!(error < 1e-3, "too noisy to tell: {error}");
}

#[test]
fn glowing_walls() {
    for depth in [1, 2, 3, 4, 8, 40] {
        let mut d = enclosure(0.5, Some(0.5));
        d.integrator.max_depth = Some(depth);
        Estimator::Naive.choose(&mut d);
        assert_every_pixel(&format!("depth {depth}"), &d, 1.0 - 0.5_f64.powi(depth as i32));
    }
}

/// Next-event estimation chooses points of the walls uniformly and so has variance; the mean is the same.
#[test]
fn glowing_walls_by_connection() {
    let depths = [2, 3, 8];
    for estimator in Estimator::CONNECTING {
        for depth in depths {
            let mut d = enclosure(0.5, Some(0.5));
            d.integrator.max_depth = Some(depth);
            d.sampler.samples_per_pixel = 1024;
            d.sampler.seed = 3;
            estimator.choose(&mut d);
            let expected = 1.0 - 0.5_f64.powi(depth as i32);
            let what = format!("{estimator:?}, depth {depth}");
            assert_expectation(&what, &render(&d), [expected; 3], 1e-5, 9);
        }
    }
}

/// The white furnace: L = Le / (1 - rho). With `n` edges at most, the sum falls short by the fraction rho^n, and exactly so.
#[test]
fn white_furnace() {
    for (albedo, edges) in [(0.1_f32, 8), (0.5, 24), (0.9, 120), (0.99, 1200)] {
        let rho = f64::from(albedo);
        let limit = 0.25 / (1.0 - rho);
        let truncation = rho.powi(edges);
        assert!(truncation < 1e-3 || albedo < 0.98);
        let mut d = enclosure(albedo, Some(0.25));
        d.sampler.samples_per_pixel = 4;
        d.integrator.max_depth = Some(edges as u32);
        Estimator::Naive.choose(&mut d);
        let mean = render(&d).mean().0[0];
        assert!((mean / (limit * (1.0 - truncation)) - 1.0).abs() < 1e-4, "{albedo}: {mean}");
        assert!((mean / limit - 1.0).abs() < 0.005, "{albedo}: {mean} instead of {limit}");
    }
}

/// The same without a limit, where only roulette ends a path: three estimators at four albedos, to their standard errors,
/// which are a few thousandths. Roulette by throughput keeps them so even where light hardly fades.
#[test]
fn white_furnace_with_roulette() {
    for (albedo, samples) in [(0.1_f32, 128), (0.5, 128), (0.9, 512), (0.99, 256)] {
        for estimator in [Estimator::Naive, Estimator::Nee, Estimator::MisPower] {
            let mut d = enclosure(albedo, Some(0.25));
            d.sampler.samples_per_pixel = samples;
            d.sampler.seed = 5;
            d.integrator.roulette = RouletteDescription::default();
            estimator.choose(&mut d);
            let limit = 0.25 / (1.0 - f64::from(albedo));
            let image = render(&d);
            let what = format!("{estimator:?}, albedo {albedo}");
            assert_expectation(&what, &image, [limit; 3], 1e-5, 12);
            let error = image.mean().1[0];
            assert!(error < 0.006 * limit, "{what}: too noisy to tell: {error}");
        }
    }
}

/// An object in a constant environment of radiance 2, filling the view.
fn furnace(material: MaterialKind) -> Description {
    let mut d = Description {
        camera: camera([0.0, 0.5, 3.0], [0.0; 3], 30.0),
        film: film(16, 16),
        ..Default::default()
    };
    d.camera.field_of_view =
        lichtweg::scene::description::FieldOfView::Angle { degrees: 30.0, axis: FovAxis::X };
    d.sampler.samples_per_pixel = 64;
    d.light(LightKind::Constant { radiance: SpectrumDescription::Constant(2.0) });
    let material = d.material(material);
    d.shape(SPHERE, Affine::IDENTITY, material);
    d
}

/// A lossless smooth sphere cannot be told from its surroundings: every path brings their radiance, whatever it went
/// through.
#[test]
fn smooth_glass_is_invisible() {
    for (eta, tolerance) in [(1.5_f32, 2e-5), (1.0 / 1.33, 2e-5), (2.4, 2e-5)] {
        let mut d = furnace(glass(eta, None));
        d.integrator.roulette = RouletteDescription { start_depth: None };
        for (i, pixel) in render(&d).pixels.iter().enumerate() {
            let mean = pixel.mean()[1];
            assert!((mean / 2.0 - 1.0).abs() < tolerance, "eta {eta}, pixel {i}: {mean}");
        }
        d.integrator.roulette = RouletteDescription::default();
        d.sampler.samples_per_pixel = 256;
        assert_expectation("with roulette", &render(&d), [2.0; 3], 1e-5, 3);
    }
}

/// Rough facets lose what they scatter twice: nothing may be gained, little is lost at low roughness, and all estimators
/// lose the same. Connections alone find sharp lobes too seldom to be judged.
#[test]
fn rough_glass_gains_nothing() {
    let mut last = 2.0 + 1e-6;
    for alpha in [0.01, 0.1, 0.4] {
        let estimators = Estimator::ALL.into_iter().filter(|e| alpha > 0.3 || *e != Estimator::Nee);
        let images: Vec<_> = estimators
            .map(|estimator| {
                let mut d = furnace(glass(1.5, rough(MicrofacetKind::Ggx, alpha, alpha)));
                d.sampler.samples_per_pixel = 1024;
                d.sampler.seed = 10 + estimator as u64;
                estimator.choose(&mut d);
                (format!("{estimator:?}"), render(&d))
            })
            .collect();
        assert_pairwise_agreement(&format!("alpha {alpha}"), &images);
        let (mean, error) = images[0].1.mean();
        assert!(mean[0] < last + 5.0 * error[0], "alpha {alpha}: {mean:?}");
        last = mean[0];
        assert!(alpha > 0.01 || mean[0] > 1.98, "alpha {alpha}: {mean:?}");
    }
}

/// A convex diffuse body in an even environment shows its albedo.
#[test]
fn diffuse_body_in_an_even_environment() {
    for (i, estimator) in Estimator::ALL.into_iter().enumerate() {
        let mut d = furnace(MaterialKind::Diffuse {
            reflectance: lichtweg::scene::description::TextureInput::rgb([0.2, 0.5, 0.9]),
        });
        d.camera = camera([0.0, 0.0, 3.0], [0.0; 3], 20.0);
        d.sampler.samples_per_pixel = 256;
        d.sampler.seed = i as u64;
        estimator.choose(&mut d);
        let image = render(&d);
        assert_expectation(&format!("{estimator:?}"), &image, [0.4, 1.0, 1.8], 1e-5, 4);
        // Power: the test would notice one percent.
        let off = expectation(&image, [0.4 * 1.01, 1.01, 1.8 * 1.01], 1e-5);
        assert!(estimator == Estimator::Nee || off.iter().all(|(_, o)| o.rejects(1e-6)), "{off:?}");
    }
}
