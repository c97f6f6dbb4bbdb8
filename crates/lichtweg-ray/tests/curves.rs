//! Curves in a hierarchy: against one structure a curve, at joints, and where they make no sense.

use lichtweg_ray::math::Vec3;
use lichtweg_ray::{
    Accel, BuildOptions, CurveBasis, CurvePoint, CurveStyle, Curves, Geometry, Hit, Ray, TriangleMesh,
};
use proptest::prelude::*;

fn build(geometries: Vec<Geometry>) -> Accel {
    Accel::build(geometries, BuildOptions::default()).expect("a sound scene")
}

fn point(range: f32) -> impl Strategy<Value = Vec3> {
    [-range..range, -range..range, -range..range].prop_map(Vec3::from_array)
}

/// A curve of one to four segments, and its normals, for some for ribbons.
#[derive(Clone, Debug)]
struct Chain {
    style: CurveStyle,
    basis: CurveBasis,
    points: Vec<CurvePoint>,
    normals: Vec<Vec3>,
}

impl Chain {
    /// Curves of this and others of the same kind.
    fn curves(chains: &[Self]) -> Curves {
        let counts: Vec<usize> = chains.iter().map(|c| c.points.len()).collect();
        let points: Vec<CurvePoint> = chains.iter().flat_map(|c| c.points.clone()).collect();
        let normals: Vec<Vec3> = chains.iter().flat_map(|c| c.normals.clone()).collect();
        Curves::new(chains[0].style, chains[0].basis, points, &counts, &normals).unwrap()
    }
}

fn kind() -> impl Strategy<Value = (CurveStyle, CurveBasis)> {
    let style = prop_oneof![Just(CurveStyle::Round), Just(CurveStyle::Flat), Just(CurveStyle::Ribbon)];
    let basis = prop_oneof![Just(CurveBasis::Linear), Just(CurveBasis::Bezier), Just(CurveBasis::BSpline)];
    (style, basis)
}

/// Segments, a place, and what stands at each point: position, radius and normal.
type Sketch = (usize, Vec3, Vec<((Vec3, f32), Vec3)>);

/// Chains of one kind: bundles of ten, near each other, of which some points coincide.
fn bundle(range: f32) -> impl Strategy<Value = Vec<Chain>> {
    let control = (point(0.3 * range), prop_oneof![1 => Just(0.0), 4 => 0.001 * range..0.05 * range]);
    let chain = (1..5_usize, point(range), prop::collection::vec((control, point(1.0)), 13));
    (kind(), prop::collection::vec(chain, 1..10)).prop_map(|((style, basis), chains)| {
        let chain = |(segments, at, all): Sketch| Chain {
            style,
            basis,
            points: all[..basis.order() + (segments - 1) * basis.step()]
                .iter()
                .map(|((p, radius), _)| CurvePoint { position: at + *p, radius: *radius })
                .collect(),
            normals: if style == CurveStyle::Ribbon {
                all[..=segments].iter().map(|(_, n)| *n).collect()
            } else {
                vec![]
            },
        };
        chains.into_iter().map(chain).collect()
    })
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

fn check(range: f32, bundles: &[Vec<Chain>], rays: &[Ray]) -> Result<(), TestCaseError> {
    let triangle = [Vec3::ZERO, Vec3::X * range, Vec3::Y * range].to_vec();
    let mut all = vec![Geometry::from(TriangleMesh::new(triangle, vec![[0, 1, 2]]))];
    let mut single = vec![(0, 0, build(all.clone()))];
    for (geometry, chains) in (1..).zip(bundles) {
        all.push(Chain::curves(chains).into());
        let mut first = 0;
        for chain in chains {
            let alone = Chain::curves(std::slice::from_ref(chain));
            let segments = alone.segment_count() as u32;
            single.push((geometry, first, build(vec![alone.into()])));
            first += segments;
        }
    }
    let accel = build(all);
    for ray in rays {
        let hits = single.iter().filter_map(|(geometry, first, accel)| {
            let hit = accel.closest(ray)?;
            Some(Hit { geometry: *geometry, primitive: first + hit.primitive, ..hit })
        });
        let want = hits.reduce(|a, b| if b.t < a.t { b } else { a });
        let hit = accel.closest(ray);
        prop_assert_eq!(hit, want, "{:?}", ray);
        prop_assert_eq!(accel.occluded(ray), hit.is_some(), "{:?}", ray);
        if let Some(hit) = hit {
            let beyond = ray.between(hit.t, ray.tfar);
            prop_assert!(accel.closest(&beyond).is_none_or(|h| h.t > hit.t));
            prop_assert!(!accel.occluded(&ray.between(0.0, hit.t.next_down())));
            prop_assert!((0.0..=1.0).contains(&hit.u) && (0.0..=1.0).contains(&hit.v), "{:?}", hit);
        }
    }
    Ok(())
}

fn scene(range: f32) -> impl Strategy<Value = (Vec<Vec<Chain>>, Vec<Ray>)> {
    (prop::collection::vec(bundle(range), 1..6), prop::collection::vec(ray(range), 60))
}

fn config(cases: u32) -> ProptestConfig {
    let rng_seed = proptest::test_runner::RngSeed::Fixed(1);
    ProptestConfig { cases, failure_persistence: None, rng_seed, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(config(200))]

    #[test]
    fn ordinary_coordinates((bundles, rays) in scene(1.0)) {
        check(1.0, &bundles, &rays)?;
    }

    #[test]
    fn tiny_coordinates((bundles, rays) in scene(1e-12)) {
        check(1e-12, &bundles, &rays)?;
    }

    #[test]
    fn huge_coordinates((bundles, rays) in scene(1e11)) {
        check(1e11, &bundles, &rays)?;
    }

    /// Nonsense among the points costs its segments and no more.
    #[test]
    fn what_makes_no_sense_is_left_out(
        chains in bundle(1.0),
        at in any::<prop::sample::Index>(),
        value in prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(f32::NEG_INFINITY), Just(1e35)],
        what in 0..4_usize,
        rays in prop::collection::vec(ray(1.0), 20),
    ) {
        let mut bad = chains.clone();
        let chain = at.index(chains.len());
        let point = at.index(chains[chain].points.len());
        let target = &mut bad[chain].points[point];
        if what == 3 { target.radius = value } else { target.position[what] = value }
        let (good, bad) = (Chain::curves(&chains), Chain::curves(&bad));
        let segments = good.segment_count();
        let (good, bad) = (build(vec![good.into()]), build(vec![bad.into()]));
        let lost = bad.report().dropped_non_finite;
        prop_assert!((1..=4).contains(&lost));
        let dropped = lost + bad.report().dropped_degenerate;
        prop_assert_eq!(bad.report().curve_segments, segments - dropped);
        for ray in rays {
            if let Some(hit) = bad.closest(&ray) {
                prop_assert!(good.closest(&ray).is_some_and(|h| h.t <= hit.t || h.primitive != hit.primitive));
            }
        }
    }
}

