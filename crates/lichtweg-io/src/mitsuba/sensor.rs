//! Sensors (Mitsuba 3 `src/sensors/perspective.cpp`, `thinlens.cpp`, defaults in `src/render/sensor.cpp`).

use std::sync::Arc;

use lichtweg::scene::description::{CameraDescription, Diagnostic, FieldOfView, FovAxis, SamplerDescription};
use lichtweg_ray::Placement;
use lichtweg_ray::math::{Affine, Motion};

use super::number::{parse_float, shortened};
use super::sampler::DEFAULT_SAMPLES;
use super::translate::Translator;
use super::tree::{Class, Object};

const KNOWN: [&str; 2] = ["perspective", "thinlens"];
const FOV_AXES: [(&str, FovAxis); 5] = [
    ("x", FovAxis::X),
    ("y", FovAxis::Y),
    ("diagonal", FovAxis::Diagonal),
    ("smaller", FovAxis::Smaller),
    ("larger", FovAxis::Larger),
];

impl<'a> Translator<'a> {
    /// Translates the scene's sensor with its film and sampler.
    pub fn sensor(&mut self, object: &'a Object) {
        self.description.sampler =
            SamplerDescription { samples_per_pixel: DEFAULT_SAMPLES, ..SamplerDescription::default() };
        if let Some(film) = self.single(object, Class::Film) {
            self.nested(film, |this, film| this.film(film));
        }
        if let Some(sampler) = self.single(object, Class::Sampler) {
            self.nested(sampler, |this, sampler| this.sampler(sampler));
        }
        let [near_clip, far_clip] = self.clip_distances(object);
        let focus_distance = self.positive(object, "focus_distance", far_clip);
        let aperture_radius = if object.plugin == "thinlens" {
            self.required_aperture(object)
        } else {
            // Mitsuba's pinhole knows no focus, but accepts the parameter.
            0.0
        };
        let (to_world, motion) = match self.placement(object, "to_world") {
            Placement::Fixed(map) => (self.without_scale(object, map), None),
            Placement::Moving(motion) => {
                let keys: Vec<_> =
                    motion.keys().map(|(t, map)| (t, self.without_scale(object, *map))).collect();
                (Affine::IDENTITY, Motion::new(keys).map(Arc::new))
            }
        };
        self.description.camera = CameraDescription {
            span: object.plugin_span,
            to_world,
            motion,
            field_of_view: self.field_of_view(object),
            principal_point_offset: [
                self.float(object, "principal_point_offset_x", 0.0),
                self.float(object, "principal_point_offset_y", 0.0),
            ],
            aperture_radius,
            focus_distance,
            near_clip,
            far_clip,
            shutter: self.shutter(object),
        };
        if !KNOWN.contains(&object.plugin.as_str()) {
            self.unknown_plugin(object, &KNOWN, "a perspective camera is used instead");
        }
        self.refuse_unknown(object);
    }

    fn positive(&mut self, object: &'a Object, name: &'static str, default: f32) -> f32 {
        self.float_in(object, name, default, "greater than 0", |v| v > 0.0)
    }

    fn required_aperture(&mut self, object: &'a Object) -> f32 {
        if object.property("aperture_radius").is_none() {
            let message = "the sensor \"thinlens\" needs the parameter \"aperture_radius\"";
            self.error("missing-parameter", message, object.plugin_span);
        }
        self.float_in(object, "aperture_radius", 0.0, "at least 0", |v| v >= 0.0)
    }

    fn clip_distances(&mut self, object: &'a Object) -> [f32; 2] {
        let near = self.positive(object, "near_clip", 1e-2);
        let far = self.positive(object, "far_clip", 1e4);
        if near >= far {
            let message = format!("\"near_clip\" must be less than \"far_clip\", {far}, and is {near}");
            self.error("out-of-range", message, object.span_of("near_clip"));
        }
        [near, far]
    }

    fn shutter(&mut self, object: &'a Object) -> [f32; 2] {
        let open = self.float(object, "shutter_open", 0.0);
        let close = self.float(object, "shutter_close", open.max(0.0));
        if close < open {
            let message =
                format!("\"shutter_close\" must not be before \"shutter_open\", {open}, and is {close}");
            self.error("out-of-range", message, object.span_of("shutter_close"));
        }
        [open, close]
    }

    fn field_of_view(&mut self, object: &'a Object) -> FieldOfView {
        let between = "between 0 and 180 degrees";
        let fov = object.property("fov").is_some();
        let focal_length = self.text(object, "focal_length");
        let axis = self.choice(object, "fov_axis", FovAxis::X, &FOV_AXES);
        if let (true, Some((_, span))) = (fov, focal_length) {
            self.error("contradiction", "both \"fov\" and \"focal_length\" are given", span);
        }
        if fov {
            let degrees = self.float_in(object, "fov", 50.0, between, |v| v > 0.0 && v < 180.0);
            return FieldOfView::Angle { degrees, axis };
        }
        // On a 35 mm film of 36 mm x 24 mm.
        let millimetres =
            focal_length.map_or(50.0, |(text, span)| match parse_float(text.trim().trim_end_matches("mm")) {
                Ok(v) if v > 1e-3 && v < 1e6 => v,
                _ => {
                    let message = format!("focal length like \"50mm\" expected, got '{}'", shortened(text));
                    self.error("bad-value", message, span);
                    50.0
                }
            });
        let half_diagonal = 0.5 * (36.0f64 * 36.0 + 24.0 * 24.0).sqrt();
        let degrees = 2.0 * (half_diagonal / millimetres).atan().to_degrees();
        FieldOfView::Angle { degrees: degrees as f32, axis: FovAxis::Diagonal }
    }

    /// A camera's transform must not scale; mirrors are allowed.
    fn without_scale(&mut self, object: &'a Object, found: Affine) -> Affine {
        let length = |c: usize| found.rows.iter().map(|r| r[c] * r[c]).sum::<f64>().sqrt();
        let lengths = [length(0), length(1), length(2)];
        if lengths.iter().all(|l| (l - 1.0).abs() < 1e-3) {
            return found;
        }
        let message = "the camera's \"to_world\" scales, which it must not";
        let diagnostic = Diagnostic::error("bad-transform", message).at(object.span_of("to_world"), "");
        self.diagnostics.unsupported(diagnostic, "the scale is taken out");
        let mut unit = found;
        for row in &mut unit.rows {
            row[..3].iter_mut().zip(lengths).for_each(|(entry, length)| *entry /= length);
        }
        unit
    }
}
