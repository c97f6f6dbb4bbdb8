//! Points on curves, as shading needs them.
//!
//! The point is found again from where it lies along the curve, in `f64` and in the ray's frame: its error is that of the
//! curve's coordinates, however far the ray has come. The ray, which runs along +z, enters the ball about an axis point (x, y)
//! with radius r at the normal (-x, -y, -sqrt(r^2 - x^2 - y^2)) / r.

use super::bezier::{Bezier, Point4};
use super::intersect::rung;
use super::ray_space::RaySpace;
use super::{CurveBasis, CurvePoint, CurveStyle, Curves, ribbon};
use crate::math::Vec3;
use crate::ray::Ray;

/// A point on a curve that a ray hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveSurface {
    /// Where.
    pub position: Vec3,
    /// Unit normal of what was hit: outward for round curves, towards the ray's origin for flat ones, along the given normals for
    /// ribbons.
    pub geometric_normal: Vec3,
    /// Unit normal that does not jump from chord to chord.
    pub shading_normal: Vec3,
    /// Half the width.
    pub radius: f32,
}

/// A place along a segment, in a ray's frame.
struct Place<'a> {
    curves: &'a Curves,
    segment: u32,
    space: RaySpace,
    cubic: Bezier,
    u: f64,
    /// The u of the ends of the chord, and their points.
    ends: [(f64, Point4); 2],
    /// The point of the chord.
    axis: Point4,
    /// Derivative of the cubic.
    tangent: [f64; 3],
    /// Derivative of the radius.
    slope: f64,
}

impl<'a> Place<'a> {
    fn new(curves: &'a Curves, ray: &Ray, segment: u32, u: f32) -> Self {
        let space = RaySpace::new(ray);
        let cubic = Bezier::new(curves, segment, |p| space.point(p));
        let chords = f64::from(curves.chords(segment));
        let u = f64::from(u.clamp(0.0, 1.0));
        let begin = (u * chords).floor().min(chords - 1.0);
        let ends = [begin, begin + 1.0].map(|i| (i / chords, cubic.at(i / chords)));
        let s = u * chords - begin;
        let axis = std::array::from_fn(|i| ends[0].1[i] * (1.0 - s) + ends[1].1[i] * s);
        let [x, y, z, slope] = cubic.derivative(u);
        Self { curves, segment, space, cubic, u, ends, axis, tangent: [x, y, z], slope }
    }

    fn center(&self) -> [f64; 3] {
        [self.axis[0], self.axis[1], self.axis[2]]
    }

    fn radius(&self) -> f64 {
        self.axis[3]
    }

    /// Unit vector along the chord.
    fn chord(&self) -> Option<[f64; 3]> {
        let [(_, a), (_, b)] = &self.ends;
        unit([b[0] - a[0], b[1] - a[1], b[2] - a[2]]).or(unit(self.tangent))
    }

    /// The normal of a ribbon, as it is given.
    fn given_normal(&self) -> [f64; 3] {
        self.space.vector(ribbon::normal(self.curves.end_normals(self.segment), self.u))
    }

    /// The unit vector across a band.
    fn across(&self) -> [f64; 3] {
        let [x, y, _] = self.tangent;
        match self.curves.style {
            CurveStyle::Ribbon => ribbon::across(self.given_normal(), self.tangent),
            _ => unit([-y, x, 0.0]).unwrap_or([0.0; 3]),
        }
    }

    /// Where the ray passes between the edges of a band, 0 and 1, as seen along the ray.
    fn v(&self) -> f64 {
        let [x, y, _, r] = self.axis;
        let [dx, dy, _] = self.tangent;
        let [bx, by, _] = self.across();
        let side = (dy * x - dx * y) / (r * (dx * by - dy * bx));
        if side.is_finite() { (0.5 + 0.5 * side).clamp(0.0, 1.0) } else { 0.5 }
    }

    /// The point where the ray meets the ribbon's triangles.
    fn ribbon_point(&self) -> [f64; 3] {
        let [begin, end] =
            self.ends.map(|(u, point)| rung(self.curves, self.segment, &self.space, &self.cubic, u, &point));
        match ribbon::meet(&begin, &end) {
            Some(crossing) => [0.0, 0.0, crossing.z],
            None => add(self.center(), self.across(), (2.0 * self.v() - 1.0) * self.radius()),
        }
    }
}

