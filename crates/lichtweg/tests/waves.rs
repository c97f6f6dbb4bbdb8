//! Walks that go together are the walks that go alone: a wave gives each path the radiance of [`PathTracer::radiance`], to
//! the bit, whatever else is in the wave. The one is written for sixteen lanes, the other for one, so this holds the two
//! to the same formulas.

mod common;

use common::build::{
    Build, SPHERE, bitmap, checkerboard, glass, glow, grid, metal, placed, plastic, rectangle, rough,
};
use common::gallery;
use common::room::{add_ball, add_block, room};
use common::run::{Estimator, compile_scene};
use lichtweg::camera::Camera;
use lichtweg::color::Spectrum;
use lichtweg::scene::Scene;
use lichtweg::scene::description::{
    AreaLightDescription, Description, Diagnostics, LightKind, MaterialId, MaterialKind, MicrofacetKind,
    RoughnessDescription, RouletteDescription, SpectrumDescription, TextureFilter, TextureInput,
};
use lichtweg::transport::{PathTracer, WalkCounts, Wave};
use lichtweg_montecarlo::{Sampler, SamplerKind};
use lichtweg_ray::Ray;
use lichtweg_ray::math::{Affine, Vec3};

/// Paths of a wave: no multiple of sixteen, and fewer than a wave can hold.
const PATHS: u32 = 1501;

/// Camera rays all over the image, with what is left of their random numbers.
fn starts(d: &Description, kind: SamplerKind) -> Vec<(Ray, Sampler)> {
    let camera = Camera::compile(&d.camera, 32, 32, &mut Diagnostics::default()).expect("a sound camera");
    let start = |path: u32| {
        let mut sampler = Sampler::new(kind, 7, u64::from(path), 0);
        let (film, lens, time) = (sampler.next_2d(), sampler.next_2d(), sampler.next_1d());
        (camera.ray(film, lens, time), sampler)
    };
    (0..PATHS).map(start).collect()
}

fn alone(scene: &Scene, tracer: &PathTracer, starts: &[(Ray, Sampler)]) -> (Vec<Spectrum>, WalkCounts) {
    let mut counts = WalkCounts::default();
    let one = |(ray, sampler): &(Ray, Sampler)| tracer.radiance(scene, *ray, *sampler, &mut counts, &mut ());
    (starts.iter().map(one).collect(), counts)
}

fn together(scene: &Scene, tracer: &PathTracer, starts: &[(Ray, Sampler)]) -> (Vec<Spectrum>, WalkCounts) {
    let mut counts = WalkCounts::default();
    let mut wave = Wave::new(starts[0].1.kind());
    starts.iter().for_each(|(ray, sampler)| wave.push(ray, *sampler));
    tracer.follow(scene, &mut wave, &mut counts, &mut ());
    (wave.radiance().to_vec(), counts)
}

fn check(what: &str, d: &mut Description) {
    let scene = compile_scene(d);
    for kind in [SamplerKind::Independent, SamplerKind::Sobol] {
        let starts = starts(d, kind);
        for estimator in Estimator::ALL {
            for max_depth in [Some(1), Some(4), None] {
                estimator.choose(d);
                d.integrator.max_depth = max_depth;
                d.integrator.roulette = RouletteDescription { start_depth: Some(3) };
                let tracer = PathTracer::new(&d.integrator);
                let (expected, expected_counts) = alone(&scene, &tracer, &starts);
                let (found, counts) = together(&scene, &tracer, &starts);
                let different = expected.iter().zip(&found).filter(|(a, b)| a != b).count();
                assert_eq!(different, 0, "{what}, {kind:?}, {estimator:?}, {max_depth:?}");
                assert_eq!(counts, expected_counts, "{what}, {kind:?}, {estimator:?}, {max_depth:?}");
                assert!(max_depth == Some(1) || expected.iter().any(|r| !r.is_zero()), "{what}: all black");
            }
        }
    }
}

#[test]
fn diffuse_triangles() {
    let mut d = room(1);
    let grey = d.diffuse([0.4, 0.5, 0.6]);
    add_block(&mut d, grey);
    check("a room", &mut d);
}

