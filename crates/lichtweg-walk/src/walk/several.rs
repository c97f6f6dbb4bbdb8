//! One set of walks for several functionals: whatever state a walk comes to, it scores for all that weigh it.
//!
//! Forward walks do not know what they are asked for until they score. So m unknowns take the walks of the one that needs the
//! most of them, not m sets. (Adjoint walks begin at the unknown, and serve it alone.)
//!
//! A walk hands over the functionals that it met; that it met no other is made up for in the end, so that a walk costs
//! the same for any number of functionals.

use lichtweg_montecarlo::{Sampler, SamplerKind};

use super::walker::in_order;
use super::{Tally, WalkError, Walker};

/// Functionals by the states that they weigh.
#[derive(Clone, Debug)]
pub struct Targets {
    count: usize,
    /// For each state, its place in `offsets`; 0 for states without weights.
    slot: Vec<u32>,
    offsets: Vec<u32>,
    weights: Vec<(u32, f64)>,
}

/// Chunks of walks whose scores are kept at a time.
const GROUP: usize = 1 << 9;

impl Targets {
    /// From the entries (state, weight) of each functional, on a system of `states`.
    ///
    /// # Panics
    /// When a state is out of range.
    #[must_use]
    pub fn new(states: usize, functionals: &[Vec<(usize, f64)>]) -> Self {
        let mut all: Vec<(usize, u32, f64)> = (0..)
            .zip(functionals)
            .flat_map(|(target, entries)| entries.iter().map(move |&(i, weight)| (i, target, weight)))
            .collect();
        all.sort_by_key(|&(state, target, _)| (state, target));
        let (mut slot, mut offsets) = (vec![0; states], vec![0]);
        for same in all.chunk_by(|a, b| a.0 == b.0) {
            slot[same[0].0] = offsets.len() as u32;
            offsets.push(offsets.last().map_or(0, |last| last + same.len() as u32));
        }
        let weights = all.into_iter().map(|(_, target, weight)| (target, weight)).collect();
        Self { count: functionals.len(), slot, offsets, weights }
    }

    /// Functionals that weigh a state, and by how much.
    #[inline]
    fn at(&self, state: usize) -> &[(u32, f64)] {
        match self.slot[state] as usize {
            0 => &[],
            slot => &self.weights[self.offsets[slot - 1] as usize..self.offsets[slot] as usize],
        }
    }
}

impl Walker<'_> {
    /// Walks number `first` to `first + count` under a seed, and what they score for each functional; the walker's own score
    /// vector has no part in it. Transitions are those of all walks, in each tally. The same bits for any number of threads.
    ///
    /// # Errors
    /// As [`Walker::tally`].
    pub fn tally_all(
        &self,
        targets: &Targets,
        seed: u64,
        first: u64,
        count: u64,
    ) -> Result<Vec<Tally>, WalkError> {
        let chunk = |walks: std::ops::Range<u64>| -> Result<(Vec<(u32, f64)>, u64), WalkError> {
            let (mut scores, mut steps) = (Vec::new(), 0);
            let (mut waiting, mut met) = (Vec::new(), Vec::new());
            for walk in walks {
                let sampler = Sampler::new(SamplerKind::Independent, seed, walk >> 32, walk as u32);
                met.clear();
                steps += self.follow(sampler, &mut waiting, |state, weight, _| {
                    met.extend(targets.at(state).iter().map(|&(target, g)| (target, weight * g)));
                })?;
                // A stable sort keeps the order of the walk, in which it is summed.
                met.sort_by_key(|&(target, _)| target);
                for same in met.chunk_by(|a, b| a.0 == b.0) {
                    let score = same.iter().map(|&(_, score)| score).sum::<f64>();
                    if !score.is_finite() {
                        return Err(WalkError::Overflow);
                    }
                    scores.push((same[0].0, score));
                }
            }
            Ok((scores, steps))
        };
        let mut tallies = vec![Tally::default(); targets.count];
        let mut all_steps = 0;
        in_order(first, count, GROUP, chunk, |(scores, steps)| {
            scores.into_iter().for_each(|(target, score)| tallies[target as usize].push(score, 0));
            all_steps += steps;
        })?;
        for tally in &mut tallies {
            tally.push_zeros(count - tally.moments.count());
            tally.steps = all_steps;
        }
        Ok(tallies)
    }
}
