//! One unknown, or a few, of a large system: which method, how far, and what is known in the end.
//!
//! | method | what it does | wins where |
//! |---|---|---|
//! | [`Method::Adjoint`] | walks from the unknown along the rows of M | rows are short, b is spread out |
//! | [`Method::Forward`] | walks from b along the columns of M | b is concentrated, the unknown is often visited |
//! | [`Method::Push`] | pushes from the unknown; proven bounds | the solution decays quickly around the unknown |
//! | [`Method::Bidirectional`] | pushes from the unknown, walks from b into what is left | both ends are small: one pair of nodes |
//! | [`Method::PushWalk`] | pushes from the unknown, and walks on from what is left | tolerances that push alone reaches late |
//! | [`Method::Sequential`] | walks for all unknowns, in stages | all unknowns, walks are short |
//! | [`Method::Deterministic`] | a Krylov solver, or a sparse factorisation | walks are long; all unknowns |
//!
//! Push from one end and walks from the other: Lofgren, Banerjee, Goel, *Personalized PageRank estimation and search: a
//! bidirectional approach* (WSDM 2016). Push, then walks onward: Wang et al., *FORA* (KDD 2017). For linear systems:
//! Kwok, Wei, Yang (ITCS 2026).

mod answer;
mod deterministic;
mod plan;
mod proof;
mod refusal;
mod side;

use std::sync::OnceLock;
use std::time::Instant;

use crate::convergence::Radius;
use crate::push::Push;
use crate::sequential::{self, Vector};
use crate::stopping::{Estimate, Goal, Interval, PILOT, estimate};
use crate::walk::{Ending, Prepared, Score, Start, Tally, WeightWindow};
use crate::{Matrix, System};

pub use answer::{Answer, Cost, Evidence, Functional, Method};
pub use refusal::Refusal;
pub use side::Choice;

use proof::Proof;
use side::Side;

/// How to solve.
#[derive(Clone, Debug)]
pub struct Options {
    /// How well the number should be known.
    pub goal: Goal,
    /// Which method; [`Method::Auto`] plans.
    pub method: Method,
    /// What walks score.
    pub score: Score,
    /// When walks end.
    pub ending: Ending,
    /// How walks choose their next state.
    pub choice: Choice,
    /// Seed: with the same options, the same seed gives the same bits.
    pub seed: u64,
    /// Transitions and entries pushed, at most.
    pub most_steps: u64,
    /// Intervals that hold for any bounded scores, not only for means of many.
    pub rigorous: bool,
    /// Keep contributions by walk length.
    pub lengths: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            goal: Goal::default(),
            method: Method::Auto,
            score: Score::Collision,
            ending: Ending::Window(WeightWindow::default()),
            choice: Choice::Auto,
            seed: 0,
            most_steps: 2_000_000_000,
            rigorous: false,
            lengths: false,
        }
    }
}

/// Solves for functionals of one system, and keeps what it finds out about it.
///
/// ```
/// use lichtweg_walk::{Functional, Matrix, Options, Solver, System};
/// let a = Matrix::from_triplets(2, 2, &[(0, 0, 4.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 4.0)]).unwrap();
/// let system = System::linear(&a, &[3.0, 3.0], Default::default()).unwrap();
/// let answer = Solver::new(&system).solve(&Functional::Unknown(0), &Options::default()).unwrap();
/// assert!(answer.low() <= 1.0 && 1.0 <= answer.high());
/// ```
#[derive(Debug)]
pub struct Solver<'a> {
    system: &'a System,
    proof: Proof,
    /// Along rows, along columns.
    kept: [Kept; 2],
    source_start: OnceLock<Option<Start>>,
}

/// What walks in a direction need again and again.
#[derive(Debug, Default)]
struct Kept {
    /// The kernel in the coordinates of its certificate.
    scaled: OnceLock<Matrix>,
    /// The long rows of the kernel that is walked on.
    prepared: OnceLock<Prepared>,
}

impl<'a> Solver<'a> {
    /// For a system.
    #[must_use]
    pub fn new(system: &'a System) -> Self {
        Self { system, proof: Proof::default(), kept: Default::default(), source_start: OnceLock::new() }
    }

