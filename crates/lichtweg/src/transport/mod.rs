//! Estimators: random walks, and the ways to join them with light.

mod mis;
mod observer;
mod path;

pub use observer::PathObserver;
pub use path::{PathTracer, WalkCounts};
