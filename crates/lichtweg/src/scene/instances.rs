//! Groups of shapes that instances place in the world.
//!
//! A group is a structure of its own for the ray engine, in the space of the group; instances refer to it, so that memory
//! grows with groups and instances, not with their product. A hit on an instance becomes a surface point in the space of
//! the group first, and is mapped to the world then.

use std::ops::Range;
use std::sync::Arc;

use lichtweg_ray::math::{Affine, Motion, Vec2, Vec3};
use lichtweg_ray::{Accel, BuildError, BuildOptions, BuildReport, Geometry, Hit, Instance, Placement, Ray};

use super::description::{Description, Diagnostic, InstanceDescription};
use super::emitters::Emitters;
use super::offset::position_error;
use super::surface::{Form, Place, SurfacePoint};
use super::{Scene, Shape};

/// Which shapes instances consist of.
#[derive(Debug, Default)]
pub(super) struct Instances {
    /// Index of the first instance among the ray engine's geometries: those before are the shapes in the world.
    first: u32,
    /// Of each instance, the first shape of its group.
    shapes: Vec<u32>,
}

impl Instances {
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }
}

/// The ray engine's structures over a scene.
pub(super) struct Structures {
    pub accel: Accel,
    pub emitters: Option<Emitters>,
    pub instances: Instances,
    /// Counts of all structures together.
    pub report: BuildReport,
}

impl Structures {
    /// Builds all structures. `groups` are ranges of `shapes`; the shapes before the first are in the world.
    pub fn build(
        description: &Description,
        shapes: &[Shape],
        groups: &[Range<usize>],
    ) -> Result<Self, Diagnostic> {
        let in_world = groups.first().map_or(shapes.len(), |g| g.start);
        let mut geometries: Vec<Geometry> = shapes[..in_world].iter().map(|s| s.form.geometry()).collect();
        let mut instances = Instances { first: in_world as u32, shapes: Vec::new() };
        let mut built: Vec<Option<Arc<Accel>>> = vec![None; groups.len()];
        let bad = |error: &BuildError| Diagnostic::error("bad-geometry", error.to_string());
        for instance in &description.instances {
            let group = instance.group.0 as usize;
            let Some(range) = groups.get(group) else {
                let text = "an instance refers to a group of shapes that does not exist";
                return Err(Diagnostic::error("unknown-group", text).at(instance.span, "this instance"));
            };
            if built[group].is_none() {
                let members = shapes[range.clone()].iter().map(|s| s.form.geometry()).collect();
                let accel = Accel::build(members, BuildOptions::default());
                built[group] = Some(Arc::new(accel.map_err(|error| bad(&error))?));
            }
            let Some(accel) = &built[group] else { continue };
            let to_world = on_shutter_clock(&instance.to_world, description.camera.shutter);
            geometries.push(Instance { accel: accel.clone(), to_world }.into());
            instances.shapes.push(range.start as u32);
        }
        let accel = Accel::build(geometries, BuildOptions::default()).map_err(|error| match error {
            BuildError::SingularTransform { geometry } if geometry as usize >= in_world => {
                singular(&description.instances[geometry as usize - in_world])
            }
            error => bad(&error),
        })?;
        let inner = built.iter().flatten().map(|accel| *accel.report());
        let mut report = inner.fold(*accel.report(), |mut all, r| {
            all.triangles += r.triangles;
            all.quadrics += r.quadrics;
            all.curve_segments += r.curve_segments;
            all.dropped_degenerate += r.dropped_degenerate;
            all.dropped_non_finite += r.dropped_non_finite;
            all.nodes += r.nodes;
            all.bytes += r.bytes;
            all.seconds += r.seconds;
            all
        });
        let emitters = Emitters::new(&shapes[..in_world], &report).map_err(|error| bad(&error))?;
        if let Some(again) = emitters.as_ref().map(Emitters::report) {
            report.nodes += again.nodes;
            report.bytes += again.bytes;
            report.seconds += again.seconds;
        }
        Ok(Self { accel, emitters, instances, report })
    }
}

fn singular(instance: &InstanceDescription) -> Diagnostic {
    Diagnostic::error("singular-transform", "an instance's transform is singular or not finite")
        .at(instance.span, "this instance")
        .help("no scale factor may be zero, and no entry NaN or infinite")
}

/// A placement with the times counted from the opening of the shutter, 0, to its closing, 1.
pub(crate) fn on_shutter_clock(placement: &Placement, [open, close]: [f32; 2]) -> Placement {
    let Placement::Moving(motion) = placement else { return placement.clone() };
    let retimed = motion.keys().map(|(time, map)| ((time - open) / (close - open), *map));
    match Motion::new(retimed) {
        Some(motion) if motion.keys().len() > 1 => Placement::Moving(Arc::new(motion)),
        // One key, or no time in which to move.
        _ => Placement::Fixed(motion.at(open)),
    }
}

impl Scene {
    /// The point that a ray hit, be it a hole or not.
    #[inline]
    pub(super) fn hit_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        if hit.is_instanced() {
            return self.instanced_point(ray, hit);
        }
        self.form(hit.geometry).hit_point(ray, hit)
    }

    /// A point on an instance.
    ///
    /// Its distance to the surface, along the normal, is bounded in the space of the group by e. A linear map M takes planes
    /// of unit normal n to planes that are 1 / |M^-T n| times as far apart, and cof M = det M M^-T. In the world the rounding
    /// of the position itself is added. Both may be off by sqrt 3, from coordinates to lengths.
    #[inline(never)]
    fn instanced_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let shape = self.instances.shapes[(hit.instances[0] - self.instances.first) as usize] + hit.geometry;
        let place = Place { instance: hit.instances[0], time: ray.time };
        let to_world = self.to_world(place);
        let local = match self.form(shape) {
            Form::Mesh(mesh) => mesh.point(shape, hit.primitive, hit.u, hit.v),
            Form::Quadric(quadric) => {
                let near = to_world.inverse().unwrap_or_default().point(ray.at(hit.t));
                quadric.point(shape, near, Vec2::new(hit.u, hit.v))
            }
            Form::Curves(form) => {
                let to_group = to_world.inverse().unwrap_or_default();
                let (origin, direction) = (to_group.point(ray.origin), to_group.vector(ray.direction));
                form.point(shape, &Ray { origin, direction, ..*ray }, hit)
            }
        };
        let position = to_world.point(local.position);
        let normal = to_world.normal(local.geometric_normal);
        let spread = to_world.determinant().abs() as f32 / normal.length();
        let error = local.error * spread + position_error(position.abs().max_element());
        let geometric_normal = normal.normalized();
        SurfacePoint {
            position,
            error: 3.0_f32.sqrt() * error,
            geometric_normal,
            shading_normal: to_world
                .normal(local.shading_normal)
                .try_normalized()
                .unwrap_or(geometric_normal),
            place,
            ..local
        }
    }

    /// Derivatives of the position with respect to the surface coordinates, where they exist.
    pub(super) fn partials(&self, point: &SurfacePoint) -> Option<[Vec3; 2]> {
        let form = self.form(point.shape);
        if point.place == Place::WORLD {
            return form.partials(point);
        }
        let to_world = self.to_world(point.place);
        let local = SurfacePoint { position: to_world.inverse()?.point(point.position), ..*point };
        Some(form.partials(&local)?.map(|p| to_world.vector(p)))
    }

    fn to_world(&self, place: Place) -> Affine {
        self.accel.instance_to_world(&[place.instance, Hit::NO_INSTANCE], place.time)
    }
}
