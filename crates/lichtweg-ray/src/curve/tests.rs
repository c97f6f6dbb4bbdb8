//! Curves against marching along the ray, against all their chords, and at their joints.
//!
//! Marching knows distances alone: a ball's surface is nowhere nearer than the smallest distance to any of very many balls.

use proptest::prelude::*;

use super::bezier::{Bezier, Point4};
use super::intersect::CurveHit;
use super::pieces::pieces;
use super::ray_space::RaySpace;
use super::{CurveBasis, CurveError, CurvePoint, CurveStyle, Curves, ribbon, round};
use crate::Ray;
use crate::math::Vec3;
use crate::simd::Isa;

/// Points of a curve that distances are taken to.
const DENSE: usize = 1500;

fn config(cases: u32) -> ProptestConfig {
    let rng_seed = proptest::test_runner::RngSeed::Fixed(3);
    ProptestConfig { cases, failure_persistence: None, rng_seed, ..ProptestConfig::default() }
}

fn point(range: f32) -> impl Strategy<Value = Vec3> {
    [-range..range, -range..range, -range..range].prop_map(Vec3::from_array)
}

fn control(range: f32, radii: std::ops::Range<f32>) -> impl Strategy<Value = CurvePoint> {
    (point(range), radii).prop_map(|(position, radius)| CurvePoint { position, radius })
}

fn basis() -> impl Strategy<Value = CurveBasis> {
    prop_oneof![Just(CurveBasis::Linear), Just(CurveBasis::Bezier), Just(CurveBasis::BSpline)]
}

/// Two curves of two segments each.
fn curves(style: CurveStyle, radii: std::ops::Range<f32>) -> impl Strategy<Value = Curves> {
    let points = prop::collection::vec(control(1.0, radii), 14);
    let normals = prop::collection::vec(point(1.0), 6);
    (basis(), points, normals).prop_map(move |(basis, points, normals)| {
        let each = basis.order() + basis.step();
        let normals = if style == CurveStyle::Ribbon { normals } else { vec![] };
        Curves::new(style, basis, points[..2 * each].to_vec(), &[each, each], &normals).unwrap()
    })
}

/// A ray from outside of everything to a point within.
fn ray() -> impl Strategy<Value = Ray> {
    (point(1.0), point(0.8), 0.1_f32..10.0).prop_map(|(from, to, length)| {
        let origin = from.try_normalized().unwrap_or(Vec3::X) * 20.0;
        Ray::new(origin, (to - origin).normalized() * length)
    })
}

fn closest(curves: &Curves, ray: &Ray) -> Option<(u32, CurveHit)> {
    let space = RaySpace::new(ray);
    let mut best: Option<(u32, CurveHit)> = None;
    for segment in 0..curves.segment_count() as u32 {
        for piece in pieces(curves, segment).unwrap() {
            let bounds = piece.bounds(curves);
            let hit = curves.intersect(Isa::best(), piece, &space, ray.tnear, ray.tfar);
            if let Some(h) = hit {
                let slack = Vec3::splat(1e-5);
                let (p, lo, hi) = (ray.at(h.t), bounds.min - slack, bounds.max + slack);
                assert!(p.max(lo) == p && p.min(hi) == p, "{p:?} is not in {bounds:?}");
            }
            best = match (best, hit) {
                (Some((_, b)), Some(h)) if h.t < b.t => Some((segment, h)),
                (None, Some(h)) => Some((segment, h)),
                (b, _) => b,
            };
        }
    }
    best
}

fn cubic(curves: &Curves, segment: u32, ray: &Ray) -> Bezier {
    let space = RaySpace::new(ray);
    Bezier::new(curves, segment, |p| space.point(p))
}

/// Many points of all segments in the ray's frame, with radii grown by `more`.
fn dense(curves: &Curves, ray: &Ray, more: f64) -> Vec<Point4> {
    let segments = 0..curves.segment_count() as u32;
    let all = segments.flat_map(|s| {
        let cubic = cubic(curves, s, ray);
        (0..=DENSE).map(move |i| cubic.at(i as f64 / DENSE as f64))
    });
    all.map(|[x, y, z, r]| [x, y, z, (r + more).max(0.0)]).collect()
}

