//! No walks: a solver for the whole vector, of which one number is read off.

use super::{Answer, Evidence, Method, Refusal, Solver};
use crate::krylov::{self, Solution};
use crate::stopping::Goal;

/// Relative residual where no error bound says when to stop.
const UNBOUNDED: f64 = 1e-10;
/// Residual that is not a solution.
const FAILED: f64 = 1e-6;

impl Solver<'_> {
    /// Solves until the proven error of the number is small enough, or, where nothing is proven, to a small residual.
    pub(super) fn deterministic(&self, target: &[(usize, f64)], goal: &Goal) -> Result<Answer, Refusal> {
        let system = self.system;
        let own;
        let (a, b) = match system.as_linear() {
            Some(linear) => (&linear.matrix, &linear.right_side[..]),
            None => {
                own = krylov::one_minus(system.matrix());
                (&own, system.source())
            }
        };
        let proven = self.proof.converges(system);
        let mut tolerance = if proven { (0.1 * goal.relative).clamp(1e-13, 1e-2) } else { UNBOUNDED };
        let (mut guess, mut products) = (None, 0);
        loop {
            let mut found = solve_linear(a, b, guess.take(), tolerance);
            if proven && found.residual > tolerance {
                found = krylov::fixed_point(system.matrix(), system.source(), found.x, tolerance, PRODUCTS);
            }
            products += found.products;
            let value = target.iter().map(|&(i, g)| g * found.x[i]).sum();
            let bound = if proven {
                self.proof.bound_of_error(system, target, &system.residual(&found.x))
            } else {
                None
            };
            let good = bound.is_none_or(|bound| bound <= goal.half_width(value));
            if !good && found.residual <= tolerance && tolerance > 1e-14 {
                tolerance *= 0.01;
                guess = Some(found.x);
                continue;
            }
            if found.residual > FAILED.max(tolerance) {
                return Err(Refusal::NotSolved { residual: found.residual });
            }
            return Ok(Answer {
                half_width: bound.unwrap_or(f64::INFINITY),
                evidence: if bound.is_some() { Evidence::Proven } else { Evidence::Residual(found.residual) },
                method: Method::Deterministic,
                reached: good,
                operations: (products * a.entries()) as u64,
                x: Some(found.x),
                ..Answer::exact(value, &format!("as asked for: {}, {products} products", found.method))
            });
        }
    }
}

/// Products of the Krylov solvers, at most.
const PRODUCTS: usize = 50_000;

#[cfg(not(feature = "faer"))]
fn solve_linear(a: &crate::Matrix, b: &[f64], guess: Option<Vec<f64>>, tolerance: f64) -> Solution {
    krylov::solve(a, b, guess, tolerance, PRODUCTS)
}

/// Krylov first; where it is slow, a factorisation.
#[cfg(feature = "faer")]
fn solve_linear(a: &crate::Matrix, b: &[f64], guess: Option<Vec<f64>>, tolerance: f64) -> Solution {
    let found = krylov::solve(a, b, guess, tolerance, 300);
    if found.residual <= tolerance {
        return found;
    }
    let direct = crate::direct::solve(a, b).filter(|direct| direct.residual < found.residual);
    direct.unwrap_or_else(|| krylov::solve(a, b, Some(found.x), tolerance, PRODUCTS))
}
