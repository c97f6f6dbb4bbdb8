//! Ray sets over a scene.

use lichtweg_ray::{Accel, BuildQuality, Geometry, Ray, TriangleMesh, math::Vec3};

use super::random::Random;
use super::scenes::{Scene, curves};

/// The rays of one kind.
pub struct Rays {
    pub name: &'static str,
    pub occlusion: bool,
    pub rays: Vec<Ray>,
}

/// Our structure over a scene.
pub fn accel(scene: &Scene) -> Accel {
    accel_of(scene, BuildQuality::default())
}

/// Our structure over a scene, of the quality asked for.
pub fn accel_of(scene: &Scene, quality: BuildQuality) -> Accel {
    let mesh = TriangleMesh::new(scene.positions.clone(), scene.indices.clone());
    let mut geometries = vec![Geometry::Triangles(mesh)];
    geometries.extend(scene.balls.iter().map(|&b| b.into()));
    Accel::build(geometries, quality.into()).expect("a sound scene")
}

/// As [`sets`], of a ball of hairs whose normals the structure itself tells.
pub fn of_hairs(accel: &Accel, side: u32) -> [Rays; 3] {
    let mut random = Random(3);
    let eye = curves::EYE;
    let pixel = |i: u32, offset: f32| 4.0 * (i as f32 + offset) / side as f32 - 2.0;
    let (mut primary, mut bounce, mut shadow) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..side * side {
        let target = Vec3::new(pixel(k % side, random.unit()), -pixel(k / side, random.unit()), 0.0);
        primary.push(Ray::new(eye, (target - eye).normalized()));
    }
    for ray in &primary {
        let Some(hit) = accel.closest(ray) else { continue };
        let (p, normal) = (ray.at(hit.t), accel.normal(ray, &hit).normalized());
        let light = curves::LIGHT + random.direction();
        bounce.push(Ray::new(p, random.cosine(normal)).between(1e-4 * hit.t, f32::INFINITY));
        shadow.push(Ray::new(p, light - p).between(1e-4, 0.9999));
    }
    let set = |name, occlusion, rays| Rays { name, occlusion, rays };
    [set("primary", false, primary), set("bounce", false, bounce), set("shadow", true, shadow)]
}

/// `side` squared primary rays in scanline order and, from what each of them hits, one cosine-distributed
/// bounce and a shadow ray to a random point of the light.
pub fn sets(scene: &Scene, accel: &Accel, side: u32) -> [Rays; 3] {
    let mut random = Random(3);
    let forward = (scene.target - scene.eye).normalized();
    let right = forward.cross(Vec3::Y).normalized() * scene.field;
    let up = right.cross(forward);
    let mut primary = Vec::new();
    for j in 0..side {
        for i in 0..side {
            let x = 2.0 * (i as f32 + random.unit()) / side as f32 - 1.0;
            let y = 1.0 - 2.0 * (j as f32 + random.unit()) / side as f32;
            primary.push(Ray::new(scene.eye, (forward + right * x + up * y).normalized()));
        }
    }
    let light_radius = 0.1 * (scene.light - scene.target).length();
    let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
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
        let light = scene.light + random.direction() * light_radius;
        bounce.push(Ray::new(p, random.cosine(n)).between(1e-4 * hit.t, f32::INFINITY));
        shadow.push(Ray::new(p, light - p).between(1e-4, 0.9999));
    }
    let set = |name, occlusion, rays| Rays { name, occlusion, rays };
    [set("primary", false, primary), set("bounce", false, bounce), set("shadow", true, shadow)]
}