#[test]
fn textures_sides_and_smooth_normals() {
    let mut d = room(1);
    let chess = d.texture(checkerboard([0.8, 0.2, 0.1], [0.1, 0.2, 0.8], 5.0));
    let image =
        d.texture(bitmap(2, &[[0.9; 3], [0.1; 3], [0.5; 3], [0.3, 0.6, 0.2]], TextureFilter::Bilinear));
    let front = d.material(MaterialKind::Diffuse { reflectance: chess });
    let back = d.material(MaterialKind::Diffuse { reflectance: image });
    let both = d.material(MaterialKind::TwoSided { front, back });
    let wave = |u: f32, v: f32| {
        Vec3::new(2.0 * u - 1.0, 0.2 * (9.0 * u).sin() * (7.0 * v).cos() - 0.3, 1.0 - 2.0 * v)
    };
    d.shape(grid(8, wave, true), Affine::IDENTITY, both);
    check("a wavy sheet", &mut d);
}

#[test]
fn lights_and_materials_of_all_kinds() {
    let mut d = room(1);
    let metal = d.material(metal(rough(MicrofacetKind::Beckmann, 0.2, 0.3)));
    let ball = d.material(glass(1.5, None));
    let coat = d.material(plastic([0.5, 0.3, 0.2], None));
    add_ball(&mut d, ball);
    add_block(&mut d, metal);
    d.shape(grid(3, |u, v| Vec3::new(u, v, 0.4) * 0.5, false), Affine::IDENTITY, coat);
    d.light(LightKind::Constant { radiance: SpectrumDescription::Constant(0.1) });
    d.light(LightKind::Point {
        position: Vec3::new(0.1, 0.2, 0.3),
        intensity: SpectrumDescription::Constant(0.5),
    });
    check("a bit of everything", &mut d);
}

/// A metal of a given roughness, on both sides.
fn add_two_sided(d: &mut Description, [front, back]: [Option<RoughnessDescription>; 2]) -> MaterialId {
    let [front, back] = [front, back].map(|roughness| d.material(metal(roughness)));
    d.material(MaterialKind::TwoSided { front, back })
}

/// A sheet across the room, bent so that it is seen from all angles.
fn add_sheet(d: &mut Description, height: f32, material: MaterialId) {
    let bent = move |u: f32, v: f32| {
        Vec3::new(2.0 * u - 1.0, 0.15 * (9.0 * u).sin() * (7.0 * v).cos() + height, 0.8 - 1.6 * v)
    };
    d.shape(grid(8, bent, true), Affine::IDENTITY, material);
}

#[test]
fn rough_metals() {
    use MicrofacetKind::{Beckmann, Ggx};
    let mut d = room(1);
    // One-sided and two-sided, alike and different on both sides, sharp and dull.
    let sharp = add_two_sided(&mut d, [rough(Beckmann, 0.01, 0.01), rough(Beckmann, 0.3, 0.3)]);
    let dull = d.material(metal(rough(Ggx, 0.4, 0.4)));
    let both = add_two_sided(&mut d, [rough(Ggx, 0.1, 0.1), rough(Beckmann, 0.1, 0.1)]);
    add_sheet(&mut d, -0.7, sharp);
    add_sheet(&mut d, 0.5, dull);
    add_ball(&mut d, both);
    add_block(&mut d, dull);
    check("rough metals", &mut d);
}

#[test]
fn rough_metals_with_textures() {
    let mut d = room(1);
    let chess = d.texture(checkerboard([0.9, 0.5, 0.2], [0.1, 0.3, 0.6], 4.0));
    let grey = d.texture(checkerboard([0.1; 3], [0.5; 3], 3.0));
    let MaterialKind::Conductor { eta, k, .. } = metal(None) else { unreachable!() };
    let mut metal = |roughness, specular_reflectance: &TextureInput| {
        let specular_reflectance = specular_reflectance.clone();
        d.material(MaterialKind::Conductor {
            eta: eta.clone(),
            k: k.clone(),
            roughness,
            specular_reflectance,
        })
    };
    let tinted = metal(rough(MicrofacetKind::Ggx, 0.3, 0.3), &chess);
    let mut uneven = rough(MicrofacetKind::Beckmann, 0.3, 0.3);
    uneven.as_mut().unwrap().alpha_u = grey;
    let uneven = metal(uneven, &TextureInput::number(1.0));
    let brushed = metal(rough(MicrofacetKind::Beckmann, 0.1, 0.4), &chess);
    add_sheet(&mut d, -0.6, tinted);
    add_ball(&mut d, tinted);
    add_sheet(&mut d, 0.5, brushed);
    add_block(&mut d, uneven);
    check("metals with textures", &mut d);
}

