//! Spheres, disks and cylinders in triangles: an even grid over their surface coordinates, whose corners lie on the surface.

use std::f32::consts::TAU;

use lichtweg::scene::{QuadricForm, SurfacePoint};
use lichtweg_ray::QuadricShape;
use lichtweg_ray::math::{Vec2, Vec3};

/// Sides of a whole circle, and rings of a sphere, at least.
const SIDES: f32 = 12.0;
const RINGS: u32 = 6;
/// Cuts in a direction, at most.
const MOST_CUTS: f32 = 512.0;

/// Triangles with edges of about `edge`: their corners in the world, and the point of the surface above their middle.
pub fn triangles(form: &QuadricForm, shape: u32, edge: f32) -> Vec<([Vec3; 3], SurfacePoint)> {
    let point = |uv: [f32; 2]| form.object_point(shape, on_surface(form.shape, uv), Vec2::new(uv[0], uv[1]));
    let length = |from: [f32; 2], to: [f32; 2]| {
        let at = |k: u32| {
            let t = k as f32 / SIDES;
            point([0, 1].map(|axis| from[axis] + t * (to[axis] - from[axis]))).position
        };
        (0..SIDES as u32).map(|k| (at(k + 1) - at(k)).length_squared().sqrt()).sum::<f32>()
    };
    let around = [0.0, 0.5, 1.0].map(|v| length([0.0, v], [1.0, v])).into_iter().fold(0.0, f32::max);
    let along = [0.0, 0.5].map(|u| length([u, 0.0], [u, 1.0])).into_iter().fold(0.0, f32::max);
    let (phi_max, rings) = match form.shape {
        QuadricShape::Sphere { phi_max, .. } => (phi_max, RINGS),
        QuadricShape::Disk { phi_max, .. } | QuadricShape::Cylinder { phi_max, .. } => (phi_max, 1),
    };
    let cuts = |length: f32| (length / edge).ceil().clamp(1.0, MOST_CUTS) as u32;
    let columns = cuts(around).max((SIDES * phi_max / TAU).ceil() as u32);
    let rows = cuts(along).max(rings);
    let at = |i: u32, j: u32| [i as f32 / columns as f32, j as f32 / rows as f32];
    let mut triangles = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            for corners in [[a, b, c], [a, c, d]] {
                let middle = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f32>() / 3.0);
                triangles.push((corners.map(|corner| point(corner).position), point(middle)));
            }
        }
    }
    triangles
}

/// The point of the unit form at surface coordinates.
fn on_surface(shape: QuadricShape, [u, v]: [f32; 2]) -> Vec3 {
    let (phi_max, radius, z) = match shape {
        QuadricShape::Sphere { z_min, z_max, phi_max } => {
            let [low, high] = [z_min, z_max].map(|z| z.clamp(-1.0, 1.0).acos());
            let theta = low + v * (high - low);
            (phi_max, theta.sin(), theta.cos())
        }
        QuadricShape::Disk { inner_radius, phi_max } => (phi_max, 1.0 - v * (1.0 - inner_radius), 0.0),
        QuadricShape::Cylinder { z_min, z_max, phi_max } => (phi_max, 1.0, z_min + v * (z_max - z_min)),
    };
    let phi = u * phi_max;
    Vec3::new(radius * phi.cos(), radius * phi.sin(), z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lichtweg_ray::math::Affine;
    use std::f32::consts::PI;

    /// The areas of the triangles add up to that of the form, from below.
    #[test]
    fn triangles_cover_the_form() {
        for (shape, exact) in [
            (QuadricShape::Sphere { z_min: -1.0, z_max: 1.0, phi_max: TAU }, 4.0 * PI),
            (QuadricShape::Sphere { z_min: 0.0, z_max: 0.5, phi_max: PI }, 0.5 * PI),
            (QuadricShape::Disk { inner_radius: 0.5, phi_max: TAU }, 0.75 * PI),
            (QuadricShape::Cylinder { z_min: -1.0, z_max: 2.0, phi_max: TAU }, 6.0 * PI),
        ] {
            let form = QuadricForm::new(shape, Affine::IDENTITY, false).unwrap();
            let area = |[a, b, c]: [Vec3; 3]| 0.5 * (b - a).cross(c - a).length_squared().sqrt();
            let sum: f32 = triangles(&form, 0, 0.1).into_iter().map(|(corners, _)| area(corners)).sum();
            assert!(sum < 1.0001 * exact && sum > 0.99 * exact, "{shape:?}: {sum} {exact}");
        }
    }
}
