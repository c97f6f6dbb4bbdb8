//! Top-down construction: a binary tree by the surface area heuristic, collapsed to a wide one.
//!
//! Large ranges become tasks; where they are cut depends on the references alone, so that the tree and
//! its memory order do not depend on the number of threads. The nodes above the tasks open their largest
//! children until they have eight.

use rayon::prelude::*;

use super::binning::{Extent, Split, find_split, partition};
use super::collapse::{Binary, BinaryNode, collapse};
use super::primitive::Primitive;
use super::spatial::{Knife, SpatialSplit};
use crate::bvh::{ChildRef, MAX_DEPTH, Node};
use crate::geometry::Geometry;
use crate::math::Bounds3;
use crate::simd::WIDTH;

/// Ranges above this are built as several tasks.
const TASK: usize = 1 << 14;
/// Beyond this depth ranges are halved by count, which bounds the depth.
const HALVING_DEPTH: usize = MAX_DEPTH - 20;

/// Arrays of a finished part of the tree; references count from its own start.
#[derive(Default)]
pub(crate) struct Part {
    pub nodes: Vec<Node>,
    /// Blocks are not filled before they have their final place.
    pub blocks: Vec<BlockNames>,
    pub others: Vec<u32>,
}

/// What is to be in a block: geometry and primitive of each lane, in order, as far as there are some.
#[derive(Clone, Copy)]
pub(crate) struct BlockNames {
    pub names: [(u32, u32); WIDTH],
    pub count: usize,
}

impl BlockNames {
    pub(crate) const NONE: Self = Self { names: [(0, 0); WIDTH], count: 0 };
}

/// A subtree.
pub(crate) enum Built {
    Part { part: Part, root: ChildRef },
    Node(Vec<(Bounds3, Built)>),
}

/// References that are to become a subtree, and room for more of them.
struct Range<'a> {
    slots: &'a mut [Primitive],
    /// How many slots, from the first on, are in use.
    count: usize,
    extent: Extent,
}

impl<'a> Range<'a> {
    fn references(&self) -> &[Primitive] {
        &self.slots[..self.count]
    }

    fn in_use(&mut self) -> &mut [Primitive] {
        &mut self.slots[..self.count]
    }

    /// Two ranges, the references up to `middle` and those from there on, which share the room.
    fn split_at(self, middle: usize, left: Extent, right: Extent) -> (Self, Self) {
        let room = self.slots.len() - self.count;
        let share = (room as u64 * middle as u64 / self.count.max(1) as u64) as usize;
        self.slots.copy_within(middle..self.count, middle + share);
        let (a, b) = self.slots.split_at_mut(middle + share);
        (
            Range { slots: a, count: middle, extent: left },
            Range { slots: b, count: self.count - middle, extent: right },
        )
    }
}

/// What is the same for the whole build.
pub(crate) struct TreeBuilder<'a> {
    pub geometries: &'a [Geometry],
    /// Whether there are primitives other than triangles.
    pub mixed: bool,
    /// How many of the others are tested at once: eight where all are pieces of curves.
    pub others_at_once: u32,
    /// Bins an axis for splits between references, at most.
    pub bins: usize,
    /// Cuts triangles, as far as there is room for their pieces.
    pub knife: Knife<'a>,
}

