//! Checks the geometries and lists their primitives' boxes.
//!
//! A triangle's box is 3 * 2^-23 of its largest extent wider than exact, and one step of rounding: see
//! `bvh::slab` for what this is needed for.

use std::mem::MaybeUninit;

use rayon::prelude::*;

use crate::accel::{BuildError, BuildReport};
use crate::bvh::Numbering;
use crate::geometry::{Geometry, TriangleMesh};
use crate::kind::{Item, Kind, in_range};
use crate::math::{Bounds3, Vec3};
use crate::memory;
use crate::simd::{Quad, QuadBox};

/// Largest absolute coordinate that cannot overflow in a query: 2^40.
pub(crate) const MAX_COORDINATE: f32 = 1.099_511_6e12;
/// Triangles handled by one task; fixed, so that the order of primitives is.
const CHUNK: usize = 1 << 14;

/// A primitive's name and box. The integers are never touched by `f32` operations, which would flush
/// small ones to zero on threads that do so with denormal numbers.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(crate) struct Primitive {
    lo: [f32; 3],
    geometry: u32,
    hi: [f32; 3],
    primitive: u32,
}

impl Primitive {
    #[inline(always)]
    fn new(Bounds3 { min, max }: Bounds3, geometry: u32, primitive: u32) -> Self {
        Self { lo: min.to_array(), geometry, hi: max.to_array(), primitive }
    }

    /// The same primitive with another box.
    pub(crate) fn within(&self, bounds: QuadBox) -> Self {
        Self::new(bounds.to_bounds(), self.geometry, self.primitive)
    }

    /// The box (the fourth lanes are meaningless).
    #[inline(always)]
    pub(crate) fn bounds(&self) -> QuadBox {
        // SAFETY: both are 32 plain bytes, of which the first three lanes of each half are the corners.
        unsafe { std::mem::transmute(*self) }
    }

    /// Twice the centre of the box (the fourth lane is meaningless).
    #[inline(always)]
    pub(crate) fn center2(&self) -> Quad {
        let QuadBox { lo, hi } = self.bounds();
        lo.add(hi)
    }

    pub(crate) fn geometry(&self) -> u32 {
        self.geometry
    }

    pub(crate) fn primitive(&self) -> u32 {
        self.primitive
    }
}

/// All primitives of a scene, and what was left out.
pub(crate) struct Census {
    pub primitives: Vec<Primitive>,
    /// One a geometry.
    pub kinds: Vec<Kind>,
    /// What is no static triangle; such a primitive's index is its place here.
    pub items: Vec<Item>,
    pub numbering: Numbering,
    /// Exact bounds of what can be hit.
    pub bounds: Bounds3,
    /// The counts, so far.
    pub report: BuildReport,
}

impl Default for Census {
    fn default() -> Self {
        Self {
            primitives: Vec::new(),
            kinds: Vec::new(),
            items: Vec::new(),
            numbering: Numbering::default(),
            bounds: Bounds3::EMPTY,
            report: BuildReport::default(),
        }
    }
}

/// What one task made of its triangles.
struct Chunk {
    /// How many primitives it has written.
    count: usize,
    bounds: Bounds3,
    dropped_degenerate: usize,
    dropped_non_finite: usize,
}

/// Checks and lists the primitives in order of geometry, then index.
pub(crate) fn census(geometries: &[Geometry]) -> Result<Census, BuildError> {
    let counts = || geometries.iter().map(Geometry::primitives);
    let numbering = Numbering::new(counts())
        .ok_or_else(|| BuildError::TooLarge { primitives: counts().fold(0, usize::saturating_add) })?;
    let mut all = Census { numbering, ..Census::default() };
    let triangles = geometries.iter().filter(|g| matches!(g, Geometry::Triangles(_)));
    memory::reserve(&mut all.primitives, triangles.map(Geometry::primitives).sum());
    for (geometry, g) in (0..).zip(geometries) {
        let kind = Kind::prepare(geometry, g)?;
        if let Geometry::Triangles(mesh) = g {
            add_triangles(&mut all, geometry, mesh)?;
        }
        let items = add_items(&mut all, geometry, &kind);
        kind.count(items, &mut all.report);
        all.kinds.push(kind);
    }
    if all.report.instances > 0 {
        widen_instances(&mut all);
    }
    Ok(all)
}

/// Gives boxes of instances the margin that depends on the size of the whole scene.
fn widen_instances(all: &mut Census) {
    let reach = all.bounds.reach();
    all.primitives.par_iter_mut().for_each(|p| {
        if let Kind::Instance(instance) = &all.kinds[p.geometry() as usize] {
            let wide = p.bounds().to_bounds().widened(instance.margin(reach));
            *p = Primitive::new(wide, p.geometry(), p.primitive());
        }
    });
}

