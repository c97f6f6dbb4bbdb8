//! A teapot in a stadium: a small dense thing in a large sparse one.

use lichtweg_ray::math::Vec3;

use super::Scene;

/// Radius of the pot: a stadium is a thousand times as large.
const POT: f32 = 0.1;

/// Rows of seats around a field, in whose middle stands a pot of some 4 `detail`^2 triangles.
pub fn teapot_in_a_stadium(detail: u32) -> Scene {
    let mut s = Scene::empty(
        "teapot in a stadium",
        Vec3::new(0.35, 0.3, 0.45),
        Vec3::new(0.02, 0.1, 0.0),
        Vec3::new(20.0, 60.0, 30.0),
    );
    s.quad(Vec3::new(-60.0, 0.0, -60.0), Vec3::Z * 120.0, Vec3::X * 120.0);
    for row in 0..30 {
        let (radius, height) = (50.0 + 0.9 * row as f32, 0.5 * row as f32);
        let seats = (std::f32::consts::TAU * radius) as u32;
        for i in 0..seats {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / seats as f32).sin_cos();
            let (out, along) = (Vec3::new(cos, 0.0, sin), Vec3::new(-sin, 0.0, cos));
            let corner = out * radius + Vec3::Y * height;
            s.cuboid(corner, along * 0.45, Vec3::Y * 0.4, out * 0.4);
            s.cuboid(corner + out * 0.4, along * 0.45, Vec3::Y * 0.9, out * 0.05);
        }
    }
    pot(&mut s, detail);
    s
}

/// A body of revolution with its lid, a spout and a handle.
fn pot(s: &mut Scene, detail: u32) {
    let profile = |t: f32| {
        let knob = 0.12 * (-((t - 0.97) / 0.02).powi(2)).exp();
        let belly = (std::f32::consts::PI * t.powf(0.8)).sin().max(0.0).powf(0.6);
        (POT * (belly + knob), POT * 1.6 * t)
    };
    surface(s, 2 * detail, detail / 2, |a, t| {
        let (radius, height) = profile(t);
        let (sin, cos) = (std::f32::consts::TAU * a).sin_cos();
        Vec3::new(radius * cos, height, radius * sin)
    });
    let spout = |t: f32| (Vec3::new(POT * (0.8 + t), POT * (0.5 + t * t), 0.0), POT * (0.2 - 0.12 * t));
    let handle = |t: f32| {
        let (sin, cos) = (std::f32::consts::PI * (0.5 + t)).sin_cos();
        (Vec3::new(POT * (0.8 * cos - 0.8), POT * (0.8 + 0.5 * sin), 0.0), POT * 0.08)
    };
    let tube = |s: &mut Scene, path: &dyn Fn(f32) -> (Vec3, f32)| {
        surface(s, detail / 2, detail, |a, t| {
            let (center, radius) = path(t);
            let ahead = (path(t + 0.01).0 - center).normalized();
            let (sin, cos) = (std::f32::consts::TAU * a).sin_cos();
            center + (Vec3::Z * cos + Vec3::Z.cross(ahead) * sin) * radius
        });
    };
    tube(s, &spout);
    tube(s, &handle);
}

/// `columns` by `rows` quadrilaterals of a surface over the unit square.
fn surface(s: &mut Scene, columns: u32, rows: u32, point: impl Fn(f32, f32) -> Vec3) {
    let base = s.positions.len() as u32;
    for j in 0..=rows {
        for i in 0..=columns {
            s.positions.push(point(i as f32 / columns as f32, j as f32 / rows as f32));
        }
    }
    for j in 0..rows {
        for i in 0..columns {
            let k = base + j * (columns + 1) + i;
            let above = k + columns + 1;
            s.indices.extend([[k, k + 1, above], [above, k + 1, above + 1]]);
        }
    }
}