/// Where marching along the z axis from 0 first comes to a ball.
fn first_ball(balls: &[Point4]) -> Option<f64> {
    let entries = balls.iter().filter_map(|[x, y, z, r]| {
        let square = r * r - x * x - y * y;
        (square >= 0.0).then(|| z - square.sqrt())
    });
    entries.min_by(f64::total_cmp)
}

/// The distance of (0, 0, z) to the union of the balls from `a` to `b`, by search for the nearest ball.
fn distance(a: &Point4, b: &Point4, z: f64) -> f64 {
    let to_ball = |s: f64| {
        let p: Point4 = std::array::from_fn(|i| a[i] + (b[i] - a[i]) * s);
        (p[0] * p[0] + p[1] * p[1] + (p[2] - z).powi(2)).sqrt() - p[3]
    };
    let (mut lo, mut hi) = (0.0, 1.0);
    for _ in 0..100 {
        let (s, t) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
        if to_ball(s) < to_ball(t) { hi = t } else { lo = s }
    }
    to_ball(lo).min(to_ball(0.0)).min(to_ball(1.0))
}

fn largest_radius(curves: &Curves) -> f64 {
    curves.points().iter().fold(0.0, |r, p| f64::max(r, p.radius.into()))
}

proptest! {
    #![proptest_config(config(4000))]

    #[test]
    fn cones_are_where_marching_finds_them(a in control(1.0, 0.0..0.9), b in control(1.0, 0.0..0.9)) {
        let ball = |p: CurvePoint| {
            let [x, y, z] = p.position.to_array().map(f64::from);
            [x, y, z + 5.0, f64::from(p.radius)]
        };
        let (a, b) = (ball(a), ball(b));
        let (mut z, mut nearest) = (0.0, f64::INFINITY);
        for _ in 0..2000 {
            let d = distance(&a, &b, z);
            nearest = nearest.min(d);
            if d < 1e-9 || z > 10.0 { break }
            z += d;
        }
        match round::enter(&a, &b) {
            Some(entry) => {
                prop_assert!(distance(&a, &b, entry.z).abs() < 1e-7, "{entry:?} is not on the surface");
                prop_assert!(entry.z >= z - 1e-7);
                prop_assert!(entry.z <= z + 1e-4, "{entry:?} lies behind {z}");
            }
            None => prop_assert!(nearest > 1e-9, "missed at {z}"),
        }
    }
}

