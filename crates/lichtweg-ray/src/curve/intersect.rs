//! The search for the first chord of a piece that a ray hits.
//!
//! Eight neighbouring ranges of the curve are looked at together, in `f32` lanes: one that comes no nearer to the ray than its
//! radius is left out; of the others, chords are intersected in `f64` and longer ranges searched in turn. The work is bounded by
//! the number of chords.

use super::bezier::{Bezier, Point4};
use super::capsule::meets_stadium;
use super::pieces::{FAN, Piece};
use super::ray_space::RaySpace;
use super::ribbon::Rung;
use super::round::Entry;
use super::{CurveStyle, Curves, flat, ribbon, round};
use crate::simd::{Aligned8, Isa, Lanes, Portable};
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};

/// Part of the largest coordinate across the ray that makes a margin, for the rounding of the polynomial: 2^-18.
const MARGIN: f64 = 3.814_697e-6;

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
    /// The control points across the ray and their radii, rounded.
    control: [[f32; 3]; 4],
    /// A bound on what comes of the rounding.
    margin: f32,
    /// Bound on how far the curve is from a line between neighbouring vertices.
    deviation: f32,
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
        isa: Isa,
        piece: Piece,
        space: &RaySpace,
        tnear: f32,
        tfar: f32,
    ) -> Option<CurveHit> {
        match isa {
            Isa::Portable => intersect_as::<Portable>(self, piece, space, tnear, tfar),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: values of `Isa` come from detection.
            Isa::Avx2 => unsafe { intersect_avx2(self, piece, space, tnear, tfar) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Isa::Avx512 => unsafe { intersect_avx512(self, piece, space, tnear, tfar) },
        }
    }
}

#[inline(always)]
fn intersect_as<V: Lanes>(
    curves: &Curves,
    piece: Piece,
    space: &RaySpace,
    tnear: f32,
    tfar: f32,
) -> Option<CurveHit> {
    let cubic = Bezier::new(curves, piece.segment, |p| space.point(p));
    let control = cubic.0.map(|[x, y, _, r]| [x as f32, y as f32, r as f32]);
    let largest = cubic.0.iter().fold(0.0_f64, |m, [x, y, _, r]| m.max(x.abs()).max(y.abs()).max(*r));
    let (first, own, chords) = piece.chords();
    let mut search = Search {
        curves,
        segment: piece.segment,
        space,
        cubic,
        control,
        margin: (largest * MARGIN) as f32,
        deviation: piece.deviation,
        chords,
        tnear,
        tfar,
        best: None,
    };
    match own {
        1 => search.chord(first),
        FAN => search.fan::<V>(first),
        _ => {
            let mut near = search.near::<V>(first, FAN);
            while near != 0 {
                search.fan::<V>(first + near.trailing_zeros() * FAN);
                near &= near - 1;
            }
        }
    }
    search.best
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
fn intersect_avx2(c: &Curves, piece: Piece, space: &RaySpace, tnear: f32, tfar: f32) -> Option<CurveHit> {
    intersect_as::<Avx2>(c, piece, space, tnear, tfar)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,avx512f,avx512vl,avx512dq")]
fn intersect_avx512(c: &Curves, piece: Piece, space: &RaySpace, tnear: f32, tfar: f32) -> Option<CurveHit> {
    intersect_as::<Avx512>(c, piece, space, tnear, tfar)
}

impl Search<'_> {
    /// Looks at eight chords, from `first` on.
    #[inline(always)]
    fn fan<V: Lanes>(&mut self, first: u32) {
        let mut near = self.near::<V>(first, 1);
        while near != 0 {
            self.chord(first + near.trailing_zeros());
            near &= near - 1;
        }
    }

    /// Which of eight ranges of `chords` chords each, from the chord `first` on, the ray may meet: range i as bit i.
    #[inline(always)]
    fn near<V: Lanes>(&self, first: u32, chords: u32) -> u32 {
        const FIRST: Aligned8 = Aligned8([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let step = V::splat(chords as f32 / self.chords as f32);
        let begin = V::splat(first as f32 / self.chords as f32);
        let u = V::from_array(FIRST).mul_add(step, begin);
        let [ax, ay, ar] = self.across(u);
        let [bx, by, br] = self.across(u.add(step));
        let deviation = if chords > 1 { self.deviation * (chords * chords) as f32 } else { 0.0 };
        let margin = V::splat(self.margin);
        let radius = ar.max(br).add(V::splat(deviation)).mul_add(V::splat(1.0 + 1e-6), margin);
        V::bits(meets_stadium([ax, ay], [bx, by], radius, margin))
    }

    /// Where the curve is across the ray, and its radius.
    #[inline(always)]
    fn across<V: Lanes>(&self, u: V) -> [V; 3] {
        let v = V::splat(1.0).sub(u);
        let (uu, vv, three) = (u.mul(u), v.mul(v), V::splat(3.0));
        let weights = [vv.mul(v), vv.mul(u).mul(three), uu.mul(v).mul(three), uu.mul(u)];
        [self.blend(0, weights), self.blend(1, weights), self.blend(2, weights)]
    }

    #[inline(always)]
    fn blend<V: Lanes>(&self, what: usize, [a, b, c, d]: [V; 4]) -> V {
        let [p, q, r, s] = &self.control;
        let end = V::splat(r[what]).mul_add(c, V::splat(s[what]).mul(d));
        V::splat(p[what]).mul_add(a, V::splat(q[what]).mul_add(b, end))
    }

    /// Looks at one chord.
    #[inline(always)]
    fn chord(&mut self, chord: u32) {
        let (a, b) = (&self.vertex(chord), &self.vertex(chord + 1));
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
