//! A hundred thousand spheres of ten thousand triangles, in memory for one: instances, drawn with letters.
//!
//! `cargo run --release -p lichtweg-ray --example forest`

#[path = "../benches/support/mod.rs"]
mod support;

use std::sync::Arc;

use lichtweg_ray::math::{Affine, Vec3};
use lichtweg_ray::{Accel, BuildOptions, Geometry, Instance, Ray};
use support::random::Random;
use support::rays;
use support::scenes::displaced_sphere;

fn main() {
    let tree = Arc::new(rays::accel(&displaced_sphere(70)));
    let mut random = Random(1);
    let mut unit = || f64::from(random.unit());
    let place = |i: u32| -> Geometry {
        let (x, z) = (f64::from(i % 400) - 200.0, f64::from(i / 400));
        let size = 0.1 + 0.4 * unit();
        let map = Affine::translation(x + unit(), size, z + unit())
            .after(&Affine::rotation([0.0, 1.0, 0.0], 360.0 * unit()))
            .after(&Affine::scaling(0.7 * size, size, 0.7 * size));
        Instance::new(tree.clone(), map).into()
    };
    let forest =
        Accel::build((0..100_000).map(place).collect(), BuildOptions::default()).expect("a sound scene");
    for row in 0..30 {
        let line = (0..100).map(|column| {
            let direction = Vec3::new(column as f32 / 50.0 - 1.0, 0.1 - row as f32 / 40.0, 1.0);
            let ray = Ray::new(Vec3::new(0.0, 4.0, -4.0), direction);
            let Some(hit) = forest.closest(&ray) else { return ' ' };
            let facing = -forest.normal(&ray, &hit).normalized().dot(direction.normalized());
            b"@%#*+=-:."[(facing.clamp(0.0, 0.99) * 9.0) as usize] as char
        });
        println!("{}", line.collect::<String>());
    }
    let megabytes = |accel: &Accel| accel.report().bytes as f64 / 1e6;
    println!(
        "{} instances in {:.1} MB, of {} triangles in {:.1} MB",
        forest.report().instances,
        megabytes(&forest),
        tree.report().triangles,
        megabytes(&tree)
    );
}
