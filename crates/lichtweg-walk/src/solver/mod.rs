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
//! | [`Method::Deterministic`] | Krylov iterations | walks are long; all unknowns |
//! | [`Method::Direct`] | a sparse factorisation | Krylov iterations are slow, factors are small |
//!
//! Several functionals share what can be shared: forward walks, which score for all of them at once, and solutions for all
//! unknowns.
//!
//! Push from one end and walks from the other: Lofgren, Banerjee, Goel, *Personalized PageRank estimation and search: a
//! bidirectional approach* (WSDM 2016). Push, then walks onward: Wang et al., *FORA* (KDD 2017). For linear systems:
//! Kwok, Wei, Yang (ITCS 2026).

mod ahead;
mod answer;
mod deterministic;
mod plan;
mod price;
mod proof;
mod pushing;
mod reach;
mod refusal;
mod several;
mod side;
mod stages;
mod walking;
mod watch;

use std::sync::OnceLock;

use crate::convergence::Radius;
use crate::stopping::Goal;
use crate::walk::{Ending, Prepared, Score, Start, WeightWindow};
use crate::{Matrix, System};

pub use answer::{Answer, Cost, Evidence, Functional, Method};
pub use refusal::Refusal;
pub use side::Choice;
pub use watch::Watch;

use ahead::Ahead;
use answer::Entries;
use proof::Proof;

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
    /// Quasi-random walks, with error bars from independent scrambles.
    pub quasi: bool,
    /// Terms of the Neumann series that products with M sum up, before walks estimate the rest: worth it for many
    /// functionals, which share them. Up to 8; [`Score::Expected`] takes one at least.
    pub ahead: u32,
    /// Told how far the solver is; a clone of it may stop it.
    pub watch: Watch,
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
            quasi: false,
            ahead: 0,
            watch: Watch::default(),
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
    /// Where forward walks start, by the terms that are known ahead.
    source_start: [OnceLock<Option<Start>>; ahead::MOST + 1],
    /// The first terms of the Neumann series, by their number.
    ahead: [OnceLock<Ahead>; ahead::MOST + 1],
    /// What factors would take.
    #[cfg(feature = "faer")]
    fill: OnceLock<Option<crate::direct::Fill>>,
}

/// What walks in a direction need again and again.
#[derive(Debug, Default)]
struct Kept {
    /// The kernel in the coordinates of its certificate, and its largest row sum.
    scaled: OnceLock<(Matrix, f64)>,
    /// The long rows of the kernel that is walked on.
    prepared: OnceLock<Prepared>,
}

impl<'a> Solver<'a> {
    /// For a system.
    #[must_use]
    pub fn new(system: &'a System) -> Self {
        Self {
            system,
            proof: Proof::default(),
            kept: Default::default(),
            source_start: Default::default(),
            ahead: Default::default(),
            #[cfg(feature = "faer")]
            fill: OnceLock::new(),
        }
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
        let found = self.solve_each(std::slice::from_ref(functional), options)?;
        found.into_iter().next().ok_or_else(|| Refusal::Parameter("nothing was found".into()))
    }

    /// Several functionals, with joint confidence: each at 1 - alpha / m (Bonferroni).
    ///
    /// # Errors
    /// As [`Solver::solve`], for the first that fails.
    pub fn solve_all(&self, functionals: &[Functional], options: &Options) -> Result<Vec<Answer>, Refusal> {
        let mut options = options.clone();
        options.goal.confidence = 1.0 - (1.0 - options.goal.confidence) / functionals.len().max(1) as f64;
        self.solve_each(functionals, &options)
    }

    /// A refusal where walks do not converge.
    fn check_convergence(&self) -> Result<(), Refusal> {
        if self.proof.converges(self.system) {
            Ok(())
        } else {
            Err(Refusal::diverges(self.system, self.proof.rows(self.system)))
        }
    }
}

/// Tells the pilot's walks from those that count.
const PILOT_SEED: u64 = 0x9170_7000_0000_0000;

/// Start of walks in g or b, where not all are zero.
fn start(entries: impl IntoIterator<Item = (usize, f64)>) -> Result<Option<Start>, Refusal> {
    Ok(Start::by(entries)?)
}
