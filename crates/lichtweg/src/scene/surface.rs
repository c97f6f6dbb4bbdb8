//! Points on surfaces, as scattering and emission need them.

use std::sync::Arc;

use lichtweg_ray::math::{Affine, Bounds3, Vec2, Vec3, Vector};
use lichtweg_ray::wide::{FloatLanes, LANES, Row};
use lichtweg_ray::{CurvePoint, Geometry, Hit, Quadric, QuadricShape, Ray, TriangleMesh};

use super::curve::CurveForm;
use super::offset::{offset, position_error};
use super::sphere::Sphere;

/// A point on a surface of the scene.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Where, in the world.
    pub position: Vec3,
    /// Bound on the rounding error along the normal.
    pub error: f32,
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
    /// The instance.
    pub place: Place,
}

/// The space that a surface point's form is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The instance, or [`Place::WORLD`]'s.
    pub instance: u32,
    /// When, for instances that move.
    pub time: f32,
}

impl Place {
    /// No instance: the form is in the world.
    pub const WORLD: Self = Self { instance: u32::MAX, time: 0.0 };
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
    Quadric(Box<QuadricForm>),
    /// Curves.
    Curves(CurveForm),
}

/// Triangles in the world.
#[derive(Debug)]
pub struct MeshForm {
    /// Vertex positions, shared with the ray engine.
    pub positions: Arc<[Vec3]>,
    /// Three positions a triangle, shared with the ray engine.
    pub triangles: Arc<[[u32; 3]]>,
    /// What a hit needs of each triangle, gathered.
    facets: Vec<Row>,
    /// Unit vertex normals, or empty.
    normals: Vec<Vec3>,
    /// Vertex texture coordinates, or empty: those of every triangle are then (0, 0), (1, 0) and (1, 1).
    uvs: Vec<Vec2>,
}

/// A triangle as hits need it: one cache line, the fields of a [`Row`] in this order.
#[derive(Clone, Copy, Debug)]
struct Facet {
    corner: Vec3,
    edges: [Vec3; 2],
    /// Unit, outward; not finite where the triangle has no area.
    normal: Vec3,
    area: f32,
    error: f32,
}

impl Facet {
    #[inline(always)]
    fn from_row(row: &Row) -> Self {
        let r = &row.0;
        let vector = |i: usize| Vec3::new(r[i], r[i + 1], r[i + 2]);
        Self {
            corner: vector(0),
            edges: [vector(3), vector(6)],
            normal: vector(9),
            area: r[12],
            error: r[13],
        }
    }

    fn to_row(self) -> Row {
        let mut row = Row::splat(0.0);
        for (i, v) in [self.corner, self.edges[0], self.edges[1], self.normal].into_iter().enumerate() {
            row.0[3 * i..3 * i + 3].copy_from_slice(&v.to_array());
        }
        (row.0[12], row.0[13]) = (self.area, self.error);
        row
    }
}

/// Sixteen facets in registers.
pub(crate) struct Facets<F> {
    pub corner: Vector<F>,
    pub edges: [Vector<F>; 2],
    pub normal: Vector<F>,
    pub error: F,
}

impl<F: FloatLanes> Facets<F> {
    /// From the rows of [`MeshForm::row`].
    #[inline(always)]
    pub(crate) fn new(rows: &[&Row; LANES]) -> Self {
        let [ax, ay, az, ex, ey, ez, fx, fy, fz, nx, ny, nz, _, error, ..] = F::columns(rows);
        Self {
            corner: Vector::new(ax, ay, az),
            edges: [Vector::new(ex, ey, ez), Vector::new(fx, fy, fz)],
            normal: Vector::new(nx, ny, nz),
            error,
        }
    }
}

