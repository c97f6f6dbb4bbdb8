//! Estimators: random walks, and the ways to join them with light.

mod bidirectional;
mod connect;
mod explicit;
mod fault;
mod join;
mod light;
mod light_end;
mod mis;
mod observer;
mod packets;
mod path;
#[cfg(test)]
mod proof;
mod sensor;
mod vertex;
mod visibility;
mod walk;
mod wave;

pub use bidirectional::{Bidirectional, Contribution, ContributionSink, Pair, Workspace};
pub use explicit::{ExplicitPath, PathStrategy, PathVertex, VertexKind};
pub use light::{LightTracer, walk_analog};
pub use light_end::{LightEnd, LightStart};
pub use observer::PathObserver;
pub use path::{PathTracer, WalkCounts};
pub use sensor::{Expectation, Look, Sensor};
pub use vertex::{Departure, Onward, Others, Scattering, Trail, Vertex};
pub use walk::{Crowd, Survival, Traveller, Walk, WalkVisitor};
pub(crate) use wave::Draws;
pub use wave::Wave;
