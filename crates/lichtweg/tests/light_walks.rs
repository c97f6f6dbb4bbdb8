//! Walks from the lights carry power: what is emitted is absorbed or escapes, closed rooms have as many hits as their albedo
//! asks for, and what falls on a surface is what geometry says.

mod common;

use std::f64::consts::PI;

use common::build::{Build, SPHERE, chain, facing_up, glow, placed, rectangle};
use common::judge::moments_outcome;
use common::room::{add_ball, stage};
use common::run::compile_scene;
use lichtweg::bsdf::Mode;
use lichtweg::scene::Scene;
use lichtweg::scene::description::{
    Description, GeometryDescription, Heuristic, LightKind, MaterialKind, SpectrumDescription, TextureInput,
};
use lichtweg::transport::{
    Crowd, Departure, LightStart, Survival, Trail, Traveller, Vertex, Walk, WalkCounts, WalkVisitor,
};
use lichtweg_montecarlo::{Moments, Sampler, SamplerKind};
use lichtweg_ray::math::{Affine, Vec3};

/// Level of each test.
const ALPHA: f64 = 1e-3;

/// Keeps the departure that left the scene.
#[derive(Default)]
struct Escape(Option<Departure>);

impl WalkVisitor for Escape {
    fn escapes(&mut self, traveller: &Traveller, _: Trail<'_, '_>, _: u32) {
        self.0 = Some(traveller.departure);
    }
}

