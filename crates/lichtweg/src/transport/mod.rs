//! Estimators: random walks, and the ways to join them with light.

mod bidirectional;
mod connect;
mod explicit;
mod fault;
mod light;
mod light_end;
mod mis;
mod observer;
mod path;
#[cfg(test)]
mod proof;
mod sensor;
mod vertex;
mod visibility;
mod walk;
mod wave;

pub use bidirectional::{Bidirectional, Contribution, ContributionSink, Workspace};
pub use explicit::{ExplicitPath, PathStrategy, PathVertex, VertexKind};
pub use light::{LightTracer, walk_analog};
pub use light_end::{LightEnd, LightStart};
pub use observer::PathObserver;
pub use path::{PathTracer, WalkCounts};
pub use sensor::{Look, Sensor};
pub use vertex::{Departure, Onward, Others, Scattering, Vertex};
pub use walk::{Survival, Walk, WalkVisitor};
pub(crate) use wave::Draws;
pub use wave::Wave;
