//! The walk itself.

use std::ops::Range;

use lichtweg_montecarlo::{Sampler, SamplerKind};
use rayon::prelude::*;

use super::{Kernel, Tally};

/// What a walk scores; see [the module](super).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Score {
    /// Where it ends, over the probability to end there.
    Terminal,
    /// Wherever it is.
    #[default]
    Collision,
    /// Wherever it is, what the next state will score on average.
    Expected,
}

/// When a walk ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ending {
    /// With p*_i = 1 - min(1, m_i): what the row lacks to 1, as particles are absorbed. Weights keep their magnitude where
    /// rows sum to at most one.
    Analog,
    /// With the same p* in every state.
    Constant(f64),
    /// Never by itself: weights shrink with the rows, and are kept in a window by roulette and splitting.
    Window(WeightWindow),
}

/// Weights relative to the start: below `low` a walk plays roulette to survive with `survival`, above `high` it is split
/// into walks of about `survival`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightWindow {
    /// Smallest weight that goes on unasked.
    pub low: f64,
    /// Weight of survivors; between the two others.
    pub survival: f64,
    /// Largest weight that is not split.
    pub high: f64,
}

impl Default for WeightWindow {
    fn default() -> Self {
        Self { low: 0.1, survival: 0.2, high: 2.0 }
    }
}

/// Where walks are created: in each state in proportion to the magnitude of a vector there.
#[derive(Clone, Debug)]
pub struct Start {
    states: Vec<u32>,
    values: Vec<f64>,
    /// Sums of magnitudes up to each entry. Searched rather than aliased: a table is used for few walks, and has to be
    /// monotone for stratified numbers.
    cumulative: Vec<f64>,
}

impl Start {
    /// In one state.
    #[must_use]
    pub fn state(i: usize) -> Self {
        Self { states: vec![i as u32], values: vec![1.0], cumulative: vec![1.0] }
    }

    /// By a vector (state, s_i); zeros are never drawn. `None` where all are zero.
    ///
    /// # Errors
    /// Magnitudes whose sum is not finite.
    pub fn by(entries: impl IntoIterator<Item = (usize, f64)>) -> Result<Option<Self>, WalkError> {
        let mut sum = 0.0;
        let mut start = Self { states: Vec::new(), values: Vec::new(), cumulative: Vec::new() };
        for (i, value) in entries.into_iter().filter(|&(_, value)| value != 0.0) {
            sum += value.abs();
            start.states.push(i as u32);
            start.values.push(value);
            start.cumulative.push(sum);
        }
        match sum {
            _ if start.states.is_empty() => Ok(None),
            sum if sum.is_finite() => Ok(Some(start)),
            _ => Err(WalkError::Overflow),
        }
    }

    /// States where walks are created.
    pub(crate) fn states(&self) -> impl Iterator<Item = usize> + '_ {
        self.states.iter().map(|&i| i as usize)
    }

    /// Each element times that of `factors` at its state; `None` where that is not finite or zero everywhere.
    pub(crate) fn scaled(&self, factors: &[f64]) -> Option<Self> {
        let scaled =
            self.states.iter().zip(&self.values).map(|(&i, value)| (i as usize, value * factors[i as usize]));
        Self::by(scaled).ok().flatten()
    }

    /// Sum of the magnitudes.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    /// A state and s_i / p0_i there.
    #[inline]
    pub(crate) fn draw(&self, sampler: &mut Sampler) -> (usize, f64) {
        let [state] = self.states[..] else {
            let mass = self.mass();
            let sought = sampler.next_1d_f64() * mass;
            // Rounding must not lead past the end.
            let at = self.cumulative.partition_point(|&sum| sum <= sought).min(self.states.len() - 1);
            return (self.states[at] as usize, mass.copysign(self.values[at]));
        };
        (state as usize, self.values[0])
    }
}

