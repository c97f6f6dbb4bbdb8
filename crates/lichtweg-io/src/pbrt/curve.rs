//! `Shape "curve"` (`Curve::Create` in `shapes.cpp`): Bezier or B-spline segments of degree two or three with a width that goes
//! linearly from one end to the other.
//!
//! All become cubic Bezier segments, as in pbrt. Its `cylinder`, a flat curve with bent normals, is a round tube here, of the same
//! silhouette. Limits: the first surface coordinate goes along the whole curve, not along each segment; a transform that is
//! no similarity scales widths by the cube root of its determinant.

use std::sync::Arc;

use lichtweg::scene::description::{CurvesDescription, Diagnostic, GeometryDescription};
use lichtweg_ray::math::Vec3;
use lichtweg_ray::{CurveBasis, CurvePoint, CurveStyle};

use super::build::Builder;
use super::params::{Params, Type};
use super::report::Report;
use super::state::Entity;

/// A statement's polynomials.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spline {
    /// Rather than Bezier segments.
    uniform: bool,
    degree: usize,
}

impl Builder<'_> {
    /// The curve of a statement.
    pub fn curve(&mut self, entity: &Entity) -> Option<GeometryDescription> {
        let (params, report) = (&entity.params, &mut self.report);
        let ends = widths(params, report);
        let uniform = params.choice("basis", &[("bezier", false), ("bspline", true)], report);
        let styles =
            [("flat", CurveStyle::Flat), ("cylinder", CurveStyle::Round), ("ribbon", CurveStyle::Ribbon)];
        let style = params.choice("type", &styles, report);
        let degree = params.integer_where("degree", 3, |d| d == 2 || d == 3, "must be 2 or 3", report);
        // How finely pbrt cuts curves for its hierarchy.
        params.accept("splitdepth", Type::Integer);
        let spline = Spline { uniform, degree: degree as usize };
        let Some(param) = params.array("P", Type::Point3, report) else {
            if !params.has("P") {
                let diagnostic = Diagnostic::error("missing-parameter", "a curve needs \"point3 P\"");
                report.substitute(diagnostic.at(entity.span, "no control points"), "the shape is left out");
            }
            params.accept("N", Type::Normal);
            return None;
        };
        let control = vectors(param.numbers());
        let Some(segments) = spline.segments(control.len()) else {
            let text = format!("a curve of this basis cannot have {} control points", control.len());
            report.substitute(param.bad_value(text, spline.needs()), "the shape is left out");
            params.accept("N", Type::Normal);
            return None;
        };
        let normals = normals(entity, style, segments, report)?;
        let points = spline.cubic(&control, segments);
        let last = points.len() - 1;
        let radius = |i: usize| {
            let along = i as f32 / last as f32;
            0.5 * (ends[0] * (1.0 - along) + ends[1] * along)
        };
        let points: Vec<CurvePoint> = points
            .into_iter()
            .enumerate()
            .map(|(i, position)| CurvePoint { position, radius: radius(i) })
            .collect();
        Some(GeometryDescription::Curves(Arc::new(CurvesDescription {
            style,
            basis: CurveBasis::Bezier,
            counts: vec![points.len()],
            points,
            normals,
            scales_radii: true,
        })))
    }
}

/// The widths at both ends.
fn widths(params: &Params, report: &mut Report) -> [f32; 2] {
    let mut width = |name, default| {
        let sound = |w: f32| w >= 0.0 && w.is_finite();
        params.float_where(name, default, sound, "must not be negative", report)
    };
    let common = width("width", 1.0);
    [width("width0", common), width("width1", common)]
}

/// The normals of a ribbon; `None` where it does not have them.
fn normals(entity: &Entity, style: CurveStyle, segments: usize, report: &mut Report) -> Option<Vec<Vec3>> {
    let params = &entity.params;
    let needed = segments + 1;
    let param = params.array("N", Type::Normal, report);
    match (param, style) {
        (None, CurveStyle::Ribbon) => {
            let text =
                format!("this ribbon needs {needed} normals \"normal N\", one at each end of a segment");
            let diagnostic = Diagnostic::error("missing-parameter", text).at(entity.span, "no normals");
            report.substitute(diagnostic, "the shape is left out");
            None
        }
        (None, _) => Some(Vec::new()),
        (Some(param), CurveStyle::Ribbon) => {
            let normals = vectors(param.numbers());
            if normals.len() == needed {
                return Some(normals);
            }
            let text = format!("\"N\" has the wrong number of normals: {}", normals.len());
            let label = format!("expected {needed}, one at each end of a segment");
            report.substitute(param.bad_value(text, label), "the shape is left out");
            None
        }
        (Some(param), _) => {
            let text = "the normals \"N\" are used by curves of the type \"ribbon\" alone";
            report.push(Diagnostic::warning("ignored-parameter", text).at(param.span, "not used"));
            Some(Vec::new())
        }
    }
}

