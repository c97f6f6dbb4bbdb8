//! Tests that every instruction set and every number of threads gives the same bits.

use std::sync::Arc;

use crate::bvh::Block;
use crate::math::{Affine, Motion, Vec3};
use crate::simd::Isa;
use crate::{
    Accel, BuildOptions, BuildQuality, CurveBasis, CurvePoint, CurveStyle, Curves, Geometry, Instance,
    MovingMesh, Quadric, QuadricShape, Ray, TriangleMesh,
};

/// A linear congruential generator (Knuth's MMIX constants), values in [-1, 1).
pub(crate) struct Random(pub u64);

impl Random {
    pub(crate) fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    pub(crate) fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// Triangles on and off a coarse grid, a few quadrics, and the same moving, and as fixed and moving instances.
pub(crate) fn scene(random: &mut Random, triangles: usize) -> Vec<Geometry> {
    let mut all = still(random, triangles);
    let inner = Arc::new(Accel::build(still(random, triangles / 2 + 1), BuildOptions::default()).unwrap());
    if let Geometry::Triangles(mesh) = &inner.geometries()[0] {
        let shifted: Vec<Vec3> = mesh.positions.iter().map(|p| *p + random.point() * 0.2).collect();
        let few: Vec<[u32; 3]> = mesh.indices.iter().take(200).copied().collect();
        all.push(MovingMesh::new([mesh.positions.clone(), shifted.into()], few).into());
    }
    for i in 0..6 {
        let mut map = |degrees| {
            let at = random.point();
            let axis = [f64::from(at.x), 0.5, f64::from(at.y)];
            Affine::translation(at.x.into(), at.y.into(), at.z.into())
                .after(&Affine::rotation(axis, degrees))
                .after(&Affine::scaling(0.3, -0.4, 0.2))
        };
        let fixed = Instance::new(inner.clone(), map(40.0));
        let group = Arc::new(Accel::build(vec![fixed.clone().into()], BuildOptions::default()).unwrap());
        let motion = Motion::new([(0.0, map(10.0)), (1.0, map(100.0))]).unwrap();
        let moving = Instance::moving(if i < 3 { inner.clone() } else { group }, motion);
        all.extend([fixed.into(), moving.into()]);
    }
    all
}

/// Triangles on and off a coarse grid, a few quadrics, and hairs.
pub(crate) fn still(random: &mut Random, triangles: usize) -> Vec<Geometry> {
    let mut positions = Vec::new();
    for i in 0..triangles {
        let (a, b, c) = (random.point(), random.point() * 0.1, random.point() * 0.1);
        let snap = |p: Vec3| Vec3::from_array(p.to_array().map(|x| (x * 8.0).round() / 8.0));
        let corners = [a, a + b, a + c];
        positions.extend(if i.is_multiple_of(3) { corners.map(snap) } else { corners });
    }
    let indices: Vec<[u32; 3]> = (0..triangles as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut all = vec![TriangleMesh::new(positions, indices).into()];
    for _ in 0..20 {
        let at = random.point();
        let object_to_world = Affine::translation(at.x.into(), at.y.into(), at.z.into())
            .after(&Affine::scaling(0.05, 0.08, 0.03));
        all.push(Quadric { shape: QuadricShape::SPHERE, object_to_world }.into());
    }
    for style in [CurveStyle::Round, CurveStyle::Flat] {
        let point = |_| CurvePoint { position: random.point(), radius: 0.02 + 0.01 * random.next() };
        let points: Vec<CurvePoint> = (0..60).map(point).collect();
        all.push(Curves::new(style, CurveBasis::BSpline, points, &[30, 30], &[]).unwrap().into());
    }
    all
}

pub(crate) fn ray(random: &mut Random, i: usize) -> Ray {
    let (origin, mut direction) = (random.point() * 1.5, random.point());
    match i % 4 {
        0 => direction = Vec3::from_array(direction.to_array().map(|x| (x * 1.5).round())),
        1 => direction[i / 4 % 3] = 0.0,
        _ => {}
    }
    Ray::new(origin, direction)
        .between(0.0, if i.is_multiple_of(5) { 0.7 } else { f32::INFINITY })
        .at_time(i as f32 / 30_000.0)
}

#[test]
fn instruction_sets_agree() {
    let mut random = Random(5);
    for triangles in [1, 30, 3000] {
        let mut accel = Accel::build(scene(&mut random, triangles), BuildOptions::default()).unwrap();
        let rays: Vec<Ray> = (0..30_000).map(|i| ray(&mut random, i)).collect();
        let answers: Vec<_> = Isa::available()
            .into_iter()
            .map(|isa| {
                accel.isa = isa;
                let closest: Vec<_> = rays.iter().map(|r| accel.closest(r)).collect();
                let occluded: Vec<_> = rays.iter().map(|r| accel.occluded(r)).collect();
                let filtered: Vec<_> = rays
                    .iter()
                    .map(|r| {
                        accel.closest_filtered(r, |hit| !(hit.primitive + hit.geometry).is_multiple_of(3))
                    })
                    .collect();
                (closest, occluded, filtered)
            })
            .collect();
        let (closest, occluded, _) = &answers[0];
        let instanced = closest.iter().flatten().filter(|h| h.is_instanced());
        assert!(instanced.count() > 50, "the rays must hit instances");
        for (hit, any) in closest.iter().zip(occluded) {
            assert_eq!(hit.is_some(), *any);
        }
        for other in &answers[1..] {
            assert_eq!(other, &answers[0]);
        }
    }
}

#[test]
fn the_tree_does_not_depend_on_threads() {
    for quality in [BuildQuality::Fast, BuildQuality::High] {
        assert_independent_of_threads(quality);
    }
}

fn assert_independent_of_threads(quality: BuildQuality) {
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let scene = still(&mut Random(9), 60_000);
        pool.install(|| Accel::build(scene, quality.into()).unwrap())
    };
    let (one, three) = (build(1), build(3));
    assert_eq!(one.bvh.root, three.bvh.root);
    assert_eq!(one.bvh.nodes.len(), three.bvh.nodes.len());
    for (a, b) in one.bvh.nodes.iter().zip(three.bvh.nodes.iter()) {
        assert_eq!((a.planes, a.children), (b.planes, b.children));
    }
    for (a, b) in one.bvh.blocks.iter().zip(three.bvh.blocks.iter()) {
        assert_eq!(a.ids, b.ids);
    }
    assert_eq!(*one.bvh.others, *three.bvh.others);
}

#[test]
fn pieces_are_bounded() {
    let references = |quality: BuildQuality| {
        let mut random = Random(4);
        let mut geometries = still(&mut random, 1000);
        geometries.retain(|geometry| matches!(geometry, Geometry::Triangles(_)));
        // Long triangles among each other, which are worth cutting.
        let mut long = Vec::new();
        for _ in 0..1000 {
            let at = random.point() * 4.0;
            long.extend([at, at + random.point() * 2.0, at + random.point() * 2.0]);
        }
        let indices: Vec<[u32; 3]> = (0..1000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        geometries.push(TriangleMesh::new(long, indices).into());
        let accel = Accel::build(geometries, quality.into()).unwrap();
        let in_use = accel.bvh.blocks.iter().flat_map(|b| b.ids).filter(|&id| id != Block::NO_ID).count();
        (in_use, accel.report().triangles)
    };
    let (whole, triangles) = references(BuildQuality::Fast);
    assert_eq!(whole, triangles);
    let (pieces, triangles) = references(BuildQuality::High);
    assert!(pieces > triangles && 5 * pieces <= 6 * triangles, "{pieces} pieces of {triangles} triangles");
}
