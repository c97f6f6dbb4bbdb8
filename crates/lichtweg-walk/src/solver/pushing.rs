//! Push, and what is proven of what it leaves.

use super::{Answer, Entries, Options, Refusal, Solver};
use crate::push::Push;

impl Solver<'_> {
    /// Push alone, to the goal or as far as allowed.
    pub(super) fn push(&self, target: &Entries, options: &Options) -> Result<Answer, Refusal> {
        if !self.proof.rows_contract(self.system) && !self.proof.columns_contract(self.system) {
            // Bounds need a majorant, whatever it takes.
            let _ = self.proof.majorant(self.system);
        }
        let mut push = self.new_push(target);
        let asked = |answer: Answer| Answer { why: "as asked for".to_owned(), ..answer };
        let mut promising = f64::INFINITY;
        if let Some(answer) = self.push_to(&mut push, options, SOON.min(options.most_steps), &mut promising) {
            return Ok(asked(answer));
        }
        if push.value(self.system.source()) == 0.0
            && let Some(zero) = self.zero(target)
        {
            return Ok(zero);
        }
        if let Some(answer) = self.push_to(&mut push, options, options.most_steps, &mut promising) {
            return Ok(asked(answer));
        }
        let (value, half_width) = self.pushed(&push);
        if half_width.is_infinite() {
            return Err(Refusal::NoCertificate);
        }
        let operations = push.operations();
        Ok(Answer { half_width, reached: false, operations, ..Answer::exact(value, "as asked for") })
    }

    /// Pushes until the proven bound reaches the goal (an answer), or the operations reach a limit, or nothing is left to
    /// push. The bound takes longer to find than the size of the residual: it is looked at where that is `promising`, infinite at
    /// first.
    pub(super) fn push_to(
        &self,
        push: &mut Push<'_>,
        options: &Options,
        limit: u64,
        promising: &mut f64,
    ) -> Option<Answer> {
        // Bounds by columns go with the largest residual instead.
        let by_size = self.proof.bound_of_each(self.system).is_some();
        loop {
            let size = push.residuals().map(|(_, q)| q.abs()).sum::<f64>();
            if !by_size || size <= *promising {
                let (value, half_width) = self.pushed(push);
                let goal = options.goal.half_width(value);
                if half_width <= goal {
                    return Some(Answer {
                        half_width,
                        operations: push.operations(),
                        ..Answer::exact(value, "")
                    });
                }
                *promising = size * (1.2 * goal / half_width).clamp(0.5, 1.0);
            }
            let left = limit.saturating_sub(push.operations());
            if left == 0 || !push.round(left) {
                return None;
            }
        }
    }

    /// Value and proven bound of what was pushed. With M, b >= 0 all x_i lie in a range, whose middle is the better guess.
    pub(super) fn pushed(&self, push: &Push<'_>) -> (f64, f64) {
        let system = self.system;
        let value = push.value(system.source());
        let (sum, size) = push.residuals().fold((0.0, 0.0), |(sum, size), (_, q)| (sum + q, size + q.abs()));
        if size == 0.0 {
            return (value, 0.0);
        }
        let low = if system.is_nonnegative() { Some(system.smallest_solution()) } else { None };
        if let Some(high) = self.proof.bound_of_each(system) {
            let low = low.unwrap_or(-high);
            return (value + 0.5 * (low + high) * sum, 0.5 * (high - low) * size);
        }
        let bound = self.proof.bound_of_solution(system, push.residuals()).unwrap_or(f64::INFINITY);
        match low {
            Some(low) if bound.is_finite() && push.residuals().all(|(_, q)| q >= 0.0) => {
                (value + 0.5 * (low * sum + bound), 0.5 * (bound - low * sum))
            }
            _ => (value, bound),
        }
    }

    /// A push for a target, over-relaxed where that cannot fail.
    pub(super) fn new_push(&self, target: &[(usize, f64)]) -> Push<'_> {
        // Where no bound is in sight, pushing is for walks to go on from, and signs that differ are of no use to them.
        let relaxation = if self.system.is_definite() && self.proof.rows_contract(self.system) {
            // Young's choice for the spectral radius that rows allow.
            let radius = self.system.row_mass().1;
            (2.0 / (1.0 + (1.0 - radius * radius).sqrt())).min(MOST_RELAXED)
        } else {
            1.0
        };
        Push::relaxed(self.system.matrix(), target.iter().copied(), relaxation)
    }
}

/// Operations after which a source should have been met.
pub(super) const SOON: u64 = 1 << 17;

/// More is good for pushes that go all over a system, and bad for those that do not.
const MOST_RELAXED: f64 = 1.5;
