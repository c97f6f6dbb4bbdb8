//! From geometries to a hierarchy: primitive boxes, a binary tree by the surface area heuristic with or
//! without splits through triangles, its collapse to a wide one, memory layout.

mod assemble;
mod binning;
mod clip;
mod collapse;
mod primitive;
mod spatial;
mod tree;

pub(crate) use assemble::build;
pub(crate) use primitive::{MAX_COORDINATE, census, is_sound, padded};