proptest! {
    #![proptest_config(config(1500))]

    /// What hits a slightly thinner curve hits, no later; what misses a slightly thicker one misses.
    #[test]
    fn round_curves_are_unions_of_balls(curves in curves(CurveStyle::Round, 0.02..0.3), ray in ray()) {
        let margin = largest_radius(&curves) / 100.0 + 5e-5;
        let hit = closest(&curves, &ray).map(|(_, h)| f64::from(h.t) * f64::from(ray.direction.length()));
        let inner = first_ball(&dense(&curves, &ray, -margin));
        let outer = first_ball(&dense(&curves, &ray, margin));
        if let Some(z) = inner {
            prop_assert!(hit.is_some_and(|h| h <= z + 1e-5), "{hit:?} though inner {inner:?}");
        }
        if let Some(h) = hit {
            prop_assert!(outer.is_some_and(|z| h >= z - 1e-5), "{h} though outer {outer:?}");
        }
    }

    #[test]
    fn flat_curves_have_the_silhouette_of_balls(curves in curves(CurveStyle::Flat, 0.02..0.3), ray in ray()) {
        let margin = largest_radius(&curves) / 100.0 + 5e-5;
        let hit = closest(&curves, &ray);
        let excess = |p: &Point4| p[0].hypot(p[1]) - p[3];
        let mut nearest = f64::INFINITY;
        for segment in 0..curves.segment_count() as u32 {
            let cubic = cubic(&curves, segment, &ray);
            let all: Vec<f64> = (0..=DENSE).map(|i| excess(&cubic.at(i as f64 / DENSE as f64))).collect();
            let at = (0..all.len()).min_by(|&i, &j| all[i].total_cmp(&all[j])).unwrap();
            // Nearest in the middle, the cut at the ends decides nothing.
            if all[at] < -margin && at > 0 && at < DENSE {
                let u = at as f64 / DENSE as f64;
                let [dx, dy, ..] = cubic.derivative(u);
                let [x, y, ..] = cubic.at(u);
                if (dx * x + dy * y).abs() < 0.05 * dx.hypot(dy) * x.hypot(y) {
                    prop_assert!(hit.is_some(), "missed segment {segment} at {u}");
                }
            }
            nearest = nearest.min(all[at]);
        }
        if let Some((segment, h)) = hit {
            prop_assert!(nearest < margin);
            let depth = f64::from(h.t) * f64::from(ray.direction.length());
            let p = cubic(&curves, segment, &ray).at(h.u.into());
            prop_assert!((p[2] - depth).abs() < margin, "{depth} is not the depth of {p:?}");
            prop_assert!(excess(&p) < margin);
        }
    }

    /// Rays through points that are computed from the definition hit there, or before.
    #[test]
    fn ribbons_are_where_they_should_be(
        curves in curves(CurveStyle::Ribbon, 0.02..0.1),
        segment in 0..4_u32,
        u in 0.0..1.0_f64,
        v in 0.05..0.95_f64,
        from in point(1.0),
    ) {
        let place = |u: f64| {
            let cubic = Bezier::new(&curves, segment, |p| p);
            let [tx, ty, tz, _] = cubic.derivative(u);
            let normal = ribbon::normal(curves.end_normals(segment), u);
            let across = ribbon::across(normal, [tx, ty, tz]);
            let p = ribbon::rung(&cubic.at(u), across.map(|x| x * (2.0 * v - 1.0)))[1];
            let vector = |v: [f64; 3]| Vec3::from_array(v.map(|x| x as f32));
            (vector(p), vector(across), vector([tx, ty, tz]).normalized())
        };
        let (p, across, tangent) = place(u);
        let step = 1.0 / f64::from(curves.chords(segment));
        let turns = [u - step, u + step].into_iter().any(|w| place(w.clamp(0.0, 1.0)).1.dot(across) < 0.98);
        let origin = from.try_normalized().unwrap_or(Vec3::X) * 20.0;
        let ray = Ray::new(origin, p - origin);
        let cosine = across.cross(tangent).dot(ray.direction.normalized()).abs();
        if !turns && cosine > 0.3 {
            let hit = closest(&curves, &ray);
            prop_assert!(hit.is_some_and(|(_, h)| h.t < 1.001), "missed {p:?}");
            let (s, h) = hit.unwrap();
            let surface = curves.surface(&ray, s, h.u);
            prop_assert!((surface.position - ray.at(h.t)).length() < 2e-5);
            if s == segment && (f64::from(h.u) - u).abs() < step {
                prop_assert!((h.t - 1.0).abs() < 1e-3 && (f64::from(curves.across(&ray, s, h.u)) - v).abs() < 0.1, "{h:?} not {u} {v}");
                prop_assert!(surface.shading_normal.dot(across).abs() < 0.3);
            }
        }
    }

    /// The search in the tree of chords finds what a look at every chord finds, to the bit.
    #[test]
    fn no_chord_is_overlooked(
        curves in curves(CurveStyle::Round, 0.00005..0.0005),
        segment in 0..4_u32,
        u in 0.0..1.0_f32,
        side in point(1.0),
        from in point(1.0),
    ) {
        let axis = curves.axis(segment, u);
        let origin = from.try_normalized().unwrap_or(Vec3::X) * 20.0;
        let ray = Ray::new(origin, axis.position + side * axis.radius - origin);
        let mut best: Option<f32> = None;
        for segment in 0..curves.segment_count() as u32 {
            let cubic = cubic(&curves, segment, &ray);
            let n = curves.chords(segment);
            for i in 0..n {
                let at = |i: u32| cubic.at(f64::from(i) / f64::from(n));
                if let Some(entry) = round::enter(&at(i), &at(i + 1)) {
                    let t = RaySpace::new(&ray).parameter(entry.z);
                    best = Some(best.map_or(t, |b| b.min(t)));
                }
            }
        }
        prop_assert_eq!(closest(&curves, &ray).map(|(_, h)| h.t), best);
    }

    /// Rays through any point of the ball at a joint hit: nothing slips between segments or pieces.
    #[test]
    fn joints_are_tight(
        round in curves(CurveStyle::Round, 0.001..0.1),
        u in prop_oneof![Just(0.0), Just(1.0), Just(0.5), Just(0.125)],
        segment in 0..4_u32,
        side in point(0.5),
        from in point(1.0),
    ) {
        let p = Bezier::new(&round, segment, |p| p).at(u);
        let aim = Vec3::new(p[0] as f32, p[1] as f32, p[2] as f32) + side * p[3] as f32;
        let origin = from.try_normalized().unwrap_or(Vec3::X) * 20.0;
        let ray = Ray::new(origin, aim - origin);
        prop_assert!(closest(&round, &ray).is_some());
        let surface = closest(&round, &ray).map(|(s, h)| (round.surface(&ray, s, h.u), h)).unwrap();
        prop_assert!((surface.0.position - ray.at(surface.1.t)).length() < 2e-5);
        prop_assert!(surface.0.geometric_normal.dot(ray.direction) <= 1e-3);
        let flat = Curves { style: CurveStyle::Flat, ..round.clone() };
        let inner = round.next(segment).is_some() || (u > 0.0 && u < 1.0);
        let end_on = u == 0.0 || u == 1.0;
        if inner && !end_on {
            prop_assert!(closest(&flat, &ray).is_some());
        }
    }

    /// From within a tube there is nothing to see but other tubes.
    #[test]
    fn tubes_are_empty(
        basis in basis(),
        bend in point(0.05),
        u in 0.0..1.0_f32,
        side in point(0.5),
        direction in point(1.0),
    ) {
        let points: Vec<CurvePoint> = (0..7)
            .map(|i| CurvePoint { position: Vec3::Z * i as f32 + bend * (i * i % 3) as f32, radius: 0.2 })
            .collect();
        let curves = Curves::new(CurveStyle::Round, basis, points, &[7], &[]).unwrap();
        for segment in 0..curves.segment_count() as u32 {
            let p = Bezier::new(&curves, segment, |p| p).at(u.into());
            let origin = Vec3::new(p[0] as f32, p[1] as f32, p[2] as f32) + side * 0.2;
            let hit = closest(&curves, &Ray::new(origin, direction));
            prop_assert_eq!(hit, None);
        }
    }
}

