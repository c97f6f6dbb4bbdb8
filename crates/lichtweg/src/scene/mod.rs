//! Scenes: the neutral description, and what it compiles to.

mod candidate;
mod compile;
mod curve;
pub mod description;
mod emitters;
mod instances;
mod material;
pub mod offset;
mod sphere;
mod surface;

use lichtweg_ray::math::{Bounds3, Vec2, Vec3};
use lichtweg_ray::wide::Row;
use lichtweg_ray::{Accel, BuildReport, Hit, Ray};

use crate::color::Spectrum;
use crate::light::{AreaLight, Environment, Light, LightChoice, LightRows, LightSelection, Surroundings};
use crate::texture::TextureArena;

pub use compile::CompileReport;
pub use curve::CurveForm;
pub(crate) use material::{LobeMaterial, LobeModel};
pub use material::{MaterialArena, Scatterer};
pub use sphere::Sphere;
pub(crate) use surface::Facets;
pub use surface::{Form, MeshForm, Place, QuadricForm, SurfacePoint};

use emitters::Emitters;
use instances::Instances;
pub(crate) use instances::on_shutter_clock;

/// A compiled scene: immutable, and shared by all threads.
#[derive(Debug)]
pub struct Scene {
    accel: Accel,
    /// Where rays that matter only if they run into light ask first.
    emitters: Option<Emitters>,
    instances: Instances,
    hierarchies: BuildReport,
    /// Those in the world as the ray engine numbers them, then those of groups.
    shapes: Vec<Shape>,
    textures: TextureArena,
    materials: MaterialArena,
    lights: Vec<Light>,
    selection: LightSelection,
    /// The lights that are around the scene.
    environments: Vec<u32>,
    /// Whether any surface has holes, so that occlusion has to look closer.
    has_holes: bool,
    surroundings: Surroundings,
    report: CompileReport,
}

#[derive(Debug)]
struct Shape {
    form: Form,
    material: u32,
    light: Option<u32>,
    has_holes: bool,
    /// Where sixteen walks at once can deal with it.
    lobe: Option<LobeMaterial>,
}

/// A surface that sixteen walks at once can deal with.
pub(crate) struct SimpleSurface<'a> {
    /// Triangles, or a whole sphere.
    pub form: &'a Form,
    pub material: &'a LobeMaterial,
    /// The light that it is, and its [`AreaLight::emission_row`].
    pub light: Option<(u32, &'a Row)>,
}

/// Exact counts of ray queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Closest-hit queries.
    pub closest: u64,
    /// Occlusion queries.
    pub occlusion: u64,
}

impl RayCounts {
    /// Adds those of another thread.
    pub fn merge(&mut self, other: &Self) {
        self.closest += other.closest;
        self.occlusion += other.occlusion;
    }
}

/// Holes that a ray may pass before it counts as stopped: guards against surfaces that lie in each other.
const MAX_HOLES: u32 = 256;

impl Scene {
    /// Answers ray queries.
    #[inline]
    pub(crate) fn accel(&self) -> &Accel {
        &self.accel
    }

    /// Whether any surface has holes.
    #[inline]
    pub(crate) fn has_holes(&self) -> bool {
        self.has_holes
    }

    /// Whether there are instances: only they move.
    #[inline]
    pub(crate) fn has_instances(&self) -> bool {
        !self.instances.is_empty()
    }

    /// Whether nothing is around the scene that a walk could see.
    #[inline]
    pub(crate) fn is_dark_outside(&self) -> bool {
        self.environments.is_empty()
    }

