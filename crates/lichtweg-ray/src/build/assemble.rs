//! Puts the parts of a tree into their final arrays: the few nodes above the parts first, then part by
//! part.

use std::mem::MaybeUninit;

use rayon::prelude::*;

use super::binning::Extent;
use super::primitive::Census;
use super::spatial::Knife;
use super::tree::{BlockNames, Built, Part, TreeBuilder};
use crate::accel::{BuildError, BuildQuality};
use crate::bvh::{Block, Bvh, ChildRef, Node, Numbering};
use crate::geometry::Geometry;
use crate::kind::Kind;
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
            mixed: !census.items.is_empty(),
            others_at_once: others_at_once(&census.kinds),
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
    Ok(plan.assemble(root, geometries, numbering, census.bounds.reach()))
}

/// Splits through triangles add at most this share to the references.
const ROOM: f32 = 0.2;

/// Pieces of curves are rejected eight at a time, all else is asked one by one.
fn others_at_once(kinds: &[Kind]) -> u32 {
    let quick = |kind: &Kind| matches!(kind, Kind::Triangles | Kind::Curves(_));
    if kinds.iter().all(quick) { WIDTH as u32 } else { 1 }
}

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

    fn assemble(mut self, root: ChildRef, geometries: &[Geometry], numbering: Numbering, reach: f32) -> Bvh {
        self.parts.par_iter_mut().for_each(|(at, part)| {
            for child in part.nodes.iter_mut().flat_map(|n| &mut n.children) {
                *child = child.shifted(at.nodes, at.blocks, at.others);
            }
        });
        let fill = |names: &BlockNames| block(names, geometries, &numbering);
        Bvh {
            root,
            nodes: joined(&self.upper, &self.parts, |p| &p.nodes, |node| *node),
            blocks: joined(&[Block::EMPTY], &self.parts, |p| &p.blocks, fill),
            others: joined(&[], &self.parts, |p| &p.others, |other| *other),
            numbering,
            reach,
        }
    }
}

/// The triangles of a block.
#[inline(always)]
fn block(names: &BlockNames, geometries: &[Geometry], numbering: &Numbering) -> Block {
    let mut out = Block::EMPTY;
    for (lane, &(geometry, primitive)) in names.names[..names.count].iter().enumerate() {
        if let Geometry::Triangles(mesh) = &geometries[geometry as usize] {
            out.set(lane, mesh.corners(primitive), numbering.number(geometry, primitive));
        }
    }
    out
}

/// `first` and what becomes of the parts' arrays, one after the other, made by several threads.
fn joined<T: Copy + Send + Sync, U: Sync>(
    first: &[T],
    parts: &[(Cursor, Part)],
    array: impl Fn(&Part) -> &Vec<U> + Sync,
    make: impl Fn(&U) -> T + Sync,
) -> Pages<T> {
    let len = first.len() + parts.iter().map(|(_, p)| array(p).len()).sum::<usize>();
    let fill = |out: &mut [MaybeUninit<T>]| {
        let (head, mut rest) = out.split_at_mut(first.len());
        for (to, from) in head.iter_mut().zip(first) {
            to.write(*from);
        }
        let mut jobs = Vec::with_capacity(parts.len());
        for (_, part) in parts {
            let (to, tail) = rest.split_at_mut(array(part).len());
            jobs.push((to, array(part)));
            rest = tail;
        }
        jobs.into_par_iter().for_each(|(to, from)| {
            for (to, from) in to.iter_mut().zip(from) {
                to.write(make(from));
            }
        });
    };
    // SAFETY: the pieces that are written add up to the whole.
    unsafe { Pages::filled(len, fill) }
}
