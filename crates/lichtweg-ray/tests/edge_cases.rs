//! Rays and scenes at the edge of what makes sense.

use lichtweg_ray::math::{Affine, Vec3};
use lichtweg_ray::{Accel, BuildError, BuildOptions, Geometry, Quadric, QuadricShape, Ray, TriangleMesh};

fn build(geometries: Vec<Geometry>) -> Result<Accel, BuildError> {
    Accel::build(geometries, BuildOptions::default())
}

fn square() -> Geometry {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let positions = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
    TriangleMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).into()
}

fn ball(at: Vec3, radius: f64) -> Geometry {
    let object_to_world = Affine::translation(at.x.into(), at.y.into(), at.z.into())
        .after(&Affine::scaling(radius, radius, radius));
    Quadric { shape: QuadricShape::SPHERE, object_to_world }.into()
}

#[test]
fn nothing_is_hit_in_an_empty_scene() {
    for geometries in [vec![], vec![TriangleMesh::new(vec![], vec![]).into()]] {
        let accel = build(geometries).unwrap();
        assert!(accel.bounds().is_empty());
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        assert_eq!(accel.closest(&ray), None);
        assert!(!accel.occluded(&ray));
    }
}

#[test]
fn senseless_rays_miss() {
    let accel = build(vec![square(), ball(Vec3::ZERO, 0.5)]).unwrap();
    let good = Ray::new(Vec3::new(0.1, 0.2, 3.0), Vec3::new(0.0, 0.0, -1.0));
    assert!(accel.occluded(&good));
    let mut bad = Vec::new();
    for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut a, mut b) = (good, good);
            a.origin[axis] = x;
            b.direction[axis] = x;
            bad.extend([a, b]);
        }
    }
    bad.push(Ray { direction: Vec3::ZERO, ..good });
    bad.push(Ray { direction: Vec3::splat(1e-42), ..good });
    bad.push(good.between(f32::NAN, 10.0));
    bad.push(good.between(0.0, f32::NAN));
    bad.push(good.between(5.0, 4.0));
    bad.push(good.between(0.0, 0.0));
    bad.push(good.between(f32::NEG_INFINITY, -1.0));
    for ray in bad {
        assert_eq!(accel.closest(&ray), None, "{ray:?}");
        assert!(!accel.occluded(&ray), "{ray:?}");
    }
}

#[test]
fn the_range_is_open_below_and_closed_above() {
    let accel = build(vec![square()]).unwrap();
    let ray = Ray::new(Vec3::new(0.25, 0.5, 2.0), Vec3::new(0.0, 0.0, -0.5));
    let hit = accel.closest(&ray).unwrap();
    assert_eq!(hit.t, 4.0);
    assert_eq!(accel.closest(&ray.between(4.0, 9.0)), None);
    assert_eq!(accel.closest(&ray.between(4.0_f32.next_down(), 4.0)), Some(hit));
    assert_eq!(accel.closest(&ray.between(-1.0, 4.0_f32.next_down())), None);
    let on_surface = Ray::new(Vec3::new(0.25, 0.5, 0.0), Vec3::Z);
    assert_eq!(accel.closest(&on_surface.between(-5.0, 5.0)), None);
}

#[test]
fn both_sides_are_hit_and_planes_are_not_hit_edge_on() {
    let accel = build(vec![square()]).unwrap();
    for z in [1.0, -1.0] {
        assert!(accel.occluded(&Ray::new(Vec3::new(0.3, 0.1, z), Vec3::new(0.0, 0.0, -z))));
    }
    for direction in [Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::new(-1.0, 0.3, -0.0)] {
        let ray = Ray::new(direction * -3.0, direction);
        assert_eq!(accel.closest(&ray), None);
    }
}

#[test]
fn shared_edges_and_vertices_give_the_first_triangle() {
    let accel = build(vec![square(), square()]).unwrap();
    for (x, y) in [(0.0, 0.0), (0.5, 0.5), (-1.0, -1.0), (1.0, 1.0)] {
        let hit = accel.closest(&Ray::new(Vec3::new(x, y, 1.0), Vec3::new(0.0, 0.0, -1.0))).unwrap();
        assert_eq!((hit.geometry, hit.primitive, hit.t), (0, 0, 1.0));
    }
}

#[test]
fn barycentrics_give_the_point() {
    let [a, b, c] = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(2.0, 0.0, 2.0), Vec3::new(0.0, 3.0, 0.0)];
    let accel = build(vec![TriangleMesh::new(vec![a, b, c], vec![[0, 1, 2]]).into()]).unwrap();
    let (u, v) = (0.25, 0.5);
    let p = a * (1.0 - u - v) + b * u + c * v;
    let origin = Vec3::new(5.0, -2.0, 7.0);
    let hit = accel.closest(&Ray::new(origin, p - origin)).unwrap();
    for (got, want) in [(hit.t, 1.0), (hit.u, u), (hit.v, v)] {
        assert!((got - want).abs() < 1e-6, "{hit:?}");
    }
}

