//! Structures inside structures.
//!
//! A ray is mapped into the instance by the inverse map, in `f64` and then rounded; its direction is not normalised,
//! so that t means the same on both sides. The rounding displaces the ray as seen from the world, by about 2^-24 of
//! the coordinates times the condition of the map. Boxes of instances are wider by this, for rays that start within
//! about twice the extent of the scene. Rays whose mapped origin is beyond 2^40 miss the instance.

use std::sync::Arc;

use crate::accel::{Accel, BuildError};
use crate::build::MAX_COORDINATE;
use crate::math::{Affine, Bounds3, Motion, Vec3};
use crate::ray::{Accept, Hit, Ray};
use crate::simd::Isa;

/// A structure, placed in another one. Clones share it.
#[derive(Clone, Debug)]
pub struct Instance {
    /// What is placed; itself with at most [`Hit::MAX_INSTANCES`] - 1 levels of instances.
    pub accel: Arc<Accel>,
    /// From its space to that of the structure it is placed in.
    pub to_world: Placement,
}

/// Where an instance is.
#[derive(Clone, Debug, PartialEq)]
pub enum Placement {
    /// Always there; must be invertible.
    Fixed(Affine),
    /// Moving, over times in [0, 1].
    Moving(Arc<Motion>),
}

impl Placement {
    /// The map at a time.
    pub fn at(&self, time: f32) -> Affine {
        match self {
            Self::Fixed(map) => *map,
            Self::Moving(motion) => motion.at(time),
        }
    }
}

impl Instance {
    /// A structure that does not move.
    pub fn new(accel: Arc<Accel>, to_world: Affine) -> Self {
        Self { accel, to_world: Placement::Fixed(to_world) }
    }

    /// A structure that moves.
    pub fn moving(accel: Arc<Accel>, to_world: Motion) -> Self {
        Self { accel, to_world: Placement::Moving(Arc::new(to_world)) }
    }
}

/// An instance made ready for queries.
#[derive(Debug)]
pub(crate) struct PlacedInstance {
    accel: Arc<Accel>,
    place: Place,
    /// A box around the image, but for [`PlacedInstance::margin`].
    pub bounds: Bounds3,
    /// Product of the norms of the map and its inverse.
    condition: f64,
}

#[derive(Debug)]
enum Place {
    Fixed { to_local: Affine, to_world: Affine },
    Moving(Arc<Motion>),
}

impl Place {
    fn bounds(&self, accel: &Accel) -> Bounds3 {
        match self {
            // The images of several small boxes fill less than that of one large box, where they are turned.
            Self::Fixed { to_world, .. } => {
                let parts = accel.outline().map(|part| to_world.bounds(&part));
                parts.into_iter().fold(Bounds3::EMPTY, Bounds3::union)
            }
            Self::Moving(motion) => motion.bounds(&accel.bounds()),
        }
    }
}

impl PlacedInstance {
    /// Checks an instance and makes it ready.
    pub(crate) fn new(geometry: u32, instance: &Instance) -> Result<Self, BuildError> {
        let accel = instance.accel.clone();
        if accel.levels() >= Hit::MAX_INSTANCES {
            return Err(BuildError::TooDeep { geometry });
        }
        let singular = BuildError::SingularTransform { geometry };
        let (place, condition) = match &instance.to_world {
            Placement::Fixed(to_world) => {
                let to_local = to_world.inverse().ok_or(singular.clone())?;
                (Place::Fixed { to_local, to_world: *to_world }, to_world.norm() * to_local.norm())
            }
            Placement::Moving(motion) => {
                // Rotations do not change norms, and those of the stretch lie between those of the keys.
                let (mut norm, mut inverse) = (0.0_f64, 0.0_f64);
                for (_, map) in motion.keys() {
                    norm = norm.max(map.norm());
                    inverse = inverse.max(map.inverse().ok_or(singular.clone())?.norm());
                }
                (Place::Moving(motion.clone()), norm * inverse)
            }
        };
        let bounds = place.bounds(&accel);
        let sound = bounds == Bounds3::EMPTY || super::in_range(&bounds);
        if sound && condition.is_finite() {
            Ok(Self { accel, place, bounds, condition })
        } else {
            Err(singular)
        }
    }

    /// Levels of instances below and including this.
    pub(crate) fn levels(&self) -> usize {
        1 + self.accel.levels()
    }

    /// How much wider the box must be, in a scene whose coordinates are within `reach`.
    pub(crate) fn margin(&self, reach: f32) -> f32 {
        let origin = self.to_world(0.0).point(Vec3::ZERO).abs().max_element();
        let size = f64::from(reach) + f64::from(origin) + f64::from(self.bounds.reach());
        ((2.0_f64.powi(-20) * self.condition * size) as f32).min(MAX_COORDINATE)
    }

    /// The map at a time in [0, 1].
    pub(crate) fn to_world(&self, time: f32) -> Affine {
        match &self.place {
            Place::Fixed { to_world, .. } => *to_world,
            Place::Moving(motion) => motion.at(time),
        }
    }

    /// A ray as the instance sees it; `None` where the map is singular just then.
    fn local(&self, ray: &Ray) -> Option<Ray> {
        let map = match &self.place {
            Place::Fixed { to_local, .. } => *to_local,
            Place::Moving(motion) => motion.at(ray.time).inverse()?,
        };
        Some(Ray { origin: map.point(ray.origin), direction: map.vector(ray.direction), ..*ray })
    }

    /// The nearest hit with `ray.tnear < t <= tfar`, or with `ANY` whether there is one. `geometry` is the instance's
    /// index.
    #[inline(never)]
    pub(crate) fn nearest<const ANY: bool>(
        &self,
        isa: Isa,
        geometry: u32,
        ray: &Ray,
        tfar: f32,
        accept: Option<Accept>,
    ) -> Option<Hit> {
        let ray = Ray { tfar, ..self.local(ray)? };
        let outer = accept.map(|accept| move |hit: &Hit| accept(&hit.inside(geometry)));
        let accept = outer.as_ref().map(|f| f as Accept);
        if ANY {
            return self.accel.occluded_as(isa, &ray, accept).then_some(Hit::NONE);
        }
        Some(self.accel.closest_as(isa, &ray, accept)?.inside(geometry))
    }

    /// The normal at a hit of the instance; `hit` is as the outer structure gave it.
    pub(crate) fn normal(&self, ray: &Ray, hit: &Hit) -> Vec3 {
        let Some(local) = self.local(ray) else { return Vec3::ZERO };
        self.to_world(ray.time).normal(self.accel.normal(&local, &hit.outside()))
    }

    /// The map from the innermost of some instances, of which this is the first, to the outer structure.
    pub(crate) fn path_to_world(&self, instances: &[u32; Hit::MAX_INSTANCES], time: f32) -> Affine {
        let rest = [instances[1], Hit::NO_INSTANCE];
        self.to_world(time).after(&self.accel.instance_to_world(&rest, time))
    }
}
