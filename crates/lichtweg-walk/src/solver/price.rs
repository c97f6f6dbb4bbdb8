//! What methods cost: a fixed model of the machine, in nanoseconds, that does not look at a clock.

use super::{Answer, Method, Solver};
use crate::stopping::Goal;
use crate::walk::Tally;

/// Nanoseconds of a transition: where all fits into the cache, where walks stay near their start in a large system, and
/// where they go all over it and miss the cache each time. First touches are part of it: who asks for one number comes with a
/// cold cache.
const CACHED_STEP: f64 = 45.0;
const NEAR_STEP: f64 = 60.0;
const FAR_STEP: f64 = 100.0;
/// Entries of a large system.
const LARGE: usize = 1 << 18;
/// Transitions after which a walk is far from its start.
const LONG: f64 = 200.0;
/// Nanoseconds to create a walk.
pub(super) const CREATION: f64 = 40.0;
/// Nanoseconds for each entry that is pushed, while the states that were met fit into the cache, and when they do not.
const PUSHED: f64 = 5.5;
const PUSHED_FAR: f64 = 40.0;
/// States that fit.
const FIT: usize = 1 << 15;
/// Nanoseconds for each state that was met to begin walks from what was left there.
pub(super) const LEFT: f64 = 10.0;
/// Nanoseconds for each entry of a matrix in a product, and for each unknown of a Krylov step.
const PRODUCT_ENTRY: f64 = 1.0;
const KRYLOV_UNKNOWN: f64 = 10.0;
/// Nanoseconds for each entry to make the transpose.
const TRANSPOSED: f64 = 12.0;
/// Nanoseconds of a factorisation: to order it, for each entry of the matrix; for each entry of the factors; for each
/// multiplication.
#[cfg(feature = "faer")]
const FACTORS: (f64, f64, f64) = (500.0, 10.0, 0.3);

/// Nanoseconds of pushing so many entries among the states that were met.
pub(super) fn pushing(operations: u64, met: usize) -> f64 {
    operations as f64 * if met > FIT { PUSHED_FAR } else { PUSHED }
}

impl Solver<'_> {
    /// Nanoseconds to make M^T, where that is still to be done.
    pub(super) fn making_columns(&self) -> f64 {
        if self.system.has_transposed() { 0.0 } else { TRANSPOSED * self.system.matrix().entries() as f64 }
    }

    /// Nanoseconds of a walk like those of a pilot.
    pub(super) fn nanoseconds_of_walk(&self, forward: bool, pilot: &Tally) -> f64 {
        CREATION + self.nanoseconds_of_steps(forward, pilot.steps_per_walk())
    }

    /// Nanoseconds of the transitions of a walk of this length.
    pub(super) fn nanoseconds_of_steps(&self, forward: bool, length: f64) -> f64 {
        let step = match self.system.matrix().entries() > LARGE {
            false => CACHED_STEP,
            true if forward || length > LONG => FAR_STEP,
            true => NEAR_STEP,
        };
        step * length
    }

    /// Nanoseconds of a factorisation, where it could pay to find them out.
    #[cfg(feature = "faer")]
    pub(super) fn direct_cost(&self, rival: f64) -> f64 {
        let (ordering, entry, multiplication) = FACTORS;
        let ordering = ordering * self.system.matrix().entries() as f64;
        if 2.0 * ordering > rival {
            return f64::INFINITY;
        }
        let fits = self.fill().filter(|fill| fill.entries <= crate::direct::MOST_FILL);
        fits.map_or(f64::INFINITY, |fill| ordering + entry * fill.entries + multiplication * fill.operations)
    }

    /// There is none.
    #[cfg(not(feature = "faer"))]
    pub(super) fn direct_cost(&self, _: f64) -> f64 {
        f64::INFINITY
    }

    /// Nanoseconds of a Krylov solver: its iterations by the condition that rho allows, or, where rho is not known, the lengths
    /// of walks, which are about 1 / (1 - rho). The error is then to be bounded by a second solution.
    pub(super) fn deterministic_cost(&self, goal: &Goal, length: f64) -> f64 {
        let radius = self.radius();
        let rho = radius.estimate.clamp(0.0, 1.0 - 1e-7);
        let condition = ((1.0 + rho) / (1.0 - rho)).max(2.0 * length);
        // The residual is to be smaller than the error by what the proof loses.
        let loss = if radius.certificate.is_some() { 1.0 / (1.0 - rho) } else { 1.0 };
        let digits = (2.0 * loss.min(1e6) / goal.relative.max(1e-15)).ln().max(1.0);
        let symmetric = self.system.as_linear().is_some();
        let mut products = 0.5 * condition.sqrt() * digits * if symmetric { 1.0 } else { 2.0 };
        if length > 0.0 {
            products *= 2.0;
        }
        let matrix = self.system.matrix();
        (2.0 + products) * (PRODUCT_ENTRY * matrix.entries() as f64 + KRYLOV_UNKNOWN * matrix.rows() as f64)
    }
}

