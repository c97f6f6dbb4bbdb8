//! The wide bounding volume hierarchy: its layout and how a ray goes through it.

mod layout;
mod query;
pub(crate) mod slab;
mod traverse;

pub(crate) use layout::{Block, Bvh, ChildRef, Node, Numbering};
pub(crate) use query::{closest, closest_filtered, occluded, occluded_filtered};
pub(crate) use traverse::{Best, MAX_DEPTH, Other, descend, take};
