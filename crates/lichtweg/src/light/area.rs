//! Shapes that emit.
//!
//! Points are chosen uniformly over the triangles of a mesh, over the parameters of a quadric, or, for a whole sphere
//! seen from outside, over the cone of directions that it fills ([`Cone`]).

use std::f32::consts::{PI, TAU};

use lichtweg_montecarlo::distribution::AliasTable;
use lichtweg_ray::QuadricShape;
use lichtweg_ray::math::{Vec2, Vec3, Vector};
use lichtweg_ray::wide::{Float, Row};

use super::LightSample;
use super::cone::Cone;
use crate::color::Spectrum;
use crate::lanes::warp;
use crate::scene::{Form, MeshForm, QuadricForm, Scene, Sphere, SurfacePoint};
use crate::texture::{Input, TextureArena};

/// An emitting shape.
#[derive(Debug)]
pub struct AreaLight {
    /// The shape.
    pub shape: u32,
    /// Emitted radiance, before `factor`.
    pub radiance: Input,
    /// Multiplies `radiance`.
    pub factor: f32,
    /// Emit from both sides.
    pub two_sided: bool,
    /// How points on it are chosen.
    pub sampling: EmissionSampling,
    /// Where it is made of triangles, or a whole sphere, of constant radiance without holes: what sixteen walks at once need of it.
    pub(crate) row: Option<Row>,
}

/// What sixteen walks at once need to choose a point on a light.
pub(crate) struct LightRows<'a> {
    /// Of a triangle, see [`MeshForm::row`](crate::scene::MeshForm), or of a [`Sphere`].
    pub form: &'a Row,
    /// Whether it is a sphere.
    pub is_sphere: bool,
    /// See [`AreaLight::emission_row`].
    pub emission: &'a Row,
    /// What is left of the random number.
    pub remapped: f32,
}

/// A light's point as it is seen from another one. For any width.
pub(crate) struct Sight<F: Float> {
    /// Unit, to the light.
    pub direction: Vector<F>,
    pub distance_squared: F,
    /// Of the angle to the light's normal.
    pub cos: F,
}

impl<F: Float> Sight<F> {
    #[inline(always)]
    pub fn new(from: Vector<F>, position: Vector<F>, normal: Vector<F>) -> Self {
        let to_light = position - from;
        let distance_squared = to_light.length_squared();
        let direction = to_light * (F::splat(1.0) / distance_squared.sqrt());
        Self { direction, distance_squared, cos: normal.dot(-direction) }
    }

    /// A density per area as one per solid angle: dw = cos dA / d^2.
    #[inline(always)]
    pub fn per_solid_angle(&self, pdf_area: F) -> F {
        pdf_area * self.distance_squared / self.cos.abs()
    }
}

/// How points on an emitting shape are chosen.
#[derive(Debug)]
pub enum EmissionSampling {
    /// A triangle by its area, then a point on it uniformly.
    Triangles {
        /// Over the triangles.
        table: AliasTable,
        /// Sum of their areas.
        area: f32,
    },
    /// The cone of directions to a whole sphere; from inside, its surface uniformly.
    Sphere(Sphere),
    /// The parameters of a quadric uniformly by its area in object space.
    Quadric,
}

impl EmissionSampling {
    /// The sampling that suits a form; `None` where it has no area.
    pub fn new(form: &Form) -> Option<Self> {
        match form {
            Form::Mesh(mesh) => {
                let areas: Vec<f32> = (0..mesh.triangles.len() as u32).map(|i| mesh.area(i)).collect();
                let table = AliasTable::new(&areas).ok()?;
                let area = areas.iter().map(|&a| f64::from(a)).sum::<f64>() as f32;
                Some(Self::Triangles { table, area })
            }
            Form::Quadric(q) => Some(
                Sphere::of(&q.shape, &q.to_world, q.orientation, SPHERE_TOLERANCE)
                    .map_or(Self::Quadric, Self::Sphere),
            ),
            Form::Curves(_) => None,
        }
    }
}

