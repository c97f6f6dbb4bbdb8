//! What pbrt scenes mean: cameras, films, shapes, materials and transforms.

mod pbrt_text;

use std::path::Path;

use lichtweg::scene::description::{
    ConductorQuantity, Description, Diagnostics, EstimatorKind, FieldOfView, FilterKind, FovAxis,
    GeometryDescription, LightChoiceKind, LightStrategy, MaterialKind, Severity, SourceMap,
    SpectrumDescription, TextureInput,
};
use lichtweg_io::diagnostics::render;
use lichtweg_io::options::{LoadReport, ReadOptions};
use lichtweg_io::pbrt;
use lichtweg_montecarlo::SamplerKind;
use lichtweg_ray::Placement;
use lichtweg_ray::math::{Affine, Vec3};
use pbrt_text::{read_any, read_silently};

/// Reads options and a world; panics where there are findings other than notes.
fn read(options: &str, world: &str) -> Description {
    read_silently(Path::new("/nonexistent"), options, world)
}

fn close(a: Vec3, b: Vec3) -> bool {
    (a - b).length() < 1e-5
}

/// The material of the first shape, below its wrappers.
fn material(scene: &Description, wrappers: usize) -> &MaterialKind {
    let mut kind = &scene.materials[scene.shapes[0].material.0 as usize].kind;
    for _ in 0..wrappers {
        let id = match kind {
            MaterialKind::TwoSided { front, back } => {
                assert_eq!(front, back);
                *front
            }
            MaterialKind::Mask { nested, .. }
            | MaterialKind::Bump { nested, .. }
            | MaterialKind::NormalMap { nested, .. } => *nested,
            other => panic!("{other:?} wraps nothing"),
        };
        kind = &scene.materials[id.0 as usize].kind;
    }
    kind
}

#[test]
fn defaults_are_those_of_pbrt() {
    let scene = read("", "");
    assert_eq!(scene.name, "a");
    assert_eq!(scene.camera.field_of_view, FieldOfView::Angle { degrees: 90.0, axis: FovAxis::Smaller });
    assert_eq!((scene.film.width, scene.film.height, scene.film.scale), (1280, 720, 1.0));
    assert_eq!(scene.film.filter.kind, FilterKind::Gaussian { standard_deviation: 0.5 });
    assert_eq!(scene.film.filter.radius, [1.5; 2]);
    assert_eq!((scene.sampler.kind, scene.sampler.samples_per_pixel), (SamplerKind::Sobol, 16));
    assert_eq!(scene.integrator.max_depth, Some(6));
    assert_eq!(scene.integrator.light, LightStrategy::Mis);
}

#[test]
fn the_right_of_the_image_is_up_cross_forward() {
    let look = "LookAt 0 0 5  0 0 0  0 1 0";
    let camera = read(&format!("{look}\nCamera \"perspective\""), "").camera.to_world;
    assert!(close(camera.point(Vec3::ZERO), Vec3::new(0.0, 0.0, 5.0)));
    assert!(close(camera.vector(Vec3::Z), -1.0 * Vec3::Z));
    // The description's +x is the image's left; pbrt shows y x (-z) = -x at the right.
    assert!(close(camera.vector(Vec3::X), Vec3::X));
    let mirrored = read(&format!("Scale -1 1 1\n{look}\nCamera \"perspective\""), "").camera.to_world;
    assert!(close(mirrored.vector(Vec3::X), -1.0 * Vec3::X));
}

#[test]
fn screen_windows() {
    let window = |params: &str| match read(&format!("Camera \"perspective\" \"float fov\" 90 {params}"), "")
        .camera
        .field_of_view
    {
        FieldOfView::Window(window) => window.map(|v| (v * 1e4).round() / 1e4),
        other => panic!("{other:?}"),
    };
    assert_eq!(window("\"float frameaspectratio\" 2"), [-2.0, 2.0, -1.0, 1.0]);
    assert_eq!(window("\"float frameaspectratio\" .5"), [-1.0, 1.0, -2.0, 2.0]);
    assert_eq!(window("\"float screenwindow\" [ -1 .5 0 1 ]"), [-1.0, 0.5, 0.0, 1.0]);
}

