//! Push, and what is proven of what it leaves.

use super::{Answer, Options, Refusal, Solver};
use crate::push::Push;

impl Solver<'_> {
    /// Push alone, to the goal or as far as allowed.
    pub(super) fn push(&self, target: &[(usize, f64)], options: &Options) -> Result<Answer, Refusal> {
        if !self.proof.rows_contract(self.system) && !self.proof.columns_contract(self.system) {
            // Bounds need a majorant, whatever it takes.
            let _ = self.proof.majorant(self.system);
        }
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
    pub(super) fn push_to(&self, push: &mut Push<'_>, options: &Options, limit: u64) -> Option<Answer> {
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
    pub(super) fn pushed(&self, push: &Push<'_>) -> (f64, f64) {
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
}
