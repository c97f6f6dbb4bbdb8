//! What queries touch, counted a thread, for the benchmark; only with the feature `count`.

#[cfg(feature = "count")]
use std::cell::Cell;

#[cfg(feature = "count")]
thread_local! {
    static COUNTS: Cell<[u64; 2]> = const { Cell::new([0; 2]) };
}

/// Nodes and triangle blocks that this thread's queries have touched since it last asked.
#[cfg(feature = "count")]
pub fn take() -> [u64; 2] {
    COUNTS.take()
}

/// Counts a node.
#[inline(always)]
pub(crate) fn node() {
    #[cfg(feature = "count")]
    COUNTS.set([COUNTS.get()[0] + 1, COUNTS.get()[1]]);
}

/// Counts a block.
#[inline(always)]
pub(crate) fn block() {
    #[cfg(feature = "count")]
    COUNTS.set([COUNTS.get()[0], COUNTS.get()[1] + 1]);
}