#[test]
fn film_exposure_and_crop() {
    let size = "\"integer xresolution\" 100 \"integer yresolution\" 50";
    let film = read(
        &format!("Film \"rgb\" {size} \"float iso\" 200 \"float cropwindow\" [ .5 .25 0 .31 ]\nCamera \"perspective\" \"float shutterclose\" .25"),
        "",
    )
    .film;
    assert_eq!(film.scale, 0.5);
    assert_eq!(film.crop, Some([25, 0, 25, 16]));
    let film = read(&format!("Film \"rgb\" {size} \"integer pixelbounds\" [ 10 20 30 60 ]"), "").film;
    assert_eq!(film.crop, Some([10, 30, 10, 20]));
}

#[test]
fn integrators_count_edges() {
    let light = |text: &str| read(text, "").integrator.light;
    assert_eq!(read("Integrator \"path\" \"integer maxdepth\" 0", "").integrator.max_depth, Some(1));
    assert_eq!(light("Integrator \"simplepath\""), LightStrategy::Nee);
    assert_eq!(light("Integrator \"simplepath\" \"bool samplelights\" false"), LightStrategy::Naive);
    let bdpt = read("Integrator \"bdpt\" \"integer maxdepth\" 7", "").integrator;
    assert_eq!((bdpt.estimator, bdpt.max_depth), (EstimatorKind::Bidirectional, Some(8)));
    assert_eq!(bdpt.roulette.start_depth, None);
    let walks = read("Integrator \"lightpath\"", "").integrator;
    assert_eq!((walks.estimator, walks.max_depth), (EstimatorKind::Light, Some(6)));
    let sampler = read("Option \"seed\" 5\nSampler \"stratified\" \"integer xsamples\" 3", "").sampler;
    assert_eq!((sampler.samples_per_pixel, sampler.seed), (12, 5));
    assert_eq!(read("Sampler \"independent\"", "").sampler.kind, SamplerKind::Independent);
}

#[test]
fn light_samplers() {
    for (name, kind) in [
        ("bvh", LightChoiceKind::Auto),
        ("uniform", LightChoiceKind::Uniform),
        ("power", LightChoiceKind::Power),
        ("exhaustive", LightChoiceKind::Tree),
    ] {
        let options = format!("Integrator \"path\" \"string lightsampler\" \"{name}\"");
        assert_eq!(read(&options, "").integrator.light_choice, kind);
    }
    assert_eq!(read("Integrator \"path\"", "").integrator.light_choice, LightChoiceKind::Auto);
}

#[test]
fn quadrics_are_units() {
    let shape = |text: &str| read("", text).shapes.remove(0);
    let sphere =
        shape("Translate 1 2 3\nShape \"sphere\" \"float radius\" 2 \"float zmax\" 1 \"float zmin\" -9");
    assert!(matches!(
        sphere.geometry,
        GeometryDescription::Sphere { z_min: -1.0, z_max: 0.5, phi_max: 360.0 }
    ));
    assert!(close(sphere.to_world.point(Vec3::X), Vec3::new(3.0, 2.0, 3.0)));
    let disk = shape("Shape \"disk\" \"float height\" 3 \"float radius\" 2 \"float innerradius\" 1");
    assert!(matches!(disk.geometry, GeometryDescription::Disk { inner_radius: 0.5, .. }));
    assert!(close(disk.to_world.point(Vec3::X), Vec3::new(2.0, 0.0, 3.0)));
    let cylinder =
        shape("Shape \"cylinder\" \"float radius\" 2 \"float zmin\" 4 \"float zmax\" -2 \"float phimax\" 90");
    assert!(matches!(
        cylinder.geometry,
        GeometryDescription::Cylinder { z_min: -1.0, z_max: 2.0, phi_max: 90.0 }
    ));
    assert!(close(cylinder.to_world.point(Vec3::new(0.0, 1.0, 2.0)), Vec3::new(0.0, 2.0, 4.0)));
}

