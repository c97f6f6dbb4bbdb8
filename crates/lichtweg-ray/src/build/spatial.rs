//! Splits that cut triangles in two (Stich, Friedrich and Dietrich, *Spatial Splits in Bounding Volume
//! Hierarchies*, 2009), for ranges whose halves would overlap otherwise.
//!
//! Both pieces of a triangle are references to the whole of it, with smaller boxes.

use rayon::prelude::*;

use super::binning::{Extent, Split, weight};
use super::clip::Piece;
use super::primitive::Primitive;
use crate::geometry::Geometry;
use crate::simd::{Quad, QuadBox};

/// Slabs an axis.
const BINS: usize = 16;
/// References of one task of a parallel pass.
const CHUNK: usize = 1 << 13;

/// Overlap of two halves from which on it is tried to cut, as a share of the scene's area.
const OVERLAP: f32 = 1e-3;
/// Triangles with larger boxes stay whole, as a share of the scene's area: a floor is best met once, near the
/// root, and not a piece of it in every subtree above it.
const LARGEST: f32 = 0.1;

/// A plane that cuts what straddles it.
#[derive(Clone, Copy)]
pub(crate) struct SpatialSplit {
    axis: usize,
    position: f32,
    /// References that both sides get.
    pub duplicates: usize,
    /// Sum over both sides of half area times [`weight`].
    pub cost: f32,
}

/// Equal slabs of a box, for each axis.
#[derive(Clone, Copy)]
struct Slabs {
    origin: [f32; 3],
    width: [f32; 3],
    scale: Quad,
    start: Quad,
}

impl Slabs {
    fn new(bounds: &QuadBox) -> Self {
        let (lo, extent) = (bounds.lo.to_array(), bounds.hi.sub(bounds.lo).to_array());
        let scale = |extent: f32| {
            let s = 0.9999 * BINS as f32 / extent;
            if s < f32::MAX { s } else { 0.0 }
        };
        Self {
            origin: [lo[0], lo[1], lo[2]],
            width: std::array::from_fn(|i| extent[i] / (0.9999 * BINS as f32)),
            scale: Quad::new(scale(extent[0]), scale(extent[1]), scale(extent[2]), 0.0),
            start: bounds.lo,
        }
    }

    #[inline(always)]
    fn bins_of(&self, p: Quad) -> [usize; 3] {
        let [x, y, z, _] = p.sub(self.start).mul(self.scale).truncate();
        let bin = |i: i32| i.clamp(0, BINS as i32 - 1) as usize;
        [bin(x), bin(y), bin(z)]
    }

    /// The plane at the start of a bin.
    #[inline(always)]
    fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.origin[axis] + self.width[axis] * bin as f32
    }
}

/// Boxes of what lies in each slab, and how many references begin and end there.
#[derive(Clone, Copy)]
struct Histogram {
    bounds: [[QuadBox; 3]; BINS],
    begins: [[u32; 3]; BINS],
    ends: [[u32; 3]; BINS],
}

impl Histogram {
    fn new() -> Self {
        Self { bounds: [[QuadBox::empty(); 3]; BINS], begins: [[0; 3]; BINS], ends: [[0; 3]; BINS] }
    }

    fn of(knife: &Knife, references: &[Primitive], slabs: &Slabs) -> Self {
        let mut out = Self::new();
        for reference in references {
            out.add(knife, reference, slabs);
        }
        out
    }

    #[inline(always)]
    fn add(&mut self, knife: &Knife, reference: &Primitive, slabs: &Slabs) {
        let first = slabs.bins_of(reference.bounds().lo);
        let last = slabs.bins_of(reference.bounds().hi);
        let piece = if first == last { None } else { knife.piece(reference) };
        for axis in 0..3 {
            let (mut from, mut to) = (first[axis], last[axis]);
            if let Some(piece) = piece.as_ref().filter(|_| from != to) {
                for bin in from..=to {
                    let begin = if bin == from { f32::NEG_INFINITY } else { slabs.plane(axis, bin) };
                    let end = if bin == to { f32::INFINITY } else { slabs.plane(axis, bin + 1) };
                    let b = &mut self.bounds[bin][axis];
                    *b = b.union(piece.between(axis, begin, end));
                }
            } else {
                // What cannot be cut goes where its middle is.
                from = from.midpoint(to);
                to = from;
                let b = &mut self.bounds[from][axis];
                *b = b.union(reference.bounds());
            }
            self.begins[from][axis] += 1;
            self.ends[to][axis] += 1;
        }
    }

