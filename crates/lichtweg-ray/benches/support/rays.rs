//! Ray sets over a scene.

use lichtweg_ray::{Accel, Geometry, Ray, TriangleMesh, math::Vec3};

use super::random::Random;
use super::scenes::Scene;

/// The rays of one kind.
pub struct Rays {
    pub name: &'static str,
    pub occlusion: bool,
    pub rays: Vec<Ray>,
}

/// Our structure over a scene.
pub fn accel(scene: &Scene) -> Accel {
    let mesh = TriangleMesh::new(scene.positions.clone(), scene.indices.clone());
    let mut geometries = vec![Geometry::Triangles(mesh)];
    geometries.extend(scene.balls.iter().map(|&b| b.into()));
    Accel::build(geometries, Default::default()).expect("a sound scene")
}

/// Primary rays in scanline order, one cosine bounce from each hit (in the same order and shuffled),
/// and shadow rays to the light.
pub fn sets(scene: &Scene, accel: &Accel, side: u32) -> Vec<Rays> {
    let mut random = Random(3);
    let forward = (scene.target - scene.eye).normalized();
    let right = forward.cross(Vec3::Y).normalized();
    let up = right.cross(forward);
    let mut primary = Vec::new();
    for j in 0..side {
        for i in 0..side {
            let x = (2.0 * (i as f32 + random.unit()) / side as f32 - 1.0) * 0.5;
            let y = (1.0 - 2.0 * (j as f32 + random.unit()) / side as f32) * 0.5;
            primary.push(Ray::new(scene.eye, (forward + right * x + up * y).normalized()));
        }
    }
    let reach = accel.bounds().extent().length();
    let epsilon = 1e-5 * reach;
    let (mut bounce, mut shadow, mut around) = (Vec::new(), Vec::new(), Vec::new());
    for ray in &primary {
        let Some(hit) = accel.closest(ray) else { continue };
        let p = ray.at(hit.t);
        let mut n = if hit.geometry == 0 {
            let [a, b, c] = scene.indices[hit.primitive as usize].map(|i| scene.positions[i as usize]);
            (b - a).cross(c - a).normalized()
        } else {
            let to_world = scene.balls[hit.geometry as usize - 1].object_to_world;
            (p - to_world.point(Vec3::ZERO)).normalized()
        };
        if n.dot(ray.direction) > 0.0 {
            n = -n;
        }
        bounce.push(Ray::new(p, random.cosine(n)).between(epsilon, f32::INFINITY));
        shadow.push(Ray::new(p, scene.light - p).between(1e-4, 0.9999));
        around.push(Ray::new(p, random.cosine(n)).between(epsilon, 0.2 * reach));
    }
    let mut shuffled = bounce.clone();
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, (random.bits() % (i as u64 + 1)) as usize);
    }
    let set = |name, occlusion, rays| Rays { name, occlusion, rays };
    vec![
        set("primary", false, primary),
        set("bounce", false, bounce),
        set("bounce, shuffled", false, shuffled),
        set("shadow", true, shadow),
        set("ambient", true, around),
    ]
}
