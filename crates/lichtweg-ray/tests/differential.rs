//! The hierarchy against every primitive in turn, over random soups.

use lichtweg_ray::math::{Affine, Vec3};
use lichtweg_ray::{
    Accel, BuildOptions, BuildQuality, Geometry, Hit, Quadric, QuadricShape, Ray, TriangleMesh,
};
use proptest::prelude::*;

fn build(geometries: Vec<Geometry>) -> Accel {
    Accel::build(geometries, BuildOptions::default()).expect("a sound scene")
}

/// One structure a primitive: what the nearest of all their hits is.
struct OneByOne(Vec<(u32, u32, Accel)>);

impl OneByOne {
    fn new(geometries: &[Geometry]) -> Self {
        let mut all = Vec::new();
        for (g, geometry) in geometries.iter().enumerate() {
            match geometry {
                Geometry::Triangles(mesh) => {
                    for p in 0..mesh.indices.len() as u32 {
                        let single = TriangleMesh::new(mesh.corners(p).to_vec(), vec![[0, 1, 2]]);
                        all.push((g as u32, p, build(vec![single.into()])));
                    }
                }
                other => all.push((g as u32, 0, build(vec![other.clone()]))),
            }
        }
        Self(all)
    }

    fn closest(&self, ray: &Ray) -> Option<Hit> {
        let hits = self.0.iter().filter_map(|(geometry, primitive, accel)| {
            let hit = accel.closest(ray)?;
            Some(Hit { geometry: *geometry, primitive: *primitive, ..hit })
        });
        hits.reduce(|a, b| if b.t < a.t { b } else { a })
    }
}

fn point(range: f32) -> impl Strategy<Value = Vec3> {
    // A coarse grid as well as a continuum, for shared edges, coplanar and degenerate triangles.
    let fine = -range..range;
    let coarse = (-3..=3_i32).prop_map(move |i| i as f32 * range / 3.0);
    let coordinate = prop_oneof![3 => fine, 1 => coarse];
    [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Vec3::from_array)
}

fn soup(range: f32) -> impl Strategy<Value = Geometry> {
    let triangle = (point(range), point(range * 0.3), point(range * 0.3));
    prop::collection::vec(triangle, 1..120).prop_map(|triangles| {
        let positions: Vec<Vec3> = triangles.iter().flat_map(|&(a, b, c)| [a, a + b, a + c]).collect();
        let indices: Vec<[u32; 3]> =
            (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        TriangleMesh::new(positions, indices).into()
    })
}

fn quadric(range: f32) -> impl Strategy<Value = Geometry> {
    let shape = (0..3, -1.0_f32..0.0, 0.1_f32..1.0, 0.5_f32..6.3).prop_map(|(kind, lo, hi, phi)| {
        let phi_max = phi.min(std::f32::consts::TAU);
        match kind {
            0 => QuadricShape::Sphere { z_min: lo * 1.5, z_max: hi * 1.5, phi_max },
            1 => QuadricShape::Disk { inner_radius: hi * 0.9, phi_max },
            _ => QuadricShape::Cylinder { z_min: lo, z_max: hi, phi_max },
        }
    });
    (shape, point(range), point(1.0), 0.01_f32..0.6, 0.0_f64..360.0).prop_map(
        move |(shape, at, axis, size, degrees)| {
            let axis = [axis.x, axis.y, axis.z + 1.5].map(f64::from);
            let size = f64::from(size * range);
            let object_to_world = Affine::translation(at.x.into(), at.y.into(), at.z.into())
                .after(&Affine::rotation(axis, degrees))
                .after(&Affine::scaling(size, size * 0.7, size * 1.3));
            Quadric { shape, object_to_world }.into()
        },
    )
}

fn ray(range: f32) -> impl Strategy<Value = Ray> {
    let length = prop_oneof![Just(1.0_f32), Just(1e-3), Just(1e4)];
    (point(range * 1.5), point(range), length, any::<bool>()).prop_map(
        move |(origin, target, length, limited)| {
            let direction = (target - origin).normalized() * length;
            let tfar = if limited { range / length } else { f32::INFINITY };
            Ray::new(origin, direction).between(0.0, tfar)
        },
    )
}

fn scene(range: f32) -> impl Strategy<Value = (Vec<Geometry>, Vec<Ray>)> {
    let geometry = prop_oneof![3 => soup(range), 2 => quadric(range)];
    (prop::collection::vec(geometry, 1..12), prop::collection::vec(ray(range), 40))
}

fn check((geometries, rays): (Vec<Geometry>, Vec<Ray>)) -> Result<(), TestCaseError> {
    let accel = build(geometries.clone());
    let fast = Accel::build(geometries.clone(), BuildQuality::Fast.into()).expect("a sound scene");
    let reference = OneByOne::new(&geometries);
    for ray in rays {
        let hit = accel.closest(&ray);
        prop_assert_eq!(hit, reference.closest(&ray), "{:?}", ray);
        prop_assert_eq!(hit, fast.closest(&ray), "{:?}", ray);
        prop_assert_eq!(accel.occluded(&ray), hit.is_some(), "{:?}", ray);
        if let Some(hit) = hit {
            let beyond = ray.between(hit.t, ray.tfar);
            prop_assert!(accel.closest(&beyond).is_none_or(|h| h.t > hit.t));
            prop_assert!(!accel.occluded(&ray.between(0.0, hit.t.next_down())));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 300,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn ordinary_coordinates(case in scene(1.0)) {
        check(case)?;
    }

    #[test]
    fn tiny_coordinates(case in scene(1e-12)) {
        check(case)?;
    }

    #[test]
    fn huge_coordinates(case in scene(1e11)) {
        check(case)?;
    }
}