/// A linear congruential generator (Knuth's MMIX constants), values in [-1, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.next(), self.next(), self.next());
            if v.length_squared() <= 1.0
                && let Some(unit) = v.try_normalized()
            {
                return unit;
            }
        }
    }
}

/// One long wavy hair; rays at all places of its axis, half of them at joints of its segments.
fn leaks(style: CurveStyle, basis: CurveBasis, spread: f32) -> usize {
    let mut random = Random(11);
    let points: Vec<CurvePoint> = (0..100)
        .map(|i| {
            let x = i as f32 * 0.1;
            let position = Vec3::new(x, (3.0 * x).sin() * 0.3, (2.0 * x).cos() * 0.3);
            CurvePoint { position, radius: 0.01 + 0.005 * (7.0 * x).sin() }
        })
        .collect();
    let curves = Curves::new(style, basis, points, &[100], &[]).unwrap();
    let segments = curves.segment_count() as u32;
    let target = curves.clone();
    let accel = build(vec![curves.into()]);
    let mut missed = 0;
    for i in 0..200_000_u32 {
        let segment = 1 + i % (segments - 2);
        let u = if i.is_multiple_of(2) { 0.0 } else { 0.5 + 0.5 * random.next() };
        let axis = target.axis(segment, u);
        let aim = axis.position + random.direction() * (axis.radius * spread * random.next().abs());
        let origin = aim + random.direction() * 30.0;
        missed += usize::from(!accel.occluded(&Ray::new(origin, aim - origin)));
    }
    missed
}

#[test]
fn nothing_slips_through() {
    for basis in [CurveBasis::Linear, CurveBasis::Bezier, CurveBasis::BSpline] {
        for style in [CurveStyle::Round, CurveStyle::Flat] {
            assert_eq!(leaks(style, basis, 0.98), 0, "{style:?} {basis:?}");
        }
    }
    assert_ne!(leaks(CurveStyle::Round, CurveBasis::BSpline, 1.5), 0, "the test can fail");
}

#[test]
fn hits_can_be_refused() {
    let line = |z: f32| {
        let ends = [-1.0, 1.0].map(|x| CurvePoint { position: Vec3::new(x, 0.0, z), radius: 0.1 });
        Geometry::from(Curves::new(CurveStyle::Round, CurveBasis::Linear, ends, &[2], &[]).unwrap())
    };
    let accel = build(vec![line(2.0), line(1.0)]);
    let ray = Ray::new(Vec3::new(0.5, 0.0, 5.0), Vec3::new(0.0, 0.0, -1.0));
    let hit = accel.closest(&ray).unwrap();
    assert_eq!((hit.geometry, hit.primitive, hit.u, hit.v), (0, 0, 0.75, 0.5));
    assert!((hit.t - 2.9).abs() < 1e-6);
    let second = accel.closest_filtered(&ray, |h| h.geometry == 1 && h.v == 0.5).unwrap();
    assert!((second.t - 3.9).abs() < 1e-6);
    assert!(!accel.occluded_filtered(&ray, |_| false));
}
