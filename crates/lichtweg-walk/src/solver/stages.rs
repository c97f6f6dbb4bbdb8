//! One number read off all unknowns, which walks find in stages.

use super::{Answer, Evidence, Method, Options, Refusal, Solver};
use crate::sequential::{self, Vector};

/// Stages of sequential Monte Carlo, at most.
const STAGES: u32 = 300;

impl Solver<'_> {
    /// All unknowns by walks, of which the functional is read off.
    pub(super) fn sequential(&self, target: &[(usize, f64)], options: &Options) -> Result<Answer, Refusal> {
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