    /// The system.
    #[must_use]
    pub fn system(&self) -> &'a System {
        self.system
    }

    /// What is known of rho(|M|); found out at the first call.
    pub fn radius(&self) -> &Radius {
        if self.proof.rows_contract(self.system) || !self.proof.columns_contract(self.system) {
            self.proof.rows(self.system)
        } else {
            self.proof.columns(self.system)
        }
    }

    /// Estimates or computes <g, x>.
    ///
    /// # Errors
    /// The functional is outside of the system; walks do not converge or cannot be believed.
    pub fn solve(&self, functional: &Functional, options: &Options) -> Result<Answer, Refusal> {
        let began = Instant::now();
        let target = functional.entries(self.system.unknowns())?;
        let mut answer = if self.system.summary().sources == 0 || target.is_empty() {
            Answer::exact(0.0, "the source vector or the functional is zero, and so is the answer")
        } else {
            self.by(options.method, &target, options)?
        };
        answer.seconds = began.elapsed().as_secs_f64();
        Ok(answer)
    }

    /// Several functionals, with joint confidence: each at 1 - alpha / m (Bonferroni).
    ///
    /// # Errors
    /// As [`Solver::solve`], for the first that fails.
    pub fn solve_all(&self, functionals: &[Functional], options: &Options) -> Result<Vec<Answer>, Refusal> {
        let mut options = options.clone();
        options.goal.confidence = 1.0 - (1.0 - options.goal.confidence) / functionals.len().max(1) as f64;
        functionals.iter().map(|functional| self.solve(functional, &options)).collect()
    }

    /// By one method.
    fn by(&self, method: Method, target: &[(usize, f64)], options: &Options) -> Result<Answer, Refusal> {
        match method {
            Method::Auto => self.plan(target, options),
            Method::Deterministic => self.deterministic(target, &options.goal),
            Method::Sequential => self.sequential(target, options),
            Method::Adjoint | Method::Forward => {
                self.check_convergence()?;
                let side = self.side(method == Method::Forward, target, None, options)?;
                self.walk_side(method, side.as_ref(), 0.0, 0, options)
            }
            Method::Push => {
                self.check_convergence()?;
                self.push(target, options)
            }
            Method::Bidirectional | Method::PushWalk => self.push_and_walk(method, target, options),
        }
    }

    /// A refusal where walks do not converge.
    fn check_convergence(&self) -> Result<(), Refusal> {
        if self.proof.converges(self.system) {
            Ok(())
        } else {
            Err(Refusal::diverges(self.system, self.proof.rows(self.system)))
        }
    }

    /// Walks on a side to the goal; `offset` is what was pushed already, at `operations`.
    fn walk_side(
        &self,
        method: Method,
        side: Option<&Side<'_>>,
        offset: f64,
        operations: u64,
        options: &Options,
    ) -> Result<Answer, Refusal> {
        let Some(side) = side else { return Ok(Answer::exact(offset, "nothing is left to walk for")) };
        let kernel = side.kernel(options);
        let walker = side.walker(&kernel, options)?;
        let pilot = walker.tally(options.seed ^ PILOT_SEED, 0, PILOT)?;
        if pilot.nonzero == 0 && !self.sees_source(side) {
            return Ok(Answer::exact(offset, "the source vector cannot be reached from here"));
        }
        let interval = interval(side, options)?;
        let walker = if options.lengths { walker.with_lengths() } else { walker };
        let walk = |first, count| walker.tally(options.seed, first, count);
        let found = estimate(&pilot, offset, &options.goal, interval, options.most_steps, walk)?;
        let pilot_steps = pilot.steps;
        self.report(method, offset, operations, pilot_steps, found)
    }

    /// Whether walks can come to a state that scores at all.
    fn sees_source(&self, side: &Side<'_>) -> bool {
        let mut seen = vec![false; self.system.unknowns()];
        let mut waiting: Vec<usize> = side.starts().collect();
        waiting.iter().for_each(|&i| seen[i] = true);
        while let Some(i) = waiting.pop() {
            if side.scores(i) {
                return true;
            }
            for j in side.neighbours(i) {
                if !std::mem::replace(&mut seen[j], true) {
                    waiting.push(j);
                }
            }
        }
        false
    }

    fn report(
        &self,
        method: Method,
        offset: f64,
        operations: u64,
        pilot_steps: u64,
        found: Estimate,
    ) -> Result<Answer, Refusal> {
        let moments = found.tally.moments;
        if !found.believed {
            return Err(Refusal::NotBelieved { walks: moments.count(), scored: found.tally.nonzero });
        }
        let mut warnings = Vec::new();
        if let Some(warning) = heavy_tail(&found.tally) {
            warnings.push(warning);
        }
        Ok(Answer {
            value: offset + moments.mean(),
            half_width: found.half_width,
            evidence: Evidence::Statistical,
            method,
            reached: found.reached,
            walks: moments.count(),
            steps: found.tally.steps + pilot_steps,
            operations,
            seconds: 0.0,
            why: "as asked for".to_owned(),
            costs: Vec::new(),
            warnings,
            by_length: neumann(&found.tally),
            x: None,
        })
    }

    /// Push alone, to the goal or as far as allowed.
    fn push(&self, target: &[(usize, f64)], options: &Options) -> Result<Answer, Refusal> {
        let mut push = Push::new(self.system.matrix(), target.iter().copied());
        if let Some(answer) = self.push_to(&mut push, options, options.most_steps) {
            return Ok(Answer { why: "as asked for".to_owned(), ..answer });
        }
        let (value, half_width) = self.pushed(&push);
        if half_width.is_infinite() {
            return Err(Refusal::NoCertificate);
        }
        let operations = push.operations();
        Ok(Answer { half_width, reached: false, operations, ..Answer::exact(value, "as asked for") })
    }

    /// Pushes until the proven bound reaches the goal (an answer), or the operations reach a limit, or nothing is left to
    /// push.
    fn push_to(&self, push: &mut Push<'_>, options: &Options, limit: u64) -> Option<Answer> {
        loop {
            let (value, half_width) = self.pushed(push);
            if half_width <= options.goal.half_width(value) {
                return Some(Answer {
                    half_width,
                    operations: push.operations(),
                    ..Answer::exact(value, "")
                });
            }
            let left = limit.saturating_sub(push.operations());
            if left == 0 || !push.round(left) {
                return None;
            }
        }
    }

    /// Value and proven bound of what was pushed. With M, b >= 0 all x_i lie in a range, whose middle is the better guess.
    fn pushed(&self, push: &Push<'_>) -> (f64, f64) {
        let system = self.system;
        let left = || push.touched().map(|i| (i, push.residual(i)));
        let value = push.value(system.source());
        if left().all(|(_, q)| q == 0.0) {
            return (value, 0.0);
        }
        let high = self.proof.bound_of_solution(system, left()).unwrap_or(f64::INFINITY);
        if high.is_infinite() || !system.is_nonnegative() || left().any(|(_, q)| q < 0.0) {
            return (value, high);
        }
        let low = system.smallest_solution() * left().map(|(_, q)| q).sum::<f64>();
        (value + 0.5 * (low + high), 0.5 * (high - low))
    }

    /// All unknowns by walks, of which the functional is read off.
    fn sequential(&self, target: &[(usize, f64)], options: &Options) -> Result<Answer, Refusal> {
        self.check_convergence()?;
        let (system, walks) = (self.system, (self.system.unknowns() as u64).max(256));
        let value = |x: &[f64]| target.iter().map(|&(i, g)| g * x[i]).sum::<f64>();
        let mut bound = None;
        // Where nothing is proven, the residual has to do.
        let small = 0.01 * options.goal.relative.max(1e-12);
        let is_enough = |so_far: &Vector, residual: &[f64]| {
            bound = self.proof.bound_of_error(system, target, residual);
            let goal = options.goal.half_width(value(&so_far.x));
            bound.map_or(so_far.residual <= small, |bound| bound <= goal)
        };
        let found = sequential::solve(system, is_enough, STAGES, walks, options.seed)?;
        let value = value(&found.x);
        Ok(Answer {
            half_width: bound.unwrap_or(f64::INFINITY),
            evidence: if bound.is_some() { Evidence::Proven } else { Evidence::Residual(found.residual) },
            method: Method::Sequential,
            reached: bound.map_or(found.residual <= small, |bound| bound <= options.goal.half_width(value)),
            walks: found.walks,
            steps: found.steps,
            x: Some(found.x),
            ..Answer::exact(value, "as asked for")
        })
    }
}

/// Stages of sequential Monte Carlo, at most.
const STAGES: u32 = 300;

/// Tells the pilot's walks from those that count.
const PILOT_SEED: u64 = 0x9170_7000_0000_0000;

/// Student's interval, or, where it is asked for, Bernstein's.
fn interval(side: &Side<'_>, options: &Options) -> Result<Interval, Refusal> {
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

/// Start of walks in g or b, where not all are zero.
fn start(entries: impl IntoIterator<Item = (usize, f64)>) -> Result<Option<Start>, Refusal> {
    Start::by(entries).map_err(|error| Refusal::Parameter(error.to_string()))
}
