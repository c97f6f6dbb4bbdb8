//! Estimators: random walks, and the ways to join them with light.

mod bidirectional;
mod connect;
mod connect_lanes;
mod counting_sort;
mod explicit;
mod fault;
mod join;
mod joint;
mod light;
mod light_end;
mod mis;
mod observer;
mod packets;
mod partners;
mod path;
#[cfg(test)]
mod proof;
mod sensor;
mod traveller;
mod vertex;
mod vertex_lanes;
mod visibility;
mod walk;
mod wave;

pub use bidirectional::{Bidirectional, Contribution, ContributionSink, Pair, Route, Teller, Workspace};
pub(crate) use counting_sort::CountingSort;
pub use explicit::{ExplicitPath, PathStrategy, PathVertex, VertexKind};
pub use light::{LightTracer, walk_analog};
pub use light_end::{LightEnd, LightStart};
pub use observer::PathObserver;
pub use path::{PathTracer, WalkCounts};
pub use sensor::{Expectation, Look, Sensor};
pub use traveller::Traveller;
pub use vertex::{Departure, Onward, Others, Scattering, Trail, Vertex};
pub use walk::{Crowd, Survival, Walk, WalkVisitor};
pub(crate) use wave::Draws;
pub use wave::Wave;
