//! Memory layout: nodes of eight boxes, blocks of eight triangles, both one vector register a quantity.

use crate::math::{Bounds3, Vec3};
use crate::memory::Pages;
use crate::simd::WIDTH;
use crate::wide::{Wide, Word, WordLanes};

/// A child of a node: an inner node, a leaf of triangle blocks, or a leaf of other primitives.
///
/// Bit 31: leaf; bit 30: other primitives; bits 27 to 29: number of blocks or primitives minus one;
/// bits 0 to 26: index of the first. Inner nodes use 31 bits of index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct ChildRef(pub u32);

impl ChildRef {
    const LEAF: u32 = 1 << 31;
    const OTHER: u32 = 1 << 30;
    const INDEX_BITS: u32 = 27;
    /// Largest number of items in a leaf: triangle blocks or other primitives.
    pub(crate) const MAX_ITEMS: usize = 8;
    /// Largest number of indices in one array.
    pub(crate) const MAX_INDEX: usize = 1 << Self::INDEX_BITS;
    /// What an unused slot holds: the leaf of the empty block 0 of a finished tree.
    pub(crate) const NOTHING: Self = Self(Self::LEAF);
    /// What an unused slot holds in an unfinished part of a tree.
    pub(crate) const UNUSED: Self = Self(Self::LEAF | (Self::MAX_INDEX as u32 - 1));

    pub(crate) fn inner(index: usize) -> Self {
        debug_assert!(index < 1 << 31);
        Self(index as u32)
    }

    pub(crate) fn triangles(first_block: usize, blocks: usize) -> Self {
        Self(Self::LEAF | Self::items(first_block, blocks))
    }

    pub(crate) fn others(first: usize, count: usize) -> Self {
        Self(Self::LEAF | Self::OTHER | Self::items(first, count))
    }

    fn items(first: usize, count: usize) -> u32 {
        debug_assert!((1..=Self::MAX_ITEMS).contains(&count) && first < Self::MAX_INDEX);
        (count as u32 - 1) << Self::INDEX_BITS | first as u32
    }

    #[inline(always)]
    pub(crate) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    #[inline(always)]
    pub(crate) fn is_other(self) -> bool {
        self.0 & Self::OTHER != 0
    }

    /// Index of an inner node.
    #[inline(always)]
    pub(crate) fn node(self) -> usize {
        self.0 as usize
    }

    /// The items of a leaf: first and count.
    #[inline(always)]
    pub(crate) fn leaf(self) -> (usize, usize) {
        let first = self.0 & ((1 << Self::INDEX_BITS) - 1);
        (first as usize, (self.0 >> Self::INDEX_BITS & 7) as usize + 1)
    }

    /// The same child after the arrays it points into were appended to others.
    pub(crate) fn shifted(self, nodes: usize, blocks: usize, others: usize) -> Self {
        if self == Self::UNUSED {
            return Self::NOTHING;
        }
        let by = match (self.is_leaf(), self.is_other()) {
            (false, _) => nodes,
            (true, false) => blocks,
            (true, true) => others,
        };
        Self(self.0 + by as u32)
    }
}