/// Relative deviation from a sphere that nobody sees.
const SPHERE_TOLERANCE: f32 = 1e-5;

impl AreaLight {
    /// Radiance that leaves a point on it in a direction.
    #[inline]
    pub fn radiance(&self, point: &SurfacePoint, outgoing: Vec3, textures: &TextureArena) -> Spectrum {
        if self.two_sided || point.geometric_normal.dot(outgoing) > 0.0 {
            textures.eval(self.radiance, point.uv) * self.factor
        } else {
            Spectrum::ZERO
        }
    }

    /// See [`Light::sample_part`](super::Light::sample_part); with the point on the light.
    #[inline]
    pub fn sample(
        &self,
        from: Vec3,
        triangle: Option<u32>,
        u: [f32; 2],
        scene: &Scene,
    ) -> Option<(LightSample, SurfacePoint)> {
        let (point, measure) = self.sample_point(from, triangle, u, scene.form(self.shape))?;
        let sight = Sight::new(from, point.position, point.geometric_normal);
        let direction = sight.direction;
        if sight.cos <= 0.0 && !self.two_sided {
            return None;
        }
        let pdf = match measure {
            Measure::SolidAngle(pdf) => pdf,
            Measure::Area(pdf) => sight.per_solid_angle(pdf),
        };
        let radiance = scene.textures().eval(self.radiance, point.uv)
            * self.factor
            * scene.opacity_at(&point, -direction);
        (pdf > 0.0 && pdf.is_finite() && !radiance.is_zero()).then(|| {
            let target = Some(point.leave(-direction));
            (LightSample { direction, target, radiance, pdf, delta: false }, point)
        })
    }

    /// A point that is even over the area (in object space, for quadrics), and its density per area.
    pub(super) fn point_by_area(&self, u: [f32; 2], form: &Form) -> Option<(SurfacePoint, f32)> {
        match (&self.sampling, form) {
            (EmissionSampling::Triangles { table, area }, Form::Mesh(mesh)) => {
                Some((self.triangle_point(None, u, table, mesh), 1.0 / area))
            }
            (_, Form::Quadric(quadric)) => {
                let point = quadric_point(quadric, self.shape, u);
                Some((point, self.pdf_area(&point, form)))
            }
            _ => None,
        }
    }

    /// A point that is even over a triangle, or over all of them.
    #[inline(always)]
    fn triangle_point(
        &self,
        triangle: Option<u32>,
        [u, v]: [f32; 2],
        table: &AliasTable,
        mesh: &MeshForm,
    ) -> SurfacePoint {
        let (triangle, remapped) = pick_or(triangle, u, table);
        let [_, b, c] = warp::uniform_triangle([remapped, v]);
        mesh.point(self.shape, triangle, b, c)
    }

    /// Density per area of [`AreaLight::point_by_area`].
    #[inline]
    pub(super) fn pdf_area(&self, point: &SurfacePoint, form: &Form) -> f32 {
        match (&self.sampling, form) {
            (EmissionSampling::Triangles { area, .. }, _) => 1.0 / area,
            (EmissionSampling::Sphere(sphere), _) => 1.0 / sphere_area(sphere),
            (_, Form::Quadric(quadric)) => quadric_pdf_area(quadric, point),
            _ => 0.0,
        }
    }

    /// Radiance (elements 0 to 3), 1 / area (4), and 1 where both sides emit (5); `None` where that, and the form's
    /// row, do not say it all.
    pub(crate) fn emission_row(&self, form: &Form, has_holes: bool) -> Option<Row> {
        let Input::Constant(radiance) = self.radiance else { return None };
        let mut row = Row::splat(0.0);
        row.0[..4].copy_from_slice(&(radiance * self.factor).0);
        match (&self.sampling, form) {
            (EmissionSampling::Triangles { area, .. }, _) => row.0[4] = 1.0 / area,
            (EmissionSampling::Sphere(sphere), Form::Quadric(q)) if q.sphere.is_some() => {
                row.0[4] = 1.0 / sphere_area(sphere);
            }
            _ => return None,
        }
        row.0[5] = if self.two_sided { 1.0 } else { 0.0 };
        (!has_holes).then_some(row)
    }

