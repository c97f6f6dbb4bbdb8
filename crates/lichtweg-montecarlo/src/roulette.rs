//! Russian roulette: ends walks that carry little without bias (Arvo and Kirk, *Particle transport and image
//! synthesis*, 1990).
//!
//! A walk survives with probability q and, if it does, its throughput is divided by q: the mean is unchanged,
//! E = q * (x / q) + (1 - q) * 0.

/// When and how hard to play: nothing before `start_depth` edges, then survival by throughput.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roulette {
    /// First path depth (edges so far) at which the game is played.
    pub start_depth: u32,
    /// Upper bound of the survival probability, in (0,1]; below 1 it ends even walks that lose nothing.
    pub max_survival: f32,
}

impl Default for Roulette {
    /// From the fifth edge on, and nearly by throughput alone. A bound well below 1 would multiply the second moment of the
    /// throughput by albedo^2 / bound at every edge, which diverges in bright enclosures; this one still ends walks where
    /// nothing is ever absorbed.
    fn default() -> Self {
        Self { start_depth: 5, max_survival: 0.999 }
    }
}

impl Roulette {
    /// Never ends a walk.
    pub const OFF: Self = Self { start_depth: u32::MAX, max_survival: 1.0 };

    /// Probability that a walk of `depth` edges goes on, in `[0,1]`. **The caller divides its throughput by it.**
    ///
    /// `throughput_max` is the largest lane of the path throughput, relative to one at the start of the walk (and
    /// without the eta^2 of refraction, which a later refraction undoes). A throughput that is zero or NaN gives 0:
    /// end the walk without dividing.
    #[inline]
    #[must_use]
    pub fn survival_probability(&self, depth: u32, throughput_max: f32) -> f32 {
        if depth < self.start_depth {
            return 1.0;
        }
        // `max` drops a NaN.
        throughput_max.max(0.0).min(self.max_survival)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Moments, Sampler, SamplerKind};

    /// A walk that scores 1 at each state and keeps the fraction `albedo`: the sum is 1 / (1 - albedo).
    fn score_of_walk(roulette: Roulette, albedo: f32, divide: bool, sample: u32) -> f64 {
        let mut sampler = Sampler::new(SamplerKind::Independent, 11, 0, sample);
        let (mut throughput, mut score) = (1.0_f32, 0.0);
        for depth in 0..10_000 {
            score += f64::from(throughput);
            throughput *= albedo;
            let survival = roulette.survival_probability(depth, throughput);
            if sampler.next_1d() >= survival {
                break;
            }
            if divide {
                throughput /= survival;
            }
        }
        score
    }

    fn z_of_mean(roulette: Roulette, divide: bool) -> f64 {
        let albedo = 0.7;
        let mut scores = Moments::default();
        (0..200_000).for_each(|i| scores.push(score_of_walk(roulette, albedo, divide, i)));
        (scores.mean() - 1.0 / (1.0 - f64::from(albedo))) / scores.standard_error()
    }

    #[test]
    fn geometric_series_is_unbiased() {
        // Three two-sided z tests at 4 sigma: alpha = 2e-4 together.
        for start_depth in [0, 2, 5] {
            assert!(z_of_mean(Roulette { start_depth, max_survival: 0.9 }, true).abs() < 4.0);
        }
        // Power: a walk that forgets to divide is far off.
        assert!(z_of_mean(Roulette { start_depth: 2, max_survival: 0.9 }, false) < -20.0);
    }

    #[test]
    fn probability_is_bounded() {
        let roulette = Roulette { start_depth: 3, max_survival: 0.9 };
        assert_eq!(roulette.survival_probability(2, 0.1), 1.0);
        assert_eq!(roulette.survival_probability(3, 0.1), 0.1);
        assert_eq!(roulette.survival_probability(3, 7.0), 0.9);
        assert_eq!(roulette.survival_probability(3, f32::NAN), 0.0);
        assert_eq!(Roulette::OFF.survival_probability(1000, 0.0), 1.0);
    }
}
