//! The surface area heuristic over bins of box centres (Wald, *On fast Construction of SAH-based
//! Bounding Volume Hierarchies*, 2007).

use rayon::prelude::*;

use super::primitive::Primitive;
use crate::simd::{Quad, QuadBox};

/// Bins an axis, at most.
const BINS: usize = 32;
/// Primitives of one task of a parallel pass.
const CHUNK: usize = 1 << 15;

/// Boxes of a range of primitives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// Box of the primitives.
    pub bounds: QuadBox,
    /// Box of their doubled centres.
    pub centers2: QuadBox,
}

impl Extent {
    #[inline(always)]
    pub(crate) fn empty() -> Self {
        Self { bounds: QuadBox::empty(), centers2: QuadBox::empty() }
    }

    #[inline(always)]
    fn add(&mut self, p: &Primitive) {
        self.bounds = self.bounds.union(p.bounds());
        self.centers2 = self.centers2.including(p.center2());
    }

    fn union(self, o: Self) -> Self {
        Self { bounds: self.bounds.union(o.bounds), centers2: self.centers2.union(o.centers2) }
    }

    /// Extent of all of `primitives`.
    pub(crate) fn of(primitives: &[Primitive]) -> Self {
        let sequential = |part: &[Primitive]| {
            let mut out = Self::empty();
            part.iter().for_each(|p| out.add(p));
            out
        };
        if primitives.len() <= CHUNK {
            return sequential(primitives);
        }
        primitives.par_chunks(CHUNK).map(sequential).reduce(Self::empty, Self::union)
    }
}

/// Which bin a centre falls into, for each axis.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    origin: Quad,
    scale: Quad,
    bins: usize,
}

impl Grid {
    fn new(centers2: &QuadBox, count: usize, bins: usize) -> Self {
        let bins = (8 + count / 16).min(bins).min(BINS);
        let scale = |extent: f32| {
            // Slightly below the number of bins, so that the last centre falls into the last bin.
            let s = 0.999 * bins as f32 / extent;
            if s < f32::MAX { s } else { 0.0 }
        };
        let [x, y, z, _] = centers2.hi.sub(centers2.lo).to_array();
        Self { origin: centers2.lo, scale: Quad::new(scale(x), scale(y), scale(z), 0.0), bins }
    }

    #[inline(always)]
    fn bins_of(&self, p: &Primitive) -> [usize; 3] {
        let [x, y, z, _] = p.center2().sub(self.origin).mul(self.scale).truncate();
        [x as usize & (BINS - 1), y as usize & (BINS - 1), z as usize & (BINS - 1)]
    }
}

/// A plane between bins.
#[derive(Clone, Copy)]
pub(crate) struct Split {
    grid: Grid,
    axis: usize,
    /// First bin of the right side.
    bin: usize,
    /// Sum over both sides of half area times [`weight`].
    pub cost: f32,
    /// Half area of what the boxes of both sides have in common.
    pub overlap: f32,
}

#[derive(Clone, Copy)]
struct Histogram<const N: usize> {
    bounds: [[QuadBox; 3]; N],
    counts: [[u32; 4]; N],
}

impl<const N: usize> Histogram<N> {
    fn new() -> Self {
        Self { bounds: [[QuadBox::empty(); 3]; N], counts: [[0; 4]; N] }
    }

    fn of(primitives: &[Primitive], grid: &Grid) -> Self {
        let mut out = Self::new();
        for p in primitives {
            let bins = grid.bins_of(p);
            for (axis, bin) in bins.into_iter().enumerate() {
                let bin = bin & (N - 1);
                let b = &mut out.bounds[bin][axis];
                *b = b.union(p.bounds());
                out.counts[bin][axis] += 1;
            }
        }
        out
    }

    fn merged(mut self, o: &Self) -> Self {
        for bin in 0..N {
            for axis in 0..3 {
                self.bounds[bin][axis] = self.bounds[bin][axis].union(o.bounds[bin][axis]);
                self.counts[bin][axis] += o.counts[bin][axis];
            }
        }
        self
    }
}

