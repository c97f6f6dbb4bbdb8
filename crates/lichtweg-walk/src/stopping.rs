//! When enough has been walked: sequentially valid confidence.
//!
//! To look again and again and stop as soon as Student's interval is small is to stop too early. Here the allowed error
//! alpha is spent over looks: the k-th look may err with probability alpha_k, sum alpha_k <= alpha, so that by the union bound
//! *all* looks cover together with probability 1 - alpha, whenever one stops. A pilot, which is not part of the mean, says
//! how many walks the first look will need; it gets most of alpha (0.8, then a fifth of it each time), so that the price
//! of the freedom is about a tenth of the walks.
//!
//! Student's interval holds for means of many scores, not for scores that are nearly always zero. A look is believed only
//! with enough scores that differ; where the range R of the scores is known, [`Interval::Bernstein`] holds without that:
//! half width sqrt(2 V ln(3/alpha) / n) + 3 R ln(3/alpha) / n (Audibert, Munos, Szepesvari 2009, theorem 1).

use lichtweg_montecarlo::Moments;
use lichtweg_montecarlo::special::student_t_quantile;

use crate::walk::Tally;

/// How well a number should be known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Half width of the interval relative to the value.
    pub relative: f64,
    /// Half width that is enough in any case.
    pub absolute: f64,
    /// Probability that the interval covers the truth, such as 0.95.
    pub confidence: f64,
}

impl Default for Goal {
    fn default() -> Self {
        Self { relative: 1e-2, absolute: 0.0, confidence: 0.95 }
    }
}

impl Goal {
    /// The half width that is small enough for a value.
    #[must_use]
    pub fn half_width(&self, value: f64) -> f64 {
        (self.relative * value.abs()).max(self.absolute)
    }
}

/// How an interval is made of moments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Interval {
    /// Student's t: for means of many scores.
    #[default]
    Student,
    /// Empirical Bernstein: for scores within a range of this width, always.
    Bernstein(f64),
}

impl Interval {
    /// Half of its width at error probability `alpha`.
    #[must_use]
    pub fn half_width(self, moments: &Moments, alpha: f64) -> f64 {
        let n = moments.count() as f64;
        if n < 2.0 {
            return f64::INFINITY;
        }
        match self {
            Self::Student => -student_t_quantile(0.5 * alpha, n - 1.0) * moments.standard_error(),
            Self::Bernstein(range) => {
                let log = (3.0 / alpha).ln();
                (2.0 * moments.variance() * log / n).sqrt() + 3.0 * range * log / n
            }
        }
    }
}

/// What walking to a goal gave.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// All walks that count.
    pub tally: Tally,
    /// Half width of the interval around `offset + scale * mean`.
    pub half_width: f64,
    /// Whether the goal was reached.
    pub reached: bool,
    /// Whether the scores are such that the interval can be believed.
    pub believed: bool,
    /// Looks taken.
    pub looks: u32,
}

/// Walks of the pilot.
pub(crate) const PILOT: u64 = 256;
/// Fewest walks of a look.
pub(crate) const FEWEST: u64 = 1024;
/// Most walks of the first look after a pilot that tells little.
const VAGUE: u64 = 1 << 16;
/// Scores that have to differ from the first before Student's interval is believed.
const DIFFERENT: u64 = 64;
/// Walks after which scores that are all the same are believed to be so.
const SAME: u64 = 4096;
/// Walks after which some should have scored.
const HOPELESS: u64 = 1 << 24;
/// The share of alpha that each look spends of what is left.
const SPENT: f64 = 0.8;

