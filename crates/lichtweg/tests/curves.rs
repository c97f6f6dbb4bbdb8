//! Curves as shapes: rays leave them, instances of them are what they would be in their place, and surface coordinates go along
//! and across them. All statements hold for every ray; the seeds are fixed.

mod common;

use std::sync::Arc;

use common::build::{Build, chain, placed};
use common::run::compile_scene;
use lichtweg::scene::description::{
    CurvesDescription, Description, Diagnostics, GeometryDescription, InstanceDescription, LightKind, Span,
    SpectrumDescription,
};
use lichtweg::scene::{RayCounts, Scene, SurfacePoint};
use lichtweg_montecarlo::{Sampler, SamplerKind, warp};
use lichtweg_ray::math::{Affine, Vec3};
use lichtweg_ray::{CurveBasis, CurvePoint, CurveStyle, Placement, Ray};

const STYLES: [CurveStyle; 3] = [CurveStyle::Round, CurveStyle::Flat, CurveStyle::Ribbon];

/// A curve of three segments along x, bent by so much.
fn curve(style: CurveStyle, basis: CurveBasis, bend: f32) -> GeometryDescription {
    let count = basis.order() + 2 * basis.step();
    let point = |i: usize| {
        let x = i as f32 / (count - 1) as f32 * 2.0 - 1.0;
        // A band that faces the ray is wider elsewhere than where the ray starts, if it is tapered: it shadows itself.
        let taper = if style == CurveStyle::Flat { 0.0 } else { 0.02 };
        CurvePoint { position: Vec3::new(x, bend * x * x, bend * x), radius: 0.06 - taper * x }
    };
    let normals = if style == CurveStyle::Ribbon { vec![Vec3::new(0.1, 0.2, 1.0); 4] } else { vec![] };
    GeometryDescription::Curves(Arc::new(CurvesDescription {
        style,
        basis,
        points: (0..count).map(point).collect(),
        counts: vec![count],
        normals,
        scales_radii: true,
    }))
}

/// A scene with light and nothing else.
fn empty() -> Description {
    let mut description = Description::default();
    description.light(LightKind::Constant { radiance: SpectrumDescription::Constant(1.0) });
    description
}

fn alone(geometry: GeometryDescription, to_world: Affine) -> Scene {
    let mut description = empty();
    let white = description.diffuse([1.0; 3]);
    description.shape(geometry, to_world, white);
    compile_scene(&description)
}

/// Rays from all around to a place near the curve, and their hits.
fn hits<'a>(
    scene: &'a Scene,
    to_world: &'a Affine,
    count: u32,
) -> impl Iterator<Item = (Ray, SurfacePoint, [f32; 2])> + 'a {
    (0..count).filter_map(move |i| {
        let mut sampler = Sampler::new(SamplerKind::Independent, 5, 0, i);
        let mut next = || sampler.next_1d();
        let from = warp::uniform_sphere([next(), next()]);
        let aim = Vec3::new(2.2 * next() - 1.1, 0.2 * next() - 0.1, 0.2 * next() - 0.1);
        let origin = to_world.point(Vec3::from_array(from) * 4.0);
        let ray = Ray::new(origin, to_world.point(aim) - origin);
        let point = scene.intersect(&ray, &mut RayCounts::default(), || 0.5)?;
        Some((ray, point, [next(), next()]))
    })
}

fn places() -> [Affine; 3] {
    [
        Affine::IDENTITY,
        chain(&[placed([700.0, -300.0, 40.0], [1.0; 3]), Affine::rotation([1.0, 2.0, 3.0], 50.0)]),
        placed([0.01, 0.02, -0.03], [1e-3; 3]),
    ]
}

/// A straight tube or band does not shadow itself.
#[test]
fn rays_leave_straight_curves() {
    for style in STYLES {
        for (basis, to_world) in
            [CurveBasis::Linear, CurveBasis::Bezier, CurveBasis::BSpline].into_iter().zip(places())
        {
            let scene = alone(curve(style, basis, 0.0), to_world);
            let mut number = 0;
            for (ray, point, [a, b]) in hits(&scene, &to_world, 20_000) {
                let up = Vec3::from_array(warp::uniform_sphere([a, b]));
                let normal = point.geometric_normal;
                let direction = if up.dot(normal) * normal.dot(ray.direction) < 0.0 { up } else { -up };
                let away = Ray::new(point.leave(direction), direction);
                assert_eq!(
                    scene.transmittance(&away, &mut RayCounts::default()),
                    1.0,
                    "{style:?} {basis:?}: {point:?} along {direction:?}"
                );
                number += 1;
            }
            assert!(number > 2000, "{number} hits");
        }
    }
}

