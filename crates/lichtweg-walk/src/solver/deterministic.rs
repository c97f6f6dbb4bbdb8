//! No walks: a solver for the whole vector, of which any numbers are read off.

use std::borrow::Cow;

use super::{Answer, Entries, Evidence, Method, Refusal, Solver};
use crate::Matrix;
use crate::krylov::{self, Solution};
use crate::stopping::Goal;

/// Relative residual where no error bound says when to stop.
const UNBOUNDED: f64 = 1e-10;
/// Residual about as small as rounding allows.
const SMALL: f64 = 1e-13;
/// Residual that is not a solution.
const FAILED: f64 = 1e-6;
/// Products of the Krylov solvers, at most.
const PRODUCTS: usize = 50_000;

impl Solver<'_> {
    /// Krylov iterations until the proven errors of the numbers are small enough, or, where nothing is proven, to a small
    /// residual. One solution serves all targets.
    pub(super) fn deterministic(&self, targets: &[Entries], goal: &Goal) -> Result<Vec<Answer>, Refusal> {
        let system = self.system;
        let (a, b) = self.as_linear();
        let proven = self.proof.converges(system);
        let mut tolerance = if proven { (0.1 * goal.relative).clamp(1e-13, 1e-2) } else { UNBOUNDED };
        let (mut guess, mut products) = (None, 0);
        loop {
            let mut found = krylov::solve(&a, b, guess.take(), tolerance, PRODUCTS);
            if proven && found.residual > tolerance.max(SMALL) {
                found = krylov::fixed_point(system.matrix(), system.source(), found.x, tolerance, PRODUCTS);
            }
            products += found.products;
            let answers = self.read_off(Method::Deterministic, targets, goal, &found);
            let good = answers.iter().all(|answer| answer.reached);
            if !good && found.residual <= tolerance && tolerance > SMALL {
                // As much smaller as the bound is too large, and then some.
                let excess = answers.iter().map(|answer| goal.half_width(answer.value) / answer.half_width);
                tolerance *= (0.5 * excess.fold(1.0, f64::min)).clamp(0.01, 0.3);
                guess = Some(found.x);
                continue;
            }
            if found.residual > FAILED.max(tolerance) {
                return Err(Refusal::NotSolved { residual: found.residual });
            }
            let why = format!("as asked for: {}, {products} products", found.method);
            return Ok(with_vector(answers, found, &why, products * a.entries()));
        }
    }

    /// A sparse factorisation.
    #[cfg(not(feature = "faer"))]
    pub(super) fn direct(&self, _: &[Entries], _: &Goal) -> Result<Vec<Answer>, Refusal> {
        Err(Refusal::NoFactorisation)
    }

    /// A sparse factorisation.
    #[cfg(feature = "faer")]
    pub(super) fn direct(&self, targets: &[Entries], goal: &Goal) -> Result<Vec<Answer>, Refusal> {
        use crate::direct::{Factors, MOST_FILL};
        let system = self.system;
        let (a, b) = self.as_linear();
        let failed = Refusal::NotSolved { residual: f64::INFINITY };
        let entries = self.fill().ok_or(failed.clone())?.entries;
        if entries > MOST_FILL {
            return Err(Refusal::TooMuchFill { entries });
        }
        let factors = Factors::new(&a).ok_or(failed)?;
        let found = krylov::finish(&a, b, factors.solve(b), 0, factors.method);
        if found.residual > FAILED {
            return Err(Refusal::NotSolved { residual: found.residual });
        }
        self.proof.offer_majorant(system, |right| factors.solve(right));
        let answers = self.read_off(Method::Direct, targets, goal, &found);
        let why = format!("as asked for: {}", found.method);
        Ok(with_vector(answers, found, &why, 0))
    }

    /// What factors would take; `None` where that cannot be found out.
    #[cfg(feature = "faer")]
    pub(super) fn fill(&self) -> Option<crate::direct::Fill> {
        *self.fill.get_or_init(|| crate::direct::fill(&self.as_linear().0))
    }

    /// A x = b: as it was given, or I - M and the source vector.
    fn as_linear(&self) -> (Cow<'_, Matrix>, &[f64]) {
        match self.system.as_linear() {
            Some(linear) => (Cow::Borrowed(&linear.matrix), &linear.right_side[..]),
            None => (Cow::Owned(krylov::one_minus(self.system.matrix())), self.system.source()),
        }
    }

    /// The numbers of a solution, with their errors where these can be bounded.
    fn read_off(&self, method: Method, targets: &[Entries], goal: &Goal, found: &Solution) -> Vec<Answer> {
        let system = self.system;
        let proven = self.proof.converges(system);
        let norm = if proven { self.proof.norm_of_error(system, &system.residual(&found.x)) } else { None };
        let answer = |target: &Entries| {
            let value = target.iter().map(|&(i, g)| g * found.x[i]).sum();
            let bound = norm.map(|norm| norm * self.proof.weight(system, target));
            Answer {
                half_width: bound.unwrap_or(f64::INFINITY),
                evidence: if bound.is_some() { Evidence::Proven } else { Evidence::Residual(found.residual) },
                method,
                reached: bound.is_none_or(|bound| bound <= goal.half_width(value)),
                shared: targets.len(),
                ..Answer::exact(value, "")
            }
        };
        targets.iter().map(answer).collect()
    }
}

/// Adds what all answers have in common; the vector goes with the first.
fn with_vector(mut answers: Vec<Answer>, found: Solution, why: &str, operations: usize) -> Vec<Answer> {
    for answer in &mut answers {
        (answer.why, answer.operations) = (why.to_owned(), operations as u64);
    }
    if let Some(first) = answers.first_mut() {
        first.x = Some(found.x);
    }
    answers
}
