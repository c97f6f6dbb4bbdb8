//! Vectors, affine maps and boxes: the little linear algebra that ray queries and shading share.
//!
//! The types are our own, and few, so that no other crate's version shows in a public signature.

mod affine;
mod bounds;
mod motion;
mod vector;

pub use affine::Affine;
pub use bounds::Bounds3;
pub use motion::Motion;
pub use vector::{Vec2, Vec3, Vector};