#[test]
fn curves_are_cubic_bezier_segments() {
    use lichtweg_ray::CurveStyle;
    let curves = |text: &str| match &read("", &format!("Shape \"curve\" {text}")).shapes[0].geometry {
        GeometryDescription::Curves(curves) => (**curves).clone(),
        other => panic!("no curves: {other:?}"),
    };
    let spline = curves(
        "\"string type\" \"cylinder\" \"string basis\" \"bspline\" \"float width0\" 2 \"float width1\" 0
         \"integer splitdepth\" 3 \"point3 P\" [0 0 0  6 0 0  6 6 0  0 6 0  0 0 0]",
    );
    assert_eq!((spline.style, spline.counts), (CurveStyle::Round, vec![7]));
    assert!(close(spline.points[0].position, Vec3::new(5.0, 1.0, 0.0)));
    assert!(close(spline.points[3].position, Vec3::new(5.0, 5.0, 0.0)));
    let radii: Vec<f32> = spline.points.iter().map(|p| p.radius).collect();
    assert!(radii.iter().enumerate().all(|(i, r)| (r - (1.0 - i as f32 / 6.0)).abs() < 1e-6));
    let plain = curves("\"point3 P\" [0 0 0  1 0 0  2 0 0  3 0 0]");
    assert_eq!((plain.style, plain.points[2].radius, plain.scales_radii), (CurveStyle::Flat, 0.5, true));
    let quadratic = "\"integer degree\" 2 \"string type\" \"ribbon\" \"normal N\" [0 0 1  0 1 0]
         \"point3 P\" [0 0 0  3 0 0  6 6 0]";
    let ribbon = curves(quadratic);
    assert!(close(ribbon.points[1].position, Vec3::new(2.0, 0.0, 0.0)));
    assert_eq!((ribbon.style, ribbon.normals), (CurveStyle::Ribbon, vec![Vec3::Z, Vec3::Y]));
}

/// The outside of the first shape's first triangle, in the world, as the description defines it.
fn outside(scene: &Description) -> Vec3 {
    let shape = &scene.shapes[0];
    let GeometryDescription::Mesh(mesh) = &shape.geometry else { panic!("no mesh") };
    let [a, b, c] = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
    let normal = shape.to_world.normal((b - a).cross(c - a)).normalized();
    if shape.flip_normals { -1.0 * normal } else { normal }
}

#[test]
fn the_outside_is_where_pbrt_has_it() {
    let triangle = |before: &str, normal: &str| {
        outside(&read(
            "",
            &format!("{before}\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] {normal}"),
        ))
    };
    let (up, down) = (Vec3::Z, -1.0 * Vec3::Z);
    let downward = "\"normal N\" [ 0 .1 -1  0 0 -1  0 0 -1 ]";
    // Without normals: the winding in the shape's own space, which mirrors keep (pbrt flips twice).
    assert_eq!(triangle("", ""), up);
    assert_eq!(triangle("ReverseOrientation", ""), down);
    assert_eq!(triangle("Scale -1 1 1", ""), up);
    assert_eq!(triangle("Scale -1 1 1\nReverseOrientation", ""), down);
    // With normals: their side.
    assert_eq!(triangle("", downward), down);
    assert_eq!(triangle("ReverseOrientation", downward), up);
    assert_eq!(triangle("Scale -1 1 1", downward), down);
    assert_eq!(triangle("Scale 1 1 -1", downward), up);
}

#[test]
fn instances_share_their_shapes() {
    let scene = read(
        "",
        "Translate 1 0 0
        ObjectBegin \"o\"
            Translate 0 1 0
            Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]
        ObjectEnd
        Scale 2 2 2
        ObjectInstance \"o\"
        AttributeBegin
            Translate 0 0 1
            ObjectInstance \"o\"
        AttributeEnd",
    );
    let [shape] = &scene.shapes[..] else { panic!("{} shapes", scene.shapes.len()) };
    let [a, b] = &scene.instances[..] else { panic!("{} instances", scene.instances.len()) };
    assert_eq!([shape.group; 2], [Some(a.group), Some(b.group)]);
    // The instance's transform, then that of the definition: T(1,0,0) S(2) of (1, 1, 0).
    let origin = |placement: &Placement| placement.at(0.0).after(&shape.to_world).point(Vec3::ZERO);
    assert!(close(origin(&a.to_world), Vec3::new(3.0, 2.0, 0.0)));
    assert!(close(origin(&b.to_world), Vec3::new(3.0, 2.0, 2.0)));
}

