//! The estimators against their definitions, and with mistakes in them.
//!
//! Every path of some samples is written out ([`ExplicitPath`]): its value and its weight have to be those that the walks
//! carried. Every strategy has to have the same mean. And every mistake of [`Fault`] has to show.

#[path = "../../tests/common/mod.rs"]
mod common;

use std::collections::BTreeMap;

use lichtweg_montecarlo::hypothesis::{sidak, welch_t_test};
use lichtweg_montecarlo::{Moments, Sampler, SamplerKind};
use lichtweg_ray::math::{Affine, Vec3};

use self::common::build::{
    Build, SPHERE, chain, cube, facing_down, facing_up, float_image, glass, glow, grid, metal, placed,
    plastic, rectangle, rough,
};
use self::common::judge::compare;
use self::common::room::{add_ball, add_block, add_walls, room, stage};
use self::common::run::{Estimator, camera, compile_scene, render_scene};
use super::fault::{Fault, with_fault};
use super::{
    Bidirectional, Contribution, ContributionSink, ExplicitPath, Pair, Sensor, Teller, WalkCounts, Workspace,
};
use crate::camera::Camera;
use crate::scene::Scene;
use crate::scene::description::{
    Description, Diagnostics, EnvironmentMapping, Heuristic, LightKind, MicrofacetKind, SpectrumDescription,
    SpotFalloff,
};

/// Everything that densities have to be right for: materials, normals, a lens, and all kinds of lights.
fn everything(aperture_radius: f32) -> Description {
    let mut d = room(1);
    d.integrator.max_depth = Some(6);
    let glossy = d.material(metal(rough(MicrofacetKind::Ggx, 0.3, 0.5)));
    add_ball(&mut d, glossy);
    let glass_block = d.material(glass(1.5, None));
    add_block(&mut d, glass_block);
    let coated = d.material(plastic([0.2, 0.4, 0.7], None));
    d.shape(SPHERE, placed([0.3, 0.3, 0.4], [0.25; 3]), coated);
    let frosted = d.material(glass(1.4, rough(MicrofacetKind::Beckmann, 0.3, 0.3)));
    let wavy = grid(6, |x, y| Vec3::new(x, y, 0.15 * (4.0 * x).sin() * (3.0 * y).cos()), true);
    d.shape(wavy, placed([-0.2, 0.1, 0.5], [0.4, 0.4, 0.4]), frosted);
    let grey = d.diffuse([0.5; 3]);
    d.shape(SPHERE, placed([0.7, 0.6, 0.1], [0.12; 3]), grey).emission = glow([3.0, 2.0, 1.0]);
    let intensity = SpectrumDescription::Rgb([0.5, 0.7, 1.0]);
    d.light(LightKind::Point { position: Vec3::new(0.7, 0.5, 0.3), intensity: intensity.clone() });
    d.light(LightKind::Spot {
        to_world: chain(&[Affine::translation(-0.2, 0.8, 0.4), facing_down()]),
        intensity: intensity.clone(),
        cutoff: 40.0,
        beam_width: 20.0,
        falloff: SpotFalloff::LinearAngle,
    });
    d.light(LightKind::Directional { direction: Vec3::new(0.2, -0.3, -1.0), irradiance: intensity });
    let pixels: Vec<[f32; 3]> = (0..32).map(|i| [0.1 + 0.02 * i as f32, 0.2, 0.3]).collect();
    let (image, to_world) = (float_image(8, &pixels), Affine::IDENTITY);
    d.light(LightKind::Environment { image, mapping: EnvironmentMapping::LatitudeLongitude, to_world });
    d.camera = camera([0.0, 0.1, 1.6], [0.0, -0.2, -1.0], 70.0);
    d.camera.aperture_radius = aperture_radius;
    d.camera.focus_distance = 1.5;
    d
}

/// Walks from lights that walks from the eye are joined with: more than one, and no divisor of the number of pixels.
const PARTNERS: u32 = 3;

fn tracer(d: &Description) -> Bidirectional {
    Bidirectional::new(&d.integrator).with_partners(PARTNERS).with_lights(2)
}

