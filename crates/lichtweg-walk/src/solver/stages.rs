//! Any numbers read off all unknowns, which walks find in stages.

use super::{Answer, Entries, Evidence, Method, Options, Refusal, Solver};
use crate::sequential::{self, Vector};

/// Stages of sequential Monte Carlo, at most.
const STAGES: u32 = 300;

impl Solver<'_> {
    /// All unknowns by walks, of which the functionals are read off.
    pub(super) fn sequential(&self, targets: &[Entries], options: &Options) -> Result<Vec<Answer>, Refusal> {
        self.check_convergence()?;
        let (system, walks) = (self.system, (self.system.unknowns() as u64).max(256));
        let value = |x: &[f64], target: &Entries| target.iter().map(|&(i, g)| g * x[i]).sum::<f64>();
        let weights: Vec<f64> = targets.iter().map(|target| self.proof.weight(system, target)).collect();
        let mut norm = None;
        // Where nothing is proven, the residual has to do.
        let small = 0.01 * options.goal.relative.max(1e-12);
        let is_enough = |so_far: &Vector, residual: &[f64]| {
            norm = self.proof.norm_of_error(system, residual);
            let good = |norm: f64| {
                let reached = |(target, weight): (&Entries, &f64)| {
                    norm * weight <= options.goal.half_width(value(&so_far.x, target))
                };
                targets.iter().zip(&weights).all(reached)
            };
            norm.map_or(so_far.residual <= small, good)
        };
        let found = sequential::solve(system, is_enough, STAGES, walks, options.seed)?;
        let answer = |(target, weight): (&Entries, &f64)| {
            let value = value(&found.x, target);
            let bound = norm.map(|norm| norm * weight);
            Answer {
                half_width: bound.unwrap_or(f64::INFINITY),
                evidence: if bound.is_some() { Evidence::Proven } else { Evidence::Residual(found.residual) },
                method: Method::Sequential,
                reached: bound
                    .map_or(found.residual <= small, |bound| bound <= options.goal.half_width(value)),
                walks: found.walks,
                steps: found.steps,
                shared: targets.len(),
                ..Answer::exact(value, "as asked for")
            }
        };
        let mut answers: Vec<Answer> = targets.iter().zip(&weights).map(answer).collect();
        if let Some(first) = answers.first_mut() {
            first.x = Some(found.x);
        }
        Ok(answers)
    }
}