    /// The surface that was hit, if sixteen walks at once can deal with it.
    #[inline]
    pub(crate) fn simple_surface(&self, hit: &Hit) -> Option<SimpleSurface<'_>> {
        if hit.is_instanced() {
            return None;
        }
        let Shape { form, light, lobe, .. } = &self.shapes[hit.geometry as usize];
        let material = lobe.as_ref()?;
        let light = match *light {
            None => None,
            Some(index) => Some((index, self.lights[index as usize].row()?)),
        };
        Some(SimpleSurface { form, material, light })
    }

    /// What a textured material reflects on one of its sides.
    pub(crate) fn lobe_reflectance(&self, material: &LobeMaterial, hit: &Hit, front: bool) -> Spectrum {
        let uv = match self.form(hit.geometry) {
            Form::Mesh(mesh) => mesh.surface_coordinates(hit.primitive, hit.u, hit.v),
            _ => Vec2::new(hit.u, hit.v),
        };
        self.textures.eval(material.reflectance[usize::from(!front)], uv)
    }

    /// See [`AreaLight::rows`]; `None` for other lights.
    #[inline(always)]
    pub(crate) fn light_rows(&self, choice: &LightChoice, u: f32) -> Option<LightRows<'_>> {
        match &self.lights[choice.light as usize] {
            Light::Area(light) => light.rows(choice.triangle, u, &self.shapes[light.shape as usize].form),
            _ => None,
        }
    }

    /// The form of a shape.
    #[inline]
    pub fn form(&self, shape: u32) -> &Form {
        &self.shapes[shape as usize].form
    }

    /// The textures.
    #[inline]
    pub fn textures(&self) -> &TextureArena {
        &self.textures
    }

    /// The lights.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// Chooses lights.
    #[inline]
    pub fn selection(&self) -> &LightSelection {
        &self.selection
    }

    /// What compiling took and found.
    pub fn report(&self) -> &CompileReport {
        &self.report
    }

    /// What building the ray hierarchies took and found.
    pub fn build_report(&self) -> &BuildReport {
        &self.hierarchies
    }

    /// Bounds of all shapes.
    pub fn bounds(&self) -> Bounds3 {
        self.accel.bounds()
    }

    /// A sphere around all shapes.
    #[inline]
    pub fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// Number of shapes.
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// The first surface point along a ray, passing through holes by chance: `u` yields a uniform number each time one is
    /// asked for.
    #[inline]
    pub fn intersect(
        &self,
        ray: &Ray,
        counts: &mut RayCounts,
        u: impl FnMut() -> f32,
    ) -> Option<SurfacePoint> {
        counts.closest += 1;
        let hit = self.accel.closest(ray)?;
        self.point(ray, &hit, counts, u)
    }

    /// The surface point of the first hit of a ray, or one behind it where it is a hole; see [`Scene::intersect`].
    #[inline]
    pub(crate) fn point(
        &self,
        ray: &Ray,
        hit: &Hit,
        counts: &mut RayCounts,
        u: impl FnMut() -> f32,
    ) -> Option<SurfacePoint> {
        let point = self.hit_point(ray, hit);
        if self.shapes[point.shape as usize].has_holes {
            return self.intersect_behind_holes(ray, point, hit.t, counts, u);
        }
        Some(point)
    }

    /// Goes on from a point on a surface with holes: `point`, at `t` along `ray`.
    #[cold]
    fn intersect_behind_holes(
        &self,
        ray: &Ray,
        mut point: SurfacePoint,
        mut t: f32,
        counts: &mut RayCounts,
        mut u: impl FnMut() -> f32,
    ) -> Option<SurfacePoint> {
        let mut ray = *ray;
        for _ in 0..MAX_HOLES {
            if u() < self.opacity_at(&point, -ray.direction) {
                return Some(point);
            }
            ray = behind(&ray, &point, t);
            counts.closest += 1;
            let hit = self.accel.closest(&ray)?;
            point = self.hit_point(&ray, &hit);
            t = hit.t;
        }
        None
    }

    /// The fraction of light that passes from one end of a ray to the other: 0 or 1 but for surfaces with holes.
    #[inline]
    pub fn transmittance(&self, ray: &Ray, counts: &mut RayCounts) -> f32 {
        if self.has_holes {
            return self.transmittance_with_holes(ray, counts);
        }
        counts.occlusion += 1;
        if self.accel.occluded(ray) { 0.0 } else { 1.0 }
    }

    #[cold]
    fn transmittance_with_holes(&self, ray: &Ray, counts: &mut RayCounts) -> f32 {
        let mut ray = *ray;
        let mut transmittance = 1.0;
        for _ in 0..=MAX_HOLES {
            counts.occlusion += 1;
            let Some(hit) = self.accel.closest(&ray) else { return transmittance };
            let point = self.hit_point(&ray, &hit);
            if !self.shapes[point.shape as usize].has_holes {
                return 0.0;
            }
            transmittance *= 1.0 - self.opacity_at(&point, -ray.direction);
            if transmittance == 0.0 {
                return 0.0;
            }
            ray = behind(&ray, &point, hit.t);
        }
        0.0
    }

    /// The probability that the surface is there at a point that is looked at from the direction `wo`.
    #[inline]
    pub fn opacity_at(&self, point: &SurfacePoint, wo: Vec3) -> f32 {
        let shape = &self.shapes[point.shape as usize];
        if shape.has_holes { self.materials.opacity(shape.material, point, wo, &self.textures) } else { 1.0 }
    }

    /// What scatters at a point that is looked at from the direction `wo`.
    #[inline]
    pub fn scatterer(&self, point: &SurfacePoint, wo: Vec3) -> Scatterer<'_> {
        let shape = &self.shapes[point.shape as usize];
        self.materials.scatterer(shape.material, point, wo, || self.partials(point), &self.textures)
    }

    /// The area light that a point lies on, and its index.
    #[inline]
    pub fn area_light(&self, point: &SurfacePoint) -> Option<(u32, &AreaLight)> {
        let index = self.shapes[point.shape as usize].light?;
        match &self.lights[index as usize] {
            Light::Area(light) => Some((index, light)),
            _ => None,
        }
    }

    /// The lights around the scene, with their indices.
    #[inline]
    pub fn environments(&self) -> impl Iterator<Item = (u32, &Environment)> {
        self.environments.iter().filter_map(|&index| match &self.lights[index as usize] {
            Light::Environment(environment) => Some((index, environment)),
            _ => None,
        })
    }

    /// Radiance from around the scene.
    #[inline]
    pub fn environment_radiance(&self, direction: Vec3) -> Spectrum {
        self.environments().fold(Spectrum::ZERO, |sum, (_, e)| sum + e.seen(direction).radiance)
    }
}

/// The rest of a ray behind the point at `t` along it; its end stays where it is.
fn behind(ray: &Ray, point: &SurfacePoint, t: f32) -> Ray {
    Ray { origin: point.leave(ray.direction), tnear: 0.0, tfar: ray.tfar - t, ..*ray }
}
