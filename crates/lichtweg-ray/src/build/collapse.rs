//! From a binary tree to the cheapest wide one (Ylitie, Karras and Laine, *Efficient Incoherent Ray Traversal
//! on GPUs Through Compressed Wide BVHs*, 2017, section 3.1).
//!
//! Let C(n, i) be the least cost of a forest of at most i wide nodes or leaves that holds the subtree n. With
//! the surface area heuristic, children l and r and D(n, j) = min over k of C(l, k) + C(r, j - k),
//!
//! C(n, 1) = min(leaf cost of n, D(n, 8) + node cost of n),    C(n, i) = min(D(n, i), C(n, i - 1)).
//!
//! Subtrees become leaves where that is cheaper, so that pieces of one triangle may meet again.

use super::tree::{BlockNames, Part};
use crate::bvh::{ChildRef, Node};
use crate::simd::{QuadBox, WIDTH};

/// What fills a gap between leaves of others.
const NO_OTHER: u32 = u32::MAX;

/// Cost of visiting a node, in units of testing a block.
const NODE_COST: f32 = 0.5;

/// A subtree of the binary tree: the left child follows its parent.
pub(crate) struct BinaryNode {
    pub bounds: QuadBox,
    /// The right child, or zero for a leaf.
    pub right: u32,
    /// The references: first and count.
    pub first: u32,
    pub count: u32,
    /// How many of them are no triangles.
    pub others: u32,
}

/// A binary tree over references, each named by geometry and primitive index, in depth-first order.
#[derive(Default)]
pub(crate) struct Binary {
    pub nodes: Vec<BinaryNode>,
    pub names: Vec<(u32, u32)>,
}

/// What is cheapest for a subtree.
#[derive(Clone, Copy)]
struct Best {
    /// C(n, i + 1).
    cost: [f32; WIDTH - 1],
    /// Forests of i + 1 trees: how many go to the left child; zero where fewer trees are cheaper.
    left: [u8; WIDTH],
    is_leaf: bool,
}

/// The wide tree of a part.
pub(crate) fn collapse(binary: &mut Binary, others_at_once: u32) -> (Part, ChildRef) {
    let mut best = vec![Best { cost: [0.0; WIDTH - 1], left: [0; WIDTH], is_leaf: true }; binary.nodes.len()];
    for (i, node) in binary.nodes.iter().enumerate().rev() {
        best[i] = if node.right == 0 {
            Best { cost: [leaf_cost(node, others_at_once); WIDTH - 1], ..best[i] }
        } else {
            let children = [&best[i + 1].cost, &best[node.right as usize].cost];
            cheapest(node, leaf_cost(node, others_at_once), children)
        };
    }
    // Most leaves keep their block.
    let blocks = Vec::with_capacity(binary.nodes.len() / 2 + 1);
    let part = Part { blocks, ..Part::default() };
    let mut emission = Emission { others_at_once, binary, best: &best, part };
    let root = emission.child(0);
    emission.fill_up(0);
    (emission.part, root)
}

/// Infinite where the references do not fit into one leaf.
fn leaf_cost(node: &BinaryNode, others_at_once: u32) -> f32 {
    let most = ChildRef::MAX_ITEMS as u32;
    let tests = match node.others {
        0 => node.count.div_ceil(WIDTH as u32),
        others if others == node.count && others <= most => others.div_ceil(others_at_once),
        _ => u32::MAX,
    };
    if tests <= most { node.bounds.half_area() * tests as f32 } else { f32::INFINITY }
}

fn cheapest(node: &BinaryNode, leaf: f32, [left, right]: [&[f32; WIDTH - 1]; 2]) -> Best {
    let mut best = Best { cost: [0.0; WIDTH - 1], left: [0; WIDTH], is_leaf: false };
    // D(n, i + 1) and the share of the left child.
    let divided = |i: usize| {
        (1..=i)
            .map(|k| (left[k - 1] + right[i - k], k as u8))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .expect("i > 0")
    };
    let (cost, share) = divided(WIDTH - 1);
    best.left[WIDTH - 1] = share;
    let inner = cost + NODE_COST * node.bounds.half_area();
    best.is_leaf = leaf <= inner;
    best.cost[0] = leaf.min(inner);
    for i in 1..WIDTH - 1 {
        let (cost, share) = divided(i);
        if cost < best.cost[i - 1] {
            (best.cost[i], best.left[i]) = (cost, share);
        } else {
            best.cost[i] = best.cost[i - 1];
        }
    }
    best
}

struct Emission<'a> {
    others_at_once: u32,
    binary: &'a mut Binary,
    best: &'a [Best],
    part: Part,
}

impl Emission<'_> {
    fn child(&mut self, n: usize) -> ChildRef {
        if self.best[n].is_leaf {
            return self.leaf(n);
        }
        let index = self.part.nodes.len();
        self.part.nodes.push(Node::EMPTY);
        let mut children = Vec::with_capacity(WIDTH);
        self.gather(n, WIDTH, &mut children);
        let area = |n: usize| self.binary.nodes[n].bounds.half_area();
        children.sort_by(|&a, &b| area(b).total_cmp(&area(a)));
        let mut node = Node::EMPTY;
        for (slot, c) in children.into_iter().enumerate() {
            let bounds = self.binary.nodes[c].bounds.to_bounds();
            node.set(slot, &bounds, self.child(c));
        }
        self.part.nodes[index] = node;
        ChildRef::inner(index)
    }

    /// The roots of the cheapest forest of at most `trees` trees.
    fn gather(&self, n: usize, trees: usize, out: &mut Vec<usize>) {
        if trees == 1 {
            return out.push(n);
        }
        match usize::from(self.best[n].left[trees - 1]) {
            0 => self.gather(n, trees - 1, out),
            left => {
                self.gather(n + 1, left, out);
                self.gather(self.binary.nodes[n].right as usize, trees - left, out);
            }
        }
    }

    /// Begins another row of eight others, where the last one has no room for some more; what is tested at once lies in one.
    fn fill_up(&mut self, more: usize) {
        let (row, others) = (self.others_at_once as usize, &mut self.part.others);
        let used = others.len() % row;
        if used != 0 && (more == 0 || used + more > row) && row > 1 {
            others.resize(others.len() + row - used, NO_OTHER);
        }
    }

    fn leaf(&mut self, n: usize) -> ChildRef {
        let BinaryNode { first, count, others, .. } = self.binary.nodes[n];
        let range = first as usize..(first + count) as usize;
        let names = &mut self.binary.names[range.clone()];
        names.sort_unstable();
        if others != 0 {
            let needed = names.len();
            self.fill_up(needed);
            let first = self.part.others.len();
            let names = &self.binary.names[range];
            self.part.others.extend(names.iter().map(|(_, primitive)| primitive));
            return ChildRef::others(first, names.len());
        }
        let first = self.part.blocks.len();
        self.part.blocks.push(BlockNames::NONE);
        for (i, &name) in names.iter().enumerate() {
            if i > 0 && names[i - 1] == name {
                continue;
            }
            if self.part.blocks.last().is_none_or(|block| block.count == WIDTH) {
                self.part.blocks.push(BlockNames::NONE);
            }
            if let Some(block) = self.part.blocks.last_mut() {
                block.names[block.count] = name;
                block.count += 1;
            }
        }
        ChildRef::triangles(first, self.part.blocks.len() - first)
    }
}
