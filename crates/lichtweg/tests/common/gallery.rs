//! Scenes that more than one family of tests looks at; most are rooms with something in them.

use lichtweg::scene::description::{
    Description, EnvironmentMapping, GeometryDescription, LightKind, MaterialKind, MicrofacetKind,
    SpectrumDescription, SpotFalloff, TextureFilter, TextureId, TextureInput,
};
use lichtweg_ray::math::{Affine, Vec3};

use super::build::{
    Build, CYLINDER, DISK, SPHERE, bitmap, chain, checkerboard, cube, facing_down, facing_up, float_image,
    glass, glow, glow_input, grid, metal, placed, plastic, rectangle, rough,
};
use super::judge::assert_pairwise_agreement;
use super::room::{add_ball, add_block, add_walls, room, stage};
use super::run::{Estimator, compile_scene, render_scene};

/// Renders by each estimator, with a seed of its own from `seed` on, and compares all pairs.
pub fn assert_agreement(what: &str, description: &Description, estimators: &[Estimator], seed: u64) {
    let scene = compile_scene(description);
    let images: Vec<_> = estimators
        .iter()
        .map(|&estimator| {
            let mut d = description.clone();
            d.sampler.seed = seed + estimator as u64;
            estimator.choose(&mut d);
            (format!("{estimator:?}"), render_scene(&scene, &d))
        })
        .collect();
    let means = images.iter().map(|(_, image)| image.mean().0[0]);
    assert!(means.clone().all(|m| m > 0.01), "{what} is dark: {:?}", means.collect::<Vec<_>>());
    assert_pairwise_agreement(what, &images);
}

/// The texture of an input just made.
pub fn texture_id(input: &TextureInput) -> TextureId {
    match input {
        TextureInput::Texture(id) => *id,
        TextureInput::Constant(_) => unreachable!("made as a texture"),
    }
}

/// A diffuse ball and block.
pub fn diffuse_room(samples_per_pixel: u32) -> Description {
    let mut d = room(samples_per_pixel);
    let white = d.diffuse([0.8, 0.75, 0.7]);
    add_ball(&mut d, white);
    add_block(&mut d, white);
    d
}

/// A ball of smooth glass and a block of metal.
pub fn smooth_room(samples_per_pixel: u32) -> Description {
    let mut d = room(samples_per_pixel);
    d.integrator.max_depth = Some(7);
    let ball = d.material(glass(1.5, None));
    let block = d.material(metal(None));
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    d
}

/// Normals that are not the surface's: interpolated, tilted by a height field, and read from a map.
pub fn tilted_room(samples_per_pixel: u32) -> Description {
    let mut d = room(samples_per_pixel);
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
    d
}

/// Lights that no walk runs into, with others that it does.
pub fn delta_room(samples_per_pixel: u32) -> Description {
    let mut d = room(samples_per_pixel);
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
    d
}

/// A sky with a broad sun, in both mappings at once, over objects that stand free.
pub fn under_skies(samples_per_pixel: u32, block: MaterialKind) -> Description {
    let sky = |width: u32, height: u32| {
        let pixels: Vec<[f32; 3]> = (0..width * height)
            .map(|i| {
                let (x, y) = (i % width, i / width);
                if x / 2 == 2 && y == 2 { [8.0, 7.0, 5.0] } else { [0.1, 0.2, 0.1 + 0.02 * y as f32] }
            })
            .collect();
        float_image(width, &pixels)
    };
    let mut d = stage(samples_per_pixel);
    let floor = d.diffuse([0.6, 0.5, 0.4]);
    let floor = d.two_sided(floor);
    d.shape(rectangle(), chain(&[Affine::translation(0.0, -1.0, 0.0), facing_up()]), floor);
    let ball = d.material(metal(rough(MicrofacetKind::Ggx, 0.2, 0.2)));
    let block = d.material(block);
    add_ball(&mut d, ball);
    add_block(&mut d, block);
    let turned = Affine::rotation([0.3, 1.0, 0.1], 40.0);
    for (image, mapping) in [
        (sky(16, 8), EnvironmentMapping::LatitudeLongitude),
        (sky(8, 8), EnvironmentMapping::EqualAreaOctahedral),
    ] {
        d.light(LightKind::Environment { image, mapping, to_world: turned });
    }
    d
}

/// Emission that varies over the surface: over triangles, and over the parameters of quadrics.
pub fn textured_lamps(samples_per_pixel: u32) -> Description {
    let mut d = stage(samples_per_pixel);
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
    d
}

/// Different materials on the two sides, and lights that shine from one side or both.
pub fn two_sides(samples_per_pixel: u32) -> Description {
    let mut d = room(samples_per_pixel);
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
    d
}

/// Lights of all shapes, sizes and powers, some outshone, some turned away.
pub fn many_lights(samples_per_pixel: u32, count: u32, albedo: f32) -> Description {
    let mut d = stage(samples_per_pixel);
    add_walls(&mut d);
    let paint = d.diffuse([albedo; 3]);
    for i in 0..count {
        let t = f64::from(i);
        let center = [
            0.9 * (2.4 * t).cos() * (t / f64::from(count)).sqrt(),
            0.8 - 0.02 * t,
            0.9 * (2.4 * t).sin() * (t / f64::from(count)),
        ];
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
        d.shape(geometry, place, paint).emission = glow(color);
    }
    d
}
