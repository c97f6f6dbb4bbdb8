//! How segments are cut into chords, and chords gathered into pieces for the hierarchy.
//!
//! n chords of a cubic c with |c''| <= M are off by at most M / (8 n^2): n makes this a small part of the largest
//! radius. A piece is 8^levels chords in a row, at most 64. A long thin segment makes a bad box, most of which is empty:
//! it is cut into up to eight pieces, as long as the sum of their areas falls well (pbrt does the same by a fixed count).

use super::bezier::{Bezier, Point4};
use super::capsule::Capsule;
use super::{CurvePoint, CurveStyle, Curves, ribbon};
use crate::build::MAX_COORDINATE;
use crate::math::{Bounds3, Vec3};

/// Chords that are looked at together.
pub(crate) const FAN: u32 = 8;
/// How far a curve may be from its chords, in units of its largest radius.
const TOLERANCE: f64 = 1.0 / 128.0;
/// How far, in radians, a ribbon may turn along a chord.
const TWIST: f64 = 0.05;
/// Levels of chords below a piece, at most.
const MAX_LEVELS: u32 = 2;
/// Pieces of a segment, at most.
const MAX_PIECES: u32 = 8;
/// Two pieces must have at most this part of one's area.
const WORTHWHILE: f64 = 0.75;

/// A run of chords of one segment: what a leaf of the hierarchy holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    /// The segment.
    pub segment: u32,
    /// Which of the segment's pieces.
    index: u16,
    cut: Cut,
    /// A bound on how far the cubic is from its chords.
    pub deviation: f32,
}

/// How a segment is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cut {
    pieces: u8,
    /// A piece has 8^levels chords.
    levels: u8,
}

/// Why a segment has no pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unusable {
    /// NaN, infinite or too large a coordinate or radius, or a negative radius.
    NonFinite,
    /// No width.
    Thin,
}

impl Cut {
    /// Chords of the segment.
    pub(crate) fn chords(self) -> u32 {
        u32::from(self.pieces) * FAN.pow(self.levels.into())
    }

    /// The cut that suits a segment; any where its points are not finite.
    pub(crate) fn new(curves: &Curves, segment: u32) -> Self {
        let cubic = Bezier::new(curves, segment, |p| p);
        let bend = cubic.bend();
        let area = |pieces| area(&cubic, bend, pieces);
        let mut pieces = 1;
        while pieces < MAX_PIECES && area(2 * pieces) <= WORTHWHILE * area(pieces) {
            pieces *= 2;
        }
        let mut needed = (bend / (8.0 * TOLERANCE * cubic.largest_radius())).sqrt();
        if curves.style == CurveStyle::Ribbon {
            needed = needed.max(turn(curves.end_normals(segment)) / TWIST);
        }
        let mut levels = 0;
        while f64::from(pieces * FAN.pow(levels)) < needed && levels < MAX_LEVELS {
            levels += 1;
        }
        while f64::from(pieces * FAN.pow(levels)) < needed && pieces < MAX_PIECES {
            pieces *= 2;
        }
        Self { pieces: pieces as u8, levels: levels as u8 }
    }
}

/// The angle between a ribbon's normals at the ends of a segment.
fn turn([a, b]: [Vec3; 2]) -> f64 {
    f64::from(a.dot(b).clamp(-1.0, 1.0)).acos()
}

/// The sum of the half areas of the boxes of so many pieces, about.
fn area(cubic: &Bezier, bend: f64, pieces: u32) -> f64 {
    let step = 1.0 / f64::from(pieces);
    let deviation = bend * step * step / 8.0;
    let half_area = |i: u32| {
        let (a, b) = (cubic.at(f64::from(i) * step), cubic.at(f64::from(i + 1) * step));
        let width = 2.0 * (a[3].max(b[3]) + deviation);
        let [x, y, z]: [f64; 3] = std::array::from_fn(|i| (a[i] - b[i]).abs() + width);
        x * y + y * z + z * x
    };
    (0..pieces).map(half_area).sum()
}

