//! What must not change the mean: roulette, the point set, the reconstruction filter.
//!
//! Each function is one family of tests with a probability of a false alarm of 0.01.

mod common;

use common::build::{Build, SPHERE, bitmap, glass, glow_input, metal, placed, rectangle, rough};
use common::judge::{assert_pairwise_agreement, expectation};
use common::room::{add_ball, add_block, room, stage};
use common::run::{Estimator, compile_scene, render, render_scene};
use lichtweg::scene::description::{
    Description, FilterDescription, FilterKind, MicrofacetKind, RouletteDescription, TextureFilter,
    TextureInput,
};
use lichtweg_montecarlo::hypothesis::{sidak, welch_t_test, z_test};
use lichtweg_montecarlo::{Moments, SamplerKind};

/// A room with glass and metal in it, whose paths are long.
fn long_paths(samples_per_pixel: u32) -> Description {
    let mut d = room(samples_per_pixel);
    let ball = d.material(glass(1.5, None));
    let block = d.material(metal(rough(MicrofacetKind::Ggx, 0.2, 0.2)));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    d
}

/// Ending paths at random from any depth, or never up to a depth behind which less than 10^-5 is left, or never at all.
#[test]
fn roulette_is_fair() {
    let options = [(None, Some(40)), (Some(5), Some(40)), (Some(1), Some(40)), (Some(2), None)];
    let images: Vec<_> = options
        .into_iter()
        .enumerate()
        .map(|(seed, (start_depth, max_depth))| {
            let mut d = long_paths(256);
            d.sampler.seed = seed as u64;
            d.integrator.max_depth = max_depth;
            d.integrator.roulette = RouletteDescription { start_depth };
            Estimator::MisPower.choose(&mut d);
            (format!("roulette from {start_depth:?}, {max_depth:?} edges"), render(&d))
        })
        .collect();
    assert_pairwise_agreement("roulette", &images);
}

/// The spread of Sobol' samples does not tell the error of their mean: it is taken from independent scramblings.
#[test]
fn point_sets_have_the_same_mean() {
    let mut d = long_paths(16);
    let scene = compile_scene(&d);
    let moments = [SamplerKind::Independent, SamplerKind::Sobol].map(|kind| {
        d.sampler.kind = kind;
        let mut blocks = vec![Moments::default(); 17];
        for seed in 0..24 {
            d.sampler.seed = 1000 * kind as u64 + seed;
            let image = render_scene(&scene, &d);
            let mut sums = [0.0; 16];
            for (i, pixel) in image.pixels.iter().enumerate() {
                sums[(i / 256) * 4 + (i % 32) / 8] += pixel.mean().iter().sum::<f64>() / (3.0 * 64.0);
            }
            blocks.iter_mut().zip(sums).for_each(|(moments, sum)| moments.push(sum));
            blocks[16].push(sums.iter().sum::<f64>() / 16.0);
        }
        blocks
    });
    let [independent, sobol] = &moments;
    for (i, (a, b)) in independent.iter().zip(sobol).enumerate() {
        let estimate = |m: &Moments| (m.mean(), m.variance_of_mean(), (m.count() - 1) as f64);
        let outcome = welch_t_test(estimate(a), estimate(b));
        assert!(!outcome.rejects(sidak(0.01, independent.len())), "block {i}: {outcome:?}, {a:?}, {b:?}");
    }
    let [a, b] = moments.map(|blocks| blocks[16].variance());
    assert!(b < 0.7 * a, "Sobol' points are not better: variance {b} against {a}");
}

fn filters() -> [FilterDescription; 6] {
    [
        FilterDescription::BOX,
        FilterDescription::new(FilterKind::Tent, 1.0),
        FilterDescription::default(),
        FilterDescription::new(FilterKind::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }, 2.0),
        FilterDescription::new(FilterKind::CatmullRom, 2.0),
        FilterDescription::new(FilterKind::Lanczos { lobes: 3.0 }, 3.0),
    ]
}

