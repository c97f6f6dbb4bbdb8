//! Estimators: random walks, and the ways to join them with light.

mod mis;
mod observer;
mod path;
mod wave;

pub use observer::PathObserver;
pub use path::{PathTracer, WalkCounts};
pub use wave::Wave;