/// The pairs of one sample of all pixels of a description.
fn pairs(d: &Description, camera: &Camera, pass: u32) -> Vec<Pair> {
    let size = [d.film.width, d.film.height];
    let pair = |i: u32| {
        let mut eye = Sampler::new(SamplerKind::Independent, 1, u64::from(i), pass);
        let light = Sampler::new(SamplerKind::Independent, 2, u64::from(i), pass);
        let [x, y] = eye.next_2d();
        let film = [((i % size[0]) as f32 + x) / size[0] as f32, ((i / size[0]) as f32 + y) / size[1] as f32];
        let ray = camera.ray(film, eye.next_2d(), 0.0);
        Pair { ray, eye, light, expected: 0.0 }
    };
    (0..size[0] * size[1]).map(pair).collect()
}

/// Samples of all pixels of a description, one after the other, and what the sinks make of them.
fn sample_film<S: ContributionSink>(
    d: &Description,
    scene: &Scene,
    passes: u32,
    sink: &mut S,
    mut pass_done: impl FnMut(&mut S),
) {
    let (sensor_camera, size) = sensor_camera(d);
    let sensor = sensor(&sensor_camera, size);
    let tracer = tracer(d);
    let mut workspace = Workspace::default();
    for pass in 0..passes {
        let pairs = pairs(d, &sensor_camera, pass);
        let counts = &mut WalkCounts::default();
        tracer.follow(scene, &sensor, &pairs, pairs.len(), &mut workspace, counts, sink);
        pass_done(sink);
    }
}

fn sensor_camera(d: &Description) -> (Camera, [u32; 2]) {
    let size = [d.film.width, d.film.height];
    let camera = Camera::compile(&d.camera, size[0], size[1], &mut Diagnostics::default());
    (camera.expect("a sound camera"), size)
}

fn sensor(camera: &Camera, size: [u32; 2]) -> Sensor<'_> {
    Sensor::new(camera, size, [0, 0, size[0], size[1]], [0.5; 2])
}

/// Compares what walks carry with what the path says when it is written out.
struct ByDefinition<'p> {
    scene: &'p Scene,
    sensor: Sensor<'p>,
    tracer: Bidirectional,
    seen: BTreeMap<(u32, u32), u32>,
    wrong: Vec<String>,
}

impl ContributionSink for ByDefinition<'_> {
    const UNWEIGHTED: bool = true;
    const ROUTES: bool = true;

    fn add(&mut self, contribution: &Contribution<'_, '_>) {
        let Contribution { s, t, value, weight, .. } = *contribution;
        let Some(path) = ExplicitPath::new(contribution, self.scene, &self.sensor, &self.tracer) else {
            return;
        };
        *self.seen.entry((s, t)).or_default() += 1;
        let total = path.strategies.iter().map(|s| s.weight).sum::<f64>();
        let expected = path.strategies[path.s].weight;
        let estimate = path.estimate();
        let close = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance * (a.abs() + b.abs()) + 1e-7;
        let same_value =
            s + t == 2 || estimate.iter().zip(value.to_rgb()).all(|(a, b)| close(*a, f64::from(b), 2e-4));
        if !((total - 1.0).abs() < 1e-9 && close(expected, f64::from(weight), 2e-3) && same_value) {
            self.wrong.push(format!(
                "({s}, {t}): weight {weight} should be {expected}, value {value:?} should be {estimate:?}: {path:#?}"
            ));
        }
    }
}

fn by_definition(d: &Description, passes: u32) -> (BTreeMap<(u32, u32), u32>, Vec<String>) {
    let scene = compile_scene(d);
    let (camera, size) = sensor_camera(d);
    let mut sink = ByDefinition {
        scene: &scene,
        sensor: sensor(&camera, size),
        tracer: tracer(d),
        seen: BTreeMap::new(),
        wrong: Vec::new(),
    };
    sample_film(d, &scene, passes, &mut sink, |_| ());
    (sink.seen, sink.wrong)
}