/// Eight child boxes and what is in them: four cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// min x, max x, min y, max y, min z, max z of the children; unused slots hold the empty box.
    pub planes: [[f32; WIDTH]; 6],
    pub children: [ChildRef; WIDTH],
    pub unused: [u32; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Self = Self {
        planes: {
            let (lo, hi) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
            [lo, hi, lo, hi, lo, hi]
        },
        children: [ChildRef::UNUSED; WIDTH],
        unused: [0; WIDTH],
    };

    /// The box of a child; empty where there is none.
    pub(crate) fn bounds(&self, slot: usize) -> Bounds3 {
        let plane = |i: usize| self.planes[i][slot];
        Bounds3 { min: Vec3::new(plane(0), plane(2), plane(4)), max: Vec3::new(plane(1), plane(3), plane(5)) }
    }

    /// The box around all children.
    pub(crate) fn hull(&self) -> Bounds3 {
        (0..WIDTH).map(|slot| self.bounds(slot)).fold(Bounds3::EMPTY, Bounds3::union)
    }

    pub(crate) fn set(&mut self, slot: usize, bounds: &Bounds3, child: ChildRef) {
        for axis in 0..3 {
            self.planes[2 * axis][slot] = bounds.min[axis];
            self.planes[2 * axis + 1][slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }
}

/// Eight triangles: five cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// `corners[vertex][axis][lane]`; unused lanes hold NaN.
    pub corners: [[[f32; WIDTH]; 3]; 3],
    /// Running numbers (see [`Numbering`]), ascending.
    pub ids: [u32; WIDTH],
}

impl Block {
    /// What unused lanes hold instead of a running number.
    pub(crate) const NO_ID: u32 = u32::MAX;
    pub(crate) const EMPTY: Self = Self { corners: [[[f32::NAN; WIDTH]; 3]; 3], ids: [Self::NO_ID; WIDTH] };

    pub(crate) fn set(&mut self, lane: usize, corners: [Vec3; 3], id: u32) {
        for (to, from) in self.corners.iter_mut().zip(corners) {
            for axis in 0..3 {
                to[axis][lane] = from[axis];
            }
        }
        self.ids[lane] = id;
    }

    /// Number of triangles: they fill the first lanes.
    #[inline(always)]
    pub(crate) fn len(&self) -> u32 {
        self.ids.iter().map(|&id| u32::from(id != Self::NO_ID)).sum()
    }

    pub(crate) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        self.corners.map(|c| Vec3::new(c[0][lane], c[1][lane], c[2][lane]))
    }
}

/// Numbers all primitives of all geometries in one row: one integer names, and orders, them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Numbering {
    /// Number of each geometry's first primitive.
    starts: Vec<u32>,
}

impl Numbering {
    /// From the numbers of primitives of the geometries; `None` where 32 bits do not suffice.
    pub(crate) fn new(counts: impl Iterator<Item = usize>) -> Option<Self> {
        let mut next = 0_usize;
        let mut starts = Vec::new();
        for count in counts {
            starts.push(u32::try_from(next).ok()?);
            next = next.checked_add(count)?;
        }
        (next < u32::MAX as usize).then_some(Self { starts })
    }

    #[inline]
    pub(crate) fn number(&self, geometry: u32, primitive: u32) -> u32 {
        self.starts[geometry as usize] + primitive
    }

    /// Geometry and primitive of a number.
    #[inline]
    pub(crate) fn locate(&self, number: u32) -> (u32, u32) {
        let geometry = self.starts.partition_point(|&s| s <= number) - 1;
        (geometry as u32, number - self.starts[geometry])
    }

    /// Geometries and primitives of sixteen numbers; of no meaning for numbers of nothing.
    #[inline(always)]
    pub(crate) fn locate_all<W: Wide>(&self, numbers: W::U32) -> (W::U32, W::U32) {
        // The geometry is among `left` from `first` on.
        let mut first = W::U32::splat(0);
        let mut left = self.starts.len() as u32;
        while left > 1 {
            let middle = first + W::U32::splat(left / 2);
            first = first.select(numbers.lt(W::U32::gather(&self.starts, middle)), middle);
            left -= left / 2;
        }
        (first, numbers - W::U32::gather(&self.starts, first))
    }
}

/// The hierarchy.
#[derive(Debug)]
pub(crate) struct Bvh {
    pub root: ChildRef,
    pub nodes: Pages<Node>,
    /// Block 0 is empty.
    pub blocks: Pages<Block>,
    /// Indices into the list of other primitives, in leaf order.
    pub others: Pages<u32>,
    pub numbering: Numbering,
    /// Largest absolute coordinate of the bounds.
    pub reach: f32,
}

impl Bvh {
    /// Memory of all arrays.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.blocks) + size_of_val(&*self.others)
    }
}
