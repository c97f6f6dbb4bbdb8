//! Looking on while paths are made.

use crate::scene::{Scatterer, SurfacePoint};

/// Is shown the vertices of eye paths as they come into being. Every method does nothing unless overridden; estimators take
/// observers by type, so that what does nothing costs nothing.
pub trait PathObserver {
    /// A path of `depth` edges so far scatters at `point`; the last edge has length `distance`.
    #[inline]
    fn scatters(&mut self, depth: u32, point: &SurfacePoint, scatterer: &Scatterer<'_>, distance: f32) {
        let _ = (depth, point, scatterer, distance);
    }
}

/// Looks away.
impl PathObserver for () {}
