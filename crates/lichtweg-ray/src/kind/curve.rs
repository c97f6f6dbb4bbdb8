//! Curves as items: pieces of segments, several a segment where that makes tighter boxes.

use rayon::prelude::*;

use super::Candidate;
use crate::accel::BuildReport;
use crate::curve::{Capsule, Curves, Piece, RaySpace, Unusable, pieces};
use crate::math::{Bounds3, Vec3};
use crate::ray::{Hit, Ray};
use crate::simd::Isa;

/// Curves and their pieces.
#[derive(Debug)]
pub(crate) struct PreparedCurves {
    curves: Curves,
    pieces: Vec<Piece>,
    dropped_degenerate: usize,
    dropped_non_finite: usize,
}

impl PreparedCurves {
    pub(crate) fn new(curves: &Curves) -> Self {
        let segments = 0..curves.segment_count() as u32;
        let lists: Vec<Result<Vec<Piece>, Unusable>> =
            segments.into_par_iter().map(|s| pieces(curves, s).map(Iterator::collect)).collect();
        let dropped = |why: Unusable| lists.iter().filter(|l| l.as_ref().is_err_and(|e| *e == why)).count();
        Self {
            curves: curves.clone(),
            dropped_degenerate: dropped(Unusable::Thin),
            dropped_non_finite: dropped(Unusable::NonFinite),
            pieces: lists.into_iter().flatten().flatten().collect(),
        }
    }

    pub(crate) fn boxes(&self) -> Vec<Bounds3> {
        self.pieces.par_iter().map(|piece| piece.bounds(&self.curves)).collect()
    }

    pub(crate) fn capsule(&self, item: u32) -> Capsule {
        self.pieces[item as usize].capsule(&self.curves)
    }

    pub(crate) fn count(&self, report: &mut BuildReport) {
        let dropped = self.dropped_degenerate + self.dropped_non_finite;
        report.curve_segments += self.curves.segment_count() - dropped;
        report.dropped_degenerate += self.dropped_degenerate;
        report.dropped_non_finite += self.dropped_non_finite;
    }

    /// The nearest hit of a piece; its v waits for [`PreparedCurves::completed`].
    #[inline]
    pub(crate) fn intersect(
        &self,
        item: u32,
        isa: Isa,
        space: &RaySpace,
        tnear: f32,
        tfar: f32,
    ) -> Option<Candidate> {
        let piece = self.pieces[item as usize];
        let hit = self.curves.intersect(isa, piece, space, tnear, tfar)?;
        Some(Candidate { t: hit.t, u: hit.u, v: 0.0, primitive: piece.segment })
    }

    pub(crate) fn completed(&self, ray: &Ray, hit: Hit) -> Hit {
        Hit { v: self.curves.across(ray, hit.primitive, hit.u), ..hit }
    }

    pub(crate) fn normal(&self, ray: &Ray, hit: &Hit) -> Vec3 {
        self.curves.surface(ray, hit.primitive, hit.u).geometric_normal
    }
}