impl Piece {
    /// The number of the first chord, of the chords, and of all chords of the segment.
    pub(crate) fn chords(self) -> (u32, u32, u32) {
        let all = self.cut.chords();
        let own = all / u32::from(self.cut.pieces);
        (u32::from(self.index) * own, own, all)
    }

    /// The points at the ends of the chords.
    fn vertices(self, curves: &Curves) -> impl Iterator<Item = Point4> + Clone {
        let cubic = Bezier::new(curves, self.segment, |p| p);
        let (first, own, all) = self.chords();
        (first..=first + own).map(move |vertex| cubic.at(f64::from(vertex) / f64::from(all)))
    }

    /// Exact bounds of the balls about the ends of the chords, rounded outwards; all styles are within.
    pub(crate) fn bounds(self, curves: &Curves) -> Bounds3 {
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in self.vertices(curves) {
            for axis in 0..3 {
                lo[axis] = lo[axis].min(p[axis] - p[3]);
                hi[axis] = hi[axis].max(p[axis] + p[3]);
            }
        }
        Bounds3 {
            min: Vec3::from_array(lo.map(|x| (x as f32).next_down())),
            max: Vec3::from_array(hi.map(|x| (x as f32).next_up())),
        }
    }

    /// A capsule around the same balls.
    pub(crate) fn capsule(self, curves: &Curves) -> Capsule {
        let vertices = self.vertices(curves);
        let end = |p: Option<Point4>| p.map_or([0.0; 3], |[x, y, z, _]| [x as f32, y as f32, z as f32]);
        let ends = [end(vertices.clone().next()), end(vertices.clone().last())];
        let [a, b] = ends.map(|end| end.map(f64::from));
        let radius = vertices.fold(0.0_f64, |r, [x, y, z, own]| r.max(distance([x, y, z], a, b) + own));
        Capsule { ends, radius: (radius as f32).next_up() }
    }
}

/// The distance of a point from the line between two others.
fn distance(p: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let difference = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| p[i] - q[i]) };
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let (line, to_p) = (difference(b, a), difference(p, a));
    let length2 = dot(line, line);
    let s = if length2 > 0.0 { (dot(line, to_p) / length2).clamp(0.0, 1.0) } else { 0.0 };
    let apart: [f64; 3] = std::array::from_fn(|i| to_p[i] - s * line[i]);
    dot(apart, apart).sqrt()
}

/// The pieces of a segment, in order.
pub(crate) fn pieces(curves: &Curves, segment: u32) -> Result<impl Iterator<Item = Piece>, Unusable> {
    let control = curves.control(segment);
    let in_range = |x: f32| x.abs() <= MAX_COORDINATE;
    let sound = |p: &CurvePoint| {
        p.radius >= 0.0 && p.position.to_array().into_iter().all(|x| in_range(x.abs() + p.radius))
    };
    if !control.iter().all(sound) {
        return Err(Unusable::NonFinite);
    }
    let flat = curves.style == CurveStyle::Ribbon && is_edge_on(curves, segment);
    if flat || control.iter().all(|p| p.radius == 0.0) {
        return Err(Unusable::Thin);
    }
    let cut = curves.cuts[segment as usize];
    let chords = f64::from(cut.chords());
    let bend = Bezier::new(curves, segment, |p| p).bend();
    let deviation = ((bend / (8.0 * chords * chords)) as f32).next_up();
    Ok((0..u16::from(cut.pieces)).map(move |index| Piece { segment, index, cut, deviation }))
}

/// Whether a ribbon has no normals that would give it a width.
fn is_edge_on(curves: &Curves, segment: u32) -> bool {
    let normals = curves.end_normals(segment);
    let cubic = Bezier::new(curves, segment, |p| p);
    [0.0, 0.5, 1.0].into_iter().all(|u| {
        let [x, y, z, _] = cubic.derivative(u);
        ribbon::across(ribbon::normal(normals, u), [x, y, z]) == [0.0; 3]
    })
}
