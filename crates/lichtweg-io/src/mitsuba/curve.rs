//! Curves from files (Mitsuba 3 `src/shapes/linearcurve.cpp`, `bsplinecurve.cpp`).
//!
//! As there the transform moves control points and leaves radii as they are. Limits: Mitsuba's B-splines are open at their ends,
//! here they end in balls as its linear curves do; surface coordinates go along and across each curve.

use std::sync::Arc;

use lichtweg::scene::description::{CurvesDescription, GeometryDescription};
use lichtweg_ray::math::Affine;
use lichtweg_ray::{CurveBasis, CurveStyle};

use super::assets::Asset;
use super::include::{find, not_found};
use super::shape::Form;
use super::translate::Translator;
use super::tree::Object;

impl<'a> Translator<'a> {
    /// Curves from a file, which must exist.
    pub fn curve_file(&mut self, object: &'a Object) -> Option<Form> {
        let basis = if object.plugin == "linearcurve" { CurveBasis::Linear } else { CurveBasis::BSpline };
        let (name, span) = self.required_text(object, "filename")?;
        let Some(path) = find(&object.search, name) else {
            let diagnostic = not_found(name, span, &object.search);
            self.diagnostics.unsupported(diagnostic, "the shape is left out");
            return None;
        };
        let empty = CurvesDescription {
            style: CurveStyle::Round,
            basis,
            points: Vec::new(),
            counts: Vec::new(),
            normals: Vec::new(),
            scales_radii: false,
        };
        Some(Form {
            geometry: GeometryDescription::Curves(Arc::new(empty)),
            to_object: Affine::IDENTITY,
            flipped_by_mirror: false,
            file: Some((Asset::Curves { path, linear: basis == CurveBasis::Linear }, span)),
        })
    }
}
