//! The search for the first chord of a piece that a ray hits.
//!
//! Eight neighbouring ranges of the curve are looked at together: one that comes no nearer to the ray than its radius is left out;
//! of the others, chords are intersected and longer ranges searched in turn. The work is bounded by the number of chords.

use super::bezier::{Bezier, Point4};
use super::pieces::{FAN, Piece};
use super::ray_space::RaySpace;
use super::ribbon::Rung;
use super::round::Entry;
use super::{CurveStyle, Curves, flat, ribbon, round};

/// Slack of the first look, for rounding.
const SLACK: f64 = 1.0 + 1e-9;

/// Where a ray meets a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurveHit {
    pub t: f32,
    /// Along the segment.
    pub u: f32,
}

/// A piece in a ray's frame.
struct Search<'a> {
    curves: &'a Curves,
    segment: u32,
    space: &'a RaySpace,
    cubic: Bezier,
    /// Bound on how far the curve is from a line between neighbouring vertices.
    deviation: f64,
    /// Chords of the segment.
    chords: u32,
    tnear: f32,
    tfar: f32,
    best: Option<CurveHit>,
}

impl Curves {
    /// The nearest hit of a piece with `tnear < t <= tfar`; of equally near ones that of the lowest u.
    pub(crate) fn intersect(
        &self,
        piece: Piece,
        space: &RaySpace,
        tnear: f32,
        tfar: f32,
    ) -> Option<CurveHit> {
        let cubic = Bezier::new(self, piece.segment, |p| space.point(p));
        let (first, own, chords) = piece.chords();
        let (segment, deviation) = (piece.segment, f64::from(piece.deviation));
        let mut search =
            Search { curves: self, segment, space, cubic, deviation, chords, tnear, tfar, best: None };
        search.range(first, own, &search.vertex(first), &search.vertex(first + own));
        search.best
    }
}

impl Search<'_> {
    /// Looks at eight ranges of `chords` chords each, from the chord `first` on.
    fn fan(&mut self, first: u32, chords: u32) {
        let vertices: [Point4; FAN as usize + 1] =
            std::array::from_fn(|i| self.vertex(first + i as u32 * chords));
        for (i, ends) in (0..).zip(vertices.windows(2)) {
            self.range(first + i * chords, chords, &ends[0], &ends[1]);
        }
    }

    /// Looks at the `chords` chords from `first` on, which reach from `a` to `b`.
    #[inline(always)]
    fn range(&mut self, first: u32, chords: u32, a: &Point4, b: &Point4) {
        let deviation = if chords > 1 { self.deviation * f64::from(chords * chords) } else { 0.0 };
        if !is_near(a, b, deviation) {
            return;
        }
        if chords == 1 {
            self.chord(first, a, b);
        } else {
            self.fan(first, chords / FAN);
        }
    }

    fn chord(&mut self, chord: u32, a: &Point4, b: &Point4) {
        let found = match self.curves.style {
            CurveStyle::Round => round::enter(a, b).filter(|e| !self.is_within_tube(chord, *e)),
            CurveStyle::Flat => flat::meet(a, b, self.cuts(chord)),
            CurveStyle::Ribbon => ribbon::meet(&self.rung(chord, a), &self.rung(chord + 1, b)),
        };
        let Some(Entry { z, s }) = found else { return };
        let t = self.space.parameter(z);
        let nearer = self.best.map_or(t <= self.tfar, |best| t < best.t);
        if nearer && t > self.tnear {
            self.best = Some(CurveHit { t, u: self.parameter(chord, s) as f32 });
        }
    }

    fn parameter(&self, chord: u32, s: f64) -> f64 {
        (f64::from(chord) + s) / f64::from(self.chords)
    }

    fn vertex(&self, index: u32) -> Point4 {
        self.cubic.at(self.parameter(index, 0.0))
    }

    /// Whether an entry through the ball at a joint of chords lies within the next chord's cone.
    fn is_within_tube(&self, chord: u32, entry: Entry) -> bool {
        let neighbour = match entry.s {
            0.0 if chord > 0 => Some([self.vertex(chord), self.vertex(chord - 1)]),
            0.0 => self.curves.previous(self.segment).map(|s| self.end_chord(s, 1.0)),
            1.0 if chord + 1 < self.chords => Some([self.vertex(chord + 1), self.vertex(chord + 2)]),
            1.0 => self.curves.next(self.segment).map(|s| self.end_chord(s, 0.0)),
            _ => None,
        };
        neighbour.is_some_and(|[a, b]| round::hides(&a, &b, entry.z))
    }

    /// The first (`end` = 0) or last (`end` = 1) chord of another segment, from its end inwards.
    fn end_chord(&self, segment: u32, end: f64) -> [Point4; 2] {
        let cubic = Bezier::new(self.curves, segment, |p| self.space.point(p));
        let step = 1.0 / f64::from(self.curves.chords(segment));
        [cubic.at(end), cubic.at((end - step).abs())]
    }

    /// Which ends of a chord are ends of its curve.
    fn cuts(&self, chord: u32) -> [bool; 2] {
        [
            chord == 0 && self.curves.previous(self.segment).is_none(),
            chord + 1 == self.chords && self.curves.next(self.segment).is_none(),
        ]
    }

    fn rung(&self, index: u32, point: &Point4) -> Rung {
        rung(self.curves, self.segment, self.space, &self.cubic, self.parameter(index, 0.0), point)
    }
}

/// The edges of a ribbon's segment about the point at `u`.
pub(super) fn rung(
    curves: &Curves,
    segment: u32,
    space: &RaySpace,
    cubic: &Bezier,
    u: f64,
    point: &Point4,
) -> Rung {
    let [x, y, z, _] = cubic.derivative(u);
    let normal = space.vector(ribbon::normal(curves.end_normals(segment), u));
    ribbon::rung(point, ribbon::across(normal, [x, y, z]))
}

/// Whether the ray may pass within the radius of the line from `a` to `b`, or of a curve within `deviation` of it.
#[inline(always)]
fn is_near(a: &Point4, b: &Point4, deviation: f64) -> bool {
    let radius = (a[3].max(b[3]) + deviation) * SLACK;
    let [x, y] = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let [dx, dy] = [0.5 * (b[0] - a[0]), 0.5 * (b[1] - a[1])];
    let moment = dx * y - dy * x;
    x.abs() <= dx.abs() + radius
        && y.abs() <= dy.abs() + radius
        && moment * moment <= radius * radius * (dx * dx + dy * dy) * SLACK
}
