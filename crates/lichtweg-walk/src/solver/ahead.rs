//! What is known before walks begin: the first terms of the Neumann series, for all unknowns at once.
//!
//! x = b + M b + ... + M^(k-1) b + x', and x' = M x' + M^k b is what walks are left with. M^k b is spread out where b is not:
//! rare large scores become frequent small ones. With k = 1 that is what expected-value scores are, without a row to be added
//! up at each step, and what light transport calls next-event estimation. A product costs as much as a few walks from each
//! unknown, so that who asks for many can look ahead further. Forward walks start in M^k b instead of b.

use super::{Options, Solver};
use crate::vector::update;
use crate::walk::Score;

/// The first terms.
#[derive(Debug)]
pub(super) struct Ahead {
    /// b + ... + M^(k-1) b.
    pub(super) sum: Vec<f64>,
    /// M^k b.
    pub(super) next: Vec<f64>,
}

/// Terms, at most: more would be a deterministic solver.
pub(super) const MOST: usize = 8;

impl Solver<'_> {
    /// Terms to look ahead by; none where walks are to score each term by itself, and no more than leave something to walk
    /// for.
    pub(super) fn terms(&self, forward: bool, options: &Options) -> usize {
        if options.lengths {
            return 0;
        }
        let least = usize::from(!forward && options.score == Score::Expected);
        let most = (options.ahead as usize).clamp(least, MOST);
        (1..=most).take_while(|&terms| self.ahead(terms).next.iter().any(|&term| term != 0.0)).count()
    }

    /// <g, x> by these terms.
    pub(super) fn known_ahead(&self, terms: usize, g: impl Iterator<Item = (usize, f64)>) -> f64 {
        if terms == 0 { 0.0 } else { g.map(|(i, value)| value * self.ahead(terms).sum[i]).sum() }
    }

    /// So many terms, which are kept.
    pub(super) fn ahead(&self, terms: usize) -> &Ahead {
        self.ahead[terms].get_or_init(|| {
            let source = self.system.source();
            let Some(fewer) = terms.checked_sub(1) else {
                return Ahead { sum: vec![0.0; source.len()], next: source.to_vec() };
            };
            let Ahead { sum, next } = self.ahead(fewer);
            let mut sum = sum.clone();
            update(&mut sum, next, |sum, term| sum + term);
            Ahead { sum, next: self.system.matrix().multiply(next) }
        })
    }
}