/// What a range of `count` primitives is thought to cost where it is hit, `block` of them being tested at once.
///
/// The heuristic takes this for proportional to the number, but a tree's cost grows more slowly. A power of 3/4
/// keeps small dense things whole in large sparse scenes, where it is all the same to the linear cost whether
/// a plane passes through them.
#[inline(always)]
pub(crate) fn weight(count: u32, block: u32) -> f32 {
    let root = (count.div_ceil(block) as f32).sqrt();
    root * root.sqrt()
}

/// The cheapest plane among those between `bins` bins an axis, if any leaves something on both sides.
pub(crate) fn find_split(
    primitives: &[Primitive],
    extent: &Extent,
    block: u32,
    bins: usize,
) -> Option<Split> {
    let grid = Grid::new(&extent.centers2, primitives.len(), bins);
    // Most ranges are small and need few bins, which take time to clear.
    if grid.bins <= BINS / 2 {
        find_split_of::<{ BINS / 2 }>(primitives, grid, block)
    } else {
        find_split_of::<BINS>(primitives, grid, block)
    }
}

fn find_split_of<const N: usize>(primitives: &[Primitive], grid: Grid, block: u32) -> Option<Split> {
    let histogram = if primitives.len() <= CHUNK {
        Histogram::<N>::of(primitives, &grid)
    } else {
        primitives
            .par_chunks(CHUNK)
            .map(|part| Box::new(Histogram::of(part, &grid)))
            .reduce_with(|a, b| Box::new(a.merged(&b)))
            .map_or_else(Histogram::new, |h| *h)
    };
    let mut split = sweep(&histogram, grid, block)?;
    let side = |bins: std::ops::Range<usize>| {
        let boxes = histogram.bounds[bins].iter().map(|b| b[split.axis]);
        boxes.fold(QuadBox::empty(), QuadBox::union)
    };
    let common = side(0..split.bin).intersection(side(split.bin..grid.bins));
    split.overlap = if common.is_empty() { 0.0 } else { common.half_area() };
    Some(split)
}

fn sweep<const N: usize>(histogram: &Histogram<N>, grid: Grid, block: u32) -> Option<Split> {
    let mut right_cost = [[0.0_f32; 3]; N];
    let mut boxes = [QuadBox::empty(); 3];
    let mut counts = [0; 3];
    for bin in (1..grid.bins).rev() {
        for axis in 0..3 {
            boxes[axis] = boxes[axis].union(histogram.bounds[bin][axis]);
            counts[axis] += histogram.counts[bin][axis];
            right_cost[bin][axis] = boxes[axis].half_area() * weight(counts[axis], block);
        }
    }
    let total = counts[0] + histogram.counts[0][0];
    let mut best: Option<Split> = None;
    let mut boxes = [QuadBox::empty(); 3];
    let mut counts = [0; 3];
    for (bin, right) in right_cost.iter().enumerate().take(grid.bins).skip(1) {
        for axis in 0..3 {
            boxes[axis] = boxes[axis].union(histogram.bounds[bin - 1][axis]);
            counts[axis] += histogram.counts[bin - 1][axis];
            if counts[axis] == 0 || counts[axis] == total {
                continue;
            }
            let cost = boxes[axis].half_area() * weight(counts[axis], block) + right[axis];
            if best.is_none_or(|b| cost < b.cost) {
                best = Some(Split { grid, axis, bin, cost, overlap: 0.0 });
            }
        }
    }
    best
}

/// Moves the left side to the front, in place. Returns its length and the extents of both sides.
pub(crate) fn partition(primitives: &mut [Primitive], split: &Split) -> (usize, Extent, Extent) {
    let is_left = |p: &Primitive| split.grid.bins_of(p)[split.axis] < split.bin;
    let (mut left, mut right) = (Extent::empty(), Extent::empty());
    let (mut i, mut j) = (0, primitives.len());
    loop {
        while i < j && is_left(&primitives[i]) {
            left.add(&primitives[i]);
            i += 1;
        }
        while i < j && !is_left(&primitives[j - 1]) {
            j -= 1;
            right.add(&primitives[j]);
        }
        if i >= j {
            return (i, left, right);
        }
        primitives.swap(i, j - 1);
    }
}
