//! Curves: hair, fur, grass, threads.
//!
//! A curve is a chain of segments; a segment is a cubic (or a line) c(u), u in [0, 1], with a radius r(u) from
//! the same basis. It is hit as a chain of straight chords between its points at u = 0, 1/n, 2/n, ..., where n,
//! at most 512, is such that the cubic is nowhere further from its chords than 1/128 of its largest radius.
//! What a ray sees of a chord depends on the style:
//!
//! * [`CurveStyle::Round`]: the union of the balls between the chord's ends, a cone with two spheres. So curves
//!   are tubes that end in balls, and rays cannot slip between segments, whose end balls are shared. Their
//!   inside is not seen: only entering counts (as in Embree), and the balls within a tube do not.
//! * [`CurveStyle::Flat`]: the same silhouette, as a band that turns towards the ray, at the depth of the axis;
//!   cut straight at the ends of a curve (as in pbrt).
//! * [`CurveStyle::Ribbon`]: a band of triangles about the axis, turned by normals that are interpolated on the
//!   sphere (pbrt's `ribbon`, but intersected as the surface that it is).
//!
//! Hits are computed in `f64` in a frame about the ray, after a look in `f32` at what lies near it, eight chords at a time,
//! which leaves out nothing that could be hit.

mod bezier;
mod capsule;
mod flat;
mod intersect;
mod pieces;
mod ray_space;
mod ribbon;
mod round;
mod surface;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use rayon::prelude::*;

use crate::math::Vec3;
pub(crate) use capsule::{Capsule, Capsules, CurveRay};
use pieces::Cut;
pub(crate) use pieces::{Piece, Unusable, pieces};
pub(crate) use ray_space::RaySpace;
pub use surface::CurveSurface;

/// What rays see of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveStyle {
    /// A closed tube with spherical ends; rays that start inside do not see it.
    Round,
    /// A band that faces the ray.
    Flat,
    /// A band that is turned by normals.
    Ribbon,
}

/// How control points make segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveBasis {
    /// Straight lines from point to point.
    Linear,
    /// Cubic Bezier segments; each begins at the last point of the one before it.
    Bezier,
    /// A uniform cubic B-spline; it does not reach its first and last point.
    BSpline,
}

impl CurveBasis {
    /// Control points of a segment.
    pub fn order(self) -> usize {
        match self {
            Self::Linear => 2,
            Self::Bezier | Self::BSpline => 4,
        }
    }

    /// Control points from one segment's first to the next one's.
    pub fn step(self) -> usize {
        match self {
            Self::Linear | Self::BSpline => 1,
            Self::Bezier => 3,
        }
    }
}

/// A control point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct CurvePoint {
    /// Where, in world space.
    pub position: Vec3,
    /// Half the width; not negative.
    pub radius: f32,
}

/// Why control points make no curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// A curve has too few control points, or for Bezier segments some over.
    #[error("curve {curve} has {points} control points: {needed} are needed, and then {step} a segment")]
    BadCount {
        /// Index of the curve.
        curve: usize,
        /// Its control points.
        points: usize,
        /// Those of the first segment.
        needed: usize,
        /// Those that each further segment adds.
        step: usize,
    },
    /// The curves' counts do not add up to the number of control points.
    #[error("the curves are to have {counted} control points together, but there are {points}")]
    CountsDiffer {
        /// The sum of the counts.
        counted: usize,
        /// The number of control points.
        points: usize,
    },
    /// A ribbon needs a normal at both ends of each segment: segments + 1 a curve. Other styles have none.
    #[error("the curves need {needed} normals, but there are {normals}")]
    NormalsDiffer {
        /// The right number.
        needed: usize,
        /// The number given.
        normals: usize,
    },
    /// More control points than 32-bit indices can name.
    #[error("{points} control points are too many")]
    TooMany {
        /// The number given.
        points: usize,
    },
}

