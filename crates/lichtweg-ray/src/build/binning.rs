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
    fn place_of(&self, p: &Primitive) -> Quad {
        p.center2().sub(self.origin).mul(self.scale)
    }

    #[inline(always)]
    fn bins_of(&self, p: &Primitive) -> [usize; 3] {
        let [x, y, z, _] = self.place_of(p).truncate();
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
    /// The boxes of both sides.
    sides: [QuadBox; 2],
}

impl Split {
    #[inline(always)]
    fn is_left(&self, p: &Primitive) -> bool {
        let below = self.grid.place_of(p).truncates_below(BINS as i32, self.bin as i32);
        below >> self.axis & 1 != 0
    }

    /// Half area of what the boxes of both sides have in common.
    pub(crate) fn overlap(&self) -> f32 {
        let common = self.sides[0].intersection(self.sides[1]);
        if common.is_empty() { 0.0 } else { common.half_area() }
    }
}

/// Boxes and numbers of the primitives in each bin, for each axis.
#[derive(Clone, Copy)]
struct Histogram<const N: usize> {
    bounds: [[QuadBox; 3]; N],
    counts: [[u32; 4]; N],
}

impl<const N: usize> Histogram<N> {
    #[inline(always)]
    fn new() -> Self {
        Self { bounds: [[QuadBox::empty(); 3]; N], counts: [[0; 4]; N] }
    }

    #[inline(always)]
    fn add(&mut self, p: &Primitive, grid: &Grid) {
        let bounds = p.bounds();
        for (axis, bin) in grid.bins_of(p).into_iter().enumerate() {
            let bin = bin & (N - 1);
            let b = &mut self.bounds[bin][axis];
            *b = b.union(bounds);
            self.counts[bin][axis] += 1;
        }
    }

    /// Neighbours mostly fall into the same bin and would wait for one another: they take turns at two histograms.
    #[inline(always)]
    fn of(primitives: &[Primitive], grid: &Grid) -> Self {
        let mut out = Self::new();
        if primitives.len() < 8 * N {
            primitives.iter().for_each(|p| out.add(p, grid));
            return out;
        }
        let mut other = Self::new();
        let pairs = primitives.chunks_exact(2);
        pairs.remainder().iter().for_each(|p| out.add(p, grid));
        for pair in pairs {
            out.add(&pair[0], grid);
            other.add(&pair[1], grid);
        }
        out.merge(&other);
        out
    }