fn line(radius: f32) -> Vec<CurvePoint> {
    (0..4).map(|i| CurvePoint { position: Vec3::X * i as f32, radius }).collect()
}

#[test]
fn counts_are_checked() {
    let new = |basis, counts: &[usize], normals: &[Vec3]| {
        let style = if normals.is_empty() { CurveStyle::Round } else { CurveStyle::Ribbon };
        Curves::new(style, basis, line(1.0), counts, normals).map(|c| c.segment_count())
    };
    assert_eq!(new(CurveBasis::Linear, &[4], &[]), Ok(3));
    assert_eq!(new(CurveBasis::Linear, &[2, 2], &[]), Ok(2));
    assert_eq!(new(CurveBasis::BSpline, &[4], &[]), Ok(1));
    let bad = |curve, points, needed, step| Err(CurveError::BadCount { curve, points, needed, step });
    assert_eq!(new(CurveBasis::Linear, &[3, 1], &[]), bad(1, 1, 2, 1));
    assert_eq!(new(CurveBasis::Bezier, &[2, 2], &[]), bad(0, 2, 4, 3));
    assert_eq!(new(CurveBasis::Linear, &[3], &[]), Err(CurveError::CountsDiffer { counted: 3, points: 4 }));
    let overflow = CurveError::CountsDiffer { counted: usize::MAX, points: 4 };
    assert_eq!(new(CurveBasis::Linear, &[usize::MAX, 5], &[]), Err(overflow));
    let normals = Err(CurveError::NormalsDiffer { needed: 4, normals: 1 });
    assert_eq!(new(CurveBasis::Linear, &[4], &[Vec3::X]), normals);
    let ragged = Curves::new(CurveStyle::Flat, CurveBasis::Bezier, vec![CurvePoint::default(); 5], &[5], &[]);
    assert_eq!(ragged.map(|c| c.segment_count()), bad(0, 5, 4, 3));
}