    fn merged(mut self, o: &Self) -> Self {
        for bin in 0..BINS {
            for axis in 0..3 {
                self.bounds[bin][axis] = self.bounds[bin][axis].union(o.bounds[bin][axis]);
                self.begins[bin][axis] += o.begins[bin][axis];
                self.ends[bin][axis] += o.ends[bin][axis];
            }
        }
        self
    }
}

fn sweep(histogram: &Histogram, slabs: &Slabs, total: usize, block: u32) -> Option<SpatialSplit> {
    let mut best: Option<SpatialSplit> = None;
    for axis in 0..3 {
        let mut right_cost = [0.0_f32; BINS];
        let mut right_count = [0_u32; BINS];
        let (mut bounds, mut count) = (QuadBox::empty(), 0);
        for bin in (1..BINS).rev() {
            bounds = bounds.union(histogram.bounds[bin][axis]);
            count += histogram.ends[bin][axis];
            right_count[bin] = count;
            right_cost[bin] = bounds.half_area() * weight(count, block);
        }
        let (mut bounds, mut count) = (QuadBox::empty(), 0);
        for bin in 1..BINS {
            bounds = bounds.union(histogram.bounds[bin - 1][axis]);
            count += histogram.begins[bin - 1][axis];
            if count as usize == total || right_count[bin] as usize == total {
                continue;
            }
            let cost = bounds.half_area() * weight(count, block) + right_cost[bin];
            if best.is_none_or(|b| cost < b.cost) {
                let duplicates = (count + right_count[bin]) as usize - total;
                best = Some(SpatialSplit { axis, position: slabs.plane(axis, bin), duplicates, cost });
            }
        }
    }
    best
}

/// The two sides of a plane.
pub(crate) struct Sides {
    /// What lies to the left, then what lies to the right.
    pub references: Vec<Primitive>,
    pub middle: usize,
    pub left: Extent,
    pub right: Extent,
}

/// Cuts triangles.
pub(crate) struct Knife<'a> {
    geometries: &'a [Geometry],
    /// Overlap from which on it is tried to cut.
    overlap: f32,
    /// Half area of the largest boxes of triangles that are cut.
    largest: f32,
}

impl<'a> Knife<'a> {
    pub(crate) fn new(geometries: &'a [Geometry], scene: &Extent) -> Self {
        let area = scene.bounds.half_area();
        Self { geometries, overlap: OVERLAP * area, largest: LARGEST * area }
    }

    /// Whether it is likely enough that another split is cheaper than this one.
    pub(crate) fn may_pay(&self, split: &Split) -> bool {
        split.overlap() > self.overlap
    }

    /// What can be cut.
    #[inline(always)]
    fn piece(&self, reference: &Primitive) -> Option<Piece> {
        match &self.geometries[reference.geometry() as usize] {
            Geometry::Triangles(mesh) => {
                Piece::of(mesh.corners(reference.primitive()), reference, self.largest)
            }
            _ => None,
        }
    }

    /// The cheapest plane that leaves less on either side than there is.
    pub(crate) fn find_split(
        &self,
        references: &[Primitive],
        extent: &Extent,
        block: u32,
    ) -> Option<SpatialSplit> {
        let slabs = Slabs::new(&extent.bounds);
        let histogram = if references.len() <= CHUNK {
            Histogram::of(self, references, &slabs)
        } else {
            references
                .par_chunks(CHUNK)
                .map(|part| Box::new(Histogram::of(self, part, &slabs)))
                .reduce_with(|a, b| Box::new(a.merged(&b)))
                .map_or_else(Histogram::new, |h| *h)
        };
        sweep(&histogram, &slabs, references.len(), block)
    }

    /// Cuts the references. Of what lies on one side only, or cannot be cut, nothing is duplicated.
    pub(crate) fn cut(&self, references: &[Primitive], split: &SpatialSplit) -> Sides {
        let &SpatialSplit { axis, position, duplicates, .. } = split;
        let mut left = Vec::with_capacity(references.len() + duplicates);
        let mut right = Vec::with_capacity(references.len());
        for reference in references {
            let (lo, hi) = (reference.bounds().lo.to_array()[axis], reference.bounds().hi.to_array()[axis]);
            if hi <= position {
                left.push(*reference);
            } else if lo >= position {
                right.push(*reference);
            } else if let Some(piece) = self.piece(reference) {
                left.extend(piece.cut(piece.between(axis, f32::NEG_INFINITY, position)));
                right.extend(piece.cut(piece.between(axis, position, f32::INFINITY)));
            } else if lo + hi <= 2.0 * position {
                left.push(*reference);
            } else {
                right.push(*reference);
            }
        }
        let middle = left.len();
        let (a, b) = (Extent::of(&left), Extent::of(&right));
        left.extend_from_slice(&right);
        Sides { references: left, middle, left: a, right: b }
    }
}