#[test]
fn spheres_as_surfaces_and_as_lights() {
    let mut d = room(1);
    let chess = d.texture(checkerboard([0.8, 0.2, 0.1], [0.1, 0.2, 0.8], 5.0));
    let painted = d.material(MaterialKind::Diffuse { reflectance: chess });
    let shiny = add_two_sided(&mut d, [0.2, 0.3].map(|alpha| rough(MicrofacetKind::Ggx, alpha, alpha)));
    let grey = d.diffuse([0.5; 3]);
    add_ball(&mut d, painted);
    add_sheet(&mut d, -0.9, shiny);
    // Small and large, on the floor where the cone is wide, and one that shines inwards and is seen from inside.
    for (center, radius) in [([0.5, -0.4, 0.3], 0.05), ([0.4, 0.2, -0.4], 0.3), ([-0.3, -0.98, 0.7], 0.2)] {
        d.shape(SPHERE, placed(center, [radius; 3]), grey).emission = glow([2.0, 1.0, 3.0]);
    }
    let around = d.shape(SPHERE, placed([0.1, 0.2, 0.3], [6.0; 3]), shiny);
    (around.emission, around.flip_normals) = (glow([0.1, 0.2, 0.3]), true);
    // No similarity, and cut: neither is a sphere to waves.
    d.shape(SPHERE, placed([0.0, 0.6, 0.0], [0.2, 0.1, 0.2]), shiny).emission = glow([1.0, 1.0, 0.0]);
    check("spheres", &mut d);
}

#[test]
fn lights_on_both_sides() {
    let mut d = room(1);
    let grey = d.diffuse([0.5; 3]);
    let both = |radiance| glow(radiance).map(|light| AreaLightDescription { two_sided: true, ..light });
    d.shape(SPHERE, placed([0.1, 0.2, 0.3], [5.0; 3]), grey).emission = both([0.1, 0.2, 0.3]);
    d.shape(SPHERE, placed([0.4, -0.4, -0.2], [0.3; 3]), grey).emission = both([1.0, 2.0, 3.0]);
    d.shape(rectangle(), placed([-0.4, -0.2, 0.3], [0.3; 3]), grey).emission = both([1.0, 2.0, 3.0]);
    check("lights on both sides", &mut d);
}

/// Lights that are chosen by place: triangles of a mesh that shine both ways, balls, and a point.
#[test]
fn many_lights() {
    let mut d = gallery::many_lights(1, 20, 0.5);
    let grey = d.diffuse([0.4, 0.5, 0.6]);
    let wave = |u: f32, v: f32| Vec3::new(u, 0.1 * (9.0 * u).sin() - 0.8, v) * 0.9;
    let mut emission = glow([0.5, 1.0, 2.0]).expect("emits");
    emission.two_sided = true;
    d.shape(grid(6, wave, true), Affine::IDENTITY, grey).emission = Some(emission);
    let ball = d.material(glass(1.5, rough(MicrofacetKind::Ggx, 0.3, 0.3)));
    add_ball(&mut d, ball);
    add_block(&mut d, grey);
    d.light(LightKind::Point {
        position: Vec3::new(0.1, 0.2, 0.3),
        intensity: SpectrumDescription::Constant(0.5),
    });
    d.light(LightKind::Constant { radiance: SpectrumDescription::Constant(0.1) });
    check("many lights", &mut d);
}

#[test]
fn holes() {
    let mut d = room(1);
    let grey = d.diffuse([0.5; 3]);
    let veil = d.material(MaterialKind::Mask { opacity: TextureInput::number(0.6), nested: grey });
    add_block(&mut d, veil);
    check("a veil", &mut d);
}
