//! Walks on one side to the goal: by independent or quasi-random numbers.

use lichtweg_montecarlo::hash::combine;

use super::reach::nothing_more;
use super::several::in_parts;
use super::side::Side;
use super::{Answer, Evidence, Method, Options, PILOT_SEED, Refusal, Solver};
use crate::stopping::{Estimate, Interval, PILOT, estimate};
use crate::walk::{Tally, Walker, quasi_random};

/// Independent scrambles of quasi-random walks, whose means make the interval.
const SCRAMBLES: u32 = 32;
/// Relative error of a sum over many pushes, by rounding.
const ROUNDING: f64 = 1e-14;
/// Points of each at the first look; enough for means to be about normal.
const FIRST_POINTS: u32 = 64;

impl Solver<'_> {
    /// Walks on a side to the goal; `offset` is what was pushed already, at `operations`.
    pub(super) fn walk_side(
        &self,
        method: Method,
        side: Option<&Side<'_>>,
        offset: f64,
        operations: u64,
        options: &Options,
    ) -> Result<Answer, Refusal> {
        let Some(side) = side else { return Ok(Answer::exact(offset, "nothing is left to walk for")) };
        let offset = offset + side.ahead();
        let kernel = side.kernel(options);
        let walker = side.walker(&kernel, options)?;
        let pilot = walker.tally(options.seed ^ PILOT_SEED, 0, PILOT)?;
        if pilot.nonzero == 0 && !side.reaches_a_score() {
            return Ok(Answer { operations, ..nothing_more(offset) });
        }
        if options.quasi {
            let answer = self.walk_quasi(method, &walker, offset, operations, options)?;
            return Ok(Answer { steps: answer.steps + pilot.steps, ..answer });
        }
        let interval = interval(side, options)?;
        let walker = if options.lengths { walker.with_lengths() } else { walker };
        let alone = options.watch.counts_walks();
        let walk = |first: u64, count: u64| -> Result<Vec<Tally>, Refusal> {
            if alone {
                options.watch.expect(first + count);
            }
            in_parts(first, count, 1, |first, part| {
                options.watch.check()?;
                let tally = walker.tally(options.seed, first, part)?;
                if alone {
                    options.watch.advance(part);
                }
                Ok(vec![tally])
            })
        };
        let pilot_steps = pilot.steps;
        let found = estimate(&[pilot], &[offset], &options.goal, interval, options.most_steps, walk)?;
        let report = |found: &Estimate| report(method, offset, operations, pilot_steps, found);
        found.first().map_or_else(|| Err(Refusal::NotBelieved { walks: 0, scored: 0 }), report)
    }

    /// Quasi-random walks to the goal: scrambles of twice as many points at each look, until their means agree.
    fn walk_quasi(
        &self,
        method: Method,
        walker: &Walker<'_>,
        offset: f64,
        operations: u64,
        options: &Options,
    ) -> Result<Answer, Refusal> {
        let mut left = 1.0 - options.goal.confidence;
        let (mut steps, mut points) = (0, FIRST_POINTS);
        loop {
            // Scrambles of its own for each look, so that looks are independent.
            let seed = combine(options.seed, u64::from(points));
            let (means, more) = quasi_random(walker, seed, SCRAMBLES, points)?;
            steps += more;
            let last = steps >= options.most_steps / 3 || points >= 1 << 30;
            let alpha = if last { left } else { 0.5 * left };
            left -= alpha;
            let value = offset + means.mean();
            let half_width = Interval::Student.half_width(&means, alpha);
            let reached = half_width <= options.goal.half_width(value) && means.mean() != 0.0;
            if means.mean() == 0.0 && last {
                return Err(Refusal::NotBelieved {
                    walks: u64::from(SCRAMBLES) * u64::from(points),
                    scored: 0,
                });
            }
            if reached || last {
                return Ok(Answer {
                    half_width,
                    evidence: Evidence::Statistical,
                    method,
                    reached,
                    walks: u64::from(SCRAMBLES) * u64::from(points),
                    steps,
                    operations,
                    ..Answer::exact(value, "as asked for, by quasi-random numbers")
                });
            }
            points *= 2;
        }
    }
}

/// What walks found; `operations` were spent on pushing `offset` before.
pub(super) fn report(
    method: Method,
    offset: f64,
    operations: u64,
    pilot_steps: u64,
    found: &Estimate,
) -> Result<Answer, Refusal> {
    let tally = &found.tally;
    let moments = tally.moments;
    if !found.believed {
        return Err(Refusal::NotBelieved { walks: moments.count(), scored: tally.nonzero });
    }
    Ok(Answer {
        half_width: found.half_width + ROUNDING * offset.abs(),
        evidence: Evidence::Statistical,
        method,
        reached: found.reached,
        walks: moments.count(),
        steps: tally.steps + pilot_steps,
        operations,
        warnings: heavy_tail(tally).into_iter().collect(),
        by_length: neumann(tally),
        ..Answer::exact(offset + moments.mean(), "as asked for")
    })
}

/// Student's interval, or, where it is asked for, Bernstein's.
pub(super) fn interval(side: &Side<'_>, options: &Options) -> Result<Interval, Refusal> {
    if !options.rigorous {
        return Ok(Interval::Student);
    }
    let bound = side.score_bound(options).ok_or_else(|| {
        Refusal::Parameter(
            "rigorous intervals need bounded scores: terminal ones, analog ending, and rows that sum to less than one".into(),
        )
    })?;
    Ok(Interval::Bernstein(2.0 * bound))
}

/// A warning where a few walks have nearly all of the squared scores.
fn heavy_tail(tally: &Tally) -> Option<String> {
    let (share, walks) = (tally.largest_share(), tally.moments.count());
    (walks >= 1000 && share > 0.1).then(|| {
        format!(
            "heavy tail: one of {walks} walks has {:.0} % of the squared scores; the interval may be too narrow",
            100.0 * share
        )
    })
}

/// Mean contribution by walk length.
fn neumann(tally: &Tally) -> Vec<f64> {
    let walks = tally.moments.count().max(1) as f64;
    let mut terms: Vec<f64> = tally.by_length.iter().map(|sum| sum / walks).collect();
    while terms.last() == Some(&0.0) {
        terms.pop();
    }
    terms
}
