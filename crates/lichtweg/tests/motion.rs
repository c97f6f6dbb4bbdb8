//! Instances and motion: instances render as the shapes they stand for, and blur is the time average.
//!
//! Images: Welch tests with a probability of a false alarm of 0.01 a family (see `common::judge`). Coverage: z tests over
//! blocks of 4 x 4 pixels at 0.01, corrected by Sidak.

mod common;

use std::sync::Arc;

use common::build::{
    Build, CYLINDER, DISK, SPHERE, bitmap, chain, checkerboard, cube, glow, grid, metal, rectangle, rough,
};
use common::judge::{ALPHA, assert_pairwise_agreement};
use common::run::{camera, compile_scene, film, render};
use lichtweg::camera::Camera;
use lichtweg::scene::RayCounts;
use lichtweg::scene::description::{
    CameraDescription, Description, Diagnostics, GroupId, InstanceDescription, LightKind, MaterialKind,
    MicrofacetKind, ShapeDescription, Span, SpectrumDescription, TextureFilter, TextureInput,
};
use lichtweg_montecarlo::hypothesis::{sidak, z_test};
use lichtweg_ray::math::{Affine, Motion, Vec3};
use lichtweg_ray::{Placement, Ray};

fn place(d: &mut Description, group: GroupId, to_world: Placement) {
    d.instances.push(InstanceDescription { span: Span::default(), group, to_world });
}

fn moving(keys: impl IntoIterator<Item = (f32, Affine)>) -> Placement {
    Placement::Moving(Arc::new(Motion::new(keys).expect("a motion")))
}

fn environment(d: &mut Description) {
    d.light(LightKind::Constant { radiance: SpectrumDescription::Constant(1.0) });
}

fn shift(x: f64, y: f64, z: f64) -> Affine {
    Affine::translation(x, y, z)
}

/// A black ball of radius 0.5 that passes before a white sky, from `from` when the shutter opens to `to`.
fn passing_ball(camera: CameraDescription, to_world: Placement) -> Description {
    let mut d = Description { camera, film: film(32, 32), ..Default::default() };
    d.sampler.samples_per_pixel = 64;
    environment(&mut d);
    let black = d.diffuse([0.0; 3]);
    let group = d.add_group();
    d.shape(SPHERE, Affine::scaling(0.5, 0.5, 0.5), black).group = Some(group);
    place(&mut d, group, to_world);
    d
}

