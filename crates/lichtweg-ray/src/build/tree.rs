//! Top-down construction of the wide tree: each node opens its largest children until it has eight.
//!
//! Large ranges become tasks; where they are cut depends on the primitives alone, so that the tree and
//! its memory order do not depend on the number of threads.

use rayon::prelude::*;

use super::binning::{Extent, Split, blocks, find_split, partition};
use super::primitive::Primitive;
use crate::bvh::{Block, ChildRef, MAX_DEPTH, Node, Numbering};
use crate::geometry::Geometry;
use crate::math::Bounds3;
use crate::simd::WIDTH;

/// Cost of visiting a node, in units of testing a block.
const NODE_COST: f32 = 0.5;
/// Ranges above this are built as several tasks.
const TASK: usize = 1 << 14;
/// Beyond this depth ranges are halved by count, which bounds the depth.
const HALVING_DEPTH: usize = MAX_DEPTH - 20;

/// Arrays of a finished part of the tree; references count from its own start.
#[derive(Default)]
pub(crate) struct Part {
    pub nodes: Vec<Node>,
    pub blocks: Vec<Block>,
    pub others: Vec<u32>,
}

/// A subtree.
pub(crate) enum Built {
    Part { part: Part, root: ChildRef },
    Node(Vec<(Bounds3, Built)>),
}

/// A contiguous range of primitives that is to become a child.
struct Range<'a> {
    primitives: &'a mut [Primitive],
    extent: Extent,
    settled: bool,
}

/// What is the same for the whole build.
pub(crate) struct TreeBuilder<'a> {
    pub geometries: &'a [Geometry],
    pub numbering: &'a Numbering,
    /// Whether there are primitives other than triangles.
    pub mixed: bool,
}

impl TreeBuilder<'_> {
    pub(crate) fn build(&self, primitives: &mut [Primitive]) -> Built {
        let extent = Extent::of(primitives);
        self.subtree(Range { primitives, extent, settled: false }, 0)
    }

    /// A subtree, as several tasks where it is large.
    fn subtree(&self, range: Range, depth: usize) -> Built {
        if range.primitives.len() <= TASK {
            let mut part = Part::default();
            let root = self.child(range, depth, &mut part);
            return Built::Part { part, root };
        }
        let children = self.open(range, depth);
        let built = children
            .into_par_iter()
            .map(|c| (c.extent.bounds.to_bounds(), self.subtree(c, depth + 1)))
            .collect();
        Built::Node(built)
    }

    /// A subtree within one part.
    fn child(&self, mut range: Range, depth: usize, part: &mut Part) -> ChildRef {
        if range.settled || matches!(self.plan(&mut range, depth), Plan::Leaf) {
            return self.leaf(range.primitives, part);
        }
        let index = part.nodes.len();
        part.nodes.push(Node::EMPTY);
        let mut node = Node::EMPTY;
        for (slot, c) in self.open(range, depth).into_iter().enumerate() {
            let bounds = c.extent.bounds.to_bounds();
            node.set(slot, &bounds, self.child(c, depth + 1, part));
        }
        part.nodes[index] = node;
        ChildRef::inner(index)
    }

    /// Splits a range into two to eight children.
    fn open<'r>(&self, range: Range<'r>, depth: usize) -> Vec<Range<'r>> {
        let mut children = Vec::with_capacity(WIDTH);
        children.push(range);
        while children.len() < WIDTH {
            let weight = |r: &Range| {
                if depth >= HALVING_DEPTH { r.primitives.len() as f32 } else { r.extent.bounds.half_area() }
            };
            let candidate = (0..children.len())
                .filter(|&i| !children[i].settled)
                .max_by(|&a, &b| weight(&children[a]).total_cmp(&weight(&children[b])));
            let Some(candidate) = candidate else { break };
            let plan = self.plan(&mut children[candidate], depth);
            if let Plan::Leaf = plan {
                children[candidate].settled = true;
                continue;
            }
            let range = children.swap_remove(candidate);
            let (left, right) = self.divide(range, plan);
            children.extend([left, right]);
        }
        let area = |r: &Range| r.extent.bounds.half_area();
        children.sort_by(|a, b| area(b).total_cmp(&area(a)));
        children
    }

    fn plan(&self, range: &mut Range, depth: usize) -> Plan {
        let count = range.primitives.len();
        let others = if self.mixed && count <= WIDTH * ChildRef::MAX_ITEMS {
            range.primitives.iter().filter(|p| self.is_other(p)).count()
        } else {
            0
        };
        let only_others = others == count;
        let block = if only_others { 1 } else { WIDTH as u32 };
        if count <= block as usize && (others == 0 || only_others) {
            return Plan::Leaf;
        }
        let may_be_leaf = count <= block as usize * ChildRef::MAX_ITEMS;
        if depth >= HALVING_DEPTH && !may_be_leaf {
            return Plan::Halve;
        }
        if may_be_leaf && others != 0 && !only_others {
            return Plan::Kinds;
        }
        match find_split(range.primitives, &range.extent, block) {
            None if may_be_leaf => Plan::Leaf,
            None => Plan::Halve,
            Some(split) => {
                let area = range.extent.bounds.half_area();
                let leaf_cost = area * blocks(count as u32, block);
                if may_be_leaf && leaf_cost <= NODE_COST * area + split.cost {
                    Plan::Leaf
                } else {
                    Plan::Split(split)
                }
            }
        }
    }

    fn divide<'r>(&self, range: Range<'r>, plan: Plan) -> (Range<'r>, Range<'r>) {
        let primitives = range.primitives;
        let (middle, extents) = match plan {
            Plan::Split(split) => {
                let (middle, left, right) = partition(primitives, &split);
                (middle, Some((left, right)))
            }
            Plan::Kinds => {
                primitives.sort_by_key(|p| self.is_other(p));
                (primitives.partition_point(|p| !self.is_other(p)), None)
            }
            Plan::Halve | Plan::Leaf => (primitives.len() / 2, None),
        };
        let (left, right) = primitives.split_at_mut(middle);
        let (a, b) = extents.unwrap_or_else(|| (Extent::of(left), Extent::of(right)));
        (
            Range { primitives: left, extent: a, settled: false },
            Range { primitives: right, extent: b, settled: false },
        )
    }

    fn is_other(&self, p: &Primitive) -> bool {
        !matches!(self.geometries[p.geometry() as usize], Geometry::Triangles(_))
    }

    fn leaf(&self, primitives: &mut [Primitive], part: &mut Part) -> ChildRef {
        primitives.sort_unstable_by_key(|p| (p.geometry(), p.primitive()));
        if self.mixed && self.is_other(&primitives[0]) {
            let first = part.others.len();
            part.others.extend(primitives.iter().map(Primitive::primitive));
            return ChildRef::others(first, primitives.len());
        }
        let first = part.blocks.len();
        for group in primitives.chunks(WIDTH) {
            let mut block = Block::EMPTY;
            for (lane, p) in group.iter().enumerate() {
                let (geometry, primitive) = (p.geometry(), p.primitive());
                if let Geometry::Triangles(mesh) = &self.geometries[geometry as usize] {
                    let id = self.numbering.number(geometry, primitive);
                    block.set(lane, mesh.corners(primitive), id);
                }
            }
            part.blocks.push(block);
        }
        ChildRef::triangles(first, primitives.len().div_ceil(WIDTH))
    }
}

/// What to do with a range.
enum Plan {
    Leaf,
    Split(Split),
    /// Triangles to the left, others to the right.
    Kinds,
    /// Halve by count.
    Halve,
}
