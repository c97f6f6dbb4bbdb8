//! What good Mitsuba scenes become: conventions, defaults and the spellings of old versions, family by family.
//!
//! The numbers that are expected are Mitsuba 3.9's own defaults and behaviour.

use std::path::Path;
use std::sync::Arc;

use lichtweg::scene::description::{
    ConductorQuantity, Description, Diagnostics, EstimatorKind, FieldOfView, FilterDescription, FilterKind,
    FovAxis, GeometryDescription, LightKind, MaterialKind, Mesh, MicrofacetKind, ShapeDescription, SourceMap,
    SpectrumDescription, TextureDescription, TextureFilter, TextureInput, TextureKind, WrapMode,
};
use lichtweg_io::diagnostics::render;
use lichtweg_io::mitsuba::{read, read_str};
use lichtweg_io::options::{LoadReport, ReadOptions};
use lichtweg_montecarlo::SamplerKind;
use lichtweg_ray::math::{Affine, Vec3};
use lichtweg_ray::{CurveBasis, CurvePoint, CurveStyle};

fn file(path: &str, defines: &[(&str, &str)]) -> Description {
    let defines = defines.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect();
    let (mut sources, mut diagnostics) = (SourceMap::default(), Diagnostics::new(false));
    let options = ReadOptions { defines };
    let scene = read(Path::new(path), &options, &mut sources, &mut diagnostics, &mut LoadReport::default());
    scene.unwrap_or_else(|| panic!("{}", render(&diagnostics, &sources, false)))
}

/// A scene of version 3 with a plain camera and this in it.
fn scene(body: &str) -> Description {
    version("3.0.0", &format!("<sensor type=\"perspective\"/>{body}"))
}

fn version(version: &str, body: &str) -> Description {
    let text = format!("<scene version=\"{version}\">{body}</scene>");
    let (mut sources, mut diagnostics) = (SourceMap::default(), Diagnostics::new(false));
    let name = Path::new("tests/good/mitsuba/scene.xml");
    let (options, mut report) = (ReadOptions::default(), LoadReport::default());
    let scene = read_str(name, &text, &options, &mut sources, &mut diagnostics, &mut report);
    scene.unwrap_or_else(|| panic!("{}", render(&diagnostics, &sources, false)))
}

fn material(bsdf: &str) -> MaterialKind {
    scene(bsdf).materials.pop().unwrap().kind
}

fn shape(body: &str) -> ShapeDescription {
    scene(body).shapes.pop().unwrap()
}

fn to_world(body: &str) -> Affine {
    shape(&format!("<shape type=\"disk\"><transform name=\"to_world\">{body}</transform></shape>")).to_world
}

fn mesh(shape: &ShapeDescription) -> &Arc<Mesh> {
    match &shape.geometry {
        GeometryDescription::Mesh(mesh) => mesh,
        other => panic!("a mesh expected, got {other:?}"),
    }
}

fn texture(scene: &Description, input: &TextureInput) -> TextureDescription {
    match input {
        TextureInput::Texture(id) => scene.textures[id.0 as usize].clone(),
        other => panic!("a texture expected, got {other:?}"),
    }
}

fn close(a: Vec3, b: [f32; 3]) -> bool {
    (a - Vec3::from_array(b)).length() < 1e-5
}

