//! Looking on while paths are made.

use crate::scene::{Scatterer, SurfacePoint};

/// Is shown the vertices of eye paths as they come into being. Every method does nothing unless overridden; estimators take
/// observers by type, so that what does nothing costs nothing.
pub trait PathObserver {
    /// Whether it wants to be shown vertices at the end of edge number `depth`.
    #[inline]
    fn watches(&self, depth: u32) -> bool {
        let _ = depth;
        true
    }

    /// Path number `path` of those traced together scatters at `point`, the end of its edge number `depth`, which has
    /// length `distance`.
    #[inline]
    fn scatters(
        &mut self,
        path: u32,
        depth: u32,
        point: &SurfacePoint,
        scatterer: &Scatterer<'_>,
        distance: f32,
    ) {
        let _ = (path, depth, point, scatterer, distance);
    }
}

/// Looks away.
impl PathObserver for () {
    #[inline]
    fn watches(&self, _depth: u32) -> bool {
        false
    }
}