    /// The triangle that [`AreaLight::sample`] chooses by the first of its random numbers, if it was not told which; or the
    /// sphere.
    #[inline(always)]
    pub(crate) fn rows<'a>(&'a self, triangle: Option<u32>, u: f32, form: &'a Form) -> Option<LightRows<'a>> {
        let emission = self.row.as_ref()?;
        match (&self.sampling, form) {
            (EmissionSampling::Triangles { table, .. }, Form::Mesh(mesh)) => {
                let (triangle, remapped) = pick_or(triangle, u, table);
                Some(LightRows { form: mesh.row(triangle), is_sphere: false, emission, remapped })
            }
            (_, Form::Quadric(quadric)) => {
                let form = quadric.sphere.as_ref()?;
                Some(LightRows { form, is_sphere: true, emission, remapped: u })
            }
            _ => None,
        }
    }

    #[inline(always)]
    fn sample_point(
        &self,
        from: Vec3,
        triangle: Option<u32>,
        u: [f32; 2],
        form: &Form,
    ) -> Option<(SurfacePoint, Measure)> {
        if let (EmissionSampling::Triangles { table, area }, Form::Mesh(mesh)) = (&self.sampling, form) {
            return Some((self.triangle_point(triangle, u, table, mesh), Measure::Area(1.0 / area)));
        }
        self.sample_quadric(from, u, form)
    }

    #[inline(never)]
    fn sample_quadric(&self, from: Vec3, u: [f32; 2], form: &Form) -> Option<(SurfacePoint, Measure)> {
        if let (EmissionSampling::Sphere(sphere), Form::Quadric(quadric)) = (&self.sampling, form) {
            let cone = Cone::new(sphere, from);
            if cone.valid {
                let [position, normal] = cone.point(sphere, u);
                let uv = match self.radiance {
                    Input::Constant(_) => Vec2::ZERO,
                    Input::Texture(_) => sphere_uv(quadric.to_object.point(position)),
                };
                let point = quadric.sphere_point(self.shape, sphere, [position, normal], uv);
                return Some((point, Measure::SolidAngle(cone.pdf())));
            }
        }
        self.point_by_area(u, form).map(|(point, pdf)| (point, Measure::Area(pdf)))
    }

    /// Density per area with which [`AreaLight::sample`] chooses a point for `from`.
    #[inline]
    pub fn connection_pdf_area(&self, from: Vec3, point: &SurfacePoint, form: &Form) -> f32 {
        if let EmissionSampling::Sphere(sphere) = &self.sampling {
            let cone = Cone::new(sphere, from);
            if cone.valid {
                let sight = Sight::new(from, point.position, point.geometric_normal);
                return cone.pdf() * sight.cos.abs() / sight.distance_squared;
            }
        }
        self.pdf_area(point, form)
    }

    /// Density per solid angle at `from` with which [`AreaLight::sample`] chooses the direction to `point`.
    #[inline]
    pub fn pdf(&self, from: Vec3, point: &SurfacePoint, direction: Vec3, form: &Form) -> f32 {
        if let EmissionSampling::Sphere(sphere) = &self.sampling {
            let cone = Cone::new(sphere, from);
            if cone.valid {
                return cone.pdf();
            }
        }
        let distance_squared = (point.position - from).length_squared();
        let cos = point.geometric_normal.dot(direction);
        Sight { direction, distance_squared, cos }.per_solid_angle(self.pdf_area(point, form))
    }
}

fn sphere_area(sphere: &Sphere) -> f32 {
    2.0 * TAU * sphere.radius * sphere.radius
}

/// Surface coordinates of a whole sphere at a point of object space.
fn sphere_uv(p: Vec3) -> Vec2 {
    let azimuth = p.y.atan2(p.x) / TAU;
    Vec2::new(azimuth - azimuth.floor(), 1.0 - p.normalized().z.clamp(-1.0, 1.0).acos() / PI)
}

