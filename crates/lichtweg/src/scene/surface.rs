//! Points on surfaces, as scattering and emission need them.

use std::sync::Arc;

use lichtweg_ray::math::{Affine, Vec2, Vec3};
use lichtweg_ray::{Hit, QuadricShape};

use super::offset::{offset, position_error};

/// A point on a surface of the scene.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Where, in the world.
    pub position: Vec3,
    /// Bound on the rounding error of each coordinate.
    pub error: Vec3,
    /// Unit geometric normal, pointing to the outside.
    pub geometric_normal: Vec3,
    /// Unit shading normal.
    pub shading_normal: Vec3,
    /// Surface coordinates.
    pub uv: Vec2,
    /// The shape.
    pub shape: u32,
    /// The triangle, in a mesh.
    pub primitive: u32,
}

impl SurfacePoint {
    /// Where a ray in a direction may start.
    #[inline]
    pub fn leave(&self, direction: Vec3) -> Vec3 {
        offset(self.position, self.error, self.geometric_normal, direction)
    }
}

/// The form of a shape, placed in the world.
#[derive(Debug)]
pub enum Form {
    /// Triangles.
    Mesh(MeshForm),
    /// A sphere, disk or cylinder.
    Quadric(QuadricForm),
}

/// Triangles in the world; the positions and triangles are shared with the ray engine.
#[derive(Debug)]
pub struct MeshForm {
    /// Vertex positions.
    pub positions: Arc<[Vec3]>,
    /// Three positions a triangle.
    pub triangles: Arc<[[u32; 3]]>,
    /// Unit vertex normals, or empty.
    pub normals: Vec<Vec3>,
    /// Vertex texture coordinates, or empty.
    pub uvs: Vec<Vec2>,
    /// -1 where the winding is clockwise seen from the outside.
    pub winding: f32,
}

/// Texture coordinates of the corners of a triangle that has none.
const DEFAULT_UVS: [Vec2; 3] = [Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.0), Vec2::new(1.0, 1.0)];

impl MeshForm {
    /// Positions of a triangle's corners.
    #[inline]
    pub fn corners(&self, primitive: u32) -> [Vec3; 3] {
        self.triangles[primitive as usize].map(|i| self.positions[i as usize])
    }

    /// Twice the area of a triangle times its unit normal.
    #[inline]
    pub fn area_normal(&self, primitive: u32) -> Vec3 {
        let [a, b, c] = self.corners(primitive);
        (b - a).cross(c - a) * self.winding
    }

    /// The point (1 - u - v) a + u b + v c of a triangle.
    #[inline]
    pub fn point(&self, shape: u32, primitive: u32, u: f32, v: f32) -> SurfacePoint {
        let corners = self.triangles[primitive as usize].map(|i| i as usize);
        let [a, b, c] = corners.map(|i| self.positions[i]);
        let w = 1.0 - u - v;
        let geometric_normal = ((b - a).cross(c - a) * self.winding).normalized();
        let shading_normal = if self.normals.is_empty() {
            geometric_normal
        } else {
            let [na, nb, nc] = corners.map(|i| self.normals[i]);
            (na * w + nb * u + nc * v).try_normalized().unwrap_or(geometric_normal)
        };
        let [ta, tb, tc] = self.corner_uvs(corners);
        SurfacePoint {
            position: a * w + b * u + c * v,
            error: position_error(a.abs() * w + b.abs() * u + c.abs() * v),
            geometric_normal,
            shading_normal,
            uv: ta * w + tb * u + tc * v,
            shape,
            primitive,
        }
    }

    #[inline]
    fn corner_uvs(&self, corners: [usize; 3]) -> [Vec2; 3] {
        if self.uvs.is_empty() { DEFAULT_UVS } else { corners.map(|i| self.uvs[i]) }
    }

    /// Derivatives of the position with respect to the surface coordinates, constant over a triangle.
    pub fn partials(&self, primitive: u32) -> Option<[Vec3; 2]> {
        let corners = self.triangles[primitive as usize].map(|i| i as usize);
        let [a, b, c] = corners.map(|i| self.positions[i]);
        let [ta, tb, tc] = self.corner_uvs(corners);
        let (e, f) = (b - a, c - a);
        let (s, t) = (tb - ta, tc - ta);
        let determinant = s.x * t.y - s.y * t.x;
        let partials = [(e * t.y - f * s.y) / determinant, (f * s.x - e * t.x) / determinant];
        partials.iter().all(|p| p.is_finite()).then_some(partials)
    }
}

/// A quadric and its place.
#[derive(Debug)]
pub struct QuadricForm {
    /// Its form in object space.
    pub shape: QuadricShape,
    /// From object space to the world.
    pub to_world: Affine,
    /// The inverse.
    pub to_object: Affine,
    /// The linear map of normals, outward to outward.
    pub normal_to_world: Affine,
    /// -1 where the inside is the outside.
    pub orientation: f32,
}

