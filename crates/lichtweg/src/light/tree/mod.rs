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

use node::{Node, WIDTH};

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
    u: f64,
    probability: f32,
}

impl Descent {
    fn new(u: f64) -> Self {
        Self { node: 0, u, probability: 1.0 }
    }
}

enum Step {
    Down(Descent),
    /// A leaf and its probability, or nothing that can shine on the receiver.
    End(Option<(u32, f32)>),
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
    pub fn sample(&self, to: &Receiver, u: f64) -> Option<(u32, f32)> {
        let mut at = Descent::new(u);
        loop {
            match self.step(at, to) {
                Step::Down(below) => at = below,
                Step::End(end) => return end,
            }
        }
    }

    /// The same for some receivers at a time, level by level: what they wait for from memory, they wait for together.
    #[inline(always)]
    pub fn sample_many<const N: usize>(
        &self,
        to: &[Receiver; N],
        u: &[Option<f64>; N],
    ) -> [Option<(u32, f32)>; N] {
        let mut ends = [None; N];
        let mut walks = u.map(|u| u.map(Descent::new));
        while walks.iter().any(Option::is_some) {
            for ((walk, to), end) in walks.iter_mut().zip(to).zip(&mut ends) {
                let Some(at) = *walk else { continue };
                *walk = match self.step(at, to) {
                    Step::Down(below) => Some(below),
                    Step::End(leaf) => {
                        *end = leaf;
                        None
                    }
                };
            }
            let touched =
                walks.iter().flatten().fold(0, |all, at| all ^ self.nodes[at.node as usize].touch());
            std::hint::black_box(touched);
        }
        ends
    }

    #[inline(always)]
    fn step(&self, at: Descent, to: &Receiver) -> Step {
        let Some(node) = self.nodes.get(at.node as usize) else { return Step::End(None) };
        let importances = node.importances(to);
        let mut sums = importances;
        for i in 1..WIDTH {
            sums[i] += sums[i - 1];
        }
        let total = sums[WIDTH - 1];
        if total <= 0.0 {
            return Step::End(None);
        }
        let target = at.u * f64::from(total);
        let slot = sums[..WIDTH - 1].iter().map(|&sum| usize::from(f64::from(sum) <= target)).sum::<usize>();
        let probability = at.probability * (importances[slot] / total);
        match node.child(slot).resolve() {
            Ok(leaf) => Step::End(Some((leaf, probability))),
            Err(node) => {
                let low = if slot == 0 { 0.0 } else { f64::from(sums[slot - 1]) };
                // Below one, but for rounding.
                let u = ((target - low) / (f64::from(sums[slot]) - low)).min(1.0 - f64::EPSILON);
                Step::Down(Descent { node, u, probability })
            }
        }
    }

    /// Probability that [`LightTree::sample`] chooses a leaf.
    #[inline]
    pub fn probability(&self, to: &Receiver, leaf: u32) -> f32 {
        let mut place = self.places[leaf as usize];
        if place == Node::NO_PLACE {
            return 0.0;
        }
        let mut probability = 1.0;
        while place != Node::NO_PLACE {
            let node = &self.nodes[place as usize / WIDTH];
            let importances = node.importances(to);
            let total: f32 = importances.iter().sum();
            if total <= 0.0 {
                return 0.0;
            }
            probability *= importances[place as usize % WIDTH] / total;
            place = node.parent;
        }
        probability
    }
}

#[cfg(test)]
mod tests;