#[test]
fn what_is_used_once_is_placed_directly() {
    let object = "ObjectBegin \"o\" Translate 1 0 0 Shape \"sphere\" ObjectEnd Scale 2 2 2";
    let scene = read("", object);
    assert!(scene.shapes.is_empty() && scene.instances.is_empty());
    let scene = read("", &format!("{object} ObjectInstance \"o\""));
    assert!(scene.instances.is_empty() && scene.shapes[0].group.is_none());
    assert!(close(scene.shapes[0].to_world.point(Vec3::ZERO), Vec3::new(2.0, 0.0, 0.0)));
}

#[test]
fn motion_has_two_ends() {
    let options = "TransformTimes 1 3
        ActiveTransform EndTime Translate 0 0 4 ActiveTransform All
        Camera \"perspective\" \"float shutteropen\" 1.5 \"float shutterclose\" 2";
    let scene = read(
        options,
        "Translate 0 1 0
        ActiveTransform EndTime Translate 6 0 0 ActiveTransform All
        Shape \"sphere\" \"float radius\" 2
        ActiveTransform StartTime Translate 6 0 0 ActiveTransform All
        Shape \"disk\"",
    );
    assert_eq!(scene.camera.shutter, [1.5, 2.0]);
    let camera = scene.camera.motion.as_ref().expect("the camera moves");
    assert!(close(camera.at(2.0).point(Vec3::ZERO), Vec3::new(0.0, 0.0, -2.0)));
    let [ball, disk] = &scene.shapes[..] else { panic!("{} shapes", scene.shapes.len()) };
    let [instance] = &scene.instances[..] else { panic!("{} instances", scene.instances.len()) };
    assert_eq!((ball.group, disk.group), (Some(instance.group), None));
    assert!(close(ball.to_world.vector(Vec3::X), 2.0 * Vec3::X));
    for (time, x) in [(0.0, 0.0), (1.0, 0.0), (2.0, 3.0), (3.0, 6.0), (9.0, 6.0)] {
        assert!(close(instance.to_world.at(time).point(Vec3::ZERO), Vec3::new(x, 1.0, 0.0)), "at {time}");
    }
    assert!(close(disk.to_world.point(Vec3::ZERO), Vec3::new(6.0, 1.0, 0.0)));
}

#[test]
fn transforms_concatenate() {
    let at = |text: &str| read("", &format!("{text}\nShape \"sphere\"")).shapes[0].to_world;
    let matrix = "[ 0 1 0 0  -1 0 0 0  0 0 1 0  5 6 7 1 ]";
    let turned = Affine::translation(5.0, 6.0, 7.0).after(&Affine::rotation([0.0, 0.0, 1.0], 90.0));
    for (text, want) in [
        (format!("Transform {matrix}"), turned),
        (format!("Translate 9 9 9 Transform {matrix}"), turned),
        (format!("Scale 2 2 2 ConcatTransform {matrix}"), Affine::scaling(2.0, 2.0, 2.0).after(&turned)),
        ("Translate 5 6 7 Rotate 90 0 0 1".to_owned(), turned),
        (
            "Translate 1 0 0 CoordinateSystem \"c\" Identity CoordSysTransform \"c\"".to_owned(),
            Affine::translation(1.0, 0.0, 0.0),
        ),
        ("TransformBegin Translate 1 0 0 TransformEnd".to_owned(), Affine::IDENTITY),
    ] {
        let found = at(&text);
        for (a, b) in found.rows.iter().flatten().zip(want.rows.iter().flatten()) {
            assert!((a - b).abs() < 1e-12, "{text}");
        }
    }
}

