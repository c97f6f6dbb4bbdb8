//! A tree of lights: chooses one of many by what it may give to a receiver (Conty Estevez and Kulla 2018, "Importance Sampling of
//! Many Lights with Adaptive Tree Splitting", without the splitting; compare Pharr, Jakob and Humphreys 2023, section 12.6.3).
//!
//! Every node bounds the places of its lights by a sphere, and the directions in which they shine by a cone. A walk goes down from
//! the root by a single random number, and takes each child in proportion to a bound on what it gives ([`node`]). The probability
//! of a leaf is found on the way back up.
//!
//! Limits: the bound knows nothing of occlusion.

mod bounds;
mod build;
mod node;

pub use bounds::LightBounds;
pub use node::Receiver;

use lichtweg_ray::math::Vec3;
use lichtweg_ray::wide::{Double, Float, FloatLanes, LANES, Lanes, Mask, Wide, Word, WordLanes};

use crate::lanes::{BELOW_ONE, lanes_of};
use node::{Child, Node, WIDTH};

/// A tree over leaves that have numbers.
#[derive(Debug)]
pub(super) struct LightTree {
    nodes: Vec<Node>,
    /// Where each leaf is; [`Node::NO_PLACE`] where it is not in the tree.
    places: Vec<u32>,
}

/// On the way from the root to a leaf.
#[derive(Clone, Copy)]
struct Descent {
    node: u32,
    /// What is left of the random number.
    u: f32,
    probability: f32,
}

impl Descent {
    fn new(u: f32) -> Self {
        Self { node: 0, u, probability: 1.0 }
    }
}

enum Step {
    Down(Descent),
    /// A leaf and its probability, or nothing that can shine on the receiver.
    End(Option<(u32, f32)>),
}

impl Step {
    #[inline(always)]
    fn to(child: Child, probability: f32, u: f32) -> Self {
        match child.resolve() {
            Ok(leaf) => Self::End(Some((leaf, probability))),
            Err(node) => Self::Down(Descent { node, u, probability }),
        }
    }
}

/// A slot of a node, chosen in proportion to numbers.
struct Pick<F: Float> {
    /// Whether any of them is positive.
    valid: F::Mask,
    slot: F::Bits,
    probability: F,
    /// What is left of the random number.
    rest: F,
}

impl<F: Float> Pick<F> {
    #[inline(always)]
    fn new(importances: &[F; WIDTH], u: F) -> Self {
        let zero = F::splat(0.0);
        let mut sums = *importances;
        for i in 1..WIDTH {
            sums[i] = sums[i - 1] + sums[i];
        }
        let total = sums[WIDTH - 1];
        // In single precision the product could be the whole total.
        let target = u.widen() * total.widen();
        let (mut slot, mut own) = (F::Bits::splat(0), importances[0]);
        let (mut low, mut high) = (zero, sums[0]);
        for i in 1..WIDTH {
            let past = sums[i - 1].widen().le(target);
            slot = F::Bits::splat(i as u32).select(past, slot);
            own = importances[i].select(past, own);
            low = sums[i - 1].select(past, low);
            high = sums[i].select(past, high);
        }
        let low = low.widen();
        let rest = ((target - low) / (high.widen() - low)).narrow();
        Self { valid: zero.lt(total), slot, probability: own / total, rest: rest.min(F::splat(BELOW_ONE)) }
    }
}

impl LightTree {
    /// Over leaves by their number; those that are dark are left out.
    pub fn new(leaves: &[LightBounds]) -> Self {
        let brightest = leaves.iter().map(|b| b.intensity).fold(0.0, f32::max);
        let lit = leaves.iter().filter(|b| b.intensity > 0.0).count();
        // Relative to each other, so that sums of them are at most 1.
        let scale = |b: &LightBounds| (b.intensity / brightest / lit as f32).max(f32::MIN_POSITIVE);
        let mut items: Vec<build::Item> = (0..)
            .zip(leaves)
            .filter(|(_, b)| b.intensity > 0.0)
            .map(|(i, b)| (i, LightBounds { intensity: scale(b), ..*b }))
            .collect();
        let mut places = vec![Node::NO_PLACE; leaves.len()];
        Self { nodes: build::build(&mut items, &mut places), places }
    }

    /// A leaf for a receiver by a uniform number, and the probability of its choice; `None` where none can shine on it.
    #[inline]
    pub fn sample(&self, to: &Receiver, u: f32) -> Option<(u32, f32)> {
        let mut at = Descent::new(u);
        loop {
            match self.step(at, to) {
                Step::Down(below) => at = below,
                Step::End(end) => return end,
            }
        }
    }

    /// What each slot of the root may give to sixteen receivers.
    #[inline(always)]
    pub fn root_importances<W: Wide>(&self, to: &Receiver<W::F32>) -> [W::F32; WIDTH] {
        self.nodes[0].importances_each(to)
    }