/// The recursive weights are those of the definition, and so sum to one; the factors of a path make its value. Cancellation
/// near grazing angles may spoil one path in two thousand.
#[test]
fn paths_are_what_their_factors_say() {
    for (aperture, heuristic) in
        [(0.0, Heuristic::Balance), (0.2, Heuristic::Power), (0.2, Heuristic::Balance)]
    {
        let mut d = everything(aperture);
        d.integrator.heuristic = heuristic;
        let (seen, wrong) = by_definition(&d, 12);
        let paths: u32 = seen.values().sum();
        assert!(paths > 20_000, "{paths}");
        assert!(wrong.len() as u32 <= paths / 2000, "{} of {paths}: {}", wrong.len(), wrong[0]);
        for s in 0..=7 {
            for t in 0..=7 - s {
                // Long walks that hit the lens are rare.
                let expected = s + t >= 2 && (t > 0 || (aperture > 0.0 && s <= 4));
                assert!(
                    !expected || seen.contains_key(&(s, t)),
                    "({s}, {t}) is never seen with lens {aperture}"
                );
            }
        }
    }
}

/// A path: strategy, place, value and weight.
type Made = (u32, u32, Option<[f32; 2]>, [f32; 3], f32);

/// The paths of each pair.
struct Lists(Vec<Vec<Made>>);

impl Lists {
    fn keep(&mut self, c: &Contribution<'_, '_>) {
        self.0[c.sample as usize].push((c.s, c.t, c.film, c.value.to_rgb(), c.weight));
    }
}

/// Makes every walk go alone.
struct Alone<'l>(&'l mut Lists);

impl ContributionSink for Alone<'_> {
    const UNWEIGHTED: bool = true;
    const ROUTES: bool = true;

    fn add(&mut self, c: &Contribution<'_, '_>) {
        self.0.keep(c);
    }
}

/// The paths of some pairs, in rows; each pair's in an order of their own.
fn lists(d: &Description, pairs: &[Pair], row: usize, partners: u32, alone: bool) -> Vec<Vec<Made>> {
    let scene = compile_scene(d);
    let (camera, size) = sensor_camera(d);
    let (mut workspace, mut counts) = (Workspace::default(), WalkCounts::default());
    let tracer = Bidirectional::new(&d.integrator).with_partners(partners).with_lights(partners);
    let mut lists = Lists(vec![Vec::new(); pairs.len()]);
    let sensor = sensor(&camera, size);
    if alone {
        let mut sink = Alone(&mut lists);
        tracer.follow(&scene, &sensor, pairs, row, &mut workspace, &mut counts, &mut sink);
    } else {
        let mut keep = |c: &Contribution<'_, '_>| lists.keep(c);
        let mut sink = Teller(&mut keep);
        tracer.follow(&scene, &sensor, pairs, row, &mut workspace, &mut counts, &mut sink);
    }
    lists.0.iter_mut().for_each(|list| list.sort_by(|a, b| a.partial_cmp(b).expect("no NaN")));
    lists.0
}

/// A room of surfaces that go in lanes, and with some that do not.
fn lobes() -> Description {
    let mut d = room(1);
    d.integrator.max_depth = Some(6);
    let [beckmann, ggx] =
        [MicrofacetKind::Beckmann, MicrofacetKind::Ggx].map(|kind| d.material(metal(rough(kind, 0.3, 0.3))));
    add_ball(&mut d, ggx);
    add_block(&mut d, beckmann);
    let sides = d.two_sided(beckmann);
    let wavy = grid(6, |x, y| Vec3::new(x, y, 0.15 * (4.0 * x).sin() * (3.0 * y).cos()), true);
    d.shape(wavy, placed([-0.2, 0.1, 0.5], [0.4, 0.4, 0.4]), sides);
    let coated = d.material(plastic([0.2, 0.4, 0.7], None));
    d.shape(SPHERE, placed([0.3, 0.3, 0.4], [0.25; 3]), coated);
    d
}

