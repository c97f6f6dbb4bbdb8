//! The structure that answers queries.

use std::time::Instant;

use crate::build;
use crate::bvh::{self, Bvh};
use crate::curve::Capsules;
use crate::geometry::Geometry;
use crate::kind::{Item, Kind};
use crate::math::{Affine, Bounds3, Vec3};
use crate::packet::{self, HitPacket, RayPacket};
use crate::ray::{Accept, Hit, Ray, unit_time};
use crate::simd::{Isa, WIDTH};
use crate::triangle::TriangleHit;

/// How much work to put into a structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// Few bins, no splits through triangles: for what changes often.
    Fast,
    /// The surface area heuristic with splits through triangles, which add at most a fifth to the number
    /// of references.
    #[default]
    High,
}

/// How to build.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BuildOptions {
    /// How much work to put into the structure.
    pub quality: BuildQuality,
}

impl From<BuildQuality> for BuildOptions {
    fn from(quality: BuildQuality) -> Self {
        Self { quality }
    }
}

/// What a build did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BuildReport {
    /// Triangles in the structure, moving ones included; not those of instances.
    pub triangles: usize,
    /// Quadrics in the structure.
    pub quadrics: usize,
    /// Segments of curves in the structure.
    pub curve_segments: usize,
    /// Instances in the structure.
    pub instances: usize,
    /// Primitives of the caller's own in the structure.
    pub user_primitives: usize,
    /// Triangles and curve segments left out because they have no area.
    pub dropped_degenerate: usize,
    /// Primitives left out because a coordinate is NaN, infinite or beyond 2^40, or a radius negative.
    pub dropped_non_finite: usize,
    /// Inner nodes.
    pub nodes: usize,
    /// Memory of the structure, without the caller's meshes and without that of instanced structures.
    pub bytes: usize,
    /// Wall-clock time of the build.
    pub seconds: f64,
}

/// Why a structure could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A triangle names a vertex that does not exist.
    #[error("geometry {geometry}, triangle {primitive}: vertex {index} of {vertices} does not exist")]
    IndexOutOfRange {
        /// Index of the geometry.
        geometry: u32,
        /// Index of the triangle.
        primitive: u32,
        /// The vertex it names.
        index: u32,
        /// The number of vertices there are.
        vertices: usize,
    },
    /// The map of a quadric or an instance has no inverse or is not finite, or leads beyond 2^40.
    #[error("geometry {geometry}: the map to the world is singular or not finite")]
    SingularTransform {
        /// Index of the geometry.
        geometry: u32,
    },
    /// A quadric's parameters make no sense.
    #[error("geometry {geometry}: {reason}")]
    InvalidQuadric {
        /// Index of the geometry.
        geometry: u32,
        /// What is wrong.
        reason: &'static str,
    },
    /// Keys of a motion do not go together.
    #[error("geometry {geometry}: {reason}")]
    InvalidMotion {
        /// Index of the geometry.
        geometry: u32,
        /// What is wrong.
        reason: &'static str,
    },
    /// Instances of instances go deeper than [`Hit::MAX_INSTANCES`].
    #[error("geometry {geometry}: instances of instances go too deep")]
    TooDeep {
        /// Index of the geometry.
        geometry: u32,
    },
    /// More primitives than 32-bit references can name.
    #[error("{primitives} primitives are more than a structure can hold")]
    TooLarge {
        /// The number asked for.
        primitives: usize,
    },
}

/// An immutable structure over a list of geometries; queries may run from any number of threads.
#[derive(Debug)]
pub struct Accel {
    pub(crate) geometries: Vec<Geometry>,
    /// One a geometry.
    pub(crate) kinds: Vec<Kind>,
    /// What leaves of other primitives refer to.
    pub(crate) items: Vec<Item>,
    /// One an item, where there are curves.
    pub(crate) capsules: Capsules,
    pub(crate) bvh: Bvh,
    pub(crate) isa: Isa,
    /// One a geometry, or none where no mask was set.
    masks: Vec<u32>,
    /// The bits that all masks have.
    common_mask: u32,
    pub(crate) bounds: Bounds3,
    levels: usize,
    report: BuildReport,
}

impl Accel {
    /// Builds the structure on rayon's current thread pool; the result does not depend on its size.
    /// Primitives that are not finite, beyond 2^40 or without area are dropped and counted.
    pub fn build(geometries: Vec<Geometry>, options: BuildOptions) -> Result<Self, BuildError> {
        let start = Instant::now();
        let mut census = build::census(&geometries)?;
        let bvh = build::build(&geometries, &mut census, options.quality)?;
        let item = |&i: &u32| census.items.get(i as usize).copied().unwrap_or(Item::NONE);
        let items: Vec<Item> = bvh.others.iter().map(item).collect();
        let kinds = census.kinds;
        let capsules = Capsules::new(&items, &kinds);
        let report = BuildReport {
            nodes: bvh.nodes.len(),
            bytes: bvh.bytes() + size_of_val(&*items) + capsules.bytes() + size_of_val(&*kinds),
            seconds: start.elapsed().as_secs_f64(),
            ..census.report
        };
        let levels = kinds.iter().map(Kind::levels).max().unwrap_or(0);
        Ok(Self {
            levels,
            geometries,
            kinds,
            items,
            capsules,
            bvh,
            isa: Isa::best(),
            masks: Vec::new(),
            common_mask: u32::MAX,
            bounds: census.bounds,
            report,
        })
    }