#[test]
fn an_empty_scene_has_mitsubas_defaults() {
    let scene = scene("");
    let camera = &scene.camera;
    assert_eq!(camera.near_clip, 0.01);
    assert_eq!(camera.far_clip, 1e4);
    assert_eq!(camera.focus_distance, 1e4);
    // 50 mm on the diagonal of 36 mm x 24 mm: Mitsuba prints an x_fov of 38.1848 degrees for it at 768 x 576.
    let FieldOfView::Angle { degrees, axis: FovAxis::Diagonal } = camera.field_of_view else { panic!() };
    let half_width = (0.5 * degrees).to_radians().tan() / (1.0f32 + 0.75 * 0.75).sqrt();
    assert!((2.0 * half_width.atan().to_degrees() - 38.1848).abs() < 1e-3);
    assert_eq!((scene.film.width, scene.film.height, scene.film.crop), (768, 576, None));
    let gaussian = FilterDescription::new(FilterKind::Gaussian { standard_deviation: 0.5 }, 2.0);
    assert_eq!(scene.film.filter, gaussian);
    assert_eq!((scene.sampler.kind, scene.sampler.samples_per_pixel), (SamplerKind::Independent, 4));
    assert_eq!((scene.integrator.max_depth, scene.integrator.roulette.start_depth), (None, Some(5)));
    assert_eq!(scene.name, "scene");
}

#[test]
fn integrators_count_edges() {
    let depth = |body: &str| scene(body).integrator.max_depth;
    assert_eq!(
        depth("<integrator type=\"path\"><integer name=\"max_depth\" value=\"7\"/></integrator>"),
        Some(7)
    );
    assert_eq!(
        depth("<integrator type=\"path\"><integer name=\"max_depth\" value=\"-1\"/></integrator>"),
        None
    );
    assert_eq!(depth("<integrator type=\"direct\"/>"), Some(2));
}

#[test]
fn walks_from_the_lights() {
    let light = scene(
        "<integrator type=\"ptracer\"><integer name=\"max_depth\" value=\"8\"/><integer name=\"rr_depth\" value=\"9\"/>\
         <boolean name=\"hide_emitters\" value=\"true\"/><integer name=\"samples_per_pass\" value=\"4\"/></integrator>",
    );
    let light = light.integrator;
    assert_eq!(
        (light.estimator, light.max_depth, light.hide_emitters),
        (EstimatorKind::Light, Some(8), true)
    );
    let both = version(
        "0.6.0",
        "<sensor type=\"perspective\"/><integrator type=\"bdpt\"><integer name=\"maxDepth\" value=\"5\"/><integer name=\"rrDepth\" value=\"3\"/>\
         <boolean name=\"lightImage\" value=\"true\"/><boolean name=\"sampleDirect\" value=\"false\"/></integrator>",
    );
    let both = both.integrator;
    assert_eq!((both.estimator, both.max_depth), (EstimatorKind::Bidirectional, Some(5)));
    assert_eq!(both.roulette.start_depth, Some(3));
}

#[test]
fn filters_have_mitsubas_radii() {
    let filter = |rfilter: &str| {
        version(
            "3.0.0",
            &format!("<sensor type=\"perspective\"><film type=\"hdrfilm\">{rfilter}</film></sensor>"),
        )
        .film
        .filter
    };
    assert_eq!(filter("<rfilter type=\"box\"/>"), FilterDescription::BOX);
    assert_eq!(filter("<rfilter type=\"tent\"/>"), FilterDescription::new(FilterKind::Tent, 1.0));
    let third = 1.0 / 3.0;
    let mitchell = FilterDescription::new(FilterKind::Mitchell { b: third, c: third }, 2.0);
    assert_eq!(filter("<rfilter type=\"mitchell\"/>"), mitchell);
    assert_eq!(filter("<rfilter type=\"catmullrom\"/>"), FilterDescription::new(FilterKind::CatmullRom, 2.0));
    let lanczos = FilterDescription::new(FilterKind::Lanczos { lobes: 3.0 }, 3.0);
    assert_eq!(filter("<rfilter type=\"lanczos\"/>"), lanczos);
    let wide = "<rfilter type=\"gaussian\"><float name=\"stddev\" value=\"1\"/></rfilter>";
    assert_eq!(filter(wide).radius, [4.0, 4.0]);
}

