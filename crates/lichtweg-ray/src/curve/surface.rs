//! Points on curves, as shading needs them.
//!
//! The point is found again from where it lies along the curve, in `f64` and in the ray's frame: its error is that of the
//! curve's coordinates, however far the ray has come. A ray that comes from +z meets the ball about an axis point (x, y) with
//! radius r at the normal (-x, -y, -sqrt(r^2 - x^2 - y^2)) / r.

use super::bezier::{Bezier, Point4};
use super::intersect::rung;
use super::pieces::Cut;
use super::ray_space::RaySpace;
use super::{CurveBasis, CurveStyle, Curves, ribbon};
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
    /// Derivative of the position by u, along the segment.
    pub along: Vec3,
    /// A tangent across the curve, in the sense of growing v, as long as the curve is wide.
    pub across: Vec3,
    /// Half the width.
    pub radius: f32,
}

impl Curves {
    /// The point of a hit of `ray`, from the segment and the parameters that the hit names.
    pub fn surface(&self, ray: &Ray, segment: u32, u: f32, v: f32) -> CurveSurface {
        let space = RaySpace::new(ray);
        let cubic = Bezier::new(self, segment, |p| space.point(p));
        let chords = f64::from(Cut::of(self, segment).chords());
        let u = f64::from(u.clamp(0.0, 1.0));
        let begin = (u * chords).floor().min(chords - 1.0);
        let (a, b) = (cubic.at(begin / chords), cubic.at((begin + 1.0) / chords));
        let s = u * chords - begin;
        let axis: Point4 = std::array::from_fn(|i| a[i] * (1.0 - s) + b[i] * s);
        let [tx, ty, tz, slope] = cubic.derivative(u);
        let tangent = [tx, ty, tz];
        let chord = unit([b[0] - a[0], b[1] - a[1], b[2] - a[2]]).or(unit(tangent));
        let radius = axis[3];
        let (position, geometric, shading, along, across) = match self.style {
            CurveStyle::Round => {
                let normal = near_side(&axis);
                let smooth = if self.is_smooth(segment, u) { cone(normal, tangent, slope) } else { None };
                let shading = smooth.unwrap_or(normal);
                let position = add([axis[0], axis[1], axis[2]], normal, radius);
                let along = add(tangent, shading, slope);
                (position, normal, shading, along, cross(tangent, shading))
            }
            CurveStyle::Flat => {
                let normal = across_part([0.0, 0.0, -1.0], chord).unwrap_or([0.0, 0.0, -1.0]);
                let shading = across_part(normal, unit(tangent)).unwrap_or(normal);
                ([0.0, 0.0, axis[2]], normal, shading, tangent, [-ty, tx, 0.0])
            }
            CurveStyle::Ribbon => {
                let given = space.vector(ribbon::normal(self.end_normals(segment), u));
                let across = ribbon::across(given, tangent);
                let rungs = [(begin, &a), (begin + 1.0, &b)]
                    .map(|(i, p)| rung(self, segment, &space, &cubic, i / chords, p));
                let side = (2.0 * f64::from(v) - 1.0) * radius;
                let position = ribbon::meet(&rungs[0], &rungs[1])
                    .map_or(add([axis[0], axis[1], axis[2]], across, side), |hit| [0.0, 0.0, hit.z]);
                let shading = across_part(given, unit(tangent)).unwrap_or([0.0, 0.0, -1.0]);
                let normal = across_part(shading, chord).unwrap_or(shading);
                (position, normal, shading, tangent, across)
            }
        };
        let across = unit(across).unwrap_or([0.0; 3]).map(|x| x * 2.0 * radius);
        let vector = |v: [f64; 3]| Vec3::from_array(space.to_world(v).map(|x| x as f32));
        CurveSurface {
            position: Vec3::from_array(space.point_to_world(position).map(|x| x as f32)),
            geometric_normal: vector(geometric),
            shading_normal: vector(shading),
            along: vector(along),
            across: vector(across),
            radius: radius as f32,
        }
    }

    /// Whether the surface at `u` is a tube about a smooth curve: not a ball at an end or between lines.
    fn is_smooth(&self, segment: u32, u: f64) -> bool {
        let ends =
            (u == 0.0 && self.previous(segment).is_none()) || (u == 1.0 && self.next(segment).is_none());
        self.basis != CurveBasis::Linear && !ends
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

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn add(a: [f64; 3], b: [f64; 3], times: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + b[i] * times)
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(v, v).sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}