impl MeshForm {
    /// Triangles over world positions, with unit normals and texture coordinates a vertex or none. `winding` is -1 where
    /// triangles run clockwise seen from the outside. All indices must be in range.
    pub fn new(
        positions: Arc<[Vec3]>,
        triangles: Arc<[[u32; 3]]>,
        normals: Vec<Vec3>,
        uvs: Vec<Vec2>,
        winding: f32,
    ) -> Self {
        let facet = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| positions[i as usize]);
            let edges = [b - a, c - a];
            let double_area = edges[0].cross(edges[1]) * winding;
            let size = a.abs().max(b.abs()).max(c.abs()).max_element();
            Facet {
                corner: a,
                edges,
                normal: double_area.normalized(),
                area: 0.5 * double_area.length(),
                error: position_error(size),
            }
            .to_row()
        };
        let facets = triangles.iter().map(facet).collect();
        Self { positions, triangles, facets, normals, uvs }
    }

    /// Forgets the texture coordinates, which nothing looks at.
    pub fn forget_coordinates(&mut self) {
        self.uvs = Vec::new();
    }

    /// What sixteen hits at once need of a triangle.
    #[inline(always)]
    pub(crate) fn row(&self, primitive: u32) -> &Row {
        &self.facets[primitive as usize]
    }

    /// Whether normals are interpolated.
    #[inline(always)]
    pub(crate) fn is_smooth(&self) -> bool {
        !self.normals.is_empty()
    }

    /// The shading normal at a point of a triangle.
    #[inline]
    pub(crate) fn shading_normal(&self, primitive: u32, u: f32, v: f32) -> Vec3 {
        let normal = Facet::from_row(self.row(primitive)).normal;
        if self.is_smooth() { self.normal(primitive, u, v, normal) } else { normal }
    }

    /// The surface coordinates at a point of a triangle.
    #[inline]
    pub(crate) fn surface_coordinates(&self, primitive: u32, u: f32, v: f32) -> Vec2 {
        if self.uvs.is_empty() { Vec2::new(u + v, v) } else { self.coordinates(primitive, u, v) }
    }

    /// Area of a triangle; a triangle that the ray engine drops, because it has none, has none here.
    pub fn area(&self, primitive: u32) -> f32 {
        let facet = Facet::from_row(self.row(primitive));
        if facet.normal.is_finite() { facet.area } else { 0.0 }
    }

    /// The point (1 - u - v) a + u b + v c of a triangle.
    #[inline(always)]
    pub fn point(&self, shape: u32, primitive: u32, u: f32, v: f32) -> SurfacePoint {
        let facet = Facet::from_row(self.row(primitive));
        let shading_normal =
            if self.normals.is_empty() { facet.normal } else { self.normal(primitive, u, v, facet.normal) };
        let uv = self.surface_coordinates(primitive, u, v);
        SurfacePoint {
            position: facet.corner + facet.edges[0] * u + facet.edges[1] * v,
            error: facet.error,
            geometric_normal: facet.normal,
            shading_normal,
            uv,
            shape,
            primitive,
            place: Place::WORLD,
        }
    }

    /// The interpolated normal, or the geometric one where that vanishes.
    fn normal(&self, primitive: u32, u: f32, v: f32, geometric: Vec3) -> Vec3 {
        let [a, b, c] = self.triangles[primitive as usize].map(|i| self.normals[i as usize]);
        (a * (1.0 - u - v) + b * u + c * v).try_normalized().unwrap_or(geometric)
    }

    /// The interpolated texture coordinates.
    fn coordinates(&self, primitive: u32, u: f32, v: f32) -> Vec2 {
        let [a, b, c] = self.triangles[primitive as usize].map(|i| self.uvs[i as usize]);
        a * (1.0 - u - v) + b * u + c * v
    }

    /// Derivatives of the position with respect to the surface coordinates, constant over a triangle.
    pub fn partials(&self, primitive: u32) -> Option<[Vec3; 2]> {
        let [e, f] = Facet::from_row(self.row(primitive)).edges;
        let [s, t] = if self.uvs.is_empty() {
            [Vec2::new(1.0, 0.0), Vec2::new(1.0, 1.0)]
        } else {
            let [a, b, c] = self.triangles[primitive as usize].map(|i| self.uvs[i as usize]);
            [b - a, c - a]
        };
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
    /// The [`Sphere`] that it is, if it is a whole one.
    pub(crate) sphere: Option<Row>,
}

/// Relative deviation from a sphere that is well within [`position_error`].
const SPHERE_TOLERANCE: f32 = 5e-7;