/// Walks from the lights of a scene: each one's power, vertices, and departure out of the scene.
fn walks(scene: &Scene, number: u32, mut each: impl FnMut([f32; 3], &[Vertex<'_>], Option<Departure>)) {
    let walk = Walk {
        scene,
        mode: Mode::Importance,
        heuristic: Heuristic::Balance,
        survival: Survival::Analog,
        max_vertices: usize::MAX,
        leaves_last: false,
    };
    let (mut path, mut counts, mut crowd) = (Vec::new(), WalkCounts::default(), Crowd::default());
    for i in 0..number {
        let mut sampler = Sampler::new(SamplerKind::Independent, 5, 6, i);
        let Some(start) = LightStart::sample(scene, &mut sampler) else { continue };
        path.clear();
        let departure = start.depart(0.0, 1.0);
        crowd.push(Traveller::new(0, departure, sampler));
        let mut escape = Escape::default();
        walk.run(&mut crowd, &mut counts, &mut path, &mut escape);
        each(start.emission.power.to_rgb(), &path, escape.0);
    }
}

/// In every channel, the mean power of walks is that of the lights, and what surfaces absorb and what escapes adds up to it.
#[test]
fn energy_is_conserved() {
    const ALBEDO: [f32; 3] = [0.8, 0.5, 0.2];
    let mut d = stage(1);
    let painted = d.diffuse(ALBEDO);
    let painted = d.two_sided(painted);
    d.shape(rectangle(), chain(&[Affine::translation(0.0, -1.0, 0.0), facing_up()]), painted);
    add_ball(&mut d, painted);
    // One-sided, with the area 4, and a sphere of radius 0.2 that lights its surroundings.
    d.shape(rectangle(), Affine::translation(0.0, 0.0, -1.0), painted).emission = glow([1.0, 2.0, 3.0]);
    d.shape(SPHERE, placed([0.4, 0.2, 0.3], [0.2; 3]), painted).emission = glow([4.0, 2.0, 1.0]);
    let scene = compile_scene(&d);
    let (mut emitted, mut balance) = ([Moments::default(); 3], [Moments::default(); 3]);
    walks(&scene, 200_000, |power, path, escaped| {
        let out = escaped.map_or([0.0; 3], |d| d.throughput.to_rgb());
        for c in 0..3 {
            let absorbed: f32 = path.iter().map(|v| v.throughput.to_rgb()[c] * (1.0 - ALBEDO[c])).sum();
            emitted[c].push(f64::from(power[c]));
            balance[c].push(f64::from(absorbed + out[c]));
        }
    });
    for c in 0..3 {
        let radiance = [[1.0, 4.0], [2.0, 2.0], [3.0, 1.0]][c];
        let expected = PI * (4.0 * radiance[0] + 4.0 * PI * 0.04 * radiance[1]);
        for moments in [&emitted[c], &balance[c]] {
            let outcome = moments_outcome(moments, expected, 1e-5);
            assert!(!outcome.rejects(ALPHA), "channel {c}: {} instead of {expected}", moments.mean());
        }
        // Power: one percent would show.
        assert!(moments_outcome(&balance[c], 1.01 * expected, 1e-5).rejects(ALPHA));
    }
}

/// In a closed room of albedo rho, a walk hits 1 / (1 - rho) times, and all that it carries is absorbed.
#[test]
fn closed_rooms_have_their_hits() {
    for albedo in [0.3_f32, 0.7, 0.9] {
        let mut d = stage(1);
        let wall = d.diffuse([albedo; 3]);
        d.shape(SPHERE, Affine::IDENTITY, wall).flip_normals = true;
        let intensity = SpectrumDescription::Constant(1.0);
        d.light(LightKind::Point { position: Vec3::new(0.2, 0.3, -0.1), intensity });
        let scene = compile_scene(&d);
        let mut hits = Moments::default();
        walks(&scene, 100_000, |_, path, escaped| {
            assert!(escaped.is_none());
            hits.push(path.len() as f64);
        });
        let expected = 1.0 / (1.0 - f64::from(albedo));
        assert!(!moments_outcome(&hits, expected, 1e-5).rejects(ALPHA), "{} {expected}", hits.mean());
        assert!(moments_outcome(&hits, 1.02 * expected, 1e-5).rejects(ALPHA));
    }
}

/// A lamp of power Phi lights a patch by way of a mirror: rho Phi cos / (4 pi d^2) per area, as if it stood behind the mirror.
#[test]
fn mirrors_deposit_what_geometry_says() {
    const RHO: f32 = 0.8;
    let mut d = stage(1);
    // F = 1 where eta = 0.
    let mirror = d.material(MaterialKind::Conductor {
        eta: TextureInput::number(0.0),
        k: TextureInput::number(1.0),
        roughness: None,
        specular_reflectance: TextureInput::number(RHO),
    });
    let black = d.diffuse([0.0; 3]);
    // The mirror is the plane y = 0; the patch hangs above it and faces down.
    d.shape(rectangle(), chain(&[facing_up(), Affine::scaling(5.0, 5.0, 1.0)]), mirror);
    let down = Affine::rotation([1.0, 0.0, 0.0], 90.0);
    let patch = chain(&[Affine::translation(1.0, 1.0, 0.0), down, Affine::scaling(0.2, 0.2, 1.0)]);
    d.shape(rectangle(), patch, black);
    let lamp = Vec3::new(0.0, 1.5, 0.0);
    d.light(LightKind::Point { position: lamp, intensity: SpectrumDescription::Constant(1.0) });
    let scene = compile_scene(&d);
    let mut deposits = Moments::default();
    walks(&scene, 2_000_000, |_, path, _| {
        let deposit = path.get(1).filter(|v| v.point.shape == 1).map_or(0.0, |v| v.throughput.0[0]);
        deposits.push(f64::from(deposit) / 0.16);
    });
    // Averaged over the patch, from the lamp's image at y = -1.5.
    let at = |i: usize| (i as f64 + 0.5) / 32.0 * 0.4 - 0.2;
    let irradiance = |x: f64, z: f64| {
        let (dx, dy) = (1.0 + x, 2.5_f64);
        let d2 = dx * dx + dy * dy + z * z;
        f64::from(RHO) * 4.0 * PI * (dy / d2.sqrt()) / (4.0 * PI * d2)
    };
    let expected = (0..1024).map(|i| irradiance(at(i % 32), at(i / 32))).sum::<f64>() / 1024.0;
    let outcome = moments_outcome(&deposits, expected, 1e-4);
    assert!(!outcome.rejects(ALPHA), "{} instead of {expected}: {outcome:?}", deposits.mean());
    assert!(moments_outcome(&deposits, expected / f64::from(RHO), 1e-4).rejects(ALPHA));
}

/// All kinds of lights emit the power they have.
#[test]
fn lights_emit_their_power() {
    let emitted = |build: &dyn Fn(&mut Description)| {
        let mut d = stage(1);
        let black = d.diffuse([0.0; 3]);
        d.shape(SPHERE, placed([1.0, 2.0, 3.0], [0.5; 3]), black);
        build(&mut d);
        let scene = compile_scene(&d);
        let mut power = Moments::default();
        walks(&scene, 100_000, |p, _, _| power.push(f64::from(p[0])));
        (power, f64::from(scene.surroundings().radius))
    };
    let constant = SpectrumDescription::Constant;
    let (point, _) =
        emitted(&|d| d.light(LightKind::Point { position: Vec3::ZERO, intensity: constant(2.0) }));
    assert!((point.mean() - 8.0 * PI).abs() < 1e-4);
    let irradiance = || constant(3.0);
    let (sun, r) =
        emitted(&|d| d.light(LightKind::Directional { direction: Vec3::Y, irradiance: irradiance() }));
    assert!((sun.mean() / (3.0 * PI * r * r) - 1.0).abs() < 1e-4);
    let (sky, r) = emitted(&|d| d.light(LightKind::Constant { radiance: constant(0.5) }));
    assert!((sky.mean() / (2.0 * PI * PI * r * r) - 1.0).abs() < 1e-4);
    let cut = || GeometryDescription::Sphere { z_min: -0.5, z_max: 0.5, phi_max: 180.0 };
    let (shell, _) = emitted(&|d| {
        let black = d.diffuse([0.0; 3]);
        let mut emission = glow([2.0; 3]).expect("emits");
        emission.two_sided = true;
        d.shape(cut(), Affine::scaling(1.0, 1.0, 2.0), black).emission = Some(emission);
    });
    // The area of half the belt of a spheroid: pi times the integral of sqrt(r^2 + (r r')^2) over its axis.
    let belt = |z: f64| (4.0 - 0.75 * z * z).sqrt() * 0.5;
    let area = (0..2000).map(|i| belt((i as f64 + 0.5) / 1000.0 - 1.0) / 1000.0).sum::<f64>() * PI;
    let outcome = moments_outcome(&shell, 2.0 * 2.0 * PI * area, 1e-4);
    assert!(!outcome.rejects(ALPHA), "{} instead of {}", shell.mean(), 4.0 * PI * area);
}
