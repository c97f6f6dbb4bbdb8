//! Instances and moving things: names, normals, maps and faults.

mod support;

use std::sync::Arc;

use lichtweg_ray::math::{Affine, Motion, Vec3};
use lichtweg_ray::{
    Accel, BuildError, BuildOptions, Geometry, Hit, Instance, MovingMesh, Quadric, QuadricShape, Ray,
    TriangleMesh, UserPrimitives,
};
use support::{Balls, build};

const NONE: u32 = Hit::NO_INSTANCE;

fn ball() -> Geometry {
    Quadric { shape: QuadricShape::SPHERE, object_to_world: Affine::IDENTITY }.into()
}

fn square() -> TriangleMesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let positions = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
    TriangleMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])
}

fn down(x: f32, y: f32) -> Ray {
    Ray::new(Vec3::new(x, y, 9.0), -Vec3::Z)
}

#[test]
fn hits_name_their_path() {
    let leaf = Arc::new(build(vec![ball(), square().into()]));
    let middle = Arc::new(build(vec![
        square().into(),
        Instance::new(leaf.clone(), Affine::translation(10.0, 0.0, 0.0)).into(),
    ]));
    let half = Affine::scaling(0.5, 0.5, 0.5);
    let accel = build(vec![
        Instance::new(middle, Affine::translation(0.0, 20.0, 0.0).after(&half)).into(),
        Instance::new(leaf, Affine::IDENTITY).into(),
    ]);
    let hit = accel.closest(&down(5.0, 20.0)).unwrap();
    assert_eq!((hit.t, hit.geometry, hit.primitive, hit.instances), (8.5, 0, 0, [0, 1]));
    let hit = accel.closest(&down(0.25, 20.125)).unwrap();
    assert_eq!((hit.t, hit.geometry, hit.primitive, hit.instances), (9.0, 0, 0, [0, NONE]));
    let hit = accel.closest(&down(-0.9, 0.9)).unwrap();
    assert_eq!((hit.t, hit.geometry, hit.primitive, hit.instances), (9.0, 1, 1, [1, NONE]));
    let place = accel.instance_to_world(&[0, 1], 0.0);
    assert_eq!(place.point(Vec3::ZERO), Vec3::new(5.0, 20.0, 0.0));
    assert_eq!(accel.report().instances, 2);
}

#[test]
fn equal_instances_give_the_first() {
    let leaf = Arc::new(build(vec![square().into()]));
    let same = || Instance::new(leaf.clone(), Affine::scaling(2.0, 2.0, 2.0)).into();
    let accel = build((0..40).map(|_| same()).collect());
    assert_eq!(accel.closest(&down(0.3, 0.1)).unwrap().instances, [0, NONE]);
}

#[test]
fn normals_are_perpendicular_and_outward() {
    let inner = Arc::new(build(vec![
        ball(),
        Geometry::User(Arc::new(Balls(vec![(Vec3::new(3.0, 0.0, 0.0), 1.0)]))),
        Quadric {
            shape: QuadricShape::SPHERE,
            object_to_world: Affine::translation(-3.0, 0.0, 0.0).after(&Affine::scaling(1.0, -1.0, 1.0)),
        }
        .into(),
    ]));
    let map = Affine::rotation([1.0, 0.3, 0.2], 30.0).after(&Affine::scaling(1.0, 0.5, -2.0));
    let turned = Affine::rotation([0.0, 1.0, 0.0], 50.0).after(&map);
    let motion = Motion::new([(0.0, map), (1.0, turned)]).unwrap();
    let accel = build(vec![Instance::moving(inner, motion.clone()).into()]);
    let mut seen = 0;
    for i in 0..400 {
        let (x, y) = ((i % 20) as f32 * 0.4 - 4.0, (i / 20) as f32 * 0.1 - 1.0);
        let ray = Ray::new(Vec3::new(x, y, 9.0), Vec3::new(0.01, 0.02, -1.0)).at_time(i as f32 / 400.0);
        let Some(hit) = accel.closest(&ray) else { continue };
        seen += 1;
        let normal = accel.normal(&ray, &hit);
        assert!(normal.dot(ray.direction) < 1e-3 * normal.length(), "outward, and seen from outside");
        // Along the surface to first order, the hit stays on it: a neighbouring ray meets the tangent plane.
        let near = Ray { origin: ray.origin + Vec3::new(1e-3, -1e-3, 0.0), ..ray };
        let Some(other) = accel.closest(&near).filter(|h| h.geometry == hit.geometry) else { continue };
        let step = near.at(other.t) - ray.at(hit.t);
        if step.length() < 5e-3 {
            assert!(step.dot(normal).abs() < 0.02 * step.length() * normal.length(), "{hit:?}");
        }
    }
    assert!(seen > 100);
}

