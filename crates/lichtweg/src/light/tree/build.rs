//! Building a tree of lights: first one of twos, split where the surface area orientation heuristic is least, which then becomes
//! one of eights by opening the worst nodes first.

use lichtweg_ray::math::{Bounds3, Vec3};

use super::bounds::LightBounds;
use super::node::{Child, Node, WIDTH};

/// A leaf's number, and its bounds.
pub(super) type Item = (u32, LightBounds);

/// A node of the tree of twos.
struct Binary {
    bounds: LightBounds,
    below: Below,
}

enum Below {
    Leaf(u32),
    Two(Box<[Binary; 2]>),
}

/// Bins along an axis to choose a split from.
const BINS: usize = 12;

/// Lights whose halves are worth threads of their own.
const PARALLEL: usize = 4096;

/// Levels below which lights are halved, wherever they are, so that no arrangement of them makes a deep tree.
const MAX_UNEVEN_LEVELS: u32 = 48;

/// The nodes of a tree over lights, the root first; none without lights. `places` gets, by the leaf's number, where it is.
pub(super) fn build(items: &mut [Item], places: &mut [u32]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(items.len() / 4 + 1);
    if !items.is_empty() {
        let root = match binary(items, 0) {
            Binary { below: Below::Two(children), .. } => Vec::from(*children),
            leaf => vec![leaf],
        };
        widen(root, Node::NO_PLACE, &mut nodes, places);
    }
    nodes
}

fn binary(items: &mut [Item], level: u32) -> Binary {
    if let [(leaf, bounds)] = items {
        return Binary { bounds: *bounds, below: Below::Leaf(*leaf) };
    }
    let many = items.len() > PARALLEL;
    let middle = if level < MAX_UNEVEN_LEVELS { split(items) } else { items.len() / 2 };
    let (first, second) = items.split_at_mut(middle);
    let (first, second) = if many {
        rayon::join(|| binary(first, level + 1), || binary(second, level + 1))
    } else {
        (binary(first, level + 1), binary(second, level + 1))
    };
    Binary { bounds: first.bounds.union(&second.bounds), below: Below::Two(Box::new([first, second])) }
}

/// Appends the node above some subtrees, and all below it.
fn widen(mut children: Vec<Binary>, place: u32, nodes: &mut Vec<Node>, places: &mut [u32]) -> u32 {
    while children.len() < WIDTH {
        let inner = (0..children.len()).filter(|&i| matches!(children[i].below, Below::Two(_)));
        let cost = |i: &usize| children[*i].bounds.cost();
        let Some(worst) = inner.max_by(|a, b| cost(a).total_cmp(&cost(b))) else { break };
        if let Below::Two(two) = children.swap_remove(worst).below {
            children.extend(*two);
        }
    }
    let index = nodes.len() as u32;
    let bounds: Vec<LightBounds> = children.iter().map(|c| c.bounds).collect();
    nodes.push(Node::new(&bounds, place));
    for (slot, child) in children.into_iter().enumerate() {
        let place = Node::place(index, slot);
        let child = match child.below {
            Below::Leaf(leaf) => {
                places[leaf as usize] = place;
                Child::leaf(leaf)
            }
            Below::Two(two) => Child::node(widen(Vec::from(*two), place, nodes, places)),
        };
        nodes[index as usize].set_child(slot, child);
    }
    index
}

/// Parts lights in two; how many are in the first part.
fn split(items: &mut [Item]) -> usize {
    let centers = Bounds3::of(items.iter().map(|(_, l)| l.bounds.center()));
    let extent = centers.extent();
    let bin_of = |l: &LightBounds, axis: usize| {
        let (low, length) = (component(centers.min, axis), component(extent, axis));
        let at = (component(l.bounds.center(), axis) - low) / length;
        ((at * BINS as f32) as usize).min(BINS - 1)
    };
    let best = (0..3)
        .filter(|&axis| component(extent, axis) > 0.0)
        .filter_map(|axis| {
            let mut bins: [Option<LightBounds>; BINS] = [None; BINS];
            for (_, light) in items.iter() {
                let bin = &mut bins[bin_of(light, axis)];
                *bin = Some(bin.map_or(*light, |b| b.union(light)));
            }
            // Thin boxes ask to be cut across.
            let stretch = extent.max_element() / component(extent, axis);
            let (cost, at) = cheapest_cut(&bins)?;
            Some((cost * stretch, axis, at))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, axis, at)) = best else { return items.len() / 2 };
    let mut middle = 0;
    for i in 0..items.len() {
        if bin_of(&items[i].1, axis) < at {
            items.swap(i, middle);
            middle += 1;
        }
    }
    middle.clamp(1, items.len() - 1)
}

/// The least sum of costs on both sides, and the first bin of the second side.
fn cheapest_cut(bins: &[Option<LightBounds>; BINS]) -> Option<(f32, usize)> {
    let join = |a: Option<LightBounds>, b: Option<LightBounds>| match (a, b) {
        (Some(a), Some(b)) => Some(a.union(&b)),
        (a, b) => a.or(b),
    };
    let mut after = *bins;
    for i in (1..BINS).rev() {
        after[i - 1] = join(after[i - 1], after[i]);
    }
    let mut before = None;
    let mut best: Option<(f32, usize)> = None;
    for at in 1..BINS {
        before = join(before, bins[at - 1]);
        let (Some(a), Some(b)) = (before, after[at]) else { continue };
        let cost = a.cost() + b.cost();
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, at));
        }
    }
    best
}

fn component(v: Vec3, axis: usize) -> f32 {
    v.to_array()[axis]
}
