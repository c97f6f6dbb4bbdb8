//! Light, textures and files of pbrt scenes: the scales that decide an image's brightness.

mod pbrt_text;

use std::f32::consts::PI;
use std::path::{Path, PathBuf};

use lichtweg::color::{Role, luminance, rgb_spectrum};
use lichtweg::scene::description::{
    Description, EmissionScale, EnvironmentMapping, LightDescription, LightKind, Pixels, SpectrumDescription,
    TextureInput, TextureKind, WrapMode,
};
use lichtweg_ray::math::Vec3;
use pbrt_text::read_silently;

fn read_in(directory: &Path, world: &str) -> Description {
    read_silently(directory, "", world)
}

fn read(world: &str) -> Description {
    read_in(Path::new("/nonexistent"), world)
}

fn light(text: &str) -> LightDescription {
    read(text).lights.remove(0)
}

/// A directory of this test's own, emptied.
fn directory(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// A square PFM image of one colour, bottom row first as the format has it.
fn write_pfm(path: &Path, side: usize, rgb: impl Fn(usize, usize) -> [f32; 3]) {
    let mut bytes = format!("PF\n{side} {side}\n-1\n").into_bytes();
    for y in (0..side).rev() {
        for x in 0..side {
            bytes.extend(rgb(x, y).iter().flat_map(|v| v.to_le_bytes()));
        }
    }
    std::fs::write(path, bytes).unwrap();
}

fn near(a: f32, b: f32) -> bool {
    (a - b).abs() <= 1e-4 * b.abs()
}

#[test]
fn rgb_is_taken_as_it_stands_and_all_else_has_luminance_one() {
    let emitted = |text: &str| match light(&format!("LightSource \"point\" {text}")).kind {
        LightKind::Point { intensity, .. } => intensity,
        other => panic!("{other:?}"),
    };
    assert_eq!(emitted("\"rgb I\" [ 1 2 3 ]"), SpectrumDescription::Rgb([1.0, 2.0, 3.0]));
    assert_eq!(emitted(""), SpectrumDescription::Rgb([1.0; 3]));
    assert_eq!(
        emitted("\"blackbody I\" 5000"),
        SpectrumDescription::Blackbody { kelvin: 5000.0, scale: 1.0 }
    );
    for text in ["[ 360 7 830 7 ]", "[ 450 1 600 20 ]", "[ 360 .1 500 100 600 3 830 0 ]"] {
        let spectrum = emitted(&format!("\"spectrum I\" {text}"));
        let rgb = rgb_spectrum(&spectrum, Role::Emission).unwrap();
        assert!(near(luminance(rgb.to_rgb()), 1.0), "{text}");
        // Nothing is added outside of the samples.
        if let SpectrumDescription::Sampled { wavelengths, values } = spectrum {
            assert!(wavelengths[0] <= 360.0 || values[0] == 0.0);
            assert!(wavelengths[wavelengths.len() - 1] >= 830.0 || values[values.len() - 1] == 0.0);
        }
    }
}

#[test]
fn powers_and_illuminances() {
    assert_eq!(light("LightSource \"point\" \"float scale\" 3").scale, 3.0);
    assert!(near(
        light("LightSource \"point\" \"float power\" 10 \"float scale\" 2").scale,
        20.0 / (4.0 * PI)
    ));
    let (start, end) = (20_f32.to_radians().cos(), 30_f32.to_radians().cos());
    let cone = 2.0 * PI * (1.0 - start + (start - end) / 2.0);
    let spot = light("LightSource \"spot\" \"float power\" 5 \"float conedeltaangle\" 10");
    assert!(near(spot.scale, 5.0 / cone));
    assert!(near(light("LightSource \"distant\" \"float illuminance\" 4").scale, 4.0));
    assert!(near(light("LightSource \"infinite\" \"float illuminance\" 4").scale, 4.0 / PI));
    assert!(near(light("LightSource \"infinite\" \"float illuminance\" -1").scale, 1.0));
}

#[test]
fn places_and_directions() {
    let LightKind::Point { position, .. } =
        light("Translate 1 0 0 LightSource \"point\" \"point3 from\" [ 0 2 0 ]").kind
    else {
        panic!()
    };
    assert_eq!(position, Vec3::new(1.0, 2.0, 0.0));
    let LightKind::Directional { direction, .. } =
        light("Rotate 90 0 0 1 LightSource \"distant\" \"point3 from\" [ 3 0 0 ] \"point3 to\" [ 1 0 0 ]")
            .kind
    else {
        panic!()
    };
    assert!((direction.normalized() - Vec3::new(0.0, -1.0, 0.0)).length() < 1e-6);
    let LightKind::Spot { to_world, cutoff, beam_width, .. } =
        light("LightSource \"spot\" \"point3 from\" [ 1 1 1 ] \"point3 to\" [ 1 1 -4 ]").kind
    else {
        panic!()
    };
    assert_eq!((cutoff, beam_width), (30.0, 25.0));
    assert!((to_world.vector(Vec3::Z) - Vec3::new(0.0, 0.0, -1.0)).length() < 1e-6);
    assert_eq!(to_world.point(Vec3::ZERO), Vec3::ONE);
}

#[test]
fn area_lights() {
    let factor = |light: &str, shape: &str| {
        let scene = read(&format!("AreaLightSource \"diffuse\" {light}\n{shape}"));
        match scene.shapes[0].emission.as_ref().unwrap().scale {
            EmissionScale::Factor(factor) => factor,
            other => panic!("{other:?}"),
        }
    };
    let sphere = "Shape \"sphere\" \"float radius\" 2";
    assert_eq!(factor("\"float scale\" 3", sphere), 3.0);
    assert!(near(factor("\"float power\" 100", sphere), 100.0 / (PI * 4.0 * PI * 4.0)));
    assert!(near(factor("\"float power\" 100 \"bool twosided\" true", sphere), 50.0 / (PI * 4.0 * PI * 4.0)));
    assert!(near(
        factor("\"float power\" 2", "Shape \"disk\" \"float innerradius\" .5"),
        2.0 / (PI * PI * 0.75)
    ));
    assert!(near(
        factor("\"float power\" 2", "Shape \"cylinder\" \"float radius\" .5"),
        2.0 / (PI * 2.0 * PI)
    ));
    // Each of the two triangles, of area 8 in the world, gets the whole power.
    let square = "Scale 4 4 1 Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 0 1 0 ] \"integer indices\" [ 0 1 2 0 2 3 ]";
    assert!(near(factor("\"float power\" 2", square), 2.0 / (PI * 8.0)));
}

#[test]
fn environment_maps() {
    let directory = directory("pbrt-environment");
    write_pfm(&directory.join("white.pfm"), 64, |_, _| [2.0; 3]);
    let text = "Rotate 90 1 0 0 LightSource \"infinite\" \"string filename\" \"white.pfm\" \"float scale\" 3";
    let scene = read_in(&directory, text);
    let LightKind::Environment { image, mapping, to_world } = &scene.lights[0].kind else { panic!() };
    assert_eq!((image.width, *mapping), (64, EnvironmentMapping::EqualAreaOctahedral));
    assert!((to_world.vector(Vec3::Y) - Vec3::Z).length() < 1e-6);
    assert_eq!(scene.lights[0].scale, 3.0);
    // pbrt's sum over the upper half of a map of radiance 2: 2 * 2 pi * (mean of the cosine over all directions, 1/4).
    let text = "LightSource \"infinite\" \"string filename\" \"white.pfm\" \"float illuminance\" 5";
    let scale = read_in(&directory, text).lights[0].scale;
    assert!((scale / (5.0 / PI) - 1.0).abs() < 0.01, "{scale}");
}

#[test]
fn textures() {
    let scene = read(
        "Texture \"t\" \"float\" \"constant\" \"float value\" .25
        Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [ .1 .2 .3 ]
        Texture \"c\" \"spectrum\" \"checkerboard\" \"texture tex1\" \"t\" \"float uscale\" 4 \"float vdelta\" 3
        Texture \"m\" \"spectrum\" \"mix\" \"texture tex2\" \"t\" \"texture amount\" \"t\"
        Texture \"s\" \"float\" \"scale\" \"texture tex\" \"t\" \"float scale\" 2",
    );
    let kind = |name: &str| &scene.textures.iter().rfind(|t| t.name.as_deref() == Some(name)).unwrap().kind;
    let index = |float: bool| {
        let of =
            |t: &TextureKind| matches!(t, TextureKind::Constant(SpectrumDescription::Constant(_))) == float;
        scene.textures.iter().position(|t| t.name.as_deref() == Some("t") && of(&t.kind)).unwrap() as u32
    };
    let id =
        |input: &TextureInput| if let TextureInput::Texture(id) = input { id.0 } else { panic!("{input:?}") };
    let TextureKind::Checkerboard { even, odd, to_uv } = kind("c") else { panic!() };
    assert_eq!((id(even), odd), (index(false), &TextureInput::number(0.0)));
    // pbrt's squares have side 1 in (4 u, v + 3), the description's 1/2.
    assert_eq!(to_uv.rows, [[2.0, 0.0, 0.0], [0.0, 0.5, 1.5]]);
    let TextureKind::Mix { a, b, amount } = kind("m") else { panic!() };
    assert_eq!((a, id(b), id(amount)), (&TextureInput::number(0.0), index(false), index(true)));
    let TextureKind::Scale { texture, by } = kind("s") else { panic!() };
    assert_eq!((id(texture), by), (index(true), &TextureInput::number(2.0)));
}

#[test]
fn image_maps() {
    let directory = directory("pbrt-images");
    write_pfm(&directory.join("a.pfm"), 2, |x, y| [x as f32, y as f32, 0.0]);
    let texture = |params: &str| {
        let text = format!("Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"a.pfm\" {params}");
        read_in(&directory, &text).textures
    };
    let textures = texture("\"string wrap\" \"black\" \"float scale\" .5");
    let TextureKind::Bitmap { image, wrap: WrapMode::Black, scale: 0.5, invert: false, raw: false, .. } =
        &textures[0].kind
    else {
        panic!("{:?}", textures[0].kind)
    };
    // Top row first: y counts downwards.
    assert!(matches!(&image.pixels, Pixels::F32(v) if v[1] == 0.0 && v[7] == 1.0));
    // 1 - s x, for the description inverts before it scales.
    let textures = texture("\"float scale\" .25 \"bool invert\" true");
    assert!(matches!(&textures[0].kind, TextureKind::Bitmap { scale: 1.0, invert: true, .. }));
    let TextureKind::Mix { a, amount, .. } = &textures[1].kind else { panic!() };
    assert_eq!((a, amount), (&TextureInput::number(1.0), &TextureInput::number(0.25)));
}

#[test]
fn files_include_and_import_each_other() {
    let directory = directory("pbrt-include");
    let packed = |text: &str| {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::Write::write_all(&mut encoder, text.as_bytes()).unwrap();
        encoder.finish().unwrap()
    };
    std::fs::write(directory.join("moved.pbrt"), "Translate 1 0 0\nShape \"sphere\"\n").unwrap();
    std::fs::write(directory.join("packed.pbrt.gz"), packed("Translate 0 1 0\nShape \"sphere\"\n")).unwrap();
    std::fs::write(directory.join("a.spd"), "# nm value\n400 1\n700 2 # end\n").unwrap();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::fs::write(directory.join("a.ply.gz"), packed(ply)).unwrap();
    let scene = read_in(
        &directory,
        "Import \"moved.pbrt\" Shape \"sphere\" Include \"packed.pbrt.gz\" Include \"moved.pbrt\" Shape \"sphere\"
        LightSource \"infinite\" \"spectrum L\" \"a.spd\"
        Shape \"plymesh\" \"string filename\" \"a.ply.gz\"",
    );
    let places: Vec<[f32; 3]> =
        scene.shapes.iter().map(|s| s.to_world.point(Vec3::ZERO).to_array()).collect();
    let want =
        [[1.0, 0.0, 0.0], [0.0; 3], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    assert_eq!(places, want);
    assert!(matches!(
        &scene.lights[0].kind,
        LightKind::Constant { radiance: SpectrumDescription::Sampled { .. } }
    ));
}
