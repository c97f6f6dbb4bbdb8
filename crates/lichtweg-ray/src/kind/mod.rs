//! Primitives other than static triangles: what leaves hold beside blocks of triangles.
//!
//! A geometry of another kind is prepared into a [`Kind`], which lists boxes: the items of the tree's leaves. An
//! item is mostly a primitive, but a kind may cut a primitive into several items for tighter boxes, or put several
//! into one. The traversal meets items one by one and asks the kind for the nearest hit in a range.
//!
//! To add a kind:
//! 1. a variant of [`Geometry`] with its arm in [`Geometry::primitives`];
//! 2. a file with the prepared form, and a variant of [`Kind`] that holds it;
//! 3. an arm in each function of [`Kind`]: `prepare` (checks), `boxes`, `intersect`, `completed`, `normal`, `count`;
//! 4. cases in `tests/differential.rs` and `agreement.rs`.
//!
//! A kind must find the same hit whatever the range's end is, as long as it includes the hit: ties and equality of
//! all orders of traversal rest on this. Boxes must contain the hits that `intersect` reports with the margin that
//! `bvh::slab` asks for. A kind that uses lanes dispatches on [`Probe::isa`] itself, as `bvh::query` does.

mod curve;
mod instance;
mod moving;
mod quadric;
mod user;

use std::sync::Arc;

pub use instance::{Instance, Placement};
pub use moving::MovingMesh;
pub use quadric::{Quadric, QuadricShape};
pub use user::{UserHit, UserPrimitives};

use crate::accel::{Accel, BuildError, BuildReport};
use crate::build::MAX_COORDINATE;
use crate::bvh::ChildRef;
use crate::curve::CurveRay;
use crate::geometry::Geometry;
use crate::math::{Bounds3, Vec3};
use crate::ray::{Accept, Hit, Ray, unit_time};
use crate::simd::Isa;
use crate::triangle::Shear;
use curve::PreparedCurves;
use instance::PlacedInstance;
use quadric::PlacedQuadric;

/// A geometry made ready for queries.
#[derive(Debug)]
pub(crate) enum Kind {
    /// Static triangles: they live in blocks and are not asked here.
    Triangles,
    Quadric(PlacedQuadric),
    Curves(PreparedCurves),
    MovingTriangles(MovingMesh),
    Instance(PlacedInstance),
    User(Arc<dyn UserPrimitives>),
}

/// What a leaf of other primitives holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Item {
    pub geometry: u32,
    /// Number of the item within its geometry, as its kind counts.
    pub index: u32,
}

/// A ray as kinds see it.
pub(crate) struct Probe<'a> {
    /// The ray; kinds find its time in [0, 1] and its `tnear` not negative.
    pub ray: &'a Ray,
    /// The instruction set of the query.
    pub isa: Isa,
    /// The ray made ready for triangles.
    pub shear: Shear,
}

/// A hit of a kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub t: f32,
    pub u: f32,
    pub v: f32,
    pub primitive: u32,
}

impl Item {
    /// What fills gaps between leaves.
    pub(crate) const NONE: Self = Self { geometry: u32::MAX, index: u32::MAX };
}

impl Kind {
    /// Checks a geometry and makes it ready.
    pub(crate) fn prepare(geometry: u32, source: &Geometry) -> Result<Self, BuildError> {
        Ok(match source {
            Geometry::Triangles(_) => Self::Triangles,
            Geometry::Quadric(quadric) => Self::Quadric(PlacedQuadric::new(geometry, quadric)?),
            Geometry::Curves(curves) => Self::Curves(PreparedCurves::new(curves)),
            Geometry::MovingTriangles(mesh) => {
                mesh.check(geometry)?;
                Self::MovingTriangles(mesh.clone())
            }
            Geometry::Instance(instance) => Self::Instance(PlacedInstance::new(geometry, instance)?),
            Geometry::User(user) => Self::User(user.clone()),
        })
    }

    /// The boxes of all items, in the order of their numbers; what cannot be hit has an empty box.
    pub(crate) fn boxes(&self) -> Vec<Bounds3> {
        match self {
            Self::Triangles => Vec::new(),
            Self::Quadric(quadric) => vec![quadric.bounds()],
            Self::Curves(curves) => curves.boxes(),
            Self::MovingTriangles(mesh) => mesh.boxes(),
            Self::Instance(instance) => vec![instance.bounds],
            Self::User(user) => (0..user.count() as u32).map(|primitive| user.bounds(primitive)).collect(),
        }
    }

    /// Levels of instances.
    pub(crate) fn levels(&self) -> usize {
        match self {
            Self::Instance(instance) => instance.levels(),
            _ => 0,
        }
    }

    /// Adds `items` of this kind to a report.
    pub(crate) fn count(&self, items: usize, report: &mut BuildReport) {
        match self {
            Self::Triangles | Self::MovingTriangles(_) => report.triangles += items,
            Self::Quadric(_) => report.quadrics += items,
            Self::Curves(curves) => curves.count(report),
            Self::Instance(_) => report.instances += items,
            Self::User(_) => report.user_primitives += items,
        }
    }

