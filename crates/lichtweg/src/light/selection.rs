//! Which light to connect to, and which one a walk begins at.

use lichtweg_montecarlo::distribution::AliasTable;
use lichtweg_ray::math::Vec3;

use super::tree::{LightBounds, LightTree};

/// Chooses lights.
///
/// A few are chosen by power, mixed with the uniform choice: power says nothing of distance and occlusion, and a light that
/// matters near by must not be starved by a strong one far away. Of many, those at a finite place are chosen by a [`LightTree`], and
/// count as one among those infinitely far.
#[derive(Debug)]
pub struct LightSelection {
    table: Option<AliasTable>,
    tree: Option<Tree>,
    /// By power alone: where walks from the lights begin.
    by_power: Option<AliasTable>,
}

#[derive(Debug)]
struct Tree {
    lights: LightTree,
    /// The number that stands for it in the table, after those of all lights.
    entry: u32,
    /// Probability that it is asked.
    probability: f32,
}

/// Share of the uniform choice.
const UNIFORM_SHARE: f64 = 0.5;

/// Lights at finite places that are worth a tree.
const MANY: usize = 16;

impl LightSelection {
    /// From the power of each light, and what is known of the place of those that have one; lights without power are never chosen.
    pub fn new(powers: &[f32], bounds: &[Option<LightBounds>]) -> Self {
        let by_power = AliasTable::new(powers).ok();
        let placed: Vec<(u32, LightBounds)> = (0..)
            .zip(bounds)
            .filter_map(|(i, bounds)| bounds.filter(|b| b.power > 0.0).map(|b| (i, b)))
            .collect();
        if placed.len() < MANY {
            return Self { table: mixed(powers), tree: None, by_power };
        }
        let in_tree: f32 = placed.iter().map(|(_, b)| b.power).sum();
        let outside = powers.iter().zip(bounds).map(|(&p, b)| if b.is_some() { 0.0 } else { p });
        let choices: Vec<f32> = outside.chain([in_tree]).collect();
        let table = mixed(&choices);
        let entry = powers.len() as u32;
        let probability = table.as_ref().map_or(0.0, |t| t.pmf(entry as usize));
        let tree = Tree { lights: LightTree::new(placed, powers.len()), entry, probability };
        Self { table, tree: Some(tree), by_power }
    }

    /// A light for a point, and the probability of its choice; `None` where there is none that can shine on it.
    #[inline]
    pub fn sample(&self, from: Vec3, u: f32) -> Option<(u32, f32)> {
        let pick = self.table.as_ref()?.sample(u);
        match &self.tree {
            Some(tree) if pick.index as u32 == tree.entry => {
                let (light, probability) = tree.lights.sample(from, pick.remapped)?;
                Some((light, tree.probability * probability))
            }
            _ => Some((pick.index as u32, pick.pmf)),
        }
    }

    /// Probability that [`LightSelection::sample`] chooses a light for a point.
    #[inline]
    pub fn probability(&self, from: Vec3, light: u32) -> f32 {
        let pmf = self.table.as_ref().map_or(0.0, |t| t.pmf(light as usize));
        match &self.tree {
            // Lights of the tree have no entry of their own.
            Some(tree) if pmf == 0.0 => tree.probability * tree.lights.probability(from, light),
            _ => pmf,
        }
    }

    /// A light for a walk to begin at, chosen by power, and the probability of its choice.
    #[inline]
    pub fn sample_emitter(&self, u: f64) -> Option<(u32, f32)> {
        let pick = self.by_power.as_ref()?.sample_f64(u);
        Some((pick.index as u32, pick.pmf))
    }

    /// Probability that [`LightSelection::sample_emitter`] chooses a light.
    #[inline]
    pub fn emitter_probability(&self, light: u32) -> f32 {
        self.by_power.as_ref().map_or(0.0, |t| t.pmf(light as usize))
    }
}

/// By power and uniformly, in the shares above.
fn mixed(powers: &[f32]) -> Option<AliasTable> {
    let total: f64 = powers.iter().map(|&p| f64::from(p)).sum();
    let lit = powers.iter().filter(|&&p| p > 0.0).count() as f64;
    let weight = |p: f32| match p > 0.0 {
        true => (1.0 - UNIFORM_SHARE) * f64::from(p) / total + UNIFORM_SHARE / lit,
        false => 0.0,
    };
    let weights: Vec<f64> = powers.iter().map(|&p| weight(p)).collect();
    AliasTable::new(&weights).ok()
}