    #[inline(always)]
    fn merge(&mut self, o: &Self) {
        for bin in 0..N {
            for axis in 0..3 {
                self.bounds[bin][axis] = self.bounds[bin][axis].union(o.bounds[bin][axis]);
                self.counts[bin][axis] += o.counts[bin][axis];
            }
        }
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

/// [`weight`] of four counts, of which the first three mean something.
#[inline(always)]
fn weights(counts: [u32; 4], block: u32) -> Quad {
    // Powers of two: a block holds one or eight.
    let shift = block.trailing_zeros();
    let root = Quad::from_counts(counts.map(|c| (c + block - 1) >> shift)).sqrt();
    root.mul(root.sqrt())
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
    match grid.bins {
        0..=8 => find_split_of::<8>(primitives, grid, block),
        9..=16 => find_split_of::<16>(primitives, grid, block),
        _ => find_split_of::<BINS>(primitives, grid, block),
    }
}

#[inline(never)]
fn find_split_of<const N: usize>(primitives: &[Primitive], grid: Grid, block: u32) -> Option<Split> {
    if primitives.len() <= CHUNK {
        return sweep(&Histogram::<N>::of(primitives, &grid), grid, block);
    }
    let histogram = primitives
        .par_chunks(CHUNK)
        .map(|part| Box::new(Histogram::<N>::of(part, &grid)))
        .reduce_with(|mut a, b| {
            a.merge(&b);
            a
        })?;
    sweep(&histogram, grid, block)
}

/// All three axes of a bin are dealt with at once.
#[inline(always)]
fn sweep<const N: usize>(histogram: &Histogram<N>, grid: Grid, block: u32) -> Option<Split> {
    let mut right_cost = [Quad::splat(0.0); N];
    let mut boxes = [QuadBox::empty(); 3];
    let mut counts = [0; 4];
    let add = |bin: usize, boxes: &mut [QuadBox; 3], counts: &mut [u32; 4]| {
        for (whole, part) in boxes.iter_mut().zip(histogram.bounds[bin]) {
            *whole = whole.union(part);
        }
        for (sum, n) in counts.iter_mut().zip(histogram.counts[bin]) {
            *sum += n;
        }
        half_areas(boxes).mul(weights(*counts, block))
    };
    for bin in (1..grid.bins).rev() {
        right_cost[bin] = add(bin, &mut boxes, &mut counts);
    }
    let total = counts[0] + histogram.counts[0][0];
    let mut best = (f32::INFINITY, 0, 0);
    let mut boxes = [QuadBox::empty(); 3];
    let mut counts = [0; 4];
    for (bin, right) in right_cost.iter().enumerate().take(grid.bins).skip(1) {
        let cost = add(bin - 1, &mut boxes, &mut counts).add(*right).to_array();
        for axis in 0..3 {
            let is_split = counts[axis] != 0 && counts[axis] != total;
            if is_split && cost[axis] < best.0 {
                best = (cost[axis], axis, bin);
            }
        }
    }
    let (cost, axis, bin) = best;
    if bin == 0 {
        return None;
    }
    let side = |bins: std::ops::Range<usize>| {
        let boxes = histogram.bounds[bins].iter().map(|b| b[axis]);
        boxes.fold(QuadBox::empty(), QuadBox::union)
    };
    Some(Split { grid, axis, bin, cost, sides: [side(0..bin), side(bin..grid.bins)] })
}

/// Half the surface areas of three boxes; those of empty ones are not positive, or not numbers.
#[inline(always)]
fn half_areas(boxes: &[QuadBox; 3]) -> Quad {
    let [x, y, z] = Quad::transposed(boxes.map(|b| b.hi.sub(b.lo)));
    x.mul(y.add(z)).add(y.mul(z))
}

/// Moves the left side to the front, in place. Returns its length and the extents of both sides.
pub(crate) fn partition(primitives: &mut [Primitive], split: &Split) -> (usize, Extent, Extent) {
    let (middle, centers) = if primitives.len() <= CHUNK {
        partition_chunk(primitives, split)
    } else {
        partition_chunks(primitives, split)
    };
    let [left, right] = [0, 1].map(|i| Extent { bounds: split.sides[i], centers2: centers[i] });
    (middle, left, right)
}

/// Without branches, which nobody could predict. Returns the length of the left side and the boxes of the doubled
/// centres.
fn partition_chunk(primitives: &mut [Primitive], split: &Split) -> (usize, [QuadBox; 2]) {
    let mut centers = [QuadBox::empty(); 2];
    let mut middle = 0;
    for i in 0..primitives.len() {
        let p = primitives[i];
        let is_left = split.is_left(&p);
        primitives[i] = primitives[middle];
        primitives[middle] = p;
        middle += usize::from(is_left);
        let center = p.center2();
        centers[0] = centers[0].including_if(is_left, center);
        centers[1] = centers[1].including_if(!is_left, center);
    }
    (middle, centers)
}

/// All chunks by themselves, by several threads; then what is on the wrong side changes places.
fn partition_chunks(primitives: &mut [Primitive], split: &Split) -> (usize, [QuadBox; 2]) {
    let (lefts, centers): (Vec<usize>, Vec<[QuadBox; 2]>) =
        primitives.par_chunks_mut(CHUNK).map(|chunk| partition_chunk(chunk, split)).unzip();
    let middle = lefts.iter().sum();
    let (front, back) = primitives.split_at_mut(middle);
    let rights_in_front =
        front.chunks_mut(CHUNK).zip(&lefts).flat_map(|(chunk, &left)| chunk.iter_mut().skip(left));
    // The middle cuts a chunk in two.
    let (cut, before) = (middle / CHUNK, middle % CHUNK);
    let (rest_of_cut, after) = back.split_at_mut(back.len().min(CHUNK - before));
    let lefts_in_rest = rest_of_cut.iter_mut().take(lefts[cut].saturating_sub(before));
    let lefts_after =
        after.chunks_mut(CHUNK).zip(&lefts[cut + 1..]).flat_map(|(chunk, &left)| &mut chunk[..left]);
    for (a, b) in rights_in_front.zip(lefts_in_rest.chain(lefts_after)) {
        std::mem::swap(a, b);
    }
    let both = |a: [QuadBox; 2], b: &[QuadBox; 2]| [a[0].union(b[0]), a[1].union(b[1])];
    (middle, centers.iter().fold([QuadBox::empty(); 2], both))
}
