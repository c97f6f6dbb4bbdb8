//! An image is the same bits for any number of threads, any cut into passes, and any other way to get at the same samples.

mod common;

use std::time::Duration;

use common::build::{Build, glass, plastic, rough};
use common::room::{add_ball, add_block, room};
use common::run::{Estimator, compile_job, compile_scene, render_scene};
use lichtweg::render::{Job, LayerSelection, Progress, Rendering};
use lichtweg::scene::description::{
    Description, Diagnostics, LightKind, MaterialKind, MicrofacetKind, SpectrumDescription, TextureInput,
};
use lichtweg_montecarlo::SamplerKind;

/// A bit of everything that draws random numbers, on a film that is no multiple of a tile.
fn description() -> Description {
    let mut d = room(16);
    (d.film.width, d.film.height) = (53, 37);
    d.film.filter = Default::default();
    d.camera.aperture_radius = 0.1;
    d.camera.focus_distance = 3.5;
    d.integrator.max_depth = None;
    let ball = d.material(glass(1.5, rough(MicrofacetKind::Ggx, 0.2, 0.2)));
    let coat = d.material(plastic([0.5, 0.3, 0.2], None));
    let veil = d.material(MaterialKind::Mask { opacity: TextureInput::number(0.7), nested: coat });
    add_ball(&mut d, ball);
    add_block(&mut d, veil);
    d.light(LightKind::Constant { radiance: SpectrumDescription::Constant(0.1) });
    d
}

fn render_with_threads(threads: usize, description: &Description) -> Rendering {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
    pool.install(|| {
        // The hierarchy is built by the same threads.
        let scene = compile_scene(description);
        compile_job(description).render(&scene, &Progress::default()).expect("not stopped")
    })
}

#[test]
fn threads_do_not_matter() {
    for kind in [SamplerKind::Independent, SamplerKind::Sobol] {
        for estimator in Estimator::ALL.into_iter().chain(Estimator::ADJOINT) {
            let mut d = description();
            d.sampler.kind = kind;
            estimator.choose(&mut d);
            let one = render_with_threads(1, &d);
            for threads in [2, 7] {
                let other = render_with_threads(threads, &d);
                assert!(
                    one.image == other.image,
                    "{kind:?}, {estimator:?}: {threads} threads differ from one"
                );
                assert_eq!(one.statistics.walks, other.statistics.walks);
            }
        }
    }
}

/// A render that a time limit ends is the render of as many samples, wherever its passes were cut.
#[test]
fn passes_do_not_matter() {
    for (milliseconds, estimator) in [
        (1, Estimator::MisPower),
        (40, Estimator::MisPower),
        (150, Estimator::MisPower),
        (40, Estimator::Light),
        (150, Estimator::BidirectionalPower),
    ] {
        let mut d = description();
        estimator.choose(&mut d);
        d.sampler.samples_per_pixel = 1 << 20;
        let scene = compile_scene(&d);
        let limit = Some(Duration::from_millis(milliseconds));
        let mut diagnostics = Diagnostics::default();
        let job = Job::compile(&d, LayerSelection::default(), limit, &mut diagnostics).expect("compiles");
        let limited = job.render(&scene, &Progress::default()).expect("not stopped");
        d.sampler.samples_per_pixel = limited.statistics.samples_per_pixel;
        assert!(
            limited.image == render_scene(&scene, &d),
            "{estimator:?}: limit of {milliseconds} ms differs"
        );
    }
}

/// The same for one that is asked to stop from outside.
#[test]
fn stopping_does_not_matter() {
    let mut d = description();
    d.sampler.samples_per_pixel = 1 << 20;
    let scene = compile_scene(&d);
    let job = compile_job(&d);
    let progress = Progress::default();
    let stopped = std::thread::scope(|scope| {
        let rendering = scope.spawn(|| job.render(&scene, &progress));
        while progress.passes() < 3 {
            std::thread::yield_now();
        }
        progress.stop();
        rendering.join().expect("does not panic").expect("three passes are complete")
    });
    assert!(stopped.statistics.passes >= 3);
    assert!(stopped.statistics.samples_per_pixel < 1 << 20);
    d.sampler.samples_per_pixel = stopped.statistics.samples_per_pixel;
    assert!(stopped.image == render_scene(&scene, &d));
}

/// More samples begin with the same ones: nine are eight and one more.
#[test]
fn samples_do_not_depend_on_their_number() {
    for kind in [SamplerKind::Independent, SamplerKind::Sobol] {
        let mut d = description();
        d.sampler.kind = kind;
        let scene = compile_scene(&d);
        let mut sum_of = |samples| {
            d.sampler.samples_per_pixel = samples;
            render_scene(&scene, &d).pixels
        };
        let (few, many) = (sum_of(8), sum_of(9));
        // One sample more changes sums by that sample, which is not negative under a positive filter.
        assert!(few.iter().zip(&many).all(|(a, b)| b.count == a.count + 1 && b.sum[0] >= a.sum[0]));
    }
}

/// What must make a difference does: the seed, the estimator, one sample more.
#[test]
fn the_comparison_can_fail() {
    let d = description();
    let scene = compile_scene(&d);
    let image = render_scene(&scene, &d);
    let changes: [fn(&mut Description); 4] = [
        |d| d.sampler.seed = 1,
        |d| d.sampler.samples_per_pixel += 1,
        |d| d.sampler.kind = SamplerKind::Sobol,
        |d| Estimator::Nee.choose(d),
    ];
    for change in changes {
        let mut other = d.clone();
        change(&mut other);
        assert!(image != render_scene(&scene, &other));
    }
    assert!(image == render_scene(&scene, &d));
}

/// Layers besides radiance are looked at on the way, and change nothing.
#[test]
fn observers_do_not_matter() {
    let d = description();
    let scene = compile_scene(&d);
    let layers = LayerSelection { variance: true, albedo: true, normal: true, depth: true };
    let mut diagnostics = Diagnostics::default();
    let job = Job::compile(&d, layers, None, &mut diagnostics).expect("compiles");
    let observed = job.render(&scene, &Progress::default()).expect("not stopped").image;
    assert!(observed.pixels == render_scene(&scene, &d).pixels);
    assert_eq!(observed.auxiliary.len(), observed.pixels.len());
}

/// The weighted images of all strategies are the image: of the same samples, as long as all connections are looked at, which is so for
/// the first sample of each pixel.
#[test]
fn strategies_sum_to_the_image() {
    let mut d = description();
    Estimator::BidirectionalPower.choose(&mut d);
    d.integrator.max_depth = Some(5);
    d.sampler.samples_per_pixel = 1;
    let scene = compile_scene(&d);
    let image = render_scene(&scene, &d);
    let pyramid = compile_job(&d).render_pyramid(&d, 5, &scene, &Progress::default());
    assert_eq!(pyramid.samples_per_pixel, 1);
    let means: Vec<[f64; 3]> = image.pixels.iter().map(|p| p.mean()).collect();
    let largest = means.iter().flatten().copied().fold(0.0, f64::max);
    assert!(largest > 0.1);
    for (i, mean) in means.iter().enumerate() {
        for (lane, mean) in mean.iter().enumerate() {
            let sum: f64 = pyramid.strategies.iter().map(|s| s.weighted[i][lane]).sum();
            assert!((sum - mean).abs() <= 1e-5 * largest, "pixel {i}: {sum} is not {mean}");
        }
    }
}