impl TreeBuilder<'_> {
    /// Builds a tree of the first `count` references; the other slots are room for pieces.
    pub(crate) fn build(&self, slots: &mut [Primitive], count: usize, extent: Extent) -> Built {
        self.subtree(Range { slots, count, extent }, 0)
    }

    /// A subtree, as several tasks where it is large.
    fn subtree(&self, range: Range, depth: usize) -> Built {
        if range.count <= TASK {
            let mut binary = Binary::default();
            self.grow(range, depth, &mut binary);
            let (part, root) = collapse(&mut binary, self.others_at_once);
            return Built::Part { part, root };
        }
        let children = self.open(range, depth);
        let built = children
            .into_par_iter()
            .map(|c| (c.extent.bounds.to_bounds(), self.subtree(c, depth + 1)))
            .collect();
        Built::Node(built)
    }

    /// A binary subtree; returns the number of others in it.
    fn grow(&self, range: Range, depth: usize, out: &mut Binary) -> u32 {
        let index = out.nodes.len();
        let (first, bounds) = (out.names.len() as u32, range.extent.bounds);
        out.nodes.push(BinaryNode { bounds, right: 0, first, count: 0, others: 0 });
        let (mut right, mut others) = (0, 0);
        match self.plan(&range, depth) {
            None => {
                out.names.extend(range.references().iter().map(|p| (p.geometry(), p.primitive())));
                others = self.others(range.references()) as u32;
            }
            Some(plan) => {
                let (a, b) = self.divide(range, plan);
                others += self.grow(a, depth + 1, out);
                right = out.nodes.len() as u32;
                others += self.grow(b, depth + 1, out);
            }
        }
        let count = out.names.len() as u32 - first;
        out.nodes[index] = BinaryNode { bounds, right, first, count, others };
        others
    }

    /// Splits a range into eight children, or fewer where small ones suffice.
    fn open<'r>(&self, range: Range<'r>, depth: usize) -> Vec<Range<'r>> {
        let mut children = vec![range];
        while children.len() < WIDTH {
            let weight = |r: &Range| {
                if depth >= HALVING_DEPTH { r.count as f32 } else { r.extent.bounds.half_area() }
            };
            let candidate = (0..children.len())
                .filter(|&i| children[i].count > TASK / 2)
                .max_by(|&a, &b| weight(&children[a]).total_cmp(&weight(&children[b])));
            let Some(candidate) = candidate else { break };
            let range = children.swap_remove(candidate);
            let plan = self.plan(&range, depth).unwrap_or(Plan::Halve);
            let (left, right) = self.divide(range, plan);
            children.extend([left, right]);
        }
        let area = |r: &Range| r.extent.bounds.half_area();
        children.sort_by(|a, b| area(b).total_cmp(&area(a)));
        children
    }

    /// How to split a range, or not at all.
    fn plan(&self, range: &Range, depth: usize) -> Option<Plan> {
        let count = range.count;
        let is_small = count <= WIDTH;
        let may_be_leaf = count <= WIDTH * ChildRef::MAX_ITEMS;
        let others = if may_be_leaf { self.others(range.references()) } else { 0 };
        if is_small && others != 0 && others != count {
            return Some(Plan::Kinds);
        }
        let block = if others == count { self.others_at_once } else { WIDTH as u32 };
        if count <= block as usize && (others == 0 || others == count) {
            return None;
        }
        if depth >= HALVING_DEPTH {
            return Some(Plan::Halve);
        }
        let Some(split) = find_split(range.references(), &range.extent, block, self.bins) else {
            return Some(Plan::Halve);
        };
        let room = range.slots.len() - count;
        if room > 0 && self.knife.may_pay(&split) {
            let spatial = self.knife.find_split(range.references(), &range.extent, block);
            if let Some(spatial) = spatial.filter(|s| s.cost < split.cost && s.duplicates <= room) {
                return Some(Plan::Cut(spatial, split));
            }
        }
        Some(Plan::Split(split))
    }

    fn divide<'r>(&self, mut range: Range<'r>, plan: Plan) -> (Range<'r>, Range<'r>) {
        let split = match plan {
            Plan::Split(split) => split,
            Plan::Cut(spatial, split) => {
                let sides = self.knife.cut(range.references(), &spatial);
                let count = sides.references.len();
                // Rounding may make more of it than foreseen.
                if sides.middle == 0 || sides.middle == count || count > range.slots.len() {
                    split
                } else {
                    range.slots[..count].copy_from_slice(&sides.references);
                    range.count = count;
                    return range.split_at(sides.middle, sides.left, sides.right);
                }
            }
            Plan::Kinds => {
                range.in_use().sort_by_key(|p| self.is_other(p));
                let middle = range.references().partition_point(|p| !self.is_other(p));
                return halves(range, middle);
            }
            Plan::Halve => {
                let middle = range.count / 2;
                return halves(range, middle);
            }
        };
        let (middle, left, right) = partition(range.in_use(), &split);
        range.split_at(middle, left, right)
    }

    /// How many of the references are no triangles.
    fn others(&self, references: &[Primitive]) -> usize {
        if self.mixed { references.iter().filter(|p| self.is_other(p)).count() } else { 0 }
    }

    fn is_other(&self, p: &Primitive) -> bool {
        !matches!(self.geometries[p.geometry() as usize], Geometry::Triangles(_))
    }
}

fn halves(range: Range, middle: usize) -> (Range, Range) {
    let (left, right) = range.references().split_at(middle);
    let (left, right) = (Extent::of(left), Extent::of(right));
    range.split_at(middle, left, right)
}

/// How to split a range.
enum Plan {
    Split(Split),
    /// Through triangles; the other split where that turns out not to fit.
    Cut(SpatialSplit, Split),
    /// Triangles to the left, others to the right.
    Kinds,
    /// Halve by count.
    Halve,
}
