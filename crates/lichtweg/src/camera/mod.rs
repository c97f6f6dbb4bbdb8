//! The eye: the factor R of a light path.
//!
//! A camera ray comes from (x, y, u, v, t): a point on the film, a point on the lens, and a time while the shutter is open,
//! as in the lecture's loop. All five are always drawn, so that a pinhole and a lens see the same random numbers elsewhere.

mod perspective;

pub(crate) use perspective::CameraRays;
pub use perspective::{Camera, View};