    /// [`LightTree::sample`] for some of sixteen receivers: from the root, whose importances are given, in lanes, and then level by
    /// level; what they wait for from memory, they wait for together.
    #[inline(always)]
    pub fn sample_lanes<W: Wide>(
        &self,
        root_importances: &[W::F32; WIDTH],
        to: &Receiver<W::F32>,
        u: W::F32,
        lanes: u32,
    ) -> [Option<(u32, f32)>; LANES] {
        let mut ends = [None; LANES];
        let root = &self.nodes[0];
        let pick = Pick::new(root_importances, u);
        let (slot, probability, rest) =
            (pick.slot.to_lanes(), pick.probability.to_lanes(), pick.rest.to_lanes());
        let mut walks = [None; LANES];
        for lane in lanes_of(lanes & pick.valid.bits()) {
            let (child, probability) = (root.child(slot.0[lane] as usize), probability.0[lane]);
            match Step::to(child, probability, rest.0[lane]) {
                Step::Down(below) => walks[lane] = Some(below),
                Step::End(leaf) => ends[lane] = leaf,
            }
        }
        if walks.iter().any(Option::is_some) {
            self.descend_together(&to.to_singles(), &mut walks, &mut ends);
        }
        ends
    }

    #[inline(always)]
    fn descend_together(
        &self,
        to: &[Receiver; LANES],
        walks: &mut [Option<Descent>; LANES],
        ends: &mut [Option<(u32, f32)>; LANES],
    ) {
        while walks.iter().any(Option::is_some) {
            let touched =
                walks.iter().flatten().fold(0, |all, at| all ^ self.nodes[at.node as usize].touch());
            std::hint::black_box(touched);
            for ((walk, to), end) in walks.iter_mut().zip(to).zip(ends.iter_mut()) {
                let Some(at) = *walk else { continue };
                *walk = match self.step(at, to) {
                    Step::Down(below) => Some(below),
                    Step::End(leaf) => {
                        *end = leaf;
                        None
                    }
                };
            }
        }
    }

    #[inline(always)]
    fn step(&self, at: Descent, to: &Receiver) -> Step {
        let Some(node) = self.nodes.get(at.node as usize) else { return Step::End(None) };
        let pick = Pick::new(&node.importances(to), at.u);
        if !pick.valid {
            return Step::End(None);
        }
        Step::to(node.child(pick.slot as usize), at.probability * pick.probability, pick.rest)
    }

    /// Probability that [`LightTree::sample`] chooses a leaf.
    #[inline]
    pub fn probability(&self, to: &Receiver, leaf: u32) -> f32 {
        let Some((slot, below)) = self.climb(to, leaf) else { return 0.0 };
        below * share(&self.nodes[0].importances(to), slot as u32)
    }

    /// The same for some of sixteen receivers and leaves, the root in lanes; 0 for others.
    #[inline(always)]
    pub fn probability_lanes<W: Wide>(
        &self,
        root_importances: &[W::F32; WIDTH],
        to: &Receiver<W::F32>,
        leaves: &Lanes<u32>,
        lanes: u32,
    ) -> W::F32 {
        let (mut slots, mut below) = (Lanes::splat(0), Lanes::splat(0.0));
        let singles = (!self.is_shallow()).then(|| to.to_singles());
        for lane in lanes_of(lanes) {
            let to = singles.as_ref().map_or(Receiver::open(Vec3::ZERO), |singles| singles[lane]);
            let Some((slot, probability)) = self.climb(&to, leaves.0[lane]) else { continue };
            (slots.0[lane], below.0[lane]) = (slot as u32, probability);
        }
        W::F32::load(&below) * share(root_importances, W::U32::load(&slots))
    }

    /// Whether the root is all there is, and climbing to it asks nothing of a receiver.
    #[inline(always)]
    fn is_shallow(&self) -> bool {
        self.nodes.len() == 1
    }

    /// The slot of the root that a leaf is below, and the probability of the way from there to the leaf.
    #[inline(always)]
    fn climb(&self, to: &Receiver, leaf: u32) -> Option<(usize, f32)> {
        let mut place = self.places[leaf as usize];
        if place == Node::NO_PLACE {
            return None;
        }
        let mut probability = 1.0;
        loop {
            let (number, slot) = (place as usize / WIDTH, place as usize % WIDTH);
            if number == 0 {
                return Some((slot, probability));
            }
            let node = &self.nodes[number];
            probability *= share(&node.importances(to), slot as u32);
            place = node.parent;
        }
    }
}

/// One of a node's importances over their sum.
#[inline(always)]
fn share<F: Float>(importances: &[F; WIDTH], slot: F::Bits) -> F {
    let (zero, mut own, mut total) = (F::splat(0.0), importances[0], importances[0]);
    for (i, &importance) in (0..).zip(importances).skip(1) {
        own = importance.select(slot.equal(F::Bits::splat(i)), own);
        total = total + importance;
    }
    (own / total).select(zero.lt(total), zero)
}

#[cfg(test)]
mod tests;