/// Walks in lanes bring what walks bring that go alone, to the bit: the one is written for sixteen lanes, the other for one.
#[test]
fn lanes_bring_what_walks_bring_alone() {
    for (mut d, heuristic) in [
        (lobes(), Heuristic::Power),
        (lobes(), Heuristic::Balance),
        (everything(0.0), Heuristic::Power),
        (everything(0.2), Heuristic::Power),
    ] {
        d.integrator.heuristic = heuristic;
        let (camera, _) = sensor_camera(&d);
        let pairs = pairs(&d, &camera, 0);
        let (lanes, alone) = (lists(&d, &pairs, 32, 3, false), lists(&d, &pairs, 32, 3, true));
        let paths: usize = alone.iter().map(Vec::len).sum();
        assert!(paths > 2000, "{paths}");
        for (i, (lanes, alone)) in lanes.iter().zip(&alone).enumerate() {
            assert_eq!(lanes.len(), alone.len(), "pair {i}: {lanes:?} {alone:?}");
            for (a, b) in lanes.iter().zip(alone) {
                assert_eq!(a, b, "pair {i}");
            }
        }
    }
}

/// Pairs that are followed together bring what they bring alone, to the bit and in the same order, unless they share walks: and then
/// what the pairs of their row bring.
#[test]
fn pairs_go_together_as_they_go_alone() {
    let d = everything(0.2);
    let scene = compile_scene(&d);
    let (camera, size) = sensor_camera(&d);
    let sensor = sensor(&camera, size);
    let (mut workspace, mut counts) = (Workspace::default(), WalkCounts::default());
    let mut pairs = pairs(&d, &camera, 0);
    pairs.truncate(960);
    // Every other pair plays for its connections.
    pairs.iter_mut().step_by(2).for_each(|pair| pair.expected = 1.0);
    for (partners, row) in [(1, 1), (3, 32)] {
        let tracer = Bidirectional::new(&d.integrator).with_partners(partners).with_lights(partners);
        let mut follow = |pairs: &[Pair]| {
            let mut lists = Lists(vec![Vec::new(); pairs.len()]);
            let mut keep = |c: &Contribution<'_, '_>| lists.keep(c);
            let mut sink = Teller(&mut keep);
            tracer.follow(&scene, &sensor, pairs, row, &mut workspace, &mut counts, &mut sink);
            lists.0
        };
        let together = follow(&pairs);
        let alone: Vec<_> = pairs.chunks(row).flat_map(&mut follow).collect();
        assert!(together.iter().map(Vec::len).sum::<usize>() > 1000, "{partners} partners");
        assert!(together == alone, "{partners} partners");
    }
}

/// Image means of every strategy, unweighted.
#[derive(Default)]
struct Means {
    pixels: f64,
    sums: BTreeMap<(u32, u32), f64>,
    moments: BTreeMap<(u32, u32), Moments>,
}

impl ContributionSink for Means {
    const UNWEIGHTED: bool = true;
    const ROUTES: bool = true;

    fn add(&mut self, c: &Contribution<'_, '_>) {
        if c.film.is_none_or(|[x, y]| (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y)) {
            *self.sums.entry((c.s, c.t)).or_default() += f64::from(c.value.to_rgb()[0]) / self.pixels;
        }
    }
}

/// Where all strategies can make all paths, all have the same mean: a rough room and a lens in it. One family of Welch tests at
/// 0.01.
#[test]
fn strategies_have_the_same_mean() {
    let mut d = stage(1);
    add_walls(&mut d);
    d.integrator.max_depth = Some(3);
    (d.film.width, d.film.height) = (16, 16);
    let white = d.diffuse([0.7; 3]);
    let large = chain(&[Affine::translation(0.0, 0.9, 0.2), facing_down(), Affine::scaling(0.8, 0.8, 1.0)]);
    d.shape(rectangle(), large, white).emission = glow([4.0; 3]);
    let glossy = d.material(plastic([0.5; 3], rough(MicrofacetKind::Ggx, 0.5, 0.5)));
    d.shape(cube(), placed([0.3, -0.6, -0.3], [0.3, 0.4, 0.3]), glossy);
    d.camera = camera([0.0, -0.4, 0.8], [0.0, 0.3, -1.0], 80.0);
    d.camera.aperture_radius = 0.5;
    d.camera.focus_distance = 1.0;
    let scene = compile_scene(&d);
    let mut means = Means { pixels: 256.0, ..Default::default() };
    sample_film(&d, &scene, 600, &mut means, |means| {
        for s in 0..=4_u32 {
            for t in 0..=4 - s {
                if s + t >= 2 {
                    let sum = means.sums.remove(&(s, t)).unwrap_or(0.0);
                    means.moments.entry((s, t)).or_default().push(sum);
                }
            }
        }
    });
    let estimate = |m: &Moments| (m.mean(), m.variance_of_mean(), (m.count() - 1) as f64);
    for length in 1..=3 {
        let reference = &means.moments[&(0, length + 1)];
        assert!(reference.mean() > 0.01);
        for s in 1..=length + 1 {
            let other = &means.moments[&(s, length + 1 - s)];
            let outcome = welch_t_test(estimate(reference), estimate(other));
            assert!(
                !outcome.rejects(sidak(0.01, 9)),
                "length {length}, s {s}: {} and {}: {outcome:?}",
                reference.mean(),
                other.mean()
            );
        }
    }
}