#[test]
fn senseless_segments_have_no_pieces() {
    use super::pieces::Unusable::{NonFinite, Thin};
    let fault = |points: Vec<CurvePoint>| {
        let curves = Curves::new(CurveStyle::Round, CurveBasis::Bezier, points, &[4], &[]).unwrap();
        pieces(&curves, 0).err()
    };
    assert_eq!(fault(line(0.1)), None);
    assert_eq!(fault(line(0.0)), Some(Thin));
    for bad in [f32::NAN, f32::INFINITY, 1e30] {
        let (mut position, mut radius) = (line(1.0), line(1.0));
        position[2].position.y = bad;
        radius[1].radius = bad;
        assert_eq!(fault(position), Some(NonFinite));
        assert_eq!(fault(radius), Some(NonFinite));
    }
    assert_eq!(fault(line(-1.0)), Some(NonFinite));
}

#[test]
fn points_and_huge_and_tiny_curves_are_hit() {
    for (size, style) in
        [1e11, 1.0, 1e-12, 1e-38].into_iter().zip([CurveStyle::Round, CurveStyle::Flat].into_iter().cycle())
    {
        for spread in [0.0, 1.0] {
            let points: Vec<CurvePoint> = (0..4)
                .map(|i| CurvePoint { position: Vec3::X * (i as f32 * size * spread), radius: size })
                .collect();
            let curves = Curves::new(style, CurveBasis::Bezier, points, &[4], &[]).unwrap();
            let ray = Ray::new(Vec3::new(0.1 * size, 0.2 * size, 5.0 * size), Vec3::new(0.0, 0.0, -1.0));
            let (_, hit) = closest(&curves, &ray).expect("a hit");
            let want = if style == CurveStyle::Flat { 5.0 } else { 5.0 - (1.0_f32 - 0.04).sqrt() };
            assert!((hit.t / size - want).abs() < 0.01, "{hit:?} at size {size}");
            let surface = curves.surface(&ray, 0, hit.u);
            assert!(surface.position.is_finite() && surface.geometric_normal.is_finite());
        }
    }
}

#[test]
fn bases_agree_on_a_line() {
    let spline: Vec<CurvePoint> = line(0.25);
    let hit = |basis, points: &[CurvePoint]| {
        let curves = Curves::new(CurveStyle::Round, basis, points.to_vec(), &[points.len()], &[]).unwrap();
        let ray = Ray::new(Vec3::new(1.4, 3.0, 0.125), Vec3::new(0.0, -1.0, 0.0));
        let (segment, hit) = closest(&curves, &ray).unwrap();
        (hit, curves.across(&ray, segment, hit.u))
    };
    let (a, b) = (hit(CurveBasis::BSpline, &spline), hit(CurveBasis::Linear, &spline[1..3]));
    let c = hit(CurveBasis::Bezier, &spline);
    for ((h, v), u) in [(a, 0.4), (b, 0.4), (c, 1.4 / 3.0)] {
        assert!((h.t - (3.0 - (0.25_f32 * 0.25 - 0.125 * 0.125).sqrt())).abs() < 1e-6);
        assert!((h.u - u).abs() < 1e-6 && ((v - 0.5).abs() - 0.25).abs() < 1e-6, "{h:?}");
    }
}