#[test]
fn moving_vertices_pass_their_keys() {
    let key = |z: f32| square().positions.iter().map(|p| *p + Vec3::Z * z).collect::<Arc<[Vec3]>>();
    let mesh = MovingMesh::new([key(0.0), key(4.0), key(2.0)], square().indices);
    let accel = build(vec![mesh.into()]);
    for (time, t) in
        [(0.0, 9.0), (0.25, 7.0), (0.5, 5.0), (0.75, 6.0), (1.0, 7.0), (-1.0, 9.0), (f32::NAN, 9.0)]
    {
        let ray = down(0.3, 0.1).at_time(time);
        let hit = accel.closest(&ray).unwrap();
        assert!((hit.t - t).abs() < 1e-5 && hit.primitive == 0, "at {time}: {hit:?}");
        assert!(accel.normal(&ray, &hit).z > 0.0);
    }
}

#[test]
fn a_turning_blade_is_where_it_should_be() {
    let blade = Arc::new(build(vec![square().into()]));
    let long = Affine::scaling(3.0, 0.1, 1.0);
    let turned = Affine::rotation([0.0, 0.0, 1.0], 90.0).after(&long);
    let accel =
        build(vec![Instance::moving(blade, Motion::new([(0.0, long), (1.0, turned)]).unwrap()).into()]);
    for (degrees, time) in [(0.0_f32, 0.0), (45.0, 0.5), (60.0, 2.0 / 3.0), (90.0, 1.0)] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        assert!(accel.occluded(&down(2.9 * cosine, 2.9 * sine).at_time(time)), "{degrees} degrees");
        assert!(!accel.occluded(&down(2.9 * cosine, 2.9 * sine).at_time(if time > 0.4 { 0.0 } else { 1.0 })));
    }
}

#[test]
fn faults_say_where() {
    let leaf = Arc::new(build(vec![ball()]));
    let placed = |accel: &Arc<Accel>, map| Geometry::Instance(Instance::new(accel.clone(), map));
    let fault = |g: Geometry| Accel::build(vec![ball(), g], BuildOptions::default()).unwrap_err();
    let singular = BuildError::SingularTransform { geometry: 1 };
    for map in [
        Affine::scaling(1.0, 0.0, 1.0),
        Affine::scaling(1.0, f64::NAN, 1.0),
        Affine::translation(f64::INFINITY, 0.0, 0.0),
        Affine::translation(0.0, 1e13, 0.0),
        Affine::scaling(1e300, 1e-300, 1.0),
    ] {
        assert_eq!(fault(placed(&leaf, map)), singular, "{map:?}");
    }
    // Hardly invertible maps are no error, and do no harm.
    let extreme = [(1e-30, 1e-30, 1.0), (1e-9, 1e3, 1.0), (1e-25, 1e-25, 1e-25)];
    let accel = build(extreme.map(|(x, y, z)| placed(&leaf, Affine::scaling(x, y, z))).into());
    for ray in [down(0.0, 0.0), down(1.0, 0.0), Ray::new(Vec3::splat(1e11), Vec3::splat(-1e30))] {
        assert_eq!(accel.closest(&ray).is_some(), accel.occluded(&ray));
    }
    let one = Arc::new(build(vec![placed(&leaf, Affine::IDENTITY)]));
    let two = Arc::new(build(vec![placed(&one, Affine::IDENTITY)]));
    assert_eq!(fault(placed(&two, Affine::IDENTITY)), BuildError::TooDeep { geometry: 1 });
    let key = |n: usize| vec![Vec3::ZERO; n].into();
    let uneven = MovingMesh::new([key(3), key(4)], vec![[0, 1, 2]]);
    assert!(matches!(fault(uneven.into()), BuildError::InvalidMotion { geometry: 1, .. }));
    assert!(matches!(fault(MovingMesh::new([], vec![]).into()), BuildError::InvalidMotion { .. }));
    let wild = MovingMesh::new([key(3)], vec![[0, 1, 3]]);
    let error = BuildError::IndexOutOfRange { geometry: 1, primitive: 0, index: 3, vertices: 3 };
    assert_eq!(fault(wild.into()), error);
}

