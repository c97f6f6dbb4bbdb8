//! Functions of any width: written once over [`Float`](lichtweg_ray::wide::Float), they serve one path as well as sixteen,
//! operation by operation the same.

mod elementary;
pub(crate) mod warp;

pub(crate) use elementary::{exp, ln, polynomial};