/// Curves of one style and basis. Clones share their arrays.
#[derive(Clone, Debug)]
pub struct Curves {
    style: CurveStyle,
    basis: CurveBasis,
    points: Arc<[CurvePoint]>,
    segments: Arc<[Segment]>,
    /// One a segment.
    cuts: Arc<[Cut]>,
    /// Unit, or zero where they could not be normalised; for ribbons only.
    normals: Arc<[Vec3]>,
}

/// A segment's place in its chain.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Segment {
    /// Its first control point.
    first: u32,
    /// The curve it belongs to.
    curve: u32,
}

impl Curves {
    /// Curves from all their control points, one curve after the other, and the number of points of each.
    /// `normals` are for ribbons, at the ends of the segments: one more than segments a curve; of any length.
    pub fn new(
        style: CurveStyle,
        basis: CurveBasis,
        points: impl Into<Arc<[CurvePoint]>>,
        counts: &[usize],
        normals: &[Vec3],
    ) -> Result<Self, CurveError> {
        let points = points.into();
        let (needed, step) = (basis.order(), basis.step());
        if u32::try_from(points.len()).is_err() {
            return Err(CurveError::TooMany { points: points.len() });
        }
        let counted = counts.iter().fold(0_usize, |sum, &n| sum.saturating_add(n));
        if counted != points.len() {
            return Err(CurveError::CountsDiffer { counted, points: points.len() });
        }
        let mut segments = Vec::new();
        let mut begin = 0;
        for (curve, &count) in counts.iter().enumerate() {
            if count < needed || !(count - needed).is_multiple_of(step) {
                return Err(CurveError::BadCount { curve, points: count, needed, step });
            }
            let firsts = (begin..=begin + count - needed).step_by(step);
            segments.extend(firsts.map(|first| Segment { first: first as u32, curve: curve as u32 }));
            begin += count;
        }
        let needed = if style == CurveStyle::Ribbon { segments.len() + counts.len() } else { 0 };
        if normals.len() != needed {
            return Err(CurveError::NormalsDiffer { needed, normals: normals.len() });
        }
        let normals = normals.iter().map(|n| n.try_normalized().unwrap_or(Vec3::ZERO)).collect();
        let count = segments.len() as u32;
        let uncut = Self { style, basis, points, segments: segments.into(), cuts: Arc::new([]), normals };
        let cuts = (0..count).into_par_iter().map(|segment| Cut::new(&uncut, segment)).collect();
        Ok(Self { cuts, ..uncut })
    }

    /// What rays see.
    pub fn style(&self) -> CurveStyle {
        self.style
    }

    /// How control points make segments.
    pub fn basis(&self) -> CurveBasis {
        self.basis
    }

    /// All control points.
    pub fn points(&self) -> &[CurvePoint] {
        &self.points
    }

    /// Number of segments: the primitives that hits name.
    pub fn segment_count(&self) -> usize {
        self.segments.len()
    }

    /// Number of chords of a segment.
    fn chords(&self, segment: u32) -> u32 {
        self.cuts[segment as usize].chords()
    }

    /// The segment that goes on where this one ends.
    fn next(&self, segment: u32) -> Option<u32> {
        let next = self.segments.get(segment as usize + 1)?;
        (next.curve == self.segments[segment as usize].curve).then_some(segment + 1)
    }

    /// The segment that ends where this one begins.
    fn previous(&self, segment: u32) -> Option<u32> {
        let previous = segment.checked_sub(1)?;
        (self.next(previous) == Some(segment)).then_some(previous)
    }

    /// The control points of a segment.
    fn control(&self, segment: u32) -> &[CurvePoint] {
        let first = self.segments[segment as usize].first as usize;
        &self.points[first..first + self.basis.order()]
    }

    /// The normals at the ends of a ribbon's segment.
    fn end_normals(&self, segment: u32) -> [Vec3; 2] {
        let first = (segment + self.segments[segment as usize].curve) as usize;
        [self.normals[first], self.normals[first + 1]]
    }
}