/// Why walks gave no number.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WalkError {
    /// Terminal scores need an end in each state that scores.
    #[error(
        "no walk ends in state {state} (from 0), so that terminal scores miss what it has: take collision or expected-value scores"
    )]
    NoEnd {
        /// The state.
        state: usize,
    },
    /// Walks that go on without end.
    #[error("a walk did not end within {steps} steps")]
    Endless {
        /// Steps that were allowed.
        steps: u64,
    },
    /// Weights that overflow.
    #[error("weights of walks overflow: the variance is infinite")]
    Overflow,
}

/// Walks from a start on a kernel to a score vector.
#[derive(Clone, Debug)]
pub struct Walker<'a> {
    kernel: &'a Kernel<'a>,
    start: &'a Start,
    score: &'a [f64],
    how: Score,
    ending: Ending,
    /// Keeps contributions by length.
    lengths: bool,
}

/// Walks of one task: fixed, so that results do not depend on the number of threads.
const CHUNK: u64 = 128;
/// Chunks whose tallies are kept at a time.
const GROUP: usize = 1 << 14;
/// A walk that takes more steps than this will not end in anyone's lifetime.
const ENDLESS: u64 = 1 << 24;
/// Walks that wait after splitting, at most; beyond, weights are left above the window.
const MOST_SPLIT: usize = 1 << 10;

impl<'a> Walker<'a> {
    /// Walks that score `how` and end by `ending`.
    ///
    /// # Errors
    /// Terminal scores where a state scores that no walk ends in, or with a weight window.
    pub fn new(
        kernel: &'a Kernel<'a>,
        start: &'a Start,
        score: &'a [f64],
        how: Score,
        ending: Ending,
    ) -> Result<Self, WalkError> {
        if how == Score::Terminal {
            let ends = |i: usize| match ending {
                Ending::Analog => kernel.mass(i) < 1.0,
                Ending::Constant(p) => p > 0.0 || kernel.matrix().row_len(i) == 0,
                Ending::Window(_) => false,
            };
            if let Some(state) = (0..score.len()).into_par_iter().find_first(|&i| score[i] != 0.0 && !ends(i))
            {
                return Err(WalkError::NoEnd { state });
            }
        }
        Ok(Self { kernel, start, score, how, ending, lengths: false })
    }

    /// The same, keeping contributions by length ([`Tally::by_length`]): the terms of the Neumann series.
    #[must_use]
    pub fn with_lengths(self) -> Self {
        Self { lengths: true, ..self }
    }

    /// Walks number `first` to `first + count` under a seed. Any cut into ranges gives the same walks; the sums are the
    /// same bits for any number of threads.
    ///
    /// # Errors
    /// A walk that does not end, or whose weight overflows.
    pub fn tally(&self, seed: u64, first: u64, count: u64) -> Result<Tally, WalkError> {
        let sampler = |walk: u64| Sampler::new(SamplerKind::Independent, seed, walk >> 32, walk as u32);
        self.tally_with(first, count, sampler)
    }

    pub(super) fn tally_with(
        &self,
        first: u64,
        count: u64,
        sampler: impl Fn(u64) -> Sampler + Sync,
    ) -> Result<Tally, WalkError> {
        let chunk = |walks: Range<u64>| -> Result<Tally, WalkError> {
            let mut tally = Tally::default();
            let mut waiting = Vec::new();
            for walk in walks {
                let mut score = 0.0;
                let steps = self.follow(sampler(walk), &mut waiting, |state, weight, length| {
                    let contribution = weight * self.score[state];
                    score += contribution;
                    if self.lengths && contribution != 0.0 {
                        tally.push_contribution(length, contribution);
                    }
                })?;
                if !score.is_finite() {
                    return Err(WalkError::Overflow);
                }
                tally.push(score, steps);
            }
            Ok(tally)
        };
        let mut sum = Tally::default();
        in_order(first, count, GROUP, chunk, |tally| sum.merge(&tally))?;
        Ok(sum)
    }