/// A scene on which a mistake matters.
fn scene_for(fault: Fault) -> Description {
    let mut d = room(128);
    d.integrator.max_depth = Some(4);
    match fault {
        Fault::EtaSquared => {
            // What lies behind the pane is lit and seen through it alone.
            let pane = d.material(glass(1.5, rough(MicrofacetKind::Ggx, 0.4, 0.4)));
            let place =
                chain(&[Affine::translation(0.0, 0.0, 0.1), facing_up(), Affine::scaling(0.99, 0.99, 1.0)]);
            d.shape(rectangle(), place, pane);
        }
        Fault::ShadingNormal => {
            let white = d.diffuse([0.8; 3]);
            let wavy = grid(8, |x, y| Vec3::new(x, y, 0.2 * (4.0 * x).sin() * (3.0 * y).cos()), true);
            let carpet =
                chain(&[Affine::translation(0.0, -0.6, 0.0), facing_up(), Affine::scaling(0.9, 0.9, 1.0)]);
            d.shape(wavy, carpet, white);
        }
        Fault::DistantDensity => {
            d.light(LightKind::Directional {
                direction: Vec3::new(0.2, -0.5, -1.0),
                irradiance: SpectrumDescription::Constant(2.0),
            });
        }
        Fault::Importance => {
            d.camera = camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 120.0);
        }
        Fault::LightChoice => {
            let black = d.diffuse([0.0; 3]);
            d.shape(SPHERE, placed([0.2, -0.5, 0.2], [0.3; 3]), black).emission = glow([1.0; 3]);
            d.shape(SPHERE, placed([-0.6, 0.2, -0.2], [0.05; 3]), black).emission = glow([40.0; 3]);
        }
        Fault::Cosine | Fault::Weights => {}
    }
    d
}

const FAULTS: [Fault; 7] = [
    Fault::Cosine,
    Fault::EtaSquared,
    Fault::ShadingNormal,
    Fault::Weights,
    Fault::DistantDensity,
    Fault::Importance,
    Fault::LightChoice,
];

/// Mistakes in the adjoint show in light tracing, mistakes in weights in bidirectional path tracing; without a mistake there is no
/// difference. The comparison is that of the agreement tests.
#[test]
fn seeded_faults_are_found() {
    for fault in FAULTS {
        let mut d = scene_for(fault);
        let scene = compile_scene(&d);
        let mut image = |estimator: Estimator, seed: u64, fault: Option<Fault>| {
            estimator.choose(&mut d);
            d.sampler.seed = seed;
            with_fault(fault, || render_scene(&scene, &d))
        };
        let truth = image(Estimator::MisPower, 1, None);
        let suspects = match fault {
            Fault::Weights | Fault::DistantDensity | Fault::LightChoice => Estimator::BidirectionalBalance,
            _ => Estimator::Light,
        };
        let honest = compare(&truth, &image(suspects, 2, None));
        assert!(!honest.rejects_among(FAULTS.len()), "{fault:?} is seen where it is not: {honest:?}");
        let faulty = compare(&truth, &image(suspects, 2, Some(fault)));
        assert!(faulty.rejects_among(FAULTS.len()), "{fault:?} goes unnoticed: {faulty:?}");
    }
}