impl QuadricForm {
    /// A quadric under a regular map; `None` where the map is singular.
    pub fn new(shape: QuadricShape, to_world: Affine, flip: bool) -> Option<Self> {
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| to_world.normal(axis));
        let row = |f: fn(&Vec3) -> f32| {
            let [a, b, c] = [0, 1, 2].map(|i| f64::from(f(&columns[i])));
            [a, b, c, 0.0]
        };
        let orientation = if flip { -1.0 } else { 1.0 };
        Some(Self {
            shape,
            to_object: to_world.inverse()?,
            to_world,
            normal_to_world: Affine { rows: [row(|v| v.x), row(|v| v.y), row(|v| v.z)] },
            orientation,
            sphere: Sphere::of(&shape, &to_world, orientation, SPHERE_TOLERANCE).map(Sphere::to_row),
        })
    }

    /// The point of a hit: `near` it, moved onto the surface.
    #[inline(never)]
    pub fn point(&self, shape: u32, near: Vec3, uv: Vec2) -> SurfacePoint {
        if let Some(row) = &self.sphere {
            let sphere = Sphere::from_row(row);
            return self.sphere_point(shape, &sphere, sphere.nearest(near), uv);
        }
        self.object_point(shape, self.project(self.to_object.point(near)), uv)
    }

    /// A point of a sphere that this is, and the normal there.
    #[inline]
    pub(crate) fn sphere_point(
        &self,
        shape: u32,
        sphere: &Sphere,
        [position, normal]: [Vec3; 2],
        uv: Vec2,
    ) -> SurfacePoint {
        quadric_point(shape, [position, normal], sphere.error, uv)
    }

    /// The world point of a point on the surface in object space.
    pub fn object_point(&self, shape: u32, p: Vec3, uv: Vec2) -> SurfacePoint {
        let position = self.to_world.point(p);
        let normal = self.normal_to_world.vector(self.object_normal(p)).normalized() * self.orientation;
        let size = Vec3::from_array(
            self.to_world.rows.map(|r| (r[0].abs() + r[1].abs() + r[2].abs() + r[3].abs()) as f32),
        );
        quadric_point(shape, [position, normal], position_error(size.max_element()), uv)
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

/// A point of a quadric in the world, whose shading normal is its normal.
#[inline]
fn quadric_point(shape: u32, [position, normal]: [Vec3; 2], error: f32, uv: Vec2) -> SurfacePoint {
    SurfacePoint {
        position,
        error,
        geometric_normal: normal,
        shading_normal: normal,
        uv,
        shape,
        primitive: 0,
        place: Place::WORLD,
    }
}

impl Form {
    /// A box around it.
    pub fn bounds(&self) -> Bounds3 {
        match self {
            Self::Mesh(mesh) => {
                let corners = mesh.triangles.iter().flatten();
                Bounds3::of(corners.map(|&i| mesh.positions[i as usize]))
            }
            Self::Quadric(quadric) => {
                let (low, high) = match quadric.shape {
                    QuadricShape::Sphere { .. } => (-1.0, 1.0),
                    QuadricShape::Disk { .. } => (0.0, 0.0),
                    QuadricShape::Cylinder { z_min, z_max, .. } => (z_min, z_max),
                };
                let sign = |i: usize, bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
                let corner = |i| Vec3::new(sign(i, 0), sign(i, 1), if i & 4 == 0 { low } else { high });
                Bounds3::of((0..8).map(|i| quadric.to_world.point(corner(i))))
            }
            // A curve lies in the hull of its control points.
            Self::Curves(form) => {
                let around = |p: &CurvePoint| Bounds3::of([p.position]).widened(p.radius);
                form.curves.points().iter().map(around).fold(Bounds3::EMPTY, Bounds3::union)
            }
        }
    }

    /// Unit axis and half-angle in radians of a cone about all geometric normals of a shape of this form.
    pub fn normal_cone(&self, shape: u32) -> (Vec3, f32) {
        const ALL: (Vec3, f32) = (Vec3::Z, std::f32::consts::PI);
        match self {
            Self::Mesh(mesh) => {
                let count = mesh.triangles.len() as u32;
                let normals = || {
                    (0..count)
                        .filter(|&i| mesh.area(i) > 0.0)
                        .map(|i| mesh.point(shape, i, 0.0, 0.0).geometric_normal)
                };
                let sum = normals().fold(Vec3::ZERO, |sum, n| sum + n);
                let Some(axis) = sum.try_normalized() else { return ALL };
                let cos = normals().map(|n| n.dot(axis)).fold(1.0, f32::min);
                (axis, cos.clamp(-1.0, 1.0).acos())
            }
            Self::Quadric(quadric) => match quadric.shape {
                QuadricShape::Disk { .. } => {
                    (quadric.object_point(shape, Vec3::ZERO, Vec2::ZERO).geometric_normal, 0.0)
                }
                _ => ALL,
            },
            Self::Curves(_) => ALL,
        }
    }

    /// What the ray engine sees of it.
    pub(super) fn geometry(&self) -> Geometry {
        match self {
            Self::Mesh(mesh) => TriangleMesh::new(mesh.positions.clone(), mesh.triangles.clone()).into(),
            Self::Quadric(q) => Quadric { shape: q.shape, object_to_world: q.to_world }.into(),
            Self::Curves(form) => form.curves.clone().into(),
        }
    }

    /// Whether rows say all that sixteen hits at once need of it.
    pub(super) fn has_rows(&self) -> bool {
        match self {
            Self::Mesh(_) => true,
            Self::Quadric(quadric) => quadric.sphere.is_some(),
            Self::Curves(_) => false,
        }
    }

    /// Number of triangles.
    pub(super) fn triangles(&self) -> u64 {
        match self {
            Self::Mesh(mesh) => mesh.triangles.len() as u64,
            Self::Quadric(_) | Self::Curves(_) => 0,
        }
    }

    /// The point that a ray hit.
    #[inline(always)]
    pub fn hit_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match self {
            Self::Mesh(mesh) => mesh.point(hit.geometry, hit.primitive, hit.u, hit.v),
            Self::Quadric(quadric) => quadric.point(hit.geometry, ray.at(hit.t), Vec2::new(hit.u, hit.v)),
            Self::Curves(form) => form.point(hit.geometry, ray, hit),
        }
    }

    /// Derivatives of the position with respect to the surface coordinates, where they exist.
    pub fn partials(&self, point: &SurfacePoint) -> Option<[Vec3; 2]> {
        match self {
            Self::Mesh(mesh) => mesh.partials(point.primitive),
            Self::Quadric(quadric) => quadric.partials(point),
            Self::Curves(form) => form.partials(point),
        }
    }
}