/// The part of the time for which a ray from the origin meets a ball whose centre goes from `a` to `b`: where the
/// squared distance of the centre c = a + s (b - a) to the ray, |c|^2 - (c . d)^2, is below that of the radius.
fn covered(d: Vec3, [a, b]: [Vec3; 2], radius: f64) -> f64 {
    let wide = |v: Vec3| v.to_array().map(f64::from);
    let dot = |x: [f64; 3], y: [f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    let (d, a, v) = (wide(d), wide(a), wide(b - a));
    let (ad, vd) = (dot(a, d), dot(v, d));
    let (p, q) = (dot(v, v) - vd * vd, dot(a, v) - ad * vd);
    let c = dot(a, a) - ad * ad - radius * radius;
    let root = q * q - p * c;
    if root <= 0.0 {
        return 0.0;
    }
    let [first, last] = [(-q - root.sqrt()) / p, (-q + root.sqrt()) / p].map(|s| s.clamp(0.0, 1.0));
    last - first
}

fn assert_coverage(description: &Description, path: [Vec3; 2], camera_at: Vec3) {
    let camera = Camera::compile(&description.camera, 32, 32, &mut Diagnostics::default()).expect("a camera");
    let image = render(description);
    const FINE: u32 = 24;
    let expected = |x: u32, y: u32| {
        let mut sum = 0.0;
        for i in 0..FINE * FINE {
            let fraction = |base: u32, i: u32| (base as f32 + (i as f32 + 0.5) / FINE as f32) / 32.0;
            let ray = camera.ray([fraction(x, i % FINE), fraction(y, i / FINE)], [0.5; 2], 0.0);
            sum += covered(ray.direction, path.map(|p| p - camera_at), 0.5);
        }
        1.0 - sum / f64::from(FINE * FINE)
    };
    let mut partly = 0;
    for block in 0..64 {
        let (mut mean, mut want) = (0.0, 0.0);
        for i in 0..16 {
            let (x, y) = (block % 8 * 4 + i % 4, block / 8 * 4 + i / 4);
            let pixel = &image.pixels[(y * 32 + x) as usize];
            mean += pixel.mean()[0] / 16.0;
            want += expected(x, y) / 16.0;
        }
        // The hits are binomially distributed, or less spread; few are far from normal.
        let samples = 16.0 * f64::from(description.sampler.samples_per_pixel);
        let variance = want * (1.0 - want) / samples;
        if want * (1.0 - want) * samples < 25.0 {
            assert!((mean - want).abs() < 0.03, "block {block}: {mean} instead of {want}");
            continue;
        }
        partly += 1;
        // What the quadrature over pixels may err by.
        let excess = ((mean - want).abs() - 5e-4).max(0.0);
        let outcome = z_test(excess, variance);
        assert!(!outcome.rejects(sidak(ALPHA, 64)), "block {block}: {mean} instead of {want}");
    }
    assert!(partly > 10, "only {partly} blocks see the ball for part of the time");
}

#[test]
fn a_moving_ball_blurs_as_it_covers() {
    let view = CameraDescription { shutter: [0.0, 1.0], ..camera([0.0, 0.0, 5.0], [0.0; 3], 40.0) };
    let (a, b) = (Vec3::new(-1.2, -0.3, 0.0), Vec3::new(1.0, 0.6, 1.0));
    let at = |p: Vec3| shift(p.x.into(), p.y.into(), p.z.into());
    let d = passing_ball(view.clone(), moving([(0.0, at(a)), (1.0, at(b))]));
    assert_coverage(&d, [a, b], Vec3::new(0.0, 0.0, 5.0));
    // The shutter is open for the third quarter of the way.
    let late = CameraDescription { shutter: [2.0, 2.5], ..view };
    let d = passing_ball(late, moving([(1.0, at(a)), (3.0, at(b))]));
    assert_coverage(&d, [(a + b) * 0.5, a * 0.25 + b * 0.75], Vec3::new(0.0, 0.0, 5.0));
}

#[test]
fn a_moving_camera_sees_a_moving_world() {
    let view = camera([0.0, 0.0, 5.0], [0.0; 3], 40.0);
    let (a, b) = (Vec3::new(-1.2, 0.0, 0.0), Vec3::new(1.0, 0.5, 0.0));
    let against = |p: Vec3| shift((-p.x).into(), (-p.y).into(), (-p.z).into()).after(&view.to_world);
    let motion = Motion::new([(0.0, against(a)), (1.0, against(b))]).map(Arc::new);
    let moved = CameraDescription { shutter: [0.0, 1.0], motion, ..view.clone() };
    let image = render(&passing_ball(moved, Placement::Fixed(Affine::IDENTITY)));
    let at = |p: Vec3| shift(p.x.into(), p.y.into(), p.z.into());
    let still = CameraDescription { shutter: [0.0, 1.0], ..view };
    let expected = render(&passing_ball(still, moving([(0.0, at(a)), (1.0, at(b))])));
    assert_pairwise_agreement("motion", &[("camera".to_owned(), image), ("world".to_owned(), expected)]);
}

#[test]
fn without_time_nothing_moves() {
    let view = CameraDescription { shutter: [0.5, 0.5], ..camera([0.0, 0.0, 5.0], [0.0; 3], 40.0) };
    let keys = [(0.0, shift(-2.0, 0.0, 0.0)), (1.0, shift(2.0, 0.0, 0.0))];
    let image = render(&passing_ball(view.clone(), moving(keys)));
    let still = render(&passing_ball(view, Placement::Fixed(Affine::IDENTITY)));
    assert!(image.pixels.iter().zip(&still.pixels).all(|(a, b)| a.mean() == b.mean()));
}

/// Shapes of all kinds with textures, bumps and tangents, and places for them.
fn still_life() -> (Description, Vec<ShapeDescription>, Vec<Affine>) {
    let mut d = Description {
        camera: camera([1.0, 6.0, 14.0], [0.0; 3], 40.0),
        film: film(48, 48),
        ..Default::default()
    };
    d.sampler.samples_per_pixel = 32;
    d.light(LightKind::Point {
        position: Vec3::new(3.0, 9.0, 8.0),
        intensity: SpectrumDescription::Constant(90.0),
    });
    environment(&mut d);
    let checks = d.texture(checkerboard([0.8, 0.3, 0.1], [0.1, 0.4, 0.7], 5.0));
    let diffuse = d.material(MaterialKind::Diffuse { reflectance: checks });
    let diffuse = d.two_sided(diffuse);
    let hills: Vec<[f32; 3]> = (0..16).map(|i| [(i * 7 % 16) as f32 / 16.0; 3]).collect();
    let TextureInput::Texture(height) = d.texture(bitmap(4, &hills, TextureFilter::Bilinear)) else {
        unreachable!()
    };
    let bumpy = d.material(MaterialKind::Bump { height, scale: 0.1, nested: diffuse });
    let brushed = d.material(metal(rough(MicrofacetKind::Ggx, 0.5, 0.1)));
    let brushed = d.two_sided(brushed);
    let wave = |x: f32, y: f32| Vec3::new(x, y, 0.2 * (3.0 * x).sin() * (2.0 * y).cos());
    let unit = Affine::IDENTITY;
    d.shape(grid(40, wave, true), unit, brushed);
    d.shape(cube(), chain(&[shift(0.0, 0.0, -1.0), Affine::scaling(0.5, 0.5, 0.5)]), bumpy);
    d.shape(SPHERE, chain(&[shift(0.9, 0.3, 0.6), Affine::scaling(0.4, 0.3, 0.5)]), brushed);
    d.shape(CYLINDER, chain(&[shift(-0.9, 0.0, 0.2), Affine::scaling(0.2, 0.3, 0.8)]), bumpy);
    d.shape(DISK, chain(&[shift(-0.4, 0.5, 0.9), Affine::scaling(0.4, 0.4, 0.4)]), diffuse).flip_normals =
        true;
    let places = vec![
        chain(&[
            shift(-3.0, 1.0, 0.0),
            Affine::rotation([1.0, 0.2, 0.0], -50.0),
            Affine::scaling(1.2, 1.2, 1.2),
        ]),
        chain(&[
            shift(3.0, 0.0, 1.0),
            Affine::rotation([0.3, 1.0, 0.0], 140.0),
            Affine::scaling(1.0, 1.5, 0.7),
        ]),
        chain(&[
            shift(0.0, -1.5, 3.0),
            Affine::rotation([1.0, 0.0, 0.0], -70.0),
            Affine::scaling(-1.0, 0.8, 1.0),
        ]),
    ];
    let shapes = std::mem::take(&mut d.shapes);
    (d, shapes, places)
}

/// The still life in each place: by instances, and by copies.
fn placed_both_ways() -> [Description; 2] {
    let (d, shapes, places) = still_life();
    let (mut instanced, mut copied) = (d.clone(), d);
    let group = instanced.add_group();
    instanced.shapes = shapes.iter().map(|s| ShapeDescription { group: Some(group), ..s.clone() }).collect();
    for map in places {
        place(&mut instanced, group, Placement::Fixed(map));
        let moved = |s: &ShapeDescription| ShapeDescription { to_world: map.after(&s.to_world), ..s.clone() };
        copied.shapes.extend(shapes.iter().map(moved));
    }
    [instanced, copied]
}

#[test]
fn instances_look_like_copies() {
    let images = placed_both_ways().map(|d| render(&d));
    let named = ["instances", "copies"].map(str::to_owned).into_iter().zip(images);
    assert_pairwise_agreement("still life", &named.collect::<Vec<_>>());
}

#[test]
fn points_on_instances_are_those_of_copies() {
    let [instanced, copied] = placed_both_ways().map(|d| compile_scene(&d));
    let mut met = 0;
    for i in 0..20_000 {
        let (x, y) = ((i % 200) as f32 * 0.1 - 10.0, (i / 200) as f32 * 0.1 - 5.0);
        let origin = Vec3::new(0.5, 5.0, 15.0);
        let ray = Ray::new(origin, (Vec3::new(0.6 * x, y, 0.0) - origin).normalized());
        let hit = |scene: &lichtweg::scene::Scene| scene.intersect(&ray, &mut RayCounts::default(), || 0.5);
        let (Some(a), Some(b)) = (hit(&instanced), hit(&copied)) else { continue };
        // At edges and silhouettes the two may see different surfaces.
        if (a.position - b.position).length() > 1e-3 || a.primitive != b.primitive {
            continue;
        }
        met += 1;
        let off = (a.position - b.position).dot(b.geometric_normal).abs();
        assert!(off <= a.error + b.error, "{off} off the surface: {a:?} and {b:?}");
        assert!((a.geometric_normal - b.geometric_normal).length() < 1e-3, "{a:?} and {b:?}");
        assert!((a.shading_normal - b.shading_normal).length() < 2e-2, "{a:?} and {b:?}");
        assert!((a.uv.x - b.uv.x).abs() < 1e-3 && (a.uv.y - b.uv.y).abs() < 1e-3, "{a:?} and {b:?}");
    }
    assert!(met > 3000, "{met} points compared");
}

#[test]
fn rays_leave_instances() {
    for (size, at) in [(1.0, 0.0), (1e-3, 1.0), (1.0, 1e4), (1e4, 1e3), (1e-2, 0.0)] {
        for shape in [SPHERE, cube()] {
            let mut d = Description::default();
            environment(&mut d);
            let grey = d.diffuse([0.5; 3]);
            let group = d.add_group();
            // Large in its own space, small in the world, and far from both origins.
            d.shape(shape, chain(&[shift(30.0, 0.0, 0.0), Affine::scaling(10.0, 10.0, 10.0)]), grey).group =
                Some(group);
            let s = 0.1 * size;
            let map = chain(&[
                shift(at, -at, 0.5 * at),
                Affine::rotation([1.0, 2.0, 0.5], 40.0),
                Affine::scaling(s, 0.3 * s, 2.0 * s),
                shift(-30.0, 0.0, 0.0),
            ]);
            place(&mut d, group, Placement::Fixed(map));
            let scene = compile_scene(&d);
            let center = shift(at, -at, 0.5 * at).point(Vec3::ZERO);
            let mut counts = RayCounts::default();
            for i in 0..2000_u32 {
                let unit = |k: u32| {
                    (i.wrapping_mul(2_654_435_761).wrapping_add(k) >> 7 & 0xffff) as f32 / 32768.0 - 1.0
                };
                let towards = Vec3::new(unit(0), unit(0x1234_5678), unit(0x9abc_def0));
                let Some(towards) = towards.try_normalized() else { continue };
                let ray = Ray::new(center, towards);
                let point = scene
                    .intersect(&ray, &mut counts, || 0.5)
                    .expect("from the centre the shape is all around");
                let outward = |s: f32| (point.geometric_normal + towards * s).normalized();
                for direction in [outward(0.0), outward(0.9), outward(-0.9)] {
                    let out = Ray::new(point.leave(direction), direction);
                    assert_eq!(
                        scene.transmittance(&out, &mut counts),
                        1.0,
                        "{size} {at}: outward from {point:?}"
                    );
                    let back = Ray::new(point.leave(-direction), -direction);
                    assert_eq!(
                        scene.transmittance(&back, &mut counts),
                        0.0,
                        "{size} {at}: inward from {point:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn what_cannot_be_is_told() {
    let faults = |d: &Description| {
        let mut diagnostics = Diagnostics::default();
        assert!(lichtweg::scene::Scene::compile(d, &mut diagnostics).is_none());
        diagnostics.list.iter().map(|d| d.code).collect::<Vec<_>>()
    };
    let base = || {
        let mut d = Description::default();
        environment(&mut d);
        let grey = d.diffuse([0.5; 3]);
        let group = d.add_group();
        d.shape(rectangle(), Affine::IDENTITY, grey).group = Some(group);
        (d, group)
    };
    let (mut d, group) = base();
    d.shapes[0].emission = glow([1.0; 3]);
    assert_eq!(faults(&d), ["emitting-instance"]);
    let (mut d, _) = base();
    d.shapes[0].group = Some(GroupId(7));
    assert_eq!(faults(&d), ["unknown-group"]);
    let (mut d, _) = base();
    place(&mut d, GroupId(1), Placement::Fixed(Affine::IDENTITY));
    assert_eq!(faults(&d), ["unknown-group"]);
    let (mut d, _) = base();
    place(&mut d, group, Placement::Fixed(Affine::scaling(1.0, 0.0, 1.0)));
    assert_eq!(faults(&d), ["singular-transform"]);
}