/// Lists the boxes of what is no static triangle; returns their number.
fn add_items(all: &mut Census, geometry: u32, kind: &Kind) -> usize {
    let before = all.items.len();
    for (index, bounds) in (0..).zip(kind.boxes()) {
        if bounds == Bounds3::EMPTY {
            continue;
        }
        if bounds.is_empty() || !in_range(&bounds) {
            all.report.dropped_non_finite += 1;
            continue;
        }
        all.bounds = all.bounds.union(bounds);
        all.primitives.push(Primitive::new(bounds, geometry, all.items.len() as u32));
        all.items.push(Item { geometry, index });
    }
    all.items.len() - before
}

fn add_triangles(all: &mut Census, geometry: u32, mesh: &TriangleMesh) -> Result<(), BuildError> {
    let (begin, count) = (all.primitives.len(), mesh.indices.len());
    memory::reserve(&mut all.primitives, count);
    let room = &mut all.primitives.spare_capacity_mut()[..count];
    let chunks: Vec<Chunk> = mesh
        .indices
        .par_chunks(CHUNK)
        .zip(room.par_chunks_mut(CHUNK))
        .enumerate()
        .map(|(i, (indices, out))| list(geometry, mesh, (i * CHUNK) as u32, indices, out))
        .collect::<Result<_, _>>()?;
    // What was left out leaves gaps.
    let mut end = 0;
    for (i, chunk) in chunks.iter().enumerate() {
        let start = i * CHUNK;
        if start != end {
            room.copy_within(start..start + chunk.count, end);
        }
        end += chunk.count;
        all.bounds = all.bounds.union(chunk.bounds);
        all.report.triangles += chunk.count;
        all.report.dropped_degenerate += chunk.dropped_degenerate;
        all.report.dropped_non_finite += chunk.dropped_non_finite;
    }
    // SAFETY: the chunks have written as many as they say, and these were moved together.
    unsafe { all.primitives.set_len(begin + end) };
    Ok(())
}

/// Writes the primitives of some triangles into the first places of `out`.
fn list(
    geometry: u32,
    mesh: &TriangleMesh,
    first: u32,
    indices: &[[u32; 3]],
    out: &mut [MaybeUninit<Primitive>],
) -> Result<Chunk, BuildError> {
    let mut chunk = Chunk { count: 0, bounds: Bounds3::EMPTY, dropped_degenerate: 0, dropped_non_finite: 0 };
    for (primitive, index) in (first..).zip(indices) {
        let mut corners = [Vec3::ZERO; 3];
        for (corner, &i) in corners.iter_mut().zip(index) {
            *corner = *mesh.positions.get(i as usize).ok_or(BuildError::IndexOutOfRange {
                geometry,
                primitive,
                index: i,
                vertices: mesh.positions.len(),
            })?;
        }
        if !is_in_range(corners) {
            chunk.dropped_non_finite += 1;
        } else if has_no_area(corners) {
            chunk.dropped_degenerate += 1;
        } else {
            let exact = Bounds3::of(corners);
            chunk.bounds = chunk.bounds.union(exact);
            out[chunk.count].write(Primitive::new(padded(exact), geometry, primitive));
            chunk.count += 1;
        }
    }
    Ok(chunk)
}

/// Whether a triangle can be hit: its corners are in range and it has an area.
pub(crate) fn is_sound(corners: [Vec3; 3]) -> bool {
    is_in_range(corners) && !has_no_area(corners)
}

fn is_in_range(corners: [Vec3; 3]) -> bool {
    corners.iter().all(|c| c.is_finite() && c.abs().max_element() <= MAX_COORDINATE)
}

/// Whether the corners lie on a line, as far as `f64` can tell.
fn has_no_area([a, b, c]: [Vec3; 3]) -> bool {
    let wide = |v: Vec3| v.to_array().map(f64::from);
    let (a, b, c) = (wide(a), wide(b), wide(c));
    let e: [f64; 3] = std::array::from_fn(|i| b[i] - a[i]);
    let f: [f64; 3] = std::array::from_fn(|i| c[i] - a[i]);
    e[1] * f[2] == e[2] * f[1] && e[2] * f[0] == e[0] * f[2] && e[0] * f[1] == e[1] * f[0]
}

/// A box with the margin that hits of triangles need.
pub(crate) fn padded(Bounds3 { min: lo, max: hi }: Bounds3) -> Bounds3 {
    let margin = (hi - lo).max_element() * (3.0 * 2.0_f32.powi(-23));
    let outwards = |p: Vec3| p.abs() * (0.51 * f32::EPSILON) + Vec3::splat(margin);
    Bounds3 { min: lo - outwards(lo), max: hi + outwards(hi) }
}
