//! Watching a solver from another thread, and stopping it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::Refusal;

/// How far a solver has come; clones see the same. A new one is told of by [`Options::watch`](super::Options::watch).
#[derive(Clone, Debug, Default)]
pub struct Watch(Arc<Counters>);

#[derive(Debug, Default)]
struct Counters {
    done: AtomicU64,
    of: AtomicU64,
    stopped: AtomicBool,
}

impl Watch {
    /// What is done, and of how much: functionals that are found one by one, or walks of a set that serves all. How many
    /// walks that takes is known better at each look. (0, 0) where a method cannot tell.
    #[must_use]
    pub fn progress(&self) -> (u64, u64) {
        (self.0.done.load(Ordering::Relaxed), self.0.of.load(Ordering::Relaxed))
    }

    /// Asks the solver to end with [`Refusal::Stopped`], soon.
    pub fn stop(&self) {
        self.0.stopped.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to end.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.0.stopped.load(Ordering::Relaxed)
    }

    /// Begins something of which `of` are to be done.
    pub(super) fn begin(&self, of: u64) {
        self.0.done.store(0, Ordering::Relaxed);
        self.0.of.store(of, Ordering::Relaxed);
    }

    /// Whether walks are to be counted from now on, since there is but one functional.
    pub(super) fn counts_walks(&self) -> bool {
        let alone = self.progress().1 <= 1;
        if alone {
            self.begin(0);
        }
        alone
    }

    /// More is to be done than was thought.
    pub(super) fn expect(&self, of: u64) {
        self.0.of.store(of, Ordering::Relaxed);
    }

    /// So many more are done.
    pub(super) fn advance(&self, by: u64) {
        self.0.done.fetch_add(by, Ordering::Relaxed);
    }

    /// A refusal where it was asked to end.
    ///
    /// # Errors
    /// [`Refusal::Stopped`].
    pub fn check(&self) -> Result<(), Refusal> {
        if self.is_stopped() { Err(Refusal::Stopped) } else { Ok(()) }
    }
}