#[test]
fn bad_input_is_an_error_that_says_where() {
    let mesh = TriangleMesh::new(vec![Vec3::ZERO; 3], vec![[0, 1, 2], [0, 3, 1]]);
    let error = build(vec![square(), mesh.into()]).unwrap_err();
    assert_eq!(error, BuildError::IndexOutOfRange { geometry: 1, primitive: 1, index: 3, vertices: 3 });
    let flat = Quadric { shape: QuadricShape::DISK, object_to_world: Affine::scaling(1.0, 1.0, 0.0) };
    assert_eq!(build(vec![flat.into()]).unwrap_err(), BuildError::SingularTransform { geometry: 0 });
    let shape = QuadricShape::Sphere { z_min: 0.5, z_max: 0.5, phi_max: 1.0 };
    let error = build(vec![Quadric { shape, object_to_world: Affine::IDENTITY }.into()]).unwrap_err();
    assert!(matches!(error, BuildError::InvalidQuadric { geometry: 0, .. }));
}

#[test]
fn useless_triangles_are_dropped_and_counted() {
    let positions = vec![
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::X * 2.0,
        Vec3::new(f32::NAN, 0.0, 0.0),
        Vec3::new(0.0, f32::INFINITY, 0.0),
    ];
    let indices = vec![[0, 1, 2], [0, 1, 1], [0, 1, 3], [0, 1, 4], [5, 1, 2]];
    let accel = build(vec![TriangleMesh::new(positions, indices).into()]).unwrap();
    let report = accel.report();
    assert_eq!((report.triangles, report.dropped_degenerate, report.dropped_non_finite), (1, 2, 2));
    assert_eq!(accel.bounds().max, Vec3::new(1.0, 1.0, 0.0));
}

#[test]
fn identical_triangles_do_not_hang_the_build() {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let accel = build(vec![TriangleMesh::new(positions, vec![[0, 1, 2]; 100_000]).into()]).unwrap();
    let hit = accel.closest(&Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::new(0.0, 0.0, -1.0))).unwrap();
    assert_eq!(hit.primitive, 0);
    assert!((hit.t - 1.0).abs() < 1e-6);
}

#[test]
fn quadrics_report_their_parameters() {
    let accel = build(vec![ball(Vec3::new(0.0, 0.0, 5.0), 2.0)]).unwrap();
    let hit = accel.closest(&Ray::new(Vec3::ZERO, Vec3::Z)).unwrap();
    assert_eq!((hit.t, hit.v), (3.0, 0.0));
    let hit = accel.closest(&Ray::new(Vec3::new(0.0, 9.0, 5.0), -Vec3::Y)).unwrap();
    assert_eq!((hit.t, hit.u, hit.v), (7.0, 0.25, 0.5));
    // A grazing ray at a great distance: the perpendicular distance decides.
    let far = Ray::new(Vec3::new(1.999, -1e5, 5.0), Vec3::Y);
    assert!(accel.occluded(&far));
    assert!(!accel.occluded(&Ray { origin: Vec3::new(2.001, -1e5, 5.0), ..far }));

    let shape = QuadricShape::Disk { inner_radius: 0.5, phi_max: std::f32::consts::PI };
    let disk = Quadric { shape, object_to_world: Affine::IDENTITY };
    let accel = build(vec![disk.into()]).unwrap();
    let down = |x: f32, y: f32| accel.closest(&Ray::new(Vec3::new(x, y, 1.0), -Vec3::Z));
    let hit = down(0.0, 0.75).unwrap();
    assert_eq!((hit.t, hit.u, hit.v), (1.0, 0.5, 0.5));
    for (x, y) in [(0.0, 0.25), (0.0, -0.75), (0.0, 1.25)] {
        assert_eq!(down(x, y), None);
    }

    let shape = QuadricShape::Cylinder { z_min: -1.0, z_max: 3.0, phi_max: std::f32::consts::TAU };
    let tube = Quadric { shape, object_to_world: Affine::IDENTITY };
    let accel = build(vec![tube.into()]).unwrap();
    let hit = accel.closest(&Ray::new(Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.0, -1.0, 0.0))).unwrap();
    assert_eq!((hit.t, hit.u, hit.v), (1.0, 0.75, 0.25));
    assert_eq!(accel.closest(&Ray::new(Vec3::ZERO, Vec3::Z)), None);
}

#[test]
fn the_structure_can_be_shared() {
    fn shared<T: Send + Sync>() {}
    shared::<Accel>();
}