#[test]
fn materials_have_two_sides_where_pbrt_has_them() {
    let scene = read("", "Shape \"sphere\"");
    assert!(
        matches!(material(&scene, 1), MaterialKind::Diffuse { reflectance } if *reflectance == TextureInput::number(0.5))
    );
    let scene = read("", "Material \"dielectric\" \"float roughness\" 0\nShape \"sphere\"");
    assert!(matches!(material(&scene, 0), MaterialKind::Dielectric { eta: 1.5, roughness: None, .. }));
    let scene = read("", "Material \"conductor\" \"float uroughness\" .25\nShape \"sphere\"");
    let MaterialKind::Conductor { eta, roughness: Some(roughness), .. } = material(&scene, 1) else {
        panic!()
    };
    let copper = SpectrumDescription::Conductor { name: "Cu".to_owned(), quantity: ConductorQuantity::Eta };
    assert_eq!(*eta, TextureInput::Constant(copper));
    assert_eq!(
        (&roughness.alpha_u, &roughness.alpha_v),
        (&TextureInput::number(0.25), &TextureInput::number(0.0))
    );
    assert!(roughness.remap);
}

#[test]
fn materials_of_spectra() {
    let scene = read("", "Material \"conductor\" \"rgb reflectance\" [ 0 .5 1 ]\nShape \"sphere\"");
    let MaterialKind::Conductor {
        eta, k: TextureInput::Constant(SpectrumDescription::Rgb([r, g, b])), ..
    } = material(&scene, 1)
    else {
        panic!()
    };
    assert_eq!((eta, *r, *g), (&TextureInput::number(1.0), 0.0, 2.0));
    assert!(b.is_finite() && *b > 100.0);
    for (eta, want) in
        [("\"spectrum eta\" \"glass-BK7\"", 1.51673), ("\"spectrum eta\" [ 489.3 1.5 689.3 1.4 ]", 1.45)]
    {
        let scene = read("", &format!("Material \"thindielectric\" {eta}\nShape \"sphere\""));
        let MaterialKind::ThinDielectric { eta, .. } = material(&scene, 0) else { panic!() };
        assert!((eta - want).abs() < 1e-5);
    }
}

#[test]
fn holes_bumps_and_missing_surfaces() {
    let scene = read(
        "",
        "Texture \"h\" \"float\" \"checkerboard\"
        Material \"diffuse\" \"texture displacement\" \"h\"
        Shape \"sphere\" \"float alpha\" .5
        Shape \"disk\" \"float alpha\" .5
        Material \"interface\"
        Shape \"sphere\"",
    );
    assert_eq!(scene.shapes.len(), 2);
    assert!(
        matches!(material(&scene, 0), MaterialKind::Mask { opacity, .. } if *opacity == TextureInput::number(0.5))
    );
    assert!(matches!(material(&scene, 1), MaterialKind::Bump { scale: 1.0, .. }));
    assert!(matches!(material(&scene, 3), MaterialKind::Diffuse { .. }));
    assert_eq!(scene.shapes[0].material, scene.shapes[1].material);
}

/// A light without a surface becomes black and opaque, and a warning says so.
#[test]
fn lights_without_a_surface() {
    let (scene, diagnostics) = read_any(
        Path::new("/nonexistent"),
        "",
        "Material \"interface\" AreaLightSource \"diffuse\" Shape \"sphere\"",
    );
    let codes: Vec<_> = diagnostics.list.iter().map(|d| (d.severity, d.code)).collect();
    assert_eq!(codes, [(Severity::Warning, "opaque-interface")]);
    let light = &scene.shapes[0];
    assert!(light.emission.is_some());
    let kind = &scene.materials[light.material.0 as usize].kind;
    assert!(
        matches!(kind, MaterialKind::Diffuse { reflectance } if *reflectance == TextureInput::number(0.0))
    );
}

#[test]
fn everything_is_read_in_silence() {
    let mut sources = SourceMap::default();
    let mut diagnostics = Diagnostics::new(false);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pbrt_everything.pbrt");
    let scene = pbrt::read(
        &path,
        &ReadOptions::default(),
        &mut sources,
        &mut diagnostics,
        &mut LoadReport::default(),
    );
    assert!(diagnostics.list.is_empty(), "{}", render(&diagnostics, &sources, false));
    let scene = scene.unwrap();
    assert_eq!((scene.shapes.len(), scene.instances.len(), scene.lights.len()), (7, 2, 4));
    // A default from `Attribute`.
    assert!(close(scene.shapes[0].to_world.vector(Vec3::X), 2.0 * Vec3::X));
}