impl QuadricForm {
    /// A quadric under a regular map; `None` where the map is singular.
    pub fn new(shape: QuadricShape, to_world: Affine, flip: bool) -> Option<Self> {
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| to_world.normal(axis));
        let row = |f: fn(&Vec3) -> f32| {
            let [a, b, c] = [0, 1, 2].map(|i| f64::from(f(&columns[i])));
            [a, b, c, 0.0]
        };
        Some(Self {
            shape,
            to_object: to_world.inverse()?,
            to_world,
            normal_to_world: Affine { rows: [row(|v| v.x), row(|v| v.y), row(|v| v.z)] },
            orientation: if flip { -1.0 } else { 1.0 },
        })
    }

    /// The point of a hit: `near` it, moved onto the surface.
    pub fn point(&self, shape: u32, near: Vec3, uv: Vec2) -> SurfacePoint {
        self.object_point(shape, self.project(self.to_object.point(near)), uv)
    }

    /// The world point of a point on the surface in object space.
    pub fn object_point(&self, shape: u32, p: Vec3, uv: Vec2) -> SurfacePoint {
        let position = self.to_world.point(p);
        let normal = self.normal_to_world.vector(self.object_normal(p)).normalized() * self.orientation;
        let size = Vec3::from_array(
            self.to_world.rows.map(|r| (r[0].abs() + r[1].abs() + r[2].abs() + r[3].abs()) as f32),
        );
        SurfacePoint {
            position,
            error: position_error(size),
            geometric_normal: normal,
            shading_normal: normal,
            uv,
            shape,
            primitive: 0,
        }
    }

    /// Outward normal in object space.
    pub fn object_normal(&self, p: Vec3) -> Vec3 {
        match self.shape {
            QuadricShape::Sphere { .. } => p,
            QuadricShape::Disk { .. } => Vec3::Z,
            QuadricShape::Cylinder { .. } => Vec3::new(p.x, p.y, 0.0),
        }
    }

    /// Derivative of the position with respect to the azimuth, and a second tangent, along growing v.
    pub fn partials(&self, point: &SurfacePoint) -> Option<[Vec3; 2]> {
        let p = self.project(self.to_object.point(point.position));
        let (phi_max, along_v) = match self.shape {
            QuadricShape::Sphere { z_min, z_max, phi_max } => {
                let angle = z_max.min(1.0).acos() - z_min.max(-1.0).acos();
                let radius = p.x.hypot(p.y).max(f32::MIN_POSITIVE);
                (phi_max, Vec3::new(p.x * p.z / radius, p.y * p.z / radius, -radius) * angle)
            }
            QuadricShape::Disk { inner_radius, phi_max } => {
                let radius = p.x.hypot(p.y).max(f32::MIN_POSITIVE);
                (phi_max, Vec3::new(p.x, p.y, 0.0) * ((inner_radius - 1.0) / radius))
            }
            QuadricShape::Cylinder { z_min, z_max, phi_max } => (phi_max, Vec3::Z * (z_max - z_min)),
        };
        let along_u = Vec3::new(-p.y, p.x, 0.0) * phi_max;
        let partials = [self.to_world.vector(along_u), self.to_world.vector(along_v)];
        partials.iter().all(|d| d.is_finite() && d.length_squared() > 0.0).then_some(partials)
    }

    fn project(&self, p: Vec3) -> Vec3 {
        match self.shape {
            QuadricShape::Sphere { .. } => p.normalized(),
            QuadricShape::Disk { .. } => Vec3::new(p.x, p.y, 0.0),
            QuadricShape::Cylinder { .. } => {
                let scale = 1.0 / p.x.hypot(p.y);
                Vec3::new(p.x * scale, p.y * scale, p.z)
            }
        }
    }
}

impl Form {
    /// The point that a ray hit.
    #[inline]
    pub fn hit_point(&self, ray_point: impl FnOnce() -> Vec3, hit: &Hit) -> SurfacePoint {
        match self {
            Self::Mesh(mesh) => mesh.point(hit.geometry, hit.primitive, hit.u, hit.v),
            Self::Quadric(quadric) => quadric.point(hit.geometry, ray_point(), Vec2::new(hit.u, hit.v)),
        }
    }

    /// Derivatives of the position with respect to the surface coordinates, where they exist.
    pub fn partials(&self, point: &SurfacePoint) -> Option<[Vec3; 2]> {
        match self {
            Self::Mesh(mesh) => mesh.partials(point.primitive),
            Self::Quadric(quadric) => quadric.partials(point),
        }
    }
}