impl Curves {
    /// The axis and the radius at `u` of a segment; on the cubic itself.
    ///
    /// # Panics
    /// Where there is no such segment.
    pub fn axis(&self, segment: u32, u: f32) -> CurvePoint {
        let [x, y, z, radius] = Bezier::new(self, segment, |p| p).at(u.into()).map(|x| x as f32);
        CurvePoint { position: Vec3::new(x, y, z), radius }
    }

    /// The derivative of the axis by u: the direction of growing u.
    ///
    /// # Panics
    /// Where there is no such segment.
    pub fn tangent(&self, segment: u32, u: f32) -> Vec3 {
        let [x, y, z, _] = Bezier::new(self, segment, |p| p).derivative(u.into()).map(|x| x as f32);
        Vec3::new(x, y, z)
    }

    /// Where a segment is in its curve: its number, and the number of segments.
    ///
    /// # Panics
    /// Where there is no such segment.
    pub fn place_in_curve(&self, segment: u32) -> (u32, u32) {
        let curve = self.segments[segment as usize].curve;
        let begin = self.segments.partition_point(|s| s.curve < curve) as u32;
        let end = self.segments.partition_point(|s| s.curve <= curve) as u32;
        (segment - begin, end - begin)
    }

    /// The second parameter of a hit of `ray` at `u` of a segment: from 0 to 1 across the curve as the ray sees it.
    pub(crate) fn across(&self, ray: &Ray, segment: u32, u: f32) -> f32 {
        Place::new(self, ray, segment, u).v() as f32
    }

    /// The point of a hit of `ray`, from the segment and the u that the hit names.
    ///
    /// # Panics
    /// Where there is no such segment.
    pub fn surface(&self, ray: &Ray, segment: u32, u: f32) -> CurveSurface {
        let place = Place::new(self, ray, segment, u);
        let (tangent, radius) = (place.tangent, place.radius());
        let towards_ray = [0.0, 0.0, -1.0];
        let (position, geometric, shading) = match self.style {
            CurveStyle::Round => {
                let normal = near_side(&place.axis);
                let smooth = if self.is_smooth(&place) { cone(normal, tangent, place.slope) } else { None };
                (add(place.center(), normal, radius), normal, smooth.unwrap_or(normal))
            }
            CurveStyle::Flat => {
                let normal = across_part(towards_ray, place.chord()).unwrap_or(towards_ray);
                let shading = across_part(normal, unit(tangent)).unwrap_or(normal);
                ([0.0, 0.0, place.axis[2]], normal, shading)
            }
            CurveStyle::Ribbon => {
                let shading = across_part(place.given_normal(), unit(tangent)).unwrap_or(towards_ray);
                let normal = across_part(shading, place.chord()).unwrap_or(shading);
                (place.ribbon_point(), normal, shading)
            }
        };
        let vector = |v: [f64; 3]| Vec3::from_array(place.space.world_vector(v).map(|x| x as f32));
        CurveSurface {
            position: Vec3::from_array(place.space.world_point(position).map(|x| x as f32)),
            geometric_normal: vector(geometric),
            shading_normal: vector(shading),
            radius: radius as f32,
        }
    }

    /// Whether the surface at a place is a tube about a smooth curve: not a ball at an end or between lines.
    fn is_smooth(&self, place: &Place) -> bool {
        let first = place.u == 0.0 && self.previous(place.segment).is_none();
        let last = place.u == 1.0 && self.next(place.segment).is_none();
        self.basis != CurveBasis::Linear && !first && !last
    }
}

/// The normal of the ball about an axis point where the z axis enters it.
fn near_side([x, y, _, r]: &Point4) -> [f64; 3] {
    let depth = (r * r - x * x - y * y).max(0.0).sqrt();
    unit([-x, -y, -depth]).unwrap_or([0.0, 0.0, -1.0])
}

/// The normal of a tube about a curve: across the tangent, then tilted by the change of the radius.
fn cone(normal: [f64; 3], tangent: [f64; 3], slope: f64) -> Option<[f64; 3]> {
    let axis = unit(tangent)?;
    let sine = -slope / dot(tangent, axis);
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let radial = across_part(normal, Some(axis))?;
    unit(add(radial.map(|x| x * cosine), axis, sine))
}

/// The unit vector along the part of `v` that is perpendicular to a unit vector.
fn across_part(v: [f64; 3], axis: Option<[f64; 3]>) -> Option<[f64; 3]> {
    let axis = axis?;
    unit(add(v, axis, -dot(v, axis)))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn add(a: [f64; 3], b: [f64; 3], times: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + b[i] * times)
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(v, v).sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}
