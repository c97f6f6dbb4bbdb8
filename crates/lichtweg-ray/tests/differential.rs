//! The hierarchy against every primitive in turn, over random scenes of every kind of primitive.

mod support;

use std::sync::Arc;

use lichtweg_ray::math::{Affine, Motion, Vec3};
use lichtweg_ray::{
    Accel, BuildQuality, Hit, MovingMesh, Placement, Quadric, QuadricShape, Ray, TriangleMesh,
};
use proptest::prelude::*;
use support::{Balls, OneByOne, Source, build};

fn point(range: f32) -> impl Strategy<Value = Vec3> {
    // A coarse grid as well as a continuum, for shared edges, coplanar and degenerate triangles.
    let fine = -range..range;
    let coarse = (-3..=3_i32).prop_map(move |i| i as f32 * range / 3.0);
    let coordinate = prop_oneof![3 => fine, 1 => coarse];
    [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Vec3::from_array)
}

fn triples(count: usize) -> Vec<[u32; 3]> {
    (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()
}

/// Corners of up to `most` triangles.
fn corners(range: f32, most: usize) -> impl Strategy<Value = Vec<Vec3>> {
    let triangle = (point(range), point(range * 0.3), point(range * 0.3));
    prop::collection::vec(triangle, 1..most)
        .prop_map(|triangles| triangles.iter().flat_map(|&(a, b, c)| [a, a + b, a + c]).collect())
}

fn soup(range: f32, most: usize) -> impl Strategy<Value = Source> {
    corners(range, most).prop_map(|positions| {
        let indices = triples(positions.len() / 3);
        Source::Mesh(TriangleMesh::new(positions, indices))
    })
}

fn moving_soup(range: f32) -> impl Strategy<Value = Source> {
    let shifts = prop::collection::vec(prop::collection::vec(point(range * 0.3), 30), 0..4);
    (corners(range, 40), shifts).prop_map(|(positions, shifts)| {
        let indices = triples(positions.len() / 3);
        let shifted = shifts.iter().map(|key| {
            positions.iter().enumerate().map(|(i, p)| *p + key[i % key.len()]).collect::<Vec<_>>().into()
        });
        let first: Arc<[Vec3]> = positions.clone().into();
        Source::Moving(MovingMesh::new(std::iter::once(first).chain(shifted), indices))
    })
}

fn quadric(range: f32) -> impl Strategy<Value = Source> {
    let shape = (0..3, -1.0_f32..0.0, 0.1_f32..1.0, 0.5_f32..6.3).prop_map(|(kind, lo, hi, phi)| {
        let phi_max = phi.min(std::f32::consts::TAU);
        match kind {
            0 => QuadricShape::Sphere { z_min: lo * 1.5, z_max: hi * 1.5, phi_max },
            1 => QuadricShape::Disk { inner_radius: hi * 0.9, phi_max },
            _ => QuadricShape::Cylinder { z_min: lo, z_max: hi, phi_max },
        }
    });
    (shape, map(range, 0.01, 0.6)).prop_map(move |(shape, map)| {
        let object_to_world = map.after(&Affine::scaling(range.into(), range.into(), range.into()));
        Source::Quadric(Quadric { shape, object_to_world })
    })
}

fn balls(range: f32) -> impl Strategy<Value = Source> {
    prop::collection::vec((point(range), 0.01 * range..0.3 * range), 0..10)
        .prop_map(|balls| Source::User(Arc::new(Balls(balls))))
}

/// A rotation, a scaling with a factor in a range, stretched and sometimes mirrored, and a translation.
fn map(range: f32, least: f64, most: f64) -> impl Strategy<Value = Affine> {
    (point(range), point(1.0), least..most, 0.0_f64..360.0, any::<bool>()).prop_map(
        move |(at, axis, size, degrees, mirror)| {
            let axis = [axis.x, axis.y, axis.z + 1.5].map(f64::from);
            Affine::translation(at.x.into(), at.y.into(), at.z.into())
                .after(&Affine::rotation(axis, degrees))
                .after(&Affine::scaling(size, size * 0.7, size * if mirror { -1.3 } else { 1.3 }))
        },
    )
}

fn placement(range: f32) -> impl Strategy<Value = Placement> {
    let motion =
        (prop::collection::vec(map(range, 0.3, 1.2), 1..4), -0.5_f32..0.5).prop_map(|(maps, start)| {
            let keys = maps.into_iter().zip(0..).map(|(map, i)| (start + 0.4 * i as f32, map));
            Placement::Moving(Arc::new(Motion::new(keys).unwrap()))
        });
    prop_oneof![2 => map(range, 0.3, 1.2).prop_map(Placement::Fixed), 1 => motion]
}

fn plain(range: f32, most: usize) -> BoxedStrategy<Source> {
    prop_oneof![3 => soup(range, most), 2 => quadric(range), 1 => balls(range), 1 => moving_soup(range)]
        .boxed()
}

fn group(range: f32, of: BoxedStrategy<Source>) -> BoxedStrategy<Source> {
    let inner = prop::collection::vec(of, 0..4);
    (inner, placement(range)).prop_map(|(inner, placement)| Source::Group(inner, placement)).boxed()
}

fn ray(range: f32) -> impl Strategy<Value = Ray> {
    let length = prop_oneof![Just(1.0_f32), Just(1e-3), Just(1e4)];
    (point(range * 1.5), point(range), length, any::<bool>(), -0.1_f32..1.1).prop_map(
        move |(origin, target, length, limited, time)| {
            let direction = (target - origin).normalized() * length;
            let tfar = if limited { range / length } else { f32::INFINITY };
            Ray::new(origin, direction).between(0.0, tfar).at_time(time)
        },
    )
}

type Case = (Vec<Source>, Vec<Ray>);

/// Static primitives in one structure.
fn flat(range: f32) -> impl Strategy<Value = Case> {
    let geometry = prop_oneof![3 => soup(range, 120), 2 => quadric(range)];
    (prop::collection::vec(geometry, 1..12), prop::collection::vec(ray(range), 40))
}

/// All kinds, two levels of instances deep.
fn deep(range: f32) -> impl Strategy<Value = Case> {
    let one = group(range, plain(range, 30));
    let two = group(range, prop_oneof![plain(range, 20), one.clone()].boxed());
    let geometry = prop_oneof![3 => plain(range, 60), 2 => one, 2 => two];
    (prop::collection::vec(geometry, 1..8), prop::collection::vec(ray(range), 40))
}

fn check((sources, rays): Case) -> Result<(), TestCaseError> {
    let accel = build(sources.iter().map(Source::geometry).collect());
    let fast = sources.iter().map(Source::geometry).collect();
    let fast = Accel::build(fast, BuildQuality::Fast.into()).expect("a sound scene");
    let reference = OneByOne::all(&sources);
    for ray in rays {
        let hit = accel.closest(&ray);
        prop_assert_eq!(hit, OneByOne::closest(&reference, &ray, &|_| true), "{:?}", ray);
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

/// Some pattern over everything that a hit says.
fn pattern(hit: &Hit) -> bool {
    let ids = hit.primitive + 3 * hit.geometry + 5 * (hit.instances[0] % 7);
    !ids.is_multiple_of(3) && (hit.u * 5.0) as u32 != 2
}

fn check_filtered((sources, rays): Case) -> Result<(), TestCaseError> {
    let mut accel = build(sources.iter().map(Source::geometry).collect());
    let reference = OneByOne::all(&sources);
    let mask = |geometry: u32| 1 << (geometry % 3);
    (0..sources.len() as u32).for_each(|g| accel.set_mask(g, mask(g)));
    for (i, ray) in rays.into_iter().enumerate() {
        let ray = Ray { mask: i as u32 % 8, ..ray };
        let outer = |h: &Hit| if h.is_instanced() { h.instances[0] } else { h.geometry };
        let seen = |h: &Hit| mask(outer(h)) & ray.mask != 0;
        let masked = accel.closest(&ray);
        prop_assert_eq!(masked, OneByOne::closest(&reference, &ray, &seen), "{:?}", ray);
        prop_assert_eq!(accel.occluded(&ray), masked.is_some(), "{:?}", ray);
        let hit = accel.closest_filtered(&ray, pattern);
        let both = OneByOne::closest(&reference, &ray, &|h| seen(h) && pattern(h));
        prop_assert_eq!(hit, both, "{:?}", ray);
        prop_assert_eq!(accel.occluded_filtered(&ray, pattern), hit.is_some(), "{:?}", ray);
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
    fn ordinary_coordinates(case in flat(1.0)) {
        check(case)?;
    }

    #[test]
    fn tiny_coordinates(case in flat(1e-12)) {
        check(case)?;
    }

    #[test]
    fn huge_coordinates(case in flat(1e11)) {
        check(case)?;
    }

    #[test]
    fn instances_and_motion(case in deep(1.0)) {
        check(case)?;
    }

    #[test]
    fn tiny_instances(case in deep(1e-10)) {
        check(case)?;
    }

    #[test]
    fn huge_instances(case in deep(1e10)) {
        check(case)?;
    }

    #[test]
    fn masks_and_filters(case in deep(1.0)) {
        check_filtered(case)?;
    }
}
