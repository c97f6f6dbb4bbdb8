//! Scenes to shoot rays at.

pub mod curves;
pub mod files;
pub mod stadium;

use lichtweg_ray::math::{Affine, Vec3};
use lichtweg_ray::{Quadric, QuadricShape};

use super::random::Random;

/// A mesh and where to look at it from.
pub struct Scene {
    pub name: &'static str,
    pub positions: Vec<Vec3>,
    pub indices: Vec<[u32; 3]>,
    pub balls: Vec<Quadric>,
    pub eye: Vec3,
    pub target: Vec3,
    /// Middle of the light.
    pub light: Vec3,
    /// Half the width of the picture at distance one.
    pub field: f32,
}

/// A closed sphere of 2 * `n` * `n` triangles (less the poles' halves), displaced by waves.
pub fn displaced_sphere(n: u32) -> Scene {
    let mut positions = Vec::new();
    let (rows, columns) = (n / 2, 2 * n);
    for i in 1..rows {
        for j in 0..columns {
            let theta = std::f32::consts::PI * i as f32 / rows as f32;
            let phi = std::f32::consts::TAU * j as f32 / columns as f32;
            let d = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            let wave = (13.0 * d.x).sin() * (17.0 * d.y).sin() * (11.0 * d.z).sin();
            let ripple = (131.0 * d.x).sin() * (117.0 * d.y).sin() * (111.0 * d.z).sin();
            positions.push(d * (1.0 + 0.1 * wave + 0.01 * ripple));
        }
    }
    let (north, south) = (positions.len() as u32, positions.len() as u32 + 1);
    positions.extend([Vec3::Z, -Vec3::Z]);
    let at = |i: u32, j: u32| (i - 1) * columns + j % columns;
    let mut indices = Vec::new();
    for j in 0..columns {
        indices.push([north, at(1, j), at(1, j + 1)]);
        indices.push([at(rows - 1, j), south, at(rows - 1, j + 1)]);
        for i in 1..rows - 1 {
            indices.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            indices.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let eye = Vec3::new(1.2, 2.0, 1.5);
    let scene = Scene::empty("displaced sphere", eye, Vec3::ZERO, Vec3::new(-1.0, 3.0, 4.0));
    Scene { positions, indices, ..scene }
}

impl Scene {
    fn empty(name: &'static str, eye: Vec3, target: Vec3, light: Vec3) -> Self {
        let (positions, indices, balls) = (Vec::new(), Vec::new(), Vec::new());
        Self { name, positions, indices, balls, eye, target, light, field: 0.5 }
    }

    fn quad(&mut self, corner: Vec3, u: Vec3, v: Vec3) {
        let base = self.positions.len() as u32;
        self.positions.extend([corner, corner + u, corner + u + v, corner + v]);
        self.indices.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }

    fn cuboid(&mut self, corner: Vec3, x: Vec3, y: Vec3, z: Vec3) {
        self.quad(corner, x, y);
        self.quad(corner + z, y, x);
        self.quad(corner, y, z);
        self.quad(corner + x, z, y);
        self.quad(corner, z, x);
        self.quad(corner + y, x, z);
    }
}

/// Five walls, a lamp and two boxes: 36 triangles.
pub fn box_room() -> Scene {
    let mut s = Scene::empty(
        "box room",
        Vec3::new(0.5, 0.5, 2.2),
        Vec3::new(0.5, 0.5, 0.0),
        Vec3::new(0.5, 0.95, 0.5),
    );
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    s.quad(Vec3::ZERO, z, x);
    s.quad(y, x, z);
    s.quad(Vec3::ZERO, x, y);
    s.quad(Vec3::ZERO, y, z);
    s.quad(x, z, y);
    s.quad(Vec3::new(0.4, 0.99, 0.4), x * 0.2, z * 0.2);
    s.cuboid(
        Vec3::new(0.15, 0.0, 0.15),
        Vec3::new(0.28, 0.0, 0.09),
        Vec3::new(0.0, 0.6, 0.0),
        Vec3::new(-0.09, 0.0, 0.28),
    );
    s.cuboid(
        Vec3::new(0.55, 0.0, 0.5),
        Vec3::new(0.28, 0.0, -0.09),
        Vec3::new(0.0, 0.3, 0.0),
        Vec3::new(0.09, 0.0, 0.28),
    );
    s
}

/// The box room with three spheres.
pub fn box_room_with_balls() -> Scene {
    let mut s = box_room();
    s.name = "box room with balls";
    for (x, y, z, r) in [(0.3, 0.7, 0.3, 0.1), (0.7, 0.4, 0.6, 0.1), (0.3, 0.1, 0.75, 0.1)] {
        let object_to_world = Affine::translation(x, y, z).after(&Affine::scaling(r, r, r));
        s.balls.push(Quadric { shape: QuadricShape::SPHERE, object_to_world });
    }
    s
}

/// `hairs` curled strands of 2 * `segments` long thin triangles around a sphere.
pub fn hair_ball(hairs: u32, segments: u32) -> Scene {
    let mut s = Scene::empty("hair ball", Vec3::new(0.0, 0.5, 5.0), Vec3::ZERO, Vec3::new(4.0, 6.0, 3.0));
    let mut random = Random(7);
    for _ in 0..hairs {
        let mut p = random.direction();
        let mut d = p;
        let side = random.direction() * 0.003;
        let step = 0.8 / segments as f32;
        let base = s.positions.len() as u32;
        for i in 0..=segments {
            s.positions.extend([p - side, p + side]);
            if i > 0 {
                let k = base + 2 * i;
                s.indices.extend([[k - 2, k - 1, k], [k, k - 1, k + 1]]);
            }
            d = (d + random.direction() * 0.4).normalized();
            p += d * step;
        }
    }
    s
}

/// A street grid: ground, blocks of houses with window sills, lamp posts.
pub fn street(side: u32) -> Scene {
    let mut s = Scene::empty(
        "street",
        Vec3::new(-6.0, 30.0, -20.0),
        Vec3::new(120.0, 0.0, 160.0),
        Vec3::new(3000.0, 5000.0, 1000.0),
    );
    let mut random = Random(11);
    let span = side as f32 * 20.0;
    s.quad(Vec3::ZERO, Vec3::Z * span, Vec3::X * span);
    for i in 0..side {
        for j in 0..side {
            let corner = Vec3::new(i as f32 * 20.0 + 5.0, 0.0, j as f32 * 20.0 + 5.0);
            let height = random.between(8.0, 40.0);
            s.cuboid(corner, Vec3::X * 12.0, Vec3::Y * height, Vec3::Z * 12.0);
            for floor in 0..(height / 3.0) as u32 {
                for k in 0..6 {
                    let y = floor as f32 * 3.0 + 1.0;
                    let along = k as f32 * 2.0 + 0.4;
                    for (p, u, n) in [
                        (corner + Vec3::new(along, y, -0.1), Vec3::X, Vec3::Z * 0.1),
                        (corner + Vec3::new(along, y, 12.0), Vec3::X, Vec3::Z * 0.1),
                        (corner + Vec3::new(-0.1, y, along), Vec3::Z, Vec3::X * 0.1),
                        (corner + Vec3::new(12.0, y, along), Vec3::Z, Vec3::X * 0.1),
                    ] {
                        s.cuboid(p, u * 1.2, Vec3::Y * 0.1, n);
                        s.quad(p + Vec3::Y * 0.1, u * 1.2, Vec3::Y * 1.5);
                    }
                }
            }
            let lamp = corner - Vec3::new(1.0, 0.0, 1.0);
            s.cuboid(lamp, Vec3::X * 0.15, Vec3::Y * 5.0, Vec3::Z * 0.15);
        }
    }
    s
}

/// A closed cube [-1, 1]^3 of `n` by `n` squares a side, all edges on a grid; sides share no vertices.
pub fn cube(n: u32) -> Scene {
    let mut s = Scene::empty("cube", Vec3::new(3.0, 2.0, 4.0), Vec3::ZERO, Vec3::new(0.0, 5.0, 3.0));
    let at = |i: u32| 2.0 * i as f32 / n as f32 - 1.0;
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let point = |i: u32, j: u32| {
                let mut p = Vec3::ZERO;
                p[axis] = side;
                p[(axis + 1) % 3] = at(i);
                p[(axis + 2) % 3] = at(j);
                p
            };
            for i in 0..n {
                for j in 0..n {
                    let base = s.positions.len() as u32;
                    s.positions.extend([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                    s.indices.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
                }
            }
        }
    }
    s
}
