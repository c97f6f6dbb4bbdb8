//! Ray queries: shapes, wide bounding volume hierarchies, closest-hit and occlusion.

pub mod math;