#[test]
fn instances_are_what_they_would_be_in_their_place() {
    let to_world = chain(&[placed([3.0, -2.0, 1.0], [2.0; 3]), Affine::rotation([0.3, 1.0, 0.2], 70.0)]);
    for style in STYLES {
        let geometry = curve(style, CurveBasis::BSpline, 0.3);
        let direct = alone(geometry.clone(), to_world);
        let mut description = empty();
        let white = description.diffuse([1.0; 3]);
        let group = description.add_group();
        description.shape(geometry, Affine::IDENTITY, white).group = Some(group);
        let placement = Placement::Fixed(to_world);
        description.instances.push(InstanceDescription { span: Span::default(), group, to_world: placement });
        let instanced = compile_scene(&description);
        let (mut number, mut differ) = (0, 0);
        for (ray, a, _) in hits(&direct, &to_world, 5000) {
            number += 1;
            let Some(b) = instanced.intersect(&ray, &mut RayCounts::default(), || 0.5) else {
                differ += 1;
                continue;
            };
            let near = |a: Vec3, b: Vec3, within: f32| (a - b).length() < within;
            let same = near(a.position, b.position, 1e-4)
                && near(a.geometric_normal, b.geometric_normal, 0.02)
                && near(a.shading_normal, b.shading_normal, 0.02)
                && (a.uv - b.uv).x.hypot((a.uv - b.uv).y) < 1e-2;
            differ += u32::from(!same);
        }
        // At silhouettes rounding decides.
        assert!(number > 500 && differ * 200 < number, "{style:?}: {differ} of {number} differ");
    }
}

/// Of a band: the position is about linear in the surface coordinates. Where chords meet in a round joint, u stays that of the
/// joint, so that along the curve it is right to a radius.
#[test]
fn coordinates_go_along_and_across() {
    for style in [CurveStyle::Flat, CurveStyle::Ribbon] {
        let scene = alone(curve(style, CurveBasis::BSpline, 0.1), Affine::IDENTITY);
        let (mut number, mut off) = (0, 0);
        for (ray, p, _) in hits(&scene, &Affine::IDENTITY, 4000) {
            let partials = scene.form(0).partials(&p).expect("a curve has a direction everywhere");
            let [along, across] = partials;
            assert!(along.x > 0.0 && (0.0..=1.0).contains(&p.uv.x) && (0.0..=1.0).contains(&p.uv.y));
            // What the coordinates of a hit near by say of a shift, and the shift, along a direction.
            let shift = |step: Vec3, direction: Vec3| {
                let near = Ray { direction: ray.direction + step, ..ray };
                let q = scene.intersect(&near, &mut RayCounts::default(), || 0.5)?;
                let told = along * (q.uv.x - p.uv.x) + across * (q.uv.y - p.uv.y);
                let direction = direction.normalized();
                Some((told.dot(direction), (q.position - p.position).dot(direction)))
            };
            let radius = 0.5 * across.length();
            let (aside, ahead) = (across * 1e-2, along * 0.1);
            let (Some(v), Some(u)) = (shift(aside, across), shift(ahead, along)) else { continue };
            let wrong =
                (v.0 - v.1).abs() > 0.2 * aside.length() || (u.0 - u.1).abs() > radius + 0.2 * ahead.length();
            off += u32::from(wrong);
            number += 1;
        }
        assert!(number > 200 && off * 20 < number, "{style:?}: {off} of {number} are off");
    }
}

#[test]
fn curves_that_emit_are_refused() {
    let mut description = Description::default();
    let white = description.diffuse([1.0; 3]);
    let shape = description.shape(curve(CurveStyle::Round, CurveBasis::Linear, 0.0), Affine::IDENTITY, white);
    shape.emission = common::build::glow([1.0; 3]);
    for lenient in [false, true] {
        let mut diagnostics = Diagnostics::new(lenient);
        let scene = Scene::compile(&description, &mut diagnostics);
        assert!(diagnostics.list.iter().any(|d| d.code == "emitting-curves"));
        assert_eq!(scene.is_some(), lenient);
    }
}
