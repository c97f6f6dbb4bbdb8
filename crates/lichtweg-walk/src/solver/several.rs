//! Several functionals at once: which share their work, and which go alone.

use std::time::Instant;

use rayon::prelude::*;

use super::reach::{NO_SOURCE, nothing_more};
use super::walking::{interval, report};
use super::{Answer, Entries, Functional, Method, Options, PILOT_SEED, Refusal, Solver};
use crate::stopping::{Estimate, Interval, PILOT, estimate};
use crate::walk::{Tally, Targets, Walker};

impl Solver<'_> {
    /// Several functionals, each with the confidence asked for by itself.
    ///
    /// # Errors
    /// As [`Solver::solve`], for the first that fails.
    pub fn solve_each(&self, functionals: &[Functional], options: &Options) -> Result<Vec<Answer>, Refusal> {
        let began = Instant::now();
        let targets: Result<Vec<Entries>, Refusal> =
            functionals.iter().map(|functional| functional.entries(self.system.unknowns())).collect();
        let targets = targets?;
        let zeros: Vec<Option<Answer>> =
            targets.iter().map(|one| self.known_zero(one, targets.len())).collect();
        let asked = targets.iter().zip(&zeros).filter(|(_, zero)| zero.is_none());
        let asked: Vec<Entries> = asked.map(|(target, _)| target.clone()).collect();
        let found = self.by(options.method, &asked, options)?;
        let seconds = began.elapsed().as_secs_f64();
        // What looks like zero, and is not known to be anything else, may be zero.
        let looked_at = |(answer, target): (Answer, &Entries)| {
            let vague = answer.low() <= 0.0 && 0.0 <= answer.high() && answer.why != NO_SOURCE;
            match vague.then(|| self.zero(target)).flatten() {
                Some(zero) => Answer { why: zero.why, value: 0.0, half_width: 0.0, reached: true, ..answer },
                None => answer,
            }
        };
        let mut found = found.into_iter().zip(&asked).map(looked_at);
        let mut answers: Vec<Answer> =
            zeros.into_iter().filter_map(|zero| zero.or_else(|| found.next())).collect();
        if let [answer] = &mut answers[..] {
            answer.seconds = seconds;
        }
        Ok(answers)
    }

    /// The answer 0 where that is plain.
    fn known_zero(&self, target: &Entries, count: usize) -> Option<Answer> {
        if self.system.summary().sources == 0 || target.is_empty() {
            return Some(Answer::exact(
                0.0,
                "the source vector or the functional is zero, and so is the answer",
            ));
        }
        self.zero_at_a_glance(target, count)
    }

    /// By one method.
    fn by(&self, method: Method, targets: &[Entries], options: &Options) -> Result<Vec<Answer>, Refusal> {
        if targets.is_empty() {
            return Ok(Vec::new());
        }
        match method {
            Method::Auto => self.plan(targets, options),
            Method::Forward if targets.len() > 1 && can_share(options) => {
                self.check_convergence()?;
                timed(|| self.forward(targets, options))
            }
            Method::Deterministic => timed(|| self.deterministic(targets, &options.goal)),
            Method::Direct => timed(|| self.direct(targets, &options.goal)),
            Method::Sequential => timed(|| self.sequential(targets, options)),
            _ => self.one_by_one(method, targets, options),
        }
    }

    /// Each by itself, many at a time.
    fn one_by_one(
        &self,
        method: Method,
        targets: &[Entries],
        options: &Options,
    ) -> Result<Vec<Answer>, Refusal> {
        let Some((first, rest)) = targets.split_first() else { return Ok(Vec::new()) };
        options.watch.begin(targets.len() as u64);
        let mut answers = Vec::with_capacity(targets.len());
        answers.push(self.alone(method, first, options)?);
        if !rest.is_empty() {
            self.make_ready(method, first, options)?;
        }
        // In groups, so that the first refusal is told, and soon.
        for group in rest.chunks(GROUP) {
            let found: Vec<_> = group.par_iter().map(|target| self.alone(method, target, options)).collect();
            for answer in found {
                answers.push(answer?);
            }
        }
        Ok(answers)
    }

    /// Finds out what is kept of the system, in parallel, before many threads want it at once.
    fn make_ready(&self, method: Method, target: &Entries, options: &Options) -> Result<(), Refusal> {
        self.check_convergence()?;
        if method == Method::Push {
            let _ = self.proof.majorant(self.system);
        }
        let _ = self.pushed(&self.new_push(target));
        let forward = matches!(method, Method::Forward | Method::Bidirectional);
        self.side(forward, target, None, options).map(drop)
    }

    /// One functional by a method that serves no others.
    fn alone(&self, method: Method, target: &Entries, options: &Options) -> Result<Answer, Refusal> {
        options.watch.check()?;
        self.check_convergence()?;
        let began = Instant::now();
        let answer = match method {
            Method::Push => self.push(target, options),
            Method::Bidirectional | Method::PushWalk => self.push_and_walk(method, target, options),
            _ => {
                let side = self.side(method == Method::Forward, target, None, options)?;
                self.walk_side(method, side.as_ref(), 0.0, 0, options)
            }
        }?;
        options.watch.advance(1);
        Ok(Answer { seconds: began.elapsed().as_secs_f64(), ..answer })
    }

    /// One set of forward walks for all targets, until the last of them is known.
    pub(super) fn forward(&self, targets: &[Entries], options: &Options) -> Result<Vec<Answer>, Refusal> {
        let pilot = self.joint_pilot(targets, options, PILOT)?;
        if pilot.iter().any(|tally| tally.nonzero == 0) {
            let reached = self.reached(targets, options)?;
            if reached.contains(&false) {
                return self.forward_where(&reached, targets, options);
            }
        }
        let offsets = self.all_known_ahead(targets, options);
        let pilot_steps = pilot.first().map_or(0, |tally| tally.steps);
        let found = self.with_joint_walks(targets, options, |walker, weighted| {
            options.watch.begin(0);
            let walk = |first, count| {
                options.watch.expect(first + count);
                in_parts(first, count, targets.len(), |first, part| {
                    options.watch.check()?;
                    let tallies = walker.tally_all(weighted, options.seed, first, part)?;
                    options.watch.advance(part);
                    Ok(tallies)
                })
            };
            let (goal, most) = (&options.goal, options.most_steps);
            estimate(&pilot, &offsets, goal, Interval::Student, most, walk)
        })?;
        let answer = |((found, target), &offset): ((&Estimate, &Entries), &f64)| {
            let seldom = found.tally.nonzero < SELDOM && !found.reached;
            if seldom && targets.len() > 1 {
                return self.at_its_own_end(target, options);
            }
            let answer = report(Method::Forward, offset, 0, pilot_steps, found)?;
            Ok(Answer { shared: targets.len(), ..answer })
        };
        found.iter().flatten().zip(targets).zip(&offsets).map(answer).collect()
    }

    /// What forward walks for many hardly ever come to, by push and walks from there.
    fn at_its_own_end(&self, target: &Entries, options: &Options) -> Result<Answer, Refusal> {
        if let Some(zero) = self.zero(target) {
            return Ok(zero);
        }
        let mut answer = self.alone(Method::PushWalk, target, options)?;
        answer.warnings.push("forward walks hardly ever came here: found from its own end".to_owned());
        Ok(answer)
    }

    /// The same, without targets where nothing can come.
    fn forward_where(
        &self,
        reached: &[bool],
        targets: &[Entries],
        options: &Options,
    ) -> Result<Vec<Answer>, Refusal> {
        let kept: Vec<Entries> =
            targets.iter().zip(reached).filter(|&(_, &reached)| reached).map(|(t, _)| t.clone()).collect();
        let mut found = if kept.is_empty() { Vec::new() } else { self.forward(&kept, options)? }.into_iter();
        let offsets = self.all_known_ahead(targets, options);
        let answer = |(&reached, offset)| if reached { found.next() } else { Some(nothing_more(offset)) };
        Ok(reached.iter().zip(offsets).filter_map(answer).collect())
    }

    /// What of each target is known before forward walks.
    pub(super) fn all_known_ahead(&self, targets: &[Entries], options: &Options) -> Vec<f64> {
        let terms = self.terms(true, options);
        targets.iter().map(|target| self.known_ahead(terms, target.iter().copied())).collect()
    }

    /// A pilot of forward walks for all targets.
    pub(super) fn joint_pilot(
        &self,
        targets: &[Entries],
        options: &Options,
        walks: u64,
    ) -> Result<Vec<Tally>, Refusal> {
        let pilot = self.with_joint_walks(targets, options, |walker, weighted| {
            Ok(walker.tally_all(weighted, options.seed ^ PILOT_SEED, 0, walks)?)
        })?;
        Ok(pilot.unwrap_or_default())
    }

    /// Does something with forward walks that score for all targets; `None` where nothing starts.
    fn with_joint_walks<T>(
        &self,
        targets: &[Entries],
        options: &Options,
        act: impl FnOnce(&Walker<'_>, &Targets) -> Result<T, Refusal>,
    ) -> Result<Option<T>, Refusal> {
        let mut states: Vec<usize> = targets.iter().flatten().map(|&(i, _)| i).collect();
        states.sort_unstable();
        states.dedup();
        let ones: Entries = states.into_iter().map(|i| (i, 1.0)).collect();
        let Some(side) = self.side(true, &ones, None, options)? else { return Ok(None) };
        interval(&side, options)?;
        // What a visit scores in the coordinates of the side, for a weight of one.
        let weigh = |target: &Entries| target.iter().map(|&(i, g)| (i, g * side.score_of(i))).collect();
        let weighted: Vec<Entries> = targets.iter().map(weigh).collect();
        let weighted = Targets::new(self.system.unknowns(), &weighted);
        let kernel = side.kernel(options);
        let walker = side.walker(&kernel, options)?;
        act(&walker, &weighted).map(Some)
    }

    /// Whether forward walks can come to each target.
    fn reached(&self, targets: &[Entries], options: &Options) -> Result<Vec<bool>, Refusal> {
        let ones: Entries = targets.iter().flatten().map(|&(i, _)| (i, 1.0)).collect();
        let seen = self.side(true, &ones, None, options)?.map(|side| side.reachable()).unwrap_or_default();
        let reached = |i: usize| seen.get(i).is_some_and(|&seen| seen);
        Ok(targets.iter().map(|target| target.iter().any(|&(i, _)| reached(i))).collect())
    }
}

