//! Naive walks, connections and both by multiple importance sampling have the same mean: in every pixel block of scenes
//! that need each of the system's features.
//!
//! Each scene is one family of Welch tests (all pairs of estimators, blocks and channels) with a probability of a false
//! alarm of 0.01 or less.

mod common;

use common::build::{
    Build, CYLINDER, DISK, SPHERE, bitmap, chain, checkerboard, cube, facing_down, facing_up, float_image,
    glass, glow, glow_input, grid, metal, placed, plastic, rectangle, rough,
};
use common::direct::{Fault, render_direct};
use common::judge::assert_pairwise_agreement;
use common::room::{add_ball, add_block, add_walls, room, stage};
use common::run::{Estimator, compile_scene, render_scene};
use lichtweg::scene::description::{
    Description, EnvironmentMapping, GeometryDescription, LightKind, MaterialKind, MicrofacetKind,
    SpectrumDescription, SpotFalloff, TextureFilter, TextureInput,
};
use lichtweg_ray::math::{Affine, Vec3};

/// Renders by each estimator, with a seed of its own, and compares all pairs.
fn assert_agreement(what: &str, description: &Description, estimators: &[Estimator]) {
    let scene = compile_scene(description);
    let images: Vec<_> = estimators
        .iter()
        .map(|&estimator| {
            let mut d = description.clone();
            d.sampler.seed = 100 + estimator as u64;
            estimator.choose(&mut d);
            (format!("{estimator:?}"), render_scene(&scene, &d))
        })
        .collect();
    let means = images.iter().map(|(_, image)| image.mean().0[0]);
    assert!(means.clone().all(|m| m > 0.01), "{what} is dark: {:?}", means.collect::<Vec<_>>());
    assert_pairwise_agreement(what, &images);
}

/// The texture index of an input just made.
fn texture_id(input: &TextureInput) -> lichtweg::scene::description::TextureId {
    match input {
        TextureInput::Texture(id) => *id,
        TextureInput::Constant(_) => unreachable!("made as a texture"),
    }
}

#[test]
fn diffuse_room() {
    let mut d = room(256);
    let white = d.diffuse([0.8, 0.75, 0.7]);
    add_ball(&mut d, white);
    add_block(&mut d, white);
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
    let mut d = room(512);
    d.integrator.max_depth = Some(7);
    let ball = d.material(glass(1.5, None));
    let block = d.material(metal(None));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
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
    let sky = |width: u32, height: u32| {
        let pixels: Vec<[f32; 3]> = (0..width * height)
            .map(|i| {
                let (x, y) = (i % width, i / width);
                if x / 2 == 2 && y == 2 { [8.0, 7.0, 5.0] } else { [0.1, 0.2, 0.1 + 0.02 * y as f32] }
            })
            .collect();
        float_image(width, &pixels)
    };
    let mut d = stage(512);
    let floor = d.diffuse([0.6, 0.5, 0.4]);
    let floor = d.two_sided(floor);
    d.shape(rectangle(), chain(&[Affine::translation(0.0, -1.0, 0.0), facing_up()]), floor);
    let ball = d.material(metal(rough(MicrofacetKind::Ggx, 0.2, 0.2)));
    let block = d.material(plastic([0.3, 0.6, 0.3], None));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    let turned = Affine::rotation([0.3, 1.0, 0.1], 40.0);
    for (image, mapping) in [
        (sky(16, 8), EnvironmentMapping::LatitudeLongitude),
        (sky(8, 8), EnvironmentMapping::EqualAreaOctahedral),
    ] {
        d.light(LightKind::Environment { image, mapping, to_world: turned });
    }
    assert_agreement("environment maps", &d, &Estimator::ALL);
}