#[test]
fn transforms_apply_in_order() {
    let p = |body: &str| to_world(body).point(Vec3::new(1.0, 2.0, 3.0));
    assert!(close(p("<scale value=\"2\"/><translate x=\"1\"/>"), [3.0, 4.0, 6.0]));
    assert!(close(p("<translate x=\"1\"/><scale value=\"2\"/>"), [4.0, 4.0, 6.0]));
    assert!(close(p("<scale x=\"2\"/>"), [2.0, 2.0, 3.0]));
    assert!(close(p("<rotate z=\"1\" angle=\"90\"/>"), [-2.0, 1.0, 3.0]));
    assert!(close(p("<rotate value=\"0, 0, 5\" angle=\"90\"/>"), [-2.0, 1.0, 3.0]));
    assert!(close(p("<matrix value=\"0 -1 0 1 0 0 0 0 1\"/>"), [-2.0, 1.0, 3.0]));
    assert!(close(p("<matrix value=\"1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\"/>"), [6.0, 8.0, 10.0]));
    assert!(close(p("<matrix value=\"2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 2\"/>"), [1.0, 2.0, 3.0]));
    // A camera's +x is its left: looking along -z with +y up, that is the world's -x.
    let look = "<lookat origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/>";
    assert!(close(p(look), [-1.0, 2.0, 2.0]));
    let no_up = to_world("<lookat origin=\"0, 0, 5\" target=\"0, 0, 0\"/>");
    assert!(close(no_up.vector(Vec3::Z), [0.0, 0.0, -1.0]));
    assert!((no_up.determinant() - 1.0).abs() < 1e-9);
}

#[test]
fn quadrics_are_unit_shapes_under_a_transform() {
    let sphere = shape(
        "<shape type=\"sphere\"><point name=\"center\" value=\"1, 2, 3\"/><float name=\"radius\" value=\"2\"/>\
         <transform name=\"to_world\"><translate x=\"10\"/></transform></shape>",
    );
    assert!(close(sphere.to_world.point(Vec3::X), [13.0, 2.0, 3.0]));
    let cylinder = shape(
        "<shape type=\"cylinder\"><point name=\"p0\" value=\"1, 0, 0\"/><point name=\"p1\" value=\"1, 4, 0\"/>\
         <float name=\"radius\" value=\"0.5\"/></shape>",
    );
    assert!(close(cylinder.to_world.point(Vec3::ZERO), [1.0, 0.0, 0.0]));
    assert!(close(cylinder.to_world.point(Vec3::Z), [1.0, 4.0, 0.0]));
    assert!((cylinder.to_world.vector(Vec3::X).length() - 0.5).abs() < 1e-6);
    assert!(cylinder.to_world.determinant() > 0.0);
}

#[test]
fn mirrors_turn_spheres_and_faceted_meshes_inside_out() {
    let flipped = |body: &str| {
        let mirror = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
        shape(&body.replace("MIRROR", mirror)).flip_normals
    };
    assert!(flipped("<shape type=\"sphere\">MIRROR</shape>"));
    assert!(!flipped("<shape type=\"sphere\">MIRROR<boolean name=\"flip_normals\" value=\"true\"/></shape>"));
    assert!(!flipped("<shape type=\"disk\">MIRROR</shape>"));
    assert!(!flipped("<shape type=\"rectangle\">MIRROR</shape>"));
    let obj = "<string name=\"filename\" value=\"part/triangle.obj\"/>";
    let ply = "<string name=\"filename\" value=\"part/triangle.ply\"/>";
    assert!(flipped(&format!("<shape type=\"obj\">{obj}MIRROR</shape>")));
    assert!(!flipped(&format!("<shape type=\"ply\">{ply}MIRROR</shape>")));
    let faceted =
        format!("<shape type=\"ply\">{ply}MIRROR<boolean name=\"face_normals\" value=\"true\"/></shape>");
    assert!(flipped(&faceted));
}