/// Walks until `offset + mean` is known as well as `goal` says for each tally, with an offset of its own, or `most_steps` are made. `walk(first, count)`
/// walks, and gives as many tallies as the pilot has: one, or one for each functional that the walks score for together.
///
/// # Errors
/// Those of the walks.
pub fn estimate<E>(
    pilot: &[Tally],
    offsets: &[f64],
    goal: &Goal,
    interval: Interval,
    most_steps: u64,
    walk: impl Fn(u64, u64) -> Result<Vec<Tally>, E>,
) -> Result<Vec<Estimate>, E> {
    let mut left = (1.0 - goal.confidence).max(1e-300);
    let mut tallies = vec![Tally::default(); pilot.len()];
    let (mut looks, mut walked) = (0, 0);
    let per_walk = 1.0 + pilot.first().map_or(0.0, Tally::steps_per_walk);
    let most = ((most_steps as f64 / per_walk) as u64).max(FEWEST);
    let first = |(pilot, &offset): (&Tally, &f64)| {
        let needed = walks_needed(pilot, offset, goal, interval, SPENT * left);
        // A pilot that cannot tell the value from zero cannot tell a relative goal either; of few scores, it cannot tell a
        // variance, and the largest of many such variances would be far off.
        let vague = pilot.nonzero < DIFFERENT
            || (offset + pilot.moments.mean()).abs() < 3.0 * pilot.moments.standard_error();
        if vague { needed.min(VAGUE) } else { needed }
    };
    let mut wanted = pilot.iter().zip(offsets).map(first).max().unwrap_or(0).clamp(FEWEST, most);
    loop {
        let more = walk(walked, wanted - walked)?;
        tallies.iter_mut().zip(&more).for_each(|(tally, more)| tally.merge(more));
        walked = wanted;
        looks += 1;
        // Where none of very many walks scored, more of them are no use.
        let hopeless = wanted >= HOPELESS && tallies.iter().any(|tally| tally.nonzero == 0);
        let last = wanted >= most || hopeless;
        let alpha = if last { left } else { SPENT * left };
        left -= alpha;
        let judge = |(tally, &offset): (&Tally, &f64)| {
            let half_width = interval.half_width(&tally.moments, alpha);
            let believed = is_believed(tally, interval);
            let reached = believed && half_width <= goal.half_width(offset + tally.moments.mean());
            Estimate { tally: tally.clone(), half_width, reached, believed, looks }
        };
        let found: Vec<Estimate> = tallies.iter().zip(offsets).map(judge).collect();
        if last || found.iter().all(|estimate| estimate.reached) {
            return Ok(found);
        }
        let unfinished = found.iter().zip(offsets).filter(|(estimate, _)| !estimate.reached);
        let needed =
            unfinished.map(|(e, &offset)| walks_needed(&e.tally, offset, goal, interval, SPENT * left)).max();
        let growth = wanted.saturating_add(wanted / 2)..=wanted.saturating_mul(16);
        wanted = needed.unwrap_or(0).clamp(*growth.start(), *growth.end()).min(most);
    }
}

/// Number of walks that the goal seems to need, with a tenth to spare.
pub(crate) fn walks_needed(tally: &Tally, offset: f64, goal: &Goal, interval: Interval, alpha: f64) -> u64 {
    let target = goal.half_width(offset + tally.moments.mean());
    let variance = tally.moments.variance();
    if tally.nonzero == 0 || !variance.is_finite() {
        // Nothing is known yet but that it takes more.
        return tally.moments.count().saturating_mul(16);
    }
    let needed = match interval {
        Interval::Student => {
            let z = -student_t_quantile(0.5 * alpha, 1e6);
            variance * (z / target).powi(2)
        }
        Interval::Bernstein(range) => {
            // n with sqrt(a / n) + b / n = target.
            let log = (3.0 / alpha).ln();
            let (a, b) = (2.0 * variance * log, 3.0 * range * log);
            ((a.sqrt() + (a + 4.0 * b * target).sqrt()) / (2.0 * target)).powi(2)
        }
    };
    (1.1 * needed).ceil() as u64
}

fn is_believed(tally: &Tally, interval: Interval) -> bool {
    if matches!(interval, Interval::Bernstein(_)) {
        return true;
    }
    let all_the_same = tally.unlike_first == 0 && tally.nonzero > 0;
    tally.nonzero >= DIFFERENT
        && (tally.unlike_first >= DIFFERENT || (all_the_same && tally.moments.count() >= SAME))
}
