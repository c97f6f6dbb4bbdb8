//! A packet's answers are those of its rays one by one, bit by bit, on every instruction set.

use crate::agreement::{Random, ray, scene};
use crate::math::{Affine, Vec3};
use crate::simd::Isa;
use crate::{Accel, BuildOptions, Hit, Quadric, QuadricShape, Ray};

fn bits(hit: Option<Hit>) -> Option<[u32; 7]> {
    hit.map(|h| {
        [h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.geometry, h.primitive, h.instances[0], h.instances[1]]
    })
}

fn check(accel: &mut Accel, rays: &[Ray]) {
    let single: Vec<_> = rays.iter().map(|r| (bits(accel.closest(r)), accel.occluded(r))).collect();
    assert!(single.iter().any(|s| s.1) && single.iter().any(|s| !s.1), "both happen");
    for isa in Isa::available() {
        accel.isa = isa;
        let mut hits = vec![None; rays.len()];
        let mut occluded = vec![false; rays.len()];
        accel.closest_batch(rays, &mut hits);
        accel.occluded_batch(rays, &mut occluded);
        for (i, (hit, occluded)) in hits.iter().zip(occluded).enumerate() {
            assert_eq!((bits(*hit), occluded), single[i], "{isa:?}, ray {i}: {:?}", rays[i]);
        }
    }
}

#[test]
fn incoherent_rays_agree() {
    let mut random = Random(17);
    for triangles in [1, 30, 3000] {
        let mut accel = Accel::build(scene(&mut random, triangles), BuildOptions::default()).unwrap();
        let rays: Vec<Ray> = (0..20_003).map(|i| ray(&mut random, i)).collect();
        check(&mut accel, &rays);
    }
}

#[test]
fn coherent_rays_agree() {
    let mut random = Random(23);
    let mut accel = Accel::build(scene(&mut random, 3000), BuildOptions::default()).unwrap();
    for eye in [Vec3::new(0.0, 0.0, 3.0), Vec3::new(3.0, 0.1, 0.0), Vec3::new(-0.5, -3.0, 0.25)] {
        let towards =
            |i: usize| Vec3::new((i % 100) as f32 / 50.0 - 1.0, (i / 100) as f32 / 50.0 - 1.0, 0.0) - eye;
        let rays: Vec<Ray> = (0..10_000).map(|i| Ray::new(eye, towards(i))).collect();
        check(&mut accel, &rays);
    }
}

#[test]
fn spheres_agree() {
    let mut random = Random(41);
    let mut all = scene(&mut random, 30);
    for i in 0..30 {
        let [x, y, z] = random.point().to_array().map(f64::from);
        let size = 0.3 + 0.2 * f64::from(random.next());
        let object_to_world = Affine::translation(x, y, z).after(&Affine::scaling(
            size,
            size,
            if i % 5 == 0 { 0.1 } else { size },
        ));
        let sphere = Quadric { shape: QuadricShape::SPHERE, object_to_world };
        // Some twice, so that the lowest number has to win.
        all.extend(vec![sphere.into(); 1 + i % 2]);
    }
    let mut accel = Accel::build(all, BuildOptions::default()).unwrap();
    for eye in [Vec3::new(0.0, 0.0, 3.0), Vec3::new(0.1, 0.2, 0.3)] {
        let towards =
            |i: usize| Vec3::new((i % 100) as f32 / 50.0 - 1.0, (i / 100) as f32 / 50.0 - 1.0, -0.7) - eye;
        let far = |i: usize| if i.is_multiple_of(5) { 1.1 } else { f32::INFINITY };
        let rays: Vec<Ray> = (0..10_000).map(|i| Ray::new(eye, towards(i)).between(0.3, far(i))).collect();
        check(&mut accel, &rays);
    }
}

#[test]
fn masks_are_heeded() {
    let mut random = Random(31);
    let mut accel = Accel::build(scene(&mut random, 300), BuildOptions::default()).unwrap();
    accel.set_mask(0, 2);
    let rays: Vec<Ray> = (0..1000).map(|i| Ray { mask: 1 + i as u32 % 2, ..ray(&mut random, i) }).collect();
    check(&mut accel, &rays);
}

#[test]
fn bad_rays_hit_nothing() {
    let mut random = Random(29);
    let accel = Accel::build(scene(&mut random, 300), BuildOptions::default()).unwrap();
    let good = Ray::new(Vec3::new(0.0, 0.0, 3.0), Vec3::new(0.0, 0.0, -1.0));
    let mut rays = vec![good; 3];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut origin, mut direction) = (good.origin, good.direction);
            origin[axis] = bad;
            direction[axis] = bad;
            rays.extend([Ray { origin, ..good }, Ray { direction, ..good }]);
        }
        rays.extend([Ray { tnear: bad, ..good }, Ray { tfar: bad, ..good }]);
    }
    rays.extend([Ray { direction: Vec3::ZERO, ..good }, good.between(5.0, 2.0), good.between(-1.0, 100.0)]);
    let mut hits = vec![None; rays.len()];
    accel.closest_batch(&rays, &mut hits);
    for (ray, hit) in rays.iter().zip(hits) {
        assert_eq!(bits(hit), bits(accel.closest(ray)), "{ray:?}");
    }
}