#[test]
fn meshes_are_shared_smoothed_and_flipped_as_in_mitsuba() {
    let scene = file("tests/good/mitsuba/modern.xml", &[]);
    let meshes: Vec<&ShapeDescription> =
        scene.shapes.iter().filter(|s| matches!(s.geometry, GeometryDescription::Mesh(_))).collect();
    let [mirrored, plain, ply] = meshes[..] else { panic!("{} meshes", meshes.len()) };
    assert!(Arc::ptr_eq(mesh(mirrored), mesh(plain)));
    assert!(mirrored.flip_normals && !plain.flip_normals);
    // The file has no normals: smooth ones are made, which for one triangle are its own.
    assert!(mesh(plain).normals.iter().all(|n| close(*n, [0.0, 0.0, 1.0])));
    // OBJ texture coordinates have v upwards, Mitsuba's downwards; those of PLY are taken as they are.
    assert_eq!(mesh(plain).uvs[2].y, 0.25);
    assert_eq!(mesh(ply).uvs[2].y, 0.25);
    let unflipped = shape(
        "<shape type=\"ply\"><string name=\"filename\" value=\"part/triangle.ply\"/>\
         <boolean name=\"face_normals\" value=\"true\"/></shape>",
    );
    assert_eq!(mesh(&unflipped).uvs[2].y, 0.75);
    assert!(mesh(&unflipped).normals.is_empty());
}

#[test]
fn materials_have_mitsubas_defaults() {
    let half = TextureInput::number(0.5);
    let MaterialKind::Diffuse { reflectance } = material("<bsdf type=\"diffuse\"/>") else { panic!() };
    assert_eq!(reflectance, half);
    let MaterialKind::Dielectric { eta, roughness: None, .. } = material("<bsdf type=\"dielectric\"/>")
    else {
        panic!()
    };
    assert!((eta - 1.50418).abs() < 1e-5);
    let MaterialKind::Dielectric { roughness: Some(rough), .. } =
        material("<bsdf type=\"roughdielectric\"/>")
    else {
        panic!()
    };
    assert_eq!(
        (rough.distribution, rough.alpha_u, rough.remap),
        (MicrofacetKind::Beckmann, TextureInput::number(0.1), false)
    );
    let MaterialKind::Plastic { eta, diffuse_reflectance, roughness: None, nonlinear: false, .. } =
        material("<bsdf type=\"plastic\"/>")
    else {
        panic!()
    };
    assert!((eta - 1.48959).abs() < 1e-5);
    assert_eq!(diffuse_reflectance, half);
    let MaterialKind::Conductor { eta, k, .. } = material("<bsdf type=\"conductor\"/>") else { panic!() };
    assert_eq!((eta, k), (TextureInput::number(0.0), TextureInput::number(1.0)));
    // Shapes without a material are grey, all the same grey.
    let scene = scene("<shape type=\"sphere\"/><shape type=\"disk\"/>");
    assert_eq!((scene.materials.len(), scene.shapes[0].material), (1, scene.shapes[1].material));
    assert!(
        matches!(&scene.materials[0].kind, MaterialKind::Diffuse { reflectance } if *reflectance == half)
    );
}

#[test]
fn conductors_take_presets_or_numbers() {
    let gold = "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"Au\"/>\
                <float name=\"alpha_u\" value=\"0.1\"/><float name=\"alpha_v\" value=\"0.2\"/></bsdf>";
    let MaterialKind::Conductor { eta, roughness: Some(rough), .. } = material(gold) else { panic!() };
    let name = "Au".to_owned();
    let want = SpectrumDescription::Conductor { name, quantity: ConductorQuantity::Eta };
    assert_eq!(eta, TextureInput::Constant(want));
    assert_eq!((rough.alpha_u, rough.alpha_v), (TextureInput::number(0.1), TextureInput::number(0.2)));
    let none = "<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/></bsdf>";
    let MaterialKind::Conductor { eta, .. } = material(none) else { panic!() };
    assert_eq!(eta, TextureInput::number(0.0));
    // Mitsuba 0.6 took copper where nothing was said.
    let old = version("0.6.0", "<sensor type=\"perspective\"/><bsdf type=\"conductor\"/>");
    assert!(matches!(&old.materials[0].kind, MaterialKind::Conductor {
        k: TextureInput::Constant(SpectrumDescription::Conductor { name, .. }), ..
    } if name == "Cu"));
}

