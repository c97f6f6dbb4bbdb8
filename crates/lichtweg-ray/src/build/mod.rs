//! From geometries to a hierarchy: primitive boxes, a top-down binned SAH build, memory layout.

mod assemble;
mod binning;
mod primitive;
mod tree;

pub(crate) use assemble::build;
pub(crate) use primitive::{MAX_COORDINATE, census, padded};