/// Emission and reflectance that vary over the surface: over triangles, and over the parameters of the quadrics.
#[test]
fn textured_emitters() {
    let mut d = stage(512);
    add_walls(&mut d);
    let black = d.diffuse([0.0; 3]);
    let board = d.texture(checkerboard([6.0, 1.0, 1.0], [0.2, 0.5, 3.0], 1.5));
    let pixels = [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [2.0, 2.0, 0.0]];
    let image = d.texture(bitmap(2, &pixels, TextureFilter::Bilinear));
    let ceiling =
        chain(&[Affine::translation(0.4, 0.95, 0.0), facing_down(), Affine::scaling(0.4, 0.4, 1.0)]);
    d.shape(rectangle(), ceiling, black).emission = glow_input(image.clone());
    let disk = chain(&[Affine::translation(-0.5, 0.9, 0.0), facing_down(), Affine::scaling(0.4, 0.4, 1.0)]);
    d.shape(DISK, disk, black).emission = glow_input(board.clone());
    let tube = chain(&[Affine::translation(-0.9, -0.7, -0.6), Affine::scaling(0.15, 0.15, 0.8)]);
    d.shape(CYLINDER, tube, black).emission = glow_input(image.clone());
    let egg = placed([0.6, -0.6, -0.4], [0.3, 0.4, 0.25]);
    d.shape(SPHERE, egg, black).emission = glow_input(board);
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
    let mut d = room(512);
    let white = d.diffuse([0.7; 3]);
    let wavy = grid(8, |x, y| Vec3::new(x, y, 0.15 * (4.0 * x).sin() * (3.0 * y).cos()), true);
    let carpet = chain(&[Affine::translation(0.0, -0.75, 0.2), facing_up(), Affine::scaling(0.8, 0.7, 1.0)]);
    let shiny = d.material(plastic([0.5, 0.4, 0.3], rough(MicrofacetKind::Ggx, 0.3, 0.3)));
    let shiny = d.two_sided(shiny);
    d.shape(wavy, carpet, shiny);
    let heights: Vec<[f32; 3]> = (0..64).map(|i| [0.06 * ((i % 8 + i / 8) % 3) as f32; 3]).collect();
    let height = d.texture(bitmap(8, &heights, TextureFilter::Bilinear));
    let bumpy = d.material(MaterialKind::Bump { height: texture_id(&height), scale: 2.0, nested: white });
    add_block(&mut d, bumpy);
    let normals: Vec<[f32; 3]> =
        (0..16).map(|i| [0.5 + 0.2 * ((i % 4) as f32 - 1.5) / 1.5, 0.6, 0.9]).collect();
    let normals = d.texture(bitmap(4, &normals, TextureFilter::Bilinear));
    let mapped = d.material(MaterialKind::NormalMap { normals: texture_id(&normals), nested: white });
    d.shape(rectangle(), placed([-0.1, 0.2, -0.9], [0.7, 0.5, 1.0]), mapped);
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
    let mut d = room(512);
    let [red, blue] = [[0.8, 0.2, 0.1], [0.1, 0.2, 0.8]].map(|color| d.diffuse(color));
    let gloss = d.material(metal(rough(MicrofacetKind::Ggx, 0.25, 0.25)));
    for (x, front, back) in [(-0.5, red, blue), (0.5, gloss, red)] {
        let sides = d.material(MaterialKind::TwoSided { front, back });
        let turn = Affine::rotation([0.1, 1.0, 0.0], 70.0 * f64::signum(x));
        let place = chain(&[Affine::translation(x, -0.4, 0.1), turn, Affine::scaling(0.4, 0.5, 1.0)]);
        d.shape(rectangle(), place, sides);
    }
    // Reflects on the side it is seen from only, and shines on both.
    let lamp = chain(&[Affine::translation(0.0, 0.1, -0.2), Affine::scaling(0.2, 0.2, 1.0)]);
    let mut emission = glow([2.0, 4.0, 2.0]).expect("emits");
    emission.two_sided = true;
    d.shape(rectangle(), lamp, blue).emission = Some(emission);
    assert_agreement("two sides", &d, &Estimator::ALL);
}

/// Sixty lights of all shapes, sizes and powers, some outshone, some turned away.
#[test]
fn many_lights() {
    let mut d = stage(512);
    add_walls(&mut d);
    let black = d.diffuse([0.0; 3]);
    for i in 0..60 {
        let t = f64::from(i);
        let center =
            [0.9 * (2.4 * t).cos() * (t / 60.0).sqrt(), 0.8 - 0.02 * t, 0.9 * (2.4 * t).sin() * (t / 60.0)];
        let size = 0.05 + 0.08 * (t * 0.7).sin().abs();
        let power = 20.0 * (1.0 + (t * 1.3).cos()) as f32 + 1.0;
        let turn = Affine::rotation([1.0, t.sin(), t.cos()], 29.0 * t);
        let place = chain(&[
            Affine::translation(center[0], center[1], center[2]),
            turn,
            Affine::scaling(size, size, size),
        ]);
        let geometry = match i % 6 {
            0 => SPHERE,
            1 => DISK,
            2 => CYLINDER,
            3 => cube(),
            4 => rectangle(),
            _ => GeometryDescription::Sphere { z_min: -0.5, z_max: 0.7, phi_max: 200.0 },
        };
        let color = [power, power * 0.7, power * (0.3 + 0.01 * i as f32)].map(|c| 0.15 * c);
        d.shape(geometry, place, black).emission = glow(color);
    }
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
    let mut d = room(256);
    let ball = d.material(plastic([0.5, 0.2, 0.2], rough(MicrofacetKind::Beckmann, 0.3, 0.3)));
    let block = d.material(glass(1.5, rough(MicrofacetKind::Ggx, 0.4, 0.4)));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
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
