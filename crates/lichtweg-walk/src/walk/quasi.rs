//! Walks by quasi-random numbers: padded, Owen-scrambled Sobol' points (one dimension a transition), and error bars from
//! independent scrambles.
//!
//! The first transitions of all walks are stratified together; after some ten of them little is left of it (compare
//! Mascagni and Karaivanova, *A parallel quasi-Monte Carlo method for solving systems of linear equations*, 2002). Each
//! replicate is unbiased, and replicates are independent, so that their means have an honest Student interval.

use lichtweg_montecarlo::hash::combine;
use lichtweg_montecarlo::{Moments, Sampler, SamplerKind};

use super::{WalkError, Walker};

/// Means of `replicates` independently scrambled point sets of `walks` walks each (powers of two are best), and the
/// number of transitions in all.
///
/// # Errors
/// As [`Walker::tally`].
pub fn quasi_random(
    walker: &Walker<'_>,
    seed: u64,
    replicates: u32,
    walks: u32,
) -> Result<(Moments, u64), WalkError> {
    let mut means = Moments::default();
    let mut steps = 0;
    for replicate in 0..replicates {
        let stream = combine(u64::from(replicate), 0x51_0b01);
        // Even indices alone: one (0,2)-sequence, not two.
        let sampler = |walk: u64| Sampler::new(SamplerKind::Sobol, seed, stream, 2 * walk as u32);
        let tally = walker.tally_with(0, u64::from(walks), sampler)?;
        means.push(tally.moments.mean());
        steps += tally.steps;
    }
    Ok((means, steps))
}
