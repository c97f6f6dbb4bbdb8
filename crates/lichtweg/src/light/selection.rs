//! Which light to connect to.

use lichtweg_montecarlo::distribution::AliasTable;

/// Chooses lights by power, mixed with the uniform choice: power says nothing of distance and occlusion, and a light that
/// matters near by must not be starved by a strong one far away.
#[derive(Debug)]
pub struct LightSelection {
    table: Option<AliasTable>,
    /// By power alone: where walks from the lights begin.
    by_power: Option<AliasTable>,
}

/// Share of the uniform choice.
const UNIFORM_SHARE: f64 = 0.5;

impl LightSelection {
    /// From the power of each light; lights without power are never chosen.
    pub fn new(powers: &[f32]) -> Self {
        let total: f64 = powers.iter().map(|&p| f64::from(p)).sum();
        let lit = powers.iter().filter(|&&p| p > 0.0).count() as f64;
        let weight = |p: f32| match p > 0.0 {
            true => (1.0 - UNIFORM_SHARE) * f64::from(p) / total + UNIFORM_SHARE / lit,
            false => 0.0,
        };
        let weights: Vec<f64> = powers.iter().map(|&p| weight(p)).collect();
        Self { table: AliasTable::new(&weights).ok(), by_power: AliasTable::new(powers).ok() }
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

    /// A light, the probability of its choice, and what is left of the random number; `None` where there is no light.
    #[inline]
    pub fn sample(&self, u: f32) -> Option<(u32, f32, f32)> {
        let pick = self.table.as_ref()?.sample(u);
        Some((pick.index as u32, pick.pmf, pick.remapped))
    }

    /// Probability that [`LightSelection::sample`] chooses a light.
    #[inline]
    pub fn probability(&self, light: u32) -> f32 {
        self.table.as_ref().map_or(0.0, |t| t.pmf(light as usize))
    }
}
