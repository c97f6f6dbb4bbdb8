//! The area of the surface in each texel of a chart.

use lichtweg_ray::QuadricShape;
use lichtweg_ray::math::{Vec2, Vec3};

use super::texel;
use crate::scene::{Form, MeshForm, QuadricForm};

/// Charts of triangles that are spread over more texels than this many times those there are count as even.
const MOST_WRAPS: f32 = 16.0;

/// Area per texel, by number. Curves have no chart: what they receive is not mapped.
pub fn texel_areas(form: &Form, shape: u32, resolution: u32) -> Vec<f64> {
    let mut areas = vec![0.0; (resolution * resolution) as usize];
    match form {
        Form::Mesh(mesh) => {
            for primitive in 0..mesh.triangles.len() as u32 {
                add_triangle(mesh, shape, primitive, resolution, &mut areas);
            }
        }
        Form::Quadric(quadric) => add_quadric(quadric, shape, resolution, &mut areas),
        Form::Curves(_) => {}
    }
    areas
}

/// Cuts a triangle of the chart along the texels.
fn add_triangle(mesh: &MeshForm, shape: u32, primitive: u32, resolution: u32, areas: &mut [f64]) {
    let area = f64::from(mesh.area(primitive));
    let n = resolution as f32;
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
        .map(|(u, v)| mesh.point(shape, primitive, u, v).uv)
        .map(|uv| [uv.x * n, uv.y * n]);
    let bound =
        |axis: usize, f: fn(f32, f32) -> f32| corners.iter().map(|c| c[axis]).reduce(f).unwrap_or(0.0);
    let low = [bound(0, f32::min).floor(), bound(1, f32::min).floor()];
    let high = [bound(0, f32::max), bound(1, f32::max)];
    let chart = polygon_area(&corners);
    if !(chart > 0.0 && area > 0.0) {
        return;
    }
    if (high[0] - low[0]) * (high[1] - low[1]) > MOST_WRAPS * n * n {
        areas.iter_mut().for_each(|a| *a += area / f64::from(n * n));
        return;
    }
    let (mut strip, mut cell) = (Vec::new(), Vec::new());
    let mut y = low[1];
    while y < high[1] {
        clip(&corners, 1, y, &mut strip);
        let mut x = low[0];
        while x < high[0] {
            clip(&strip, 0, x, &mut cell);
            let part = f64::from(polygon_area(&cell) / chart);
            if part > 0.0 {
                areas[texel(Vec2::new((x + 0.5) / n, (y + 0.5) / n), resolution) as usize] += area * part;
            }
            x += 1.0;
        }
        y += 1.0;
    }
}

/// The part of a convex polygon with from <= coordinate <= from + 1 along an axis (Sutherland and Hodgman 1974).
fn clip(polygon: &[[f32; 2]], axis: usize, from: f32, out: &mut Vec<[f32; 2]>) {
    let half = |polygon: &[[f32; 2]], at: f32, sign: f32| {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, a) in polygon.iter().enumerate() {
            let b = &polygon[(i + 1) % polygon.len()];
            let (da, db) = (sign * (a[axis] - at), sign * (b[axis] - at));
            if da >= 0.0 {
                kept.push(*a);
            }
            if da * db < 0.0 {
                let t = da / (da - db);
                kept.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
            }
        }
        kept
    };
    *out = half(&half(polygon, from, 1.0), from + 1.0, -1.0);
}

fn polygon_area(polygon: &[[f32; 2]]) -> f32 {
    let Some(origin) = polygon.first() else { return 0.0 };
    let double: f32 = polygon
        .windows(2)
        .map(|w| {
            let [a, b] = [w[0], w[1]].map(|p| [p[0] - origin[0], p[1] - origin[1]]);
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    0.5 * double.abs()
}

/// Adds up |dp/du x dp/dv| over points of each texel.
fn add_quadric(quadric: &QuadricForm, shape: u32, resolution: u32, areas: &mut [f64]) {
    const POINTS: u32 = 4;
    let n = resolution * POINTS;
    for i in 0..n * n {
        let uv = Vec2::new(((i % n) as f32 + 0.5) / n as f32, ((i / n) as f32 + 0.5) / n as f32);
        let point = quadric.object_point(shape, object_point(quadric, uv), uv);
        if let Some([du, dv]) = quadric.partials(&point) {
            areas[texel(uv, resolution) as usize] += f64::from(du.cross(dv).length()) / f64::from(n * n);
        }
    }
}

/// The point of a quadric with given surface coordinates, in object space.
fn object_point(quadric: &QuadricForm, uv: Vec2) -> Vec3 {
    let around = |phi_max: f32, r: f32, z: f32| {
        let (sin, cos) = (uv.x * phi_max).sin_cos();
        Vec3::new(r * cos, r * sin, z)
    };
    match quadric.shape {
        QuadricShape::Sphere { z_min, z_max, phi_max } => {
            let (low, high) = (z_min.max(-1.0).acos(), z_max.min(1.0).acos());
            let (sin, cos) = (low + uv.y * (high - low)).sin_cos();
            around(phi_max, sin, cos)
        }
        QuadricShape::Disk { inner_radius, phi_max } => {
            around(phi_max, 1.0 - uv.y * (1.0 - inner_radius), 0.0)
        }
        QuadricShape::Cylinder { z_min, z_max, phi_max } => {
            around(phi_max, 1.0, z_min + uv.y * (z_max - z_min))
        }
    }
}

#[cfg(test)]
mod tests {
    use lichtweg_ray::math::Affine;

    use super::*;

    #[test]
    fn areas_of_a_sphere() {
        let sphere = QuadricShape::Sphere { z_min: -1.0, z_max: 1.0, phi_max: std::f32::consts::TAU };
        let form = QuadricForm::new(sphere, Affine::scaling(2.0, 2.0, 2.0), false).unwrap();
        let areas = texel_areas(&Form::Quadric(Box::new(form)), 0, 16);
        let total: f64 = areas.iter().sum();
        assert!((total / (16.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3, "{total}");
        // A texel at the equator against one at the pole.
        let row = |i: f64| {
            (std::f64::consts::PI * i / 16.0).cos() - (std::f64::consts::PI * (i + 1.0) / 16.0).cos()
        };
        assert!((areas[8 * 16 + 3] / areas[3] - row(8.0) / row(0.0)).abs() < 0.05);
    }

    #[test]
    fn areas_of_triangles() {
        let positions = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(Vec3::from_array);
        let uvs = [[0.1, 0.2], [0.9, 0.2], [0.1, 1.7]].map(|[u, v]| Vec2::new(u, v)).to_vec();
        let mesh = MeshForm::new(positions.into(), [[0, 1, 2]].into(), Vec::new(), uvs, 1.0);
        let areas = texel_areas(&Form::Mesh(mesh), 0, 10);
        assert!((areas.iter().sum::<f64>() - 2.0).abs() < 1e-4);
        // Wholly inside: area over that of the chart, per texel; twice where the chart wraps round.
        let texels = |u: usize, v: usize| areas[(9 - v) * 10 + u];
        let one = 2.0 / (0.5 * 0.8 * 1.5 * 100.0);
        assert!((texels(2, 8) - one).abs() < 1e-4 && (texels(1, 3) - 2.0 * one).abs() < 1e-4);
        assert_eq!(texels(0, 5), 0.0);
    }
}
