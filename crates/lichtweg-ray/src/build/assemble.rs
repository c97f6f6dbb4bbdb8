//! Puts the parts of a tree into their final arrays: the few nodes above the parts first, then part by
//! part.

use std::mem::MaybeUninit;

use rayon::prelude::*;

use super::binning::Extent;
use super::primitive::Census;
use super::spatial::Knife;
use super::tree::{Built, Part, TreeBuilder};
use crate::accel::{BuildError, BuildQuality};
use crate::bvh::{Block, Bvh, ChildRef, Node, Numbering};
use crate::geometry::Geometry;
use crate::memory::Pages;
use crate::simd::WIDTH;

/// Builds the hierarchy of all primitives.
pub(crate) fn build(
    geometries: &[Geometry],
    census: &mut Census,
    quality: BuildQuality,
) -> Result<Bvh, BuildError> {
    let primitives = &mut census.primitives;
    let count = primitives.len();
    let mut plan = Layout::default();
    let root = if primitives.is_empty() {
        ChildRef::NOTHING
    } else {
        let (bins, room) = match quality {
            BuildQuality::Fast => (8, 0.0),
            BuildQuality::High => (32, ROOM),
        };
        let extent = Extent::of(primitives);
        primitives.resize(count + (count as f32 * room) as usize, primitives[0]);
        let builder = TreeBuilder {
            geometries,
            numbering: &census.numbering,
            mixed: !census.items.is_empty(),
            bins,
            knife: Knife::new(geometries, &extent),
        };
        let built = builder.build(primitives, count, extent);
        plan.end.nodes = upper_nodes(&built);
        plan.place(built)
    };
    if plan.end.blocks.max(plan.end.others) >= ChildRef::MAX_INDEX {
        return Err(BuildError::TooLarge { primitives: count });
    }
    let numbering = std::mem::take(&mut census.numbering);
    Ok(plan.assemble(root, numbering, census.bounds.reach()))
}

/// Splits through triangles add at most this share to the references.
const ROOM: f32 = 0.2;

fn upper_nodes(built: &Built) -> usize {
    match built {
        Built::Part { .. } => 0,
        Built::Node(children) => 1 + children.iter().map(|(_, c)| upper_nodes(c)).sum::<usize>(),
    }
}

/// Positions in the three arrays.
#[derive(Clone, Copy)]
struct Cursor {
    nodes: usize,
    blocks: usize,
    others: usize,
}

struct Layout {
    upper: Vec<Node>,
    parts: Vec<(Cursor, Part)>,
    end: Cursor,
}

impl Default for Layout {
    fn default() -> Self {
        // Block 0 is the empty one.
        let end = Cursor { nodes: 0, blocks: 1, others: 0 };
        Self { upper: Vec::new(), parts: Vec::new(), end }
    }
}

impl Layout {
    /// Gives a subtree its place; returns the reference to its root.
    fn place(&mut self, built: Built) -> ChildRef {
        match built {
            Built::Part { part, root } => {
                let at = self.end;
                self.end.nodes += part.nodes.len();
                self.end.blocks += part.blocks.len();
                self.end.others += part.others.len();
                self.parts.push((at, part));
                root.shifted(at.nodes, at.blocks, at.others)
            }
            Built::Node(children) => {
                let index = self.upper.len();
                self.upper.push(Node { children: [ChildRef::NOTHING; WIDTH], ..Node::EMPTY });
                for (slot, (bounds, child)) in children.into_iter().enumerate() {
                    let child = self.place(child);
                    self.upper[index].set(slot, &bounds, child);
                }
                ChildRef::inner(index)
            }
        }
    }

    fn assemble(mut self, root: ChildRef, numbering: Numbering, reach: f32) -> Bvh {
        self.parts.par_iter_mut().for_each(|(at, part)| {
            for child in part.nodes.iter_mut().flat_map(|n| &mut n.children) {
                *child = child.shifted(at.nodes, at.blocks, at.others);
            }
        });
        Bvh {
            root,
            nodes: joined(&self.upper, &self.parts, |p| &p.nodes),
            blocks: joined(&[Block::EMPTY], &self.parts, |p| &p.blocks),
            others: joined(&[], &self.parts, |p| &p.others),
            numbering,
            reach,
        }
    }
}

/// `first` and the parts' arrays, one after the other, copied by several threads.
fn joined<T: Copy + Send + Sync>(
    first: &[T],
    parts: &[(Cursor, Part)],
    array: impl Fn(&Part) -> &Vec<T> + Sync,
) -> Pages<T> {
    let len = first.len() + parts.iter().map(|(_, p)| array(p).len()).sum::<usize>();
    let fill = |out: &mut [MaybeUninit<T>]| {
        let (head, mut rest) = out.split_at_mut(first.len());
        copy(head, first);
        let mut jobs = Vec::with_capacity(parts.len());
        for (_, part) in parts {
            let (to, tail) = rest.split_at_mut(array(part).len());
            jobs.push((to, array(part)));
            rest = tail;
        }
        jobs.into_par_iter().for_each(|(to, from)| copy(to, from));
    };
    // SAFETY: the pieces that are written add up to the whole.
    unsafe { Pages::filled(len, fill) }
}

fn copy<T: Copy>(to: &mut [MaybeUninit<T>], from: &[T]) {
    for (to, from) in to.iter_mut().zip(from) {
        to.write(*from);
    }
}