/// A glowing wall that fills the view with a margin, and grows brighter from left to right and from below.
fn gradient() -> Description {
    let mut d = stage(1024);
    d.integrator.max_depth = Some(1);
    let black = d.diffuse([0.0; 3]);
    // Bilinear look-ups are linear between the centres of two texels: the middle half of the wall.
    let pixels = [[2.0, 1.0, 1.0], [4.0, 1.0, 3.0], [1.0, 1.0, 0.0], [3.0, 1.0, 2.0]];
    let wall = d.texture(bitmap(2, &pixels, TextureFilter::Bilinear));
    d.shape(rectangle(), placed([0.0; 3], [4.0, 4.0, 1.0]), black).emission = glow_input(wall);
    d
}

/// A symmetric filter of unit integral leaves linear images alone: every pixel shows the value at its centre.
#[test]
fn filters_preserve_gradients() {
    let half_width = 3.6 * (21.0_f64).to_radians().tan();
    for filter in filters() {
        let mut d = gradient();
        d.film.filter = filter;
        let image = render(&d);
        let level = sidak(0.01, 6 * 3 * image.pixels.len());
        for (i, pixel) in image.pixels.iter().enumerate() {
            let at = |p: usize| ((p as f64 + 0.5) / 16.0 - 1.0) * half_width;
            let (x, y) = (at(i % 32), -at(i / 32));
            // From -2 to 2 the two texels' values.
            let (s, t) = (0.25 * (x + 2.0), 0.25 * (y + 2.0));
            let expected = [1.0 + 2.0 * s + t, 1.0, 2.0 * s + t];
            let (mean, variance) = (pixel.mean(), pixel.variance_of_mean());
            for channel in 0..3 {
                let difference = mean[channel] - expected[channel];
                let outcome = z_test(difference, variance[channel] + (1e-5 * expected[channel]).powi(2));
                assert!(!outcome.rejects(level), "{filter:?}, pixel {i}, channel {channel}: {outcome:?}");
            }
        }
    }
}

/// Filters without negative lobes leave an even image exactly alone.
#[test]
fn filters_preserve_constants() {
    for filter in filters() {
        let mut d = stage(256);
        d.integrator.max_depth = Some(1);
        let black = d.diffuse([0.0; 3]);
        let even = glow_input(TextureInput::rgb([1.0, 2.0, 3.0]));
        d.shape(rectangle(), placed([0.0; 3], [4.0, 4.0, 1.0]), black).emission = even;
        d.film.filter = filter;
        let image = render(&d);
        let positive =
            matches!(filter.kind, FilterKind::Box | FilterKind::Tent | FilterKind::Gaussian { .. });
        if positive {
            assert!(image.pixels.iter().all(|p| (p.mean()[1] - 2.0).abs() < 1e-5), "{filter:?}");
        }
        for (mean, outcome) in expectation(&image, [1.0, 2.0, 3.0], 1e-5) {
            assert!(!outcome.rejects(sidak(0.01, 18)), "{filter:?}: {mean} {outcome:?}");
        }
    }
}

/// What a filter does to an edge: the mean of the pixels over a small bright ball keeps the energy of the ball.
#[test]
fn filters_preserve_energy() {
    let mut energies = Vec::new();
    for (seed, filter) in filters().into_iter().enumerate() {
        let mut d = stage(1024);
        d.integrator.max_depth = Some(1);
        d.sampler.seed = seed as u64;
        let black = d.diffuse([0.0; 3]);
        d.shape(SPHERE, placed([0.1, -0.2, 0.0], [0.3; 3]), black).emission =
            glow_input(TextureInput::number(5.0));
        d.film.filter = filter;
        let (mean, error) = render(&d).mean();
        energies.push((filter, mean[0], error[0]));
    }
    for (filter, mean, error) in &energies[1..] {
        let outcome = z_test(mean - energies[0].1, error * error + energies[0].2.powi(2));
        assert!(!outcome.rejects(sidak(0.01, 5)), "{filter:?}: {outcome:?}");
    }
    let (_, mean, error) = energies[0];
    assert!(error < 0.005 * mean, "too noisy to tell: {error} of {mean}");
}