    /// The nearest hit of an item with `tnear < t <= tfar`.
    #[inline]
    fn intersect(
        &self,
        item: u32,
        probe: &Probe,
        curve_ray: Option<&CurveRay>,
        tnear: f32,
        tfar: f32,
    ) -> Option<Candidate> {
        match self {
            Self::Triangles | Self::Instance(_) => None,
            Self::MovingTriangles(mesh) => mesh.intersect(item, &probe.shear, probe.ray.time, tnear, tfar),
            Self::User(user) => user::intersect(&**user, item, probe.ray, tnear, tfar),
            // The surface parameters wait until the nearest hit is known: see `completed`.
            Self::Quadric(quadric) => {
                let t = quadric.intersect(probe.ray, tnear, tfar)?;
                Some(Candidate { t, u: 0.0, v: 0.0, primitive: 0 })
            }
            Self::Curves(curves) => curves.intersect(item, probe.isa, &curve_ray?.space, tnear, tfar),
        }
    }

    /// A hit with the parts that [`Kind::intersect`] puts off. `ray` is that of the query, in the space of the hit.
    #[inline]
    pub(crate) fn completed(&self, ray: &Ray, hit: Hit) -> Hit {
        match self {
            Self::Quadric(quadric) => {
                let (u, v) = quadric.parameters(ray, hit.t);
                Hit { u, v, ..hit }
            }
            Self::Curves(curves) => curves.completed(ray, hit),
            _ => hit,
        }
    }

    /// The outward normal at a hit, of any length. `ray` is that of the query, in the space of the geometry.
    pub(crate) fn normal(&self, ray: &Ray, hit: &Hit) -> Vec3 {
        match self {
            Self::Triangles => Vec3::ZERO,
            Self::Quadric(quadric) => quadric.normal(ray, hit.t),
            Self::Curves(curves) => curves.normal(ray, hit),
            Self::MovingTriangles(mesh) => mesh.normal(hit.primitive, ray.time),
            Self::Instance(instance) => instance.normal(ray, hit),
            Self::User(user) => user.normal(hit.primitive, ray, &UserHit { t: hit.t, u: hit.u, v: hit.v }),
        }
    }
}

/// The nearest hit among the items of a leaf with `t <= tfar` that is let count, and its running number; of equally
/// near ones that of the lowest number. With `ANY` an arbitrary one. Not yet [`Kind::completed`].
#[inline(never)]
pub(crate) fn nearest<const ANY: bool, const FILTERED: bool>(
    accel: &Accel,
    leaf: ChildRef,
    probe: &Probe,
    mut tfar: f32,
    accept: Option<Accept>,
) -> Option<(Hit, u32)> {
    let time = unit_time(probe.ray.time);
    let ray = Ray { tnear: probe.shear.tnear, time, ..*probe.ray };
    let probe = Probe { ray: &ray, ..*probe };
    let mut best: Option<(Hit, u32)> = None;
    let (begin, count) = leaf.leaf();
    let curve_ray = (!accel.capsules.is_empty()).then(|| CurveRay::new(&ray));
    let mut near = match &curve_ray {
        Some(curve_ray) => accel.capsules.near(probe.isa, begin, count, curve_ray, tfar),
        None => (1_u32 << count) - 1,
    };
    while near != 0 {
        let item = accel.items[begin + near.trailing_zeros() as usize];
        near &= near - 1;
        if FILTERED && !accel.is_seen(ray.mask, item.geometry) {
            continue;
        }
        let kind = &accel.kinds[item.geometry as usize];
        let nearest = match kind {
            // A single primitive of this structure, whatever its own hits name.
            Kind::Instance(instance) => {
                instance.nearest::<ANY>(probe.isa, item.geometry, &ray, tfar, accept).map(|hit| (hit, 0))
            }
            _ => nearest_of::<FILTERED>(kind, item, &probe, curve_ray.as_ref(), tfar, accept)
                .map(|hit| (hit, hit.primitive)),
        };
        let Some((hit, primitive)) = nearest else { continue };
        let id = accel.bvh.numbering.number(item.geometry, primitive);
        if best.is_none_or(|(b, best_id)| hit.t < b.t || (id, hit.u) < (best_id, b.u)) {
            tfar = hit.t;
            best = Some((hit, id));
        }
        if ANY {
            break;
        }
    }
    best
}

/// The nearest hit of an item that is let count.
#[inline]
fn nearest_of<const FILTERED: bool>(
    kind: &Kind,
    item: Item,
    probe: &Probe,
    curve_ray: Option<&CurveRay>,
    tfar: f32,
    accept: Option<Accept>,
) -> Option<Hit> {
    let mut tnear = probe.ray.tnear;
    loop {
        let Candidate { t, u, v, primitive } = kind.intersect(item.index, probe, curve_ray, tnear, tfar)?;
        let hit = Hit::plain(t, u, v, item.geometry, primitive);
        match accept {
            Some(accept) if FILTERED && !accept(&kind.completed(probe.ray, hit)) => tnear = t,
            _ => return Some(hit),
        }
    }
}

/// Whether a box is finite and in the range of coordinates.
pub(crate) fn in_range(b: &Bounds3) -> bool {
    let fits = |p: Vec3| p.is_finite() && p.abs().max_element() <= MAX_COORDINATE;
    fits(b.min) && fits(b.max)
}
