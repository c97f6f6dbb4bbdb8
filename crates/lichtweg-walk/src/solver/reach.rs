//! What nothing comes to: unknowns that no source has a say in.
//!
//! x_i is a sum over chains of entries M_ij M_jk ... b_l. Where none of the states that i leads to has a source, and the sum
//! converges, x_i is 0, and no walk has to find that out. States are searched breadth first from the unknown, since sources
//! mostly are near; where a few thousand entries do not decide, the search goes on only when what was found looks like zero.

use super::{Answer, Entries, Solver};

/// Entries that may be looked at for each functional before anything else is done, and for all of them.
const QUICK: usize = 1 << 14;
const QUICK_FOR_ALL: usize = 1 << 22;

/// Why it is zero.
pub(super) const NO_SOURCE: &str = "nothing of the source vector can come here: the answer is zero";

/// What is known, where walks would find nothing more.
pub(super) fn nothing_more(known: f64) -> Answer {
    Answer::exact(known, if known == 0.0 { NO_SOURCE } else { "no source is left to come to" })
}

impl Solver<'_> {
    /// The answer 0 where it takes few entries to see that nothing comes to a functional, one of `count`.
    pub(super) fn zero_at_a_glance(&self, target: &Entries, count: usize) -> Option<Answer> {
        self.zero_within(target, QUICK.min(QUICK_FOR_ALL / count.max(1)))
    }

    /// The answer 0 where nothing comes to a functional, whatever it takes to see that.
    pub(super) fn zero(&self, target: &Entries) -> Option<Answer> {
        self.zero_within(target, usize::MAX)
    }

    /// What walks do not come to is known only where they converge: x = x has other solutions than 0.
    fn zero_within(&self, target: &Entries, entries: usize) -> Option<Answer> {
        let unreached = self.meets_a_source(target, entries) == Some(false);
        (unreached && self.proof.converges(self.system)).then(|| Answer::exact(0.0, NO_SOURCE))
    }

    /// Whether a state with a source can be come to from a functional along the rows; `None` where that takes more entries.
    fn meets_a_source(&self, target: &Entries, entries: usize) -> Option<bool> {
        let (matrix, source) = (self.system.matrix(), self.system.source());
        // Mostly so; then nothing else is needed.
        if target.iter().any(|&(i, _)| source[i] != 0.0) {
            return Some(true);
        }
        let mut met = vec![false; source.len()];
        let mut waiting: Vec<usize> = target.iter().map(|&(i, _)| i).collect();
        waiting.iter().for_each(|&i| met[i] = true);
        let (mut next, mut used) = (0, 0_usize);
        while let Some(&i) = waiting.get(next) {
            if source[i] != 0.0 {
                return Some(true);
            }
            let row = matrix.row(i);
            used = used.saturating_add(1 + row.indices.len());
            if used > entries {
                return None;
            }
            let unmet = row.iter().map(|(j, _)| j).filter(|&j| !std::mem::replace(&mut met[j], true));
            waiting.extend(unmet);
            next += 1;
        }
        Some(false)
    }
}
