//! The choice among many lights: no bias, down to the triangles of a single mesh, and less noise than by power.
//!
//! Estimators and ways of choice are compared in pairs by Welch tests over blocks of pixels; each scene is one family with a probability
//! of a false alarm of 0.01 or less.

mod common;

use std::sync::Arc;

use common::build::{Build, chain, facing_up, glow, placed, rectangle};
use common::judge::assert_pairwise_agreement;
use common::room::{add_ball, add_walls, stage};
use common::run::{Estimator, compile_scene, render_scene};
use lichtweg::light::{Light, Receiver};
use lichtweg::render::RenderedImage;
use lichtweg::scene::Form;
use lichtweg::scene::description::{
    Description, GeometryDescription, LightChoiceKind, LightKind, Mesh, SpectrumDescription,
};
use lichtweg_montecarlo::hypothesis::chi_squared_test;
use lichtweg_montecarlo::{Sampler, SamplerKind};
use lichtweg_ray::math::{Affine, Vec3};

/// Numbers in [-1, 1).
fn numbers(index: u32) -> impl FnMut() -> f32 {
    let mut sampler = Sampler::new(SamplerKind::Independent, 8, 9, index);
    move || sampler.next_1d() * 2.0 - 1.0
}

/// A mesh of small triangles, anywhere in the upper part of a room, turned anyhow.
fn swarm(count: u32, size: f32) -> GeometryDescription {
    let mut mesh = Mesh::default();
    for i in 0..count {
        let mut next = numbers(i);
        let center = Vec3::new(0.9 * next(), 0.4 + 0.5 * next(), 0.9 * next());
        mesh.positions.extend((0..3).map(|_| center + Vec3::new(next(), next(), next()) * size));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    GeometryDescription::Mesh(Arc::new(mesh))
}

fn by(choice: LightChoiceKind, d: &Description) -> RenderedImage {
    let mut d = d.clone();
    d.integrator.light_choice = choice;
    render_scene(&compile_scene(&d), &d)
}

/// Two swarms, one of which shines both ways, and a lamp at a point.
fn swarms(samples_per_pixel: u32) -> Description {
    let mut d = stage(samples_per_pixel);
    add_walls(&mut d);
    let [black, grey] = [[0.0; 3], [0.6; 3]].map(|color| d.diffuse(color));
    add_ball(&mut d, grey);
    d.shape(swarm(300, 0.05), Affine::IDENTITY, black).emission = glow([6.0, 5.0, 4.0]);
    let mut emission = glow([1.0, 2.0, 6.0]).expect("emits");
    emission.two_sided = true;
    d.shape(swarm(50, 0.1), placed([0.0, -1.1, 0.0], [1.0, 1.0, 1.0]), grey).emission = Some(emission);
    d.light(LightKind::Point {
        position: Vec3::new(0.8, 0.9, 0.8),
        intensity: SpectrumDescription::Constant(0.2),
    });
    d
}

#[test]
fn all_ways_to_choose_agree() {
    let d = swarms(192);
    let kinds = [LightChoiceKind::Uniform, LightChoiceKind::Power, LightChoiceKind::Tree];
    let mut images = Vec::new();
    for (seed, kind) in (40..).zip(kinds) {
        let mut d = d.clone();
        d.sampler.seed = seed;
        images.push((format!("{kind:?}"), by(kind, &d)));
    }
    // Other weights: connections alone, and walks from both ends.
    for (seed, estimator) in [(50, Estimator::Nee), (51, Estimator::BidirectionalPower)] {
        let mut d = d.clone();
        estimator.choose(&mut d);
        d.sampler.seed = seed;
        images.push((format!("{estimator:?}"), by(LightChoiceKind::Tree, &d)));
    }
    assert_pairwise_agreement("ways to choose", &images);
}

/// Points are chosen on triangles as often as their densities say (chi-squared), and the density of a point on a light, over all of it,
/// integrates to the probability of being chosen.
#[test]
fn triangles_are_chosen_as_said() {
    const SAMPLES: u32 = 400_000;
    let scene = compile_scene(&swarms(1));
    let selection = scene.selection();
    assert!(selection.is_by_place());
    for (case, (position, normal)) in [
        (Vec3::new(0.1, -0.9, 0.2), Vec3::Y),
        (Vec3::new(0.3, 0.5, -0.2), Vec3::new(0.0, 0.8, -0.6)),
        (Vec3::new(-0.4, 0.2, 0.9), Vec3::ZERO),
    ]
    .into_iter()
    .enumerate()
    {
        let to = Receiver { position, normal };
        let mut counts = [vec![0; 300], vec![0; 50], vec![0]];
        let mut lost = 0;
        for i in 0..SAMPLES {
            let mut sampler = Sampler::new(SamplerKind::Independent, 3, case as u64, i);
            let Some(choice) = selection.sample(&to, sampler.next_1d()) else {
                lost += 1;
                continue;
            };
            let triangle = choice.triangle.unwrap_or(0);
            let said = selection.probability(&to, choice.light, triangle);
            assert!((choice.probability / said - 1.0).abs() < 1e-4, "{choice:?}, {said}");
            counts[choice.light as usize][triangle as usize] += 1;
        }
        // The probability of a triangle is relative to its share of the light's area.
        let share = |light: u32, triangle: u32| match &scene.lights()[light as usize] {
            Light::Area(area) => match scene.form(area.shape) {
                form @ Form::Mesh(mesh) => mesh.area(triangle) / area.area(form),
                _ => unreachable!("made of triangles"),
            },
            _ => 1.0,
        };
        let (mut observed, mut expected) = (Vec::new(), Vec::new());
        for (light, counts) in (0..).zip(&counts) {
            for (triangle, &count) in (0..).zip(counts) {
                let said = selection.probability(&to, light, triangle) * share(light, triangle);
                observed.push(count);
                expected.push(f64::from(said) * f64::from(SAMPLES));
            }
        }
        // What goes where nothing can shine on the receiver.
        let left = f64::from(SAMPLES) - expected.iter().sum::<f64>();
        assert!(left > -1e-4 * f64::from(SAMPLES) && left < 0.5 * f64::from(SAMPLES), "{left}");
        observed.push(lost);
        expected.push(left.max(0.0));
        let outcome = chi_squared_test(&observed, &expected).expect("enough samples");
        assert!(!outcome.rejects(1e-3), "{to:?}: {outcome:?}");
        // Power: a third more of the likeliest would show.
        let likeliest = (0..observed.len()).max_by_key(|&i| observed[i]).expect("some");
        observed[likeliest] += observed[likeliest] / 3;
        assert!(chi_squared_test(&observed, &expected).expect("as before").rejects(1e-3));
    }
}

/// Mean variance of a pixel's sample.
fn variance(image: &RenderedImage) -> f64 {
    let of = |p: &lichtweg::film::Pixel| {
        let n = f64::from(p.count);
        (0..3).map(|c| p.sum_squares[c] / n - (p.sum[c] / n).powi(2)).sum::<f64>()
    };
    image.pixels.iter().map(of).sum::<f64>() / image.pixels.len() as f64
}

/// Over a floor under many small lamps, and in a lamp of many triangles, the same number of samples has a third of the variance.
#[test]
fn places_make_less_noise_than_power() {
    let mut d = stage(64);
    d.integrator.max_depth = Some(2);
    d.integrator.hide_emitters = true;
    let [grey, black] = [[0.6; 3], [0.0; 3]].map(|color| d.diffuse(color));
    let floor = chain(&[Affine::translation(0.0, -1.0, 0.0), facing_up(), Affine::scaling(4.0, 4.0, 1.0)]);
    d.shape(rectangle(), floor, grey);
    // One mesh, spread over the floor, near it.
    let place = chain(&[Affine::translation(0.0, -0.95, 0.0), Affine::scaling(4.0, 0.3, 4.0)]);
    d.shape(swarm(2000, 0.01), place, black).emission = glow([20.0; 3]);
    let [power, tree] = [LightChoiceKind::Power, LightChoiceKind::Auto].map(|kind| variance(&by(kind, &d)));
    assert!(power > 3.0 * tree, "{power} {tree}");
}
