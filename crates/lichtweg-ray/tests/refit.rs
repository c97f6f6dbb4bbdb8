//! A refitted structure answers as a new one does.

#[path = "../benches/support/random.rs"]
#[allow(dead_code)]
mod random;

use std::sync::Arc;

use lichtweg_ray::math::{Affine, Vec3};
use lichtweg_ray::{
    Accel, BuildOptions, BuildQuality, Geometry, Instance, Quadric, QuadricShape, Ray, RefitError,
    TriangleMesh,
};
use random::Random;

/// Small triangles anywhere in a cube, on the odd places large ones.
fn soup(random: &mut Random, triangles: u32) -> TriangleMesh {
    let mut positions = Vec::new();
    for i in 0..triangles {
        let size = if i % 20 == 0 { 0.8 } else { 0.05 };
        let at = random.direction() * random.unit();
        positions.extend([at, at + random.direction() * size, at + random.direction() * size]);
    }
    let indices: Vec<_> = (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriangleMesh::new(positions, indices)
}

fn ball() -> Geometry {
    let object_to_world = Affine::translation(0.2, 0.1, 0.0).after(&Affine::scaling(0.3, 0.2, 0.3));
    Quadric { shape: QuadricShape::SPHERE, object_to_world }.into()
}

fn moved(random: &mut Random, mesh: &TriangleMesh, by: f32) -> Arc<[Vec3]> {
    mesh.positions.iter().map(|&p| p + random.direction() * by).collect()
}

fn assert_same_answers(a: &Accel, b: &Accel, random: &mut Random) {
    let mut hits = 0;
    for _ in 0..20_000 {
        let origin = random.direction() * 1.5;
        let ray = Ray::new(origin, random.direction() * 0.4 - origin);
        let hit = a.closest(&ray);
        assert_eq!(hit, b.closest(&ray), "{ray:?}");
        assert_eq!(a.occluded(&ray), b.occluded(&ray), "{ray:?}");
        hits += usize::from(hit.is_some());
    }
    assert!(hits > 1000, "the rays must hit something");
    assert_eq!(a.bounds(), b.bounds());
}

#[test]
fn a_refit_answers_as_a_new_build() {
    let mut random = Random(1);
    for quality in [BuildQuality::Fast, BuildQuality::High] {
        for triangles in [3, 40, 4000] {
            let (still, mesh) = (soup(&mut random, triangles), soup(&mut random, triangles));
            let scene = |mesh: TriangleMesh| vec![still.clone().into(), ball(), mesh.into()];
            let mut accel = Accel::build(scene(mesh.clone()), quality.into()).unwrap();
            for by in [0.01, 0.5, 0.0] {
                let positions = moved(&mut random, &mesh, by);
                accel.refit(&[(2, positions.clone())]).unwrap();
                let anew = Accel::build(scene(TriangleMesh { positions, ..mesh.clone() }), quality.into());
                assert_same_answers(&accel, &anew.unwrap(), &mut random);
            }
        }
    }
}

#[test]
fn triangles_vanish_and_come_back() {
    let mut random = Random(2);
    let mesh = soup(&mut random, 500);
    let build =
        |mesh: &TriangleMesh| Accel::build(vec![mesh.clone().into()], BuildQuality::Fast.into()).unwrap();
    let mut accel = build(&mesh);
    let mut broken = mesh.positions.to_vec();
    broken[0] = Vec3::splat(f32::NAN);
    broken[4] = broken[3];
    let broken = TriangleMesh { positions: broken.into(), ..mesh.clone() };
    accel.refit(&[(0, broken.positions.clone())]).unwrap();
    assert_same_answers(&accel, &build(&broken), &mut random);
    accel.refit(&[(0, mesh.positions.clone())]).unwrap();
    assert_same_answers(&accel, &build(&mesh), &mut random);

    let mut without = build(&broken);
    let error = without.refit(&[(0, mesh.positions.clone())]);
    assert_eq!(error, Err(RefitError::Appeared { geometry: 0, primitive: 0 }));
    assert_same_answers(&without, &build(&broken), &mut random);
}

/// Boxes of instances are wider by the rounding of rays, which grows with the scene.
#[test]
fn instances_are_seen_from_where_the_mesh_went() {
    let mut random = Random(4);
    let inner = Arc::new(Accel::build(vec![soup(&mut random, 200).into()], BuildOptions::default()).unwrap());
    let to_world = Affine::translation(0.5, -0.25, 0.125).after(&Affine::rotation([1.0, 2.0, 3.0], 40.0));
    let to_local = to_world.inverse().unwrap();
    let near = TriangleMesh::new(vec![Vec3::X * 3.0, Vec3::Y * 3.0, Vec3::Z * 3.0], vec![[0, 1, 2]]);
    let geometries = vec![near.clone().into(), Instance::new(inner.clone(), to_world).into()];
    let mut accel = Accel::build(geometries, BuildQuality::Fast.into()).unwrap();
    let far = 1e6;
    accel.refit(&[(0, near.positions.iter().map(|&p| p * far).collect())]).unwrap();
    let mut hits = 0;
    for _ in 0..20_000 {
        let target = to_world.point(random.direction() * 1.3);
        let origin = random.direction() * far;
        let ray = Ray::new(origin, target - origin);
        let local = Ray::new(to_local.point(origin), to_local.vector(ray.direction));
        let Some(want) = inner.closest(&local) else { continue };
        // The mesh may stand before it.
        let Some(hit) = accel.closest(&ray) else { panic!("{ray:?} misses, but {want:?}") };
        assert!(hit.t == want.t || !hit.is_instanced(), "{ray:?}: {hit:?}, but {want:?}");
        hits += usize::from(hit.is_instanced());
    }
    assert!(hits > 1000, "the rays must hit something");
}

#[test]
fn what_does_not_fit_is_refused() {
    let mesh = soup(&mut Random(3), 10);
    let mut accel = Accel::build(vec![mesh.into(), ball()], BuildQuality::Fast.into()).unwrap();
    let none: Arc<[Vec3]> = Arc::new([]);
    let wrong = RefitError::VertexCount { geometry: 0, vertices: 30, given: 0 };
    assert_eq!(accel.refit(&[(0, none.clone())]), Err(wrong));
    assert_eq!(accel.refit(&[(1, none.clone())]), Err(RefitError::NotAMesh { geometry: 1 }));
    assert_eq!(accel.refit(&[(7, none)]), Err(RefitError::NotAMesh { geometry: 7 }));
}