/// Expected nanoseconds of methods that serve any number of functionals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shared {
    pub(super) deterministic: f64,
    /// A factorisation; never, where it was not looked into.
    pub(super) direct: f64,
    /// One set of forward walks; never, for one functional.
    pub(super) forward: f64,
    /// The fewest walks that give an interval, for one functional; 0 where that is not known before.
    pub(super) fewest_walks: f64,
    /// Functionals.
    pub(super) count: usize,
}

impl Shared {
    pub(super) fn cheapest(&self) -> f64 {
        self.deterministic.min(self.direct).min(self.forward)
    }

    /// Why a method was taken that serves all, where walks for one of them would take `alone`.
    pub(super) fn why(&self, answer: &Answer, alone: f64) -> String {
        let alone = time(alone);
        let for_each = if self.count > 1 { " for each unknown alone" } else { "" };
        match answer.method {
            Method::Forward => format!(
                "walks{for_each} would take about {alone}, one set of forward walks for all about {}",
                time(self.forward)
            ),
            Method::Direct => format!(
                "walks{for_each} would take about {alone}, a factorisation about {}, Krylov iterations about {}",
                time(self.direct),
                time(self.deterministic)
            ),
            _ => format!(
                "walks{for_each} would take about {alone}, a deterministic solver about {}",
                time(self.deterministic)
            ),
        }
    }
}

/// Expected nanoseconds of walks in one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct WalkCost {
    /// To the goal.
    pub(super) all: f64,
    /// For the fewest walks that give an interval.
    pub(super) least: f64,
    /// Transitions that the pilot made.
    pub(super) steps: u64,
}

impl WalkCost {
    pub(super) const NEVER: Self = Self { all: f64::INFINITY, least: f64::INFINITY, steps: 0 };
}

/// Expected nanoseconds of walks from a stage of pushing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    pub(super) adjoint: f64,
    pub(super) forward: f64,
    /// For the fewest walks that give an interval.
    pub(super) least: f64,
    /// Transitions that pilots made.
    pub(super) steps: u64,
}

impl Stage {
    /// Before any pilot.
    pub(super) fn unknown(least: f64) -> Self {
        Self { adjoint: f64::INFINITY, forward: f64::INFINITY, least, steps: 0 }
    }

    pub(super) fn cheapest(&self) -> f64 {
        self.adjoint.min(self.forward)
    }
}

/// A time in words.
pub(super) fn time(nanoseconds: f64) -> String {
    match nanoseconds * 1e-9 {
        s if !s.is_finite() => "forever".to_owned(),
        s if s < 1e-5 => "0.01 ms".to_owned(),
        s if s < 1e-3 => format!("{:.2} ms", s * 1e3),
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s if s < 1e4 => format!("{s:.1} s"),
        s => format!("{:.0} hours", s / 3600.0),
    }
}