#[test]
fn what_is_not_finite_is_dropped_and_counted() {
    let mut bad = square().positions.to_vec();
    bad[3].x = f32::NAN;
    let moving = MovingMesh::new([square().positions, bad.into()], square().indices);
    let center = |x: f32| (Vec3::new(x, 0.0, 0.0), 1.0);
    let inside_out = (Vec3::ZERO, -1.0);
    let balls = Balls(vec![center(0.0), center(f32::NAN), center(f32::INFINITY), center(1e20), inside_out]);
    assert_eq!(balls.count(), 5);
    let accel = build(vec![moving.into(), Geometry::User(Arc::new(balls))]);
    let report = accel.report();
    assert_eq!((report.triangles, report.user_primitives, report.dropped_non_finite), (1, 1, 5));
    let empty = Arc::new(build(vec![]));
    let accel = build(vec![Instance::new(empty, Affine::IDENTITY).into()]);
    assert!(accel.bounds().is_empty() && !accel.occluded(&down(0.0, 0.0)));
}

#[test]
fn masks_inside_instances_count() {
    let mut inner = build(vec![ball(), square().into()]);
    inner.set_mask(0, 0b01);
    inner.set_mask(1, 0b10);
    let accel = build(vec![Instance::new(Arc::new(inner), Affine::IDENTITY).into()]);
    let seen = |mask| accel.closest(&Ray { mask, ..down(0.25, 0.0) }).map(|h| h.geometry);
    assert_eq!(
        [seen(0b11), seen(0b01), seen(0b10), seen(0b100), seen(0)],
        [Some(0), Some(0), Some(1), None, None]
    );
}

/// Rays to corners and edges, where the slightest displacement decides: whoever meets the tile in its own space must get
/// through the box in the world.
#[test]
fn boxes_hold_what_rounding_moves() {
    let tile = Arc::new(build(vec![square().into()]));
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 23) - 1.0
    };
    let mut hits = 0;
    for i in 0..20_000 {
        let turn = Affine::rotation([random(), random(), random() + 1.5], 180.0 * random());
        // Scaled after it is turned: a shear, of large condition.
        let map = Affine::translation(random(), random(), random())
            .after(&Affine::scaling(0.01, 1.0, 10.0))
            .after(&turn);
        let corner = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][i % 4];
        let target = map.point(Vec3::new(corner.0, if i % 3 == 0 { random() as f32 } else { corner.1 }, 0.0));
        let origin = Vec3::new(random() as f32, random() as f32, random() as f32) * 10.0;
        let ray = Ray::new(origin, target - origin);
        let back = map.inverse().unwrap();
        let local = Ray::new(back.point(ray.origin), back.vector(ray.direction));
        let expected = tile.closest(&local).map(|h| h.t);
        let accel = build(vec![Instance::new(tile.clone(), map).into()]);
        assert_eq!(accel.closest(&ray).map(|h| h.t), expected, "{i}");
        hits += u32::from(expected.is_some());
    }
    assert!(hits > 3000, "{hits} rays hit");
}

#[test]
fn behind_a_rejected_hit_comes_the_next() {
    let leaf = Arc::new(build(vec![ball()]));
    let placed = build(vec![Instance::new(leaf, Affine::IDENTITY).into()]);
    for accel in [build(vec![ball()]), placed] {
        let ray = down(0.0, 0.0);
        assert_eq!(accel.closest_filtered(&ray, |hit| hit.t > 9.0).map(|hit| hit.t), Some(10.0));
        assert!(accel.occluded_filtered(&ray, |hit| hit.t > 9.0));
        assert!(!accel.occluded_filtered(&ray, |hit| hit.t > 11.0));
    }
}
