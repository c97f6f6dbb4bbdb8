//! What a running job tells, and how it is asked to stop.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};

/// Shared between a job and whoever watches it.
#[derive(Debug, Default)]
pub struct Progress {
    samples: AtomicU64,
    rays: AtomicU64,
    passes: AtomicU32,
    stop: AtomicBool,
}

impl Progress {
    /// Camera samples taken so far, over all pixels.
    pub fn samples(&self) -> u64 {
        self.samples.load(Ordering::Relaxed)
    }

    /// Ray queries made so far.
    pub fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }

    /// Passes over the image that are complete.
    pub fn passes(&self) -> u32 {
        self.passes.load(Ordering::Relaxed)
    }

    /// Asks the job to end after the pass it is in.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Whether the job has been asked to end.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    pub(super) fn add(&self, samples: u64, rays: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }

    pub(super) fn pass_done(&self) {
        self.passes.fetch_add(1, Ordering::Relaxed);
    }
}