/// Scores of forward walks for many that are too few for one of them.
const SELDOM: u64 = 64;

/// Walks after which it is told how far they are.
const SHOWN: u64 = 1 << 14;

/// Tallies of `count` walks from one on, a part at a time.
pub(super) fn in_parts(
    first: u64,
    count: u64,
    tallies: usize,
    walk: impl Fn(u64, u64) -> Result<Vec<Tally>, Refusal>,
) -> Result<Vec<Tally>, Refusal> {
    let mut sums = vec![Tally::default(); tallies];
    for from in (0..count).step_by(SHOWN as usize) {
        let more = walk(first + from, SHOWN.min(count - from))?;
        sums.iter_mut().zip(&more).for_each(|(sum, more)| sum.merge(more));
    }
    Ok(sums)
}

/// Functionals that are found at a time.
const GROUP: usize = 256;

/// Whether walks may score for several functionals: what belongs to one alone is kept for one alone.
pub(super) fn can_share(options: &Options) -> bool {
    !options.lengths && !options.quasi && !options.rigorous
}

/// Tells all answers how long their common work took.
pub(super) fn timed(work: impl FnOnce() -> Result<Vec<Answer>, Refusal>) -> Result<Vec<Answer>, Refusal> {
    let began = Instant::now();
    let mut answers = work()?;
    let seconds = began.elapsed().as_secs_f64();
    answers.iter_mut().for_each(|answer| answer.seconds = seconds);
    Ok(answers)
}