    /// One walk, with all that it is split into. `score(state, weight, length)` is told of each state that scores, with the
    /// factor of its score and the transitions before it. Number of transitions.
    #[inline]
    pub(super) fn follow(
        &self,
        mut sampler: Sampler,
        waiting: &mut Vec<Particle>,
        mut score: impl FnMut(usize, f64, u64),
    ) -> Result<u64, WalkError> {
        let (state, start_weight) = self.start.draw(&mut sampler);
        let mut steps = 0;
        if self.how == Score::Expected {
            score(state, start_weight, 0);
        }
        waiting.clear();
        waiting.push(Particle { state, weight: 1.0, length: 0 });
        while let Some(mut particle) = waiting.pop() {
            loop {
                let weight = start_weight * particle.weight;
                match self.how {
                    Score::Terminal => {}
                    Score::Collision => score(particle.state, weight, particle.length),
                    Score::Expected => {
                        let row = self.kernel.matrix().row(particle.state);
                        row.iter().for_each(|(j, value)| score(j, weight * value, particle.length + 1));
                    }
                }
                match self.advance(particle, &mut sampler, waiting) {
                    Next::Goes(next) => particle = next,
                    Next::Ended { probability } => {
                        if self.how == Score::Terminal {
                            score(particle.state, weight / probability, particle.length);
                        }
                        break;
                    }
                    Next::Lost => break,
                }
                steps += 1;
                if steps > ENDLESS {
                    return Err(WalkError::Endless { steps: ENDLESS });
                }
            }
        }
        Ok(steps)
    }

    /// Ends the walk, or takes a step.
    #[inline]
    fn advance(&self, particle: Particle, sampler: &mut Sampler, waiting: &mut Vec<Particle>) -> Next {
        let Particle { state, weight, length } = particle;
        let mass = self.kernel.mass(state);
        if mass == 0.0 {
            return Next::Ended { probability: 1.0 };
        }
        let survival = match self.ending {
            Ending::Analog => mass.min(1.0),
            Ending::Constant(probability) => 1.0 - probability,
            Ending::Window(_) => 1.0,
        };
        let u = sampler.next_1d_f64();
        if u >= survival {
            return Next::Ended { probability: 1.0 - survival };
        }
        // What is left of the number is uniform again.
        let step = self.kernel.step(state, mass, u / survival);
        let mut next =
            Particle { state: step.state, weight: weight * (step.factor / survival), length: length + 1 };
        if let Ending::Window(window) = self.ending {
            let magnitude = next.weight.abs();
            if magnitude < window.low {
                if sampler.next_1d_f64() * window.survival >= magnitude {
                    return Next::Lost;
                }
                next.weight = window.survival.copysign(next.weight);
            } else if magnitude > window.high && waiting.len() < MOST_SPLIT {
                let parts = (magnitude / window.survival).ceil().min(64.0);
                next.weight /= parts;
                waiting.extend(std::iter::repeat_n(next, parts as usize - 1));
            }
        }
        Next::Goes(next)
    }
}

/// A walk under way; its weight is relative to the start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Particle {
    state: usize,
    weight: f64,
    length: u64,
}

enum Next {
    Goes(Particle),
    Ended { probability: f64 },
    Lost,
}

/// Runs chunks of walks in parallel, and hands what they give over in the order of the walks. `group` chunks at a time, so
/// that what waits fits into memory.
pub(super) fn in_order<T: Send>(
    first: u64,
    count: u64,
    group: usize,
    chunk: impl Fn(Range<u64>) -> Result<T, WalkError> + Sync,
    mut take: impl FnMut(T),
) -> Result<(), WalkError> {
    let chunks = count.div_ceil(CHUNK);
    let walks = |chunk: u64| first + chunk * CHUNK..first + count.min((chunk + 1) * CHUNK);
    if chunks == 1 {
        // To wake other threads would take longer.
        take(chunk(walks(0))?);
        return Ok(());
    }
    for start in (0..chunks).step_by(group) {
        let range = start..chunks.min(start + group as u64);
        let found: Result<Vec<T>, WalkError> = range.into_par_iter().map(|c| chunk(walks(c))).collect();
        found?.into_iter().for_each(&mut take);
    }
    Ok(())
}