    /// The nearest hit with `tnear < t <= tfar`; of equally near ones that of the lowest geometry and
    /// primitive. Rays that are not finite (but for `tfar`) or have no direction hit nothing.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.closest_as(self.isa, ray, None)
    }

    /// Whether anything lies at `tnear < t <= tfar`.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_as(self.isa, ray, None)
    }

    /// As [`Accel::closest`], among the hits that `accept` lets count: for textures with holes. It may be asked
    /// about hits in any order, also about some that are not the nearest, and must always answer alike.
    #[inline]
    pub fn closest_filtered(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Hit> {
        self.closest_as(self.isa, ray, Some(&accept))
    }

    /// As [`Accel::occluded`], among the hits that `accept` lets count.
    #[inline]
    pub fn occluded_filtered(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> bool {
        self.occluded_as(self.isa, ray, Some(&accept))
    }

    /// Gives a geometry a mask: only rays with a common bit in theirs meet it. All bits are set before.
    ///
    /// # Panics
    /// Where there is no such geometry.
    pub fn set_mask(&mut self, geometry: u32, mask: u32) {
        self.masks.resize(self.geometries.len(), u32::MAX);
        self.masks[geometry as usize] = mask;
        self.common_mask = self.masks.iter().fold(u32::MAX, |all, m| all & m);
    }

    /// The outward normal at a hit that a query of `ray` has given, in the space of this structure, of any length.
    /// Outward is the front of a triangle, and where the surface's own normal points else; mirroring maps keep it so.
    ///
    /// # Panics
    /// May do so where the hit is from elsewhere.
    pub fn normal(&self, ray: &Ray, hit: &Hit) -> Vec3 {
        let ray = Ray { time: unit_time(ray.time), ..*ray };
        let outer = if hit.is_instanced() { hit.instances[0] } else { hit.geometry };
        match &self.geometries[outer as usize] {
            Geometry::Triangles(mesh) => {
                let [a, b, c] = mesh.corners(hit.primitive);
                (b - a).cross(c - a)
            }
            _ => self.kinds[outer as usize].normal(&ray, hit),
        }
    }

    /// The map to the space of this structure from that of the innermost of some instances, as a [`Hit`] names them, at a
    /// time in [0, 1]. The identity for none.
    pub fn instance_to_world(&self, instances: &[u32; Hit::MAX_INSTANCES], time: f32) -> Affine {
        match self.kinds.get(instances[0] as usize) {
            Some(Kind::Instance(instance)) => instance.path_to_world(instances, unit_time(time)),
            _ => Affine::IDENTITY,
        }
    }

    /// [`Accel::closest`] of the rays of a packet whose bit in `active` is set; the other lanes hit nothing.
    #[inline]
    pub fn closest_packet(&self, rays: &RayPacket, active: u32) -> HitPacket {
        match self.common_mask {
            u32::MAX => packet::closest(self.isa, self, rays, active),
            _ => packet::closest_one_by_one(self, rays, active),
        }
    }

    /// [`Accel::occluded`] of the rays of a packet whose bit in `active` is set: a bit a ray.
    #[inline]
    pub fn occluded_packet(&self, rays: &RayPacket, active: u32) -> u32 {
        match self.common_mask {
            u32::MAX => packet::occluded(self.isa, self, rays, active),
            _ => packet::occluded_one_by_one(self, rays, active),
        }
    }

    /// The box around everything that can be hit; empty for an empty scene.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// The geometries the structure was built from.
    pub fn geometries(&self) -> &[Geometry] {
        &self.geometries
    }

    /// What the build did.
    pub fn report(&self) -> &BuildReport {
        &self.report
    }

    /// The nearest hit, found with an instruction set; the plain query where nothing is to be filtered.
    #[inline(always)]
    pub(crate) fn closest_as(&self, isa: Isa, ray: &Ray, accept: Option<Accept>) -> Option<Hit> {
        if accept.is_none() && ray.mask & self.common_mask != 0 {
            bvh::closest(isa, self, ray)
        } else {
            bvh::closest_filtered(isa, self, ray, accept)
        }
    }

    /// Whether there is a hit, as [`Accel::closest_as`].
    #[inline(always)]
    pub(crate) fn occluded_as(&self, isa: Isa, ray: &Ray, accept: Option<Accept>) -> bool {
        if accept.is_none() && ray.mask & self.common_mask != 0 {
            bvh::occluded(isa, self, ray)
        } else {
            bvh::occluded_filtered(isa, self, ray, accept)
        }
    }

    /// A few boxes around everything, some of them empty.
    pub(crate) fn outline(&self) -> [Bounds3; WIDTH] {
        let root = self.bvh.root;
        if !root.is_leaf() {
            return std::array::from_fn(|slot| self.bvh.nodes[root.node()].bounds(slot));
        }
        let mut one = [Bounds3::EMPTY; WIDTH];
        one[0] = self.bounds;
        one
    }

    /// How deep instances of instances go: 0 where there is none.
    pub(crate) fn levels(&self) -> usize {
        self.levels
    }

    /// Whether a ray with a mask meets a geometry.
    #[inline]
    pub(crate) fn is_seen(&self, mask: u32, geometry: u32) -> bool {
        mask & self.masks.get(geometry as usize).copied().unwrap_or(u32::MAX) != 0
    }

    /// Whether a triangle's hit counts.
    pub(crate) fn accepts(&self, ray: &Ray, h: TriangleHit, id: u32, accept: Option<Accept>) -> bool {
        let (geometry, primitive) = self.bvh.numbering.locate(id);
        self.is_seen(ray.mask, geometry)
            && accept.is_none_or(|accept| accept(&Hit::plain(h.t, h.u, h.v, geometry, primitive)))
    }
}