#[test]
fn references_work_forwards_through_aliases_and_includes() {
    let scene = file("tests/good/mitsuba/modern.xml", &[("depth", "9")]);
    assert_eq!(scene.integrator.max_depth, Some(9));
    let pole = scene.shapes.iter().find(|s| s.name.as_deref() == Some("pole")).unwrap();
    let tiles = &scene.materials[pole.material.0 as usize];
    assert_eq!(tiles.name.as_deref(), Some("tiles"));
    let MaterialKind::TwoSided { front, back } = tiles.kind else { panic!() };
    assert!(matches!(scene.materials[back.0 as usize].kind, MaterialKind::Plastic { .. }));
    let MaterialKind::Diffuse { reflectance } = &scene.materials[front.0 as usize].kind else { panic!() };
    let TextureKind::Checkerboard { even, odd, to_uv } = texture(&scene, reflectance).kind else { panic!() };
    assert_eq!(even, TextureInput::rgb([0.8; 3]));
    assert_eq!(to_uv.rows, [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
    let TextureKind::Bitmap { image, to_uv, wrap, filter, raw, .. } = texture(&scene, &odd).kind else {
        panic!()
    };
    assert_eq!((image.width, image.height, image.channels), (2, 2, 3));
    assert_eq!((wrap, filter, raw), (WrapMode::Mirror, TextureFilter::Nearest, false));
    // Mitsuba's v runs downwards over the image, the description's upwards.
    assert_eq!(to_uv.rows, [[2.0, 0.0, 0.5], [0.0, -3.0, 1.0]]);
}

#[test]
fn spectra_are_read_in_all_forms() {
    let reflectance = |value: &str| {
        let MaterialKind::Diffuse { reflectance } =
            material(&format!("<bsdf type=\"diffuse\">{value}</bsdf>"))
        else {
            panic!()
        };
        reflectance
    };
    assert_eq!(reflectance("<spectrum name=\"reflectance\" value=\"0.25\"/>"), TextureInput::number(0.25));
    assert_eq!(reflectance("<float name=\"reflectance\" value=\"0.25\"/>"), TextureInput::number(0.25));
    assert_eq!(
        reflectance("<rgb name=\"reflectance\" value=\"0.1, 0.2, 0.3\"/>"),
        TextureInput::rgb([0.1, 0.2, 0.3])
    );
    let srgb = reflectance("<srgb name=\"reflectance\" value=\"#ff8000\"/>");
    let TextureInput::Constant(SpectrumDescription::Rgb([r, g, b])) = srgb else { panic!() };
    assert!(r == 1.0 && (g - 0.215_861).abs() < 1e-5 && b == 0.0);
    let uniform =
        "<spectrum type=\"uniform\" name=\"reflectance\"><float name=\"value\" value=\"0.3\"/></spectrum>";
    assert_eq!(reflectance(uniform), TextureInput::number(0.3));
    let irregular = "<spectrum type=\"irregular\" name=\"reflectance\"><string name=\"wavelengths\" value=\"400, 700\"/>\
                     <string name=\"values\" value=\"0.1, 0.2\"/></spectrum>";
    let sampled = SpectrumDescription::Sampled { wavelengths: vec![400.0, 700.0], values: vec![0.1, 0.2] };
    assert_eq!(reflectance(irregular), TextureInput::Constant(sampled));
    let scene = file("tests/good/mitsuba/modern.xml", &[]);
    let measured = scene.materials.iter().find(|m| m.name.as_deref() == Some("measured")).unwrap();
    let from_file = SpectrumDescription::Sampled { wavelengths: vec![400.0, 700.0], values: vec![1.5, 1.25] };
    assert!(
        matches!(&measured.kind, MaterialKind::Conductor { eta: TextureInput::Constant(s), .. } if *s == from_file)
    );
}

#[test]
fn emitters_stand_where_they_are_put() {
    let scene = file("tests/good/mitsuba/modern.xml", &[]);
    let [point, sun, sky] = &scene.lights[..] else { panic!("{} lights", scene.lights.len()) };
    assert!(matches!(&point.kind, LightKind::Point { position, .. } if close(*position, [1.0, 2.0, 3.0])));
    assert!(
        matches!(&sun.kind, LightKind::Directional { direction, irradiance: SpectrumDescription::Rgb([1.0, 2.0, 3.0]) }
        if close(*direction, [0.0, -1.0, 0.0]))
    );
    assert!(matches!(&sky.kind, LightKind::Environment { image, .. } if image.width == 2));
    assert_eq!(sky.scale, 2.0);
    let spot = self::scene("<emitter type=\"spot\"/>");
    assert!(matches!(spot.lights[0].kind, LightKind::Spot { cutoff: 20.0, beam_width: 15.0, .. }));
}

#[test]
fn scenes_of_mitsuba_0_6_are_read() {
    let scene = file("tests/good/mitsuba/legacy.xml", &[("spp", "9")]);
    assert_eq!(scene.sampler.samples_per_pixel, 9);
    assert_eq!((scene.integrator.max_depth, scene.integrator.roulette.start_depth), (Some(5), Some(3)));
    assert!(scene.integrator.hide_emitters);
    let camera = &scene.camera;
    assert_eq!((camera.aperture_radius, camera.focus_distance, camera.near_clip), (0.1, 4.0, 0.1));
    assert_eq!(camera.field_of_view, FieldOfView::Angle { degrees: 40.0, axis: FovAxis::Smaller });
    assert!(camera.to_world.determinant() < 0.0);
    assert_eq!(scene.film.crop, Some([8, 0, 32, 48]));
    let [rectangle, triangle, lamp] = &scene.shapes[..] else { panic!() };
    assert!(rectangle.flip_normals && mesh(triangle).normals.is_empty());
    let MaterialKind::Diffuse { reflectance } = &scene.materials[rectangle.material.0 as usize].kind else {
        panic!()
    };
    let TextureKind::Bitmap { to_uv, raw, wrap, filter, .. } = texture(&scene, reflectance).kind else {
        panic!()
    };
    assert_eq!((raw, wrap, filter), (true, WrapMode::Clamp, TextureFilter::Bilinear));
    assert_eq!(to_uv.rows, [[2.0, 0.0, 0.0], [0.0, -1.0, 0.75]]);
    assert!(matches!(
        &lamp.emission.as_ref().unwrap().radiance,
        TextureInput::Constant(SpectrumDescription::Rgb(_))
    ));
    let glass = scene.materials.iter().find(|m| m.name.as_deref() == Some("glass")).unwrap();
    assert!(matches!(glass.kind, MaterialKind::Dielectric { eta, .. } if eta == 1.333));
    let LightKind::Constant { radiance: SpectrumDescription::Blackbody { kelvin, scale } } =
        &scene.lights[1].kind
    else {
        panic!()
    };
    // Planck at 5000 K and 555 nm is 12.7 kW / (m^2 sr nm); its luminance is near that.
    assert!(*kelvin == 5000.0 && (1.2e4..1.35e4).contains(scale), "{scale}");
}

#[test]
fn reports_where_the_time_goes() {
    let (mut sources, mut diagnostics) = (SourceMap::default(), Diagnostics::new(false));
    let mut report = LoadReport::default();
    let path = Path::new("tests/good/mitsuba/modern.xml");
    read(path, &ReadOptions::default(), &mut sources, &mut diagnostics, &mut report).unwrap();
    assert!(report.parse_seconds > 0.0 && report.mesh_seconds > 0.0 && report.image_seconds > 0.0);
    assert!(report.total_seconds >= report.parse_seconds);
    assert_eq!(sources.files().len(), 2);
}

/// Reads scenes of a checkout of the scene collection beside this one, where there is one.
#[test]
fn scenes_of_the_collection_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    for (name, shapes) in [("cornell-box", 8), ("veach-mis", 9), ("veach-bidir", 14), ("veach-ajar", 19)] {
        let path = folder.join(name).join("scene.xml");
        if !path.exists() {
            println!("skipped: there is no {}", path.display());
            continue;
        }
        assert_eq!(file(&path.to_string_lossy(), &[("spp", "1")]).shapes.len(), shapes, "{name}");
    }
}

const BALLS: &str = "<shape type=\"shapegroup\" id=\"balls\">
        <shape type=\"sphere\"/><shape type=\"sphere\"><point name=\"center\" x=\"3\" y=\"0\" z=\"0\"/></shape>
    </shape>";

#[test]
fn groups_have_instances() {
    let instance = |x: u32| {
        format!(
            "<shape type=\"instance\"><ref id=\"balls\"/>
            <transform name=\"to_world\"><translate x=\"{x}\"/></transform></shape>"
        )
    };
    // An instance may come before its group.
    let scene = scene(&format!("{}{BALLS}{}<shape type=\"disk\"/>", instance(1), instance(2)));
    assert_eq!(scene.groups, 1);
    let groups: Vec<_> = scene.shapes.iter().map(|s| s.group.map(|g| g.0)).collect();
    assert_eq!(groups, [Some(0), Some(0), None]);
    let places: Vec<_> =
        scene.instances.iter().map(|i| (i.group.0, i.to_world.at(0.0).point(Vec3::ZERO).x)).collect();
    assert_eq!(places, [(0, 1.0), (0, 2.0)]);
}

#[test]
fn animations_move_shapes_instances_and_sensors() {
    let animation = |name: &str| {
        format!(
            "<animation name=\"{name}\">
                <transform time=\"1\"><translate x=\"1\"/></transform>
                <transform time=\"2\"><scale value=\"1\"/><translate x=\"5\"/></transform>
            </animation>"
        )
    };
    let body = format!(
        "<sensor type=\"perspective\">
            <float name=\"shutterOpen\" value=\"1\"/><float name=\"shutterClose\" value=\"1.5\"/>{0}
        </sensor>
        {BALLS}
        <shape type=\"instance\"><ref id=\"balls\"/>{0}</shape>
        <shape type=\"sphere\"><float name=\"radius\" value=\"2\"/>{0}</shape>",
        animation("toWorld")
    );
    let scene = version("0.6.0", &body);
    let x = |map: Affine| map.point(Vec3::ZERO).x;
    let camera = scene.camera.motion.as_ref().expect("the camera moves");
    assert_eq!((scene.camera.shutter, x(camera.at(1.5))), ([1.0, 1.5], 3.0));
    let [group, ball] = &scene.instances[..] else { panic!("{} instances", scene.instances.len()) };
    for instance in [group, ball] {
        assert_eq!([0.0, 1.25, 7.0].map(|time| x(instance.to_world.at(time))), [1.0, 2.0, 5.0]);
    }
    let moved = scene.shapes.last().unwrap();
    assert_eq!((moved.group, moved.to_world.vector(Vec3::X)), (Some(ball.group), 2.0 * Vec3::X));
}

#[test]
fn curves_come_from_files_with_their_radii_as_they_are() {
    let body = "<shape type=\"linearcurve\"><string name=\"filename\" value=\"part/curves.txt\"/>
        <transform name=\"to_world\"><scale value=\"2\"/></transform></shape>";
    let GeometryDescription::Curves(curves) = shape(body).geometry else { panic!("no curves") };
    assert_eq!((curves.basis, curves.style), (CurveBasis::Linear, CurveStyle::Round));
    assert_eq!((&curves.counts[..], curves.scales_radii), (&[2, 4][..], false));
    assert_eq!(curves.points[1], CurvePoint { position: Vec3::new(1.0, 1.4, 1.2), radius: 0.25 });
}