/// A triangle, which is chosen where it is not given, and what is left of the random number.
#[inline(always)]
fn pick_or(triangle: Option<u32>, u: f32, table: &AliasTable) -> (u32, f32) {
    match triangle {
        Some(triangle) => (triangle, u),
        None => {
            let pick = table.sample(u);
            (pick.index as u32, pick.remapped)
        }
    }
}

/// A density, and what it is a density of.
enum Measure {
    SolidAngle(f32),
    Area(f32),
}

/// A point on a quadric, uniform by the area of its object-space form.
fn quadric_point(quadric: &QuadricForm, shape: u32, [u, v]: [f32; 2]) -> SurfacePoint {
    let azimuth = |phi_max: f32| (u * phi_max).sin_cos();
    let (p, uv) = match quadric.shape {
        QuadricShape::Sphere { z_min, z_max, phi_max } => {
            // Archimedes: height is uniform over a sphere's area.
            let (low, high) = (z_min.max(-1.0), z_max.min(1.0));
            let z = low + v * (high - low);
            let r = (1.0 - z * z).max(0.0).sqrt();
            let (sin, cos) = azimuth(phi_max);
            let angle = (z.acos() - low.acos()) / (high.acos() - low.acos());
            (Vec3::new(r * cos, r * sin, z), Vec2::new(u, angle))
        }
        QuadricShape::Disk { inner_radius, phi_max } => {
            let r = (inner_radius * inner_radius * (1.0 - v) + v).sqrt();
            let (sin, cos) = azimuth(phi_max);
            (Vec3::new(r * cos, r * sin, 0.0), Vec2::new(u, (1.0 - r) / (1.0 - inner_radius)))
        }
        QuadricShape::Cylinder { z_min, z_max, phi_max } => {
            let (sin, cos) = azimuth(phi_max);
            (Vec3::new(cos, sin, z_min + v * (z_max - z_min)), Vec2::new(u, v))
        }
    };
    quadric.object_point(shape, p, uv)
}

/// Density per world area of [`quadric_point`]: that in object space over the map's stretch of the surface there.
fn quadric_pdf_area(quadric: &QuadricForm, point: &SurfacePoint) -> f32 {
    let object_area = match quadric.shape {
        QuadricShape::Sphere { z_min, z_max, phi_max } => phi_max * (z_max.min(1.0) - z_min.max(-1.0)),
        QuadricShape::Disk { inner_radius, phi_max } => 0.5 * phi_max * (1.0 - inner_radius * inner_radius),
        QuadricShape::Cylinder { z_min, z_max, phi_max } => phi_max * (z_max - z_min),
    };
    let normal = quadric.object_normal(quadric.to_object.point(point.position)).normalized();
    // The cofactor matrix turns object-space area vectors into those of the world.
    let stretch = quadric.normal_to_world.vector(normal).length();
    1.0 / (object_area * stretch)
}

impl AreaLight {
    /// Area of the shape.
    pub fn area(&self, form: &Form) -> f32 {
        match (&self.sampling, form) {
            (EmissionSampling::Triangles { area, .. }, _) => *area,
            (EmissionSampling::Sphere(sphere), _) => sphere_area(sphere),
            (EmissionSampling::Quadric, Form::Quadric(quadric)) => {
                // The mean of 1 / density over the density is the area; exact for disks, cylinders and similarities.
                const GRID: usize = 16;
                let cell = |i: usize| (i as f32 + 0.5) / GRID as f32;
                let inverse_pdf = |i: usize| {
                    let point = quadric_point(quadric, self.shape, [cell(i % GRID), cell(i / GRID)]);
                    1.0 / quadric_pdf_area(quadric, &point)
                };
                (0..GRID * GRID).map(inverse_pdf).sum::<f32>() / (GRID * GRID) as f32
            }
            (EmissionSampling::Quadric, _) => 0.0,
        }
    }
}
