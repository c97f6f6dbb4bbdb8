//! No ray escapes from inside a closed mesh.

#[path = "../benches/support/mod.rs"]
mod support;

use lichtweg_ray::BuildQuality;
use lichtweg_ray::math::Affine;
use support::escape::{escapes, mapped};
use support::rays::{accel, accel_of};
use support::scenes::{Scene, cube, displaced_sphere};

fn assert_tight(scene: &Scene, radius: f32, rays: u64) {
    let accel = accel(scene);
    assert_eq!(accel.report().dropped_degenerate, 0);
    assert_eq!(escapes(scene, &accel, radius, rays, 1), 0, "{}", scene.name);
}

#[test]
fn dense_sphere() {
    assert_tight(&displaced_sphere(300), 0.8, 1_000_000);
}

#[test]
fn dense_sphere_built_fast() {
    let scene = displaced_sphere(200);
    let accel = accel_of(&scene, BuildQuality::Fast);
    assert_eq!(escapes(&scene, &accel, 0.8, 300_000, 1), 0);
}

/// Embree asks its callers to set this; indices, which look like denormal numbers, must survive it.
#[test]
fn denormals_may_be_flushed() {
    let flush = |_| support::timing::flush_denormals();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).start_handler(flush).build().unwrap();
    pool.install(|| assert_tight(&displaced_sphere(60), 0.8, 100_000));
}

#[test]
fn thin_tilted_sphere() {
    let map = Affine::rotation([1.0, 2.0, 3.0], 40.0).after(&Affine::scaling(1.0, 100.0, 1e-3));
    assert_tight(&mapped(displaced_sphere(100), &map), 1e-4, 300_000);
}

#[test]
fn far_from_the_origin() {
    let map = Affine::translation(5000.0, -3000.0, 700.0);
    assert_tight(&mapped(displaced_sphere(60), &map), 0.5, 300_000);
}

#[test]
fn tiny_and_huge() {
    assert_tight(&mapped(displaced_sphere(60), &Affine::scaling(1e-15, 1e-15, 1e-15)), 1e-16, 200_000);
    assert_tight(&mapped(displaced_sphere(60), &Affine::scaling(1e11, 1e11, 1e11)), 1e10, 200_000);
}

#[test]
fn axis_aligned_cube() {
    assert_tight(&cube(1), 0.9, 200_000);
    assert_tight(&cube(64), 0.9, 300_000);
    let turned = Affine::rotation([0.3, 1.0, 0.2], 33.0);
    assert_tight(&mapped(cube(64), &turned), 0.9, 300_000);
}

#[test]
fn a_missing_triangle_is_found() {
    let mut scene = displaced_sphere(60);
    scene.indices.swap_remove(1234);
    assert_ne!(escapes(&scene, &accel(&scene), 0.5, 300_000, 1), 0, "the test can fail");
}