fn vectors(numbers: &[f32]) -> Vec<Vec3> {
    numbers.chunks_exact(3).map(|v| Vec3::new(v[0], v[1], v[2])).collect()
}

impl Spline {
    /// Segments of so many control points, if the number makes sense.
    fn segments(self, points: usize) -> Option<usize> {
        let beyond_first = points.checked_sub(self.degree + 1)?;
        let step = if self.uniform { 1 } else { self.degree };
        beyond_first.is_multiple_of(step).then_some(1 + beyond_first / step)
    }

    fn needs(self) -> String {
        let (least, step) = (self.degree + 1, self.degree);
        if self.uniform {
            format!("at least {least} are needed")
        } else {
            format!("{least} are needed, and {step} more a segment")
        }
    }

    /// The control points of cubic Bezier segments, shared where segments meet.
    fn cubic(self, control: &[Vec3], segments: usize) -> Vec<Vec3> {
        let step = if self.uniform { 1 } else { self.degree };
        let mut out = Vec::with_capacity(3 * segments + 1);
        for segment in 0..segments {
            let c = &control[segment * step..][..=self.degree];
            let bezier = match (self.uniform, self.degree) {
                (false, 2) => elevated([c[0], c[1], c[2]]),
                (true, 2) => elevated([(c[0] + c[1]) * 0.5, c[1], (c[1] + c[2]) * 0.5]),
                (false, _) => [c[0], c[1], c[2], c[3]],
                (true, _) => {
                    let joint = |i: usize| (c[i] + c[i + 1] * 4.0 + c[i + 2]) / 6.0;
                    [joint(0), third(c[1], c[2]), third(c[2], c[1]), joint(1)]
                }
            };
            out.truncate(3 * segment);
            out.extend(bezier);
        }
        out
    }
}

/// The point a third of the way from `a` to `b`.
fn third(a: Vec3, b: Vec3) -> Vec3 {
    (a * 2.0 + b) / 3.0
}

/// A quadratic Bezier segment as a cubic one.
fn elevated([a, b, c]: [Vec3; 3]) -> [Vec3; 4] {
    [a, third(b, a), third(b, c), c]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(control: &[Vec3], segment: usize, u: f32) -> Vec3 {
        let c = &control[3 * segment..];
        let v = 1.0 - u;
        c[0] * (v * v * v) + c[1] * (3.0 * u * v * v) + c[2] * (3.0 * u * u * v) + c[3] * (u * u * u)
    }

    #[test]
    fn all_splines_become_cubics() {
        let control: Vec<Vec3> =
            (0..5).map(|i| Vec3::new(i as f32, (i * i) as f32, (i % 2) as f32)).collect();
        let u = 0.3_f32;
        let v = 1.0 - u;
        for (uniform, degree, segments) in [(false, 2, 2), (true, 2, 3), (true, 3, 2)] {
            let spline = Spline { uniform, degree };
            assert_eq!(spline.segments(5), Some(segments));
            let cubic = spline.cubic(&control, segments);
            assert_eq!(cubic.len(), 3 * segments + 1);
            // The second segment, by the definitions of the bases.
            let c = &control[if uniform { 1 } else { degree }..];
            let want = match (uniform, degree) {
                (false, _) => c[0] * (v * v) + c[1] * (2.0 * u * v) + c[2] * (u * u),
                (true, 2) => c[0] * (v * v / 2.0) + c[1] * (0.5 + u * v) + c[2] * (u * u / 2.0),
                _ => {
                    let weights = [
                        v * v * v,
                        3.0 * u * u * u - 6.0 * u * u + 4.0,
                        3.0 * v * v * v - 6.0 * v * v + 4.0,
                        u * u * u,
                    ];
                    weights.iter().zip(c).fold(Vec3::ZERO, |sum, (w, p)| sum + *p * (w / 6.0))
                }
            };
            assert!((point(&cubic, 1, u) - want).length() < 1e-5, "{spline:?}");
        }
        assert_eq!(Spline { uniform: false, degree: 3 }.segments(5), None);
        assert_eq!(Spline { uniform: true, degree: 3 }.segments(3), None);
    }
}
