//! Integrators (Mitsuba 3 `src/integrators/path.cpp`, `direct.cpp`, `volpath.cpp`, `ptracer.cpp`, and the defaults in
//! `src/render/integrator.cpp`; Mitsuba 0.6 `src/integrators/bdpt/bdpt.cpp`, which Mitsuba 3 does not have).
//!
//! Particles end by the albedo of what they meet, so that `ptracer` has no use for its `rr_depth`, which is a matter of noise alone.

use lichtweg::scene::description::{Diagnostic, EstimatorKind, IntegratorDescription, RouletteDescription};

use super::translate::Translator;
use super::tree::{Class, Object};

const KNOWN: [&str; 8] = ["path", "direct", "volpath", "volpathmis", "ptracer", "bdpt", "aov", "moment"];

impl<'a> Translator<'a> {
    /// Translates the scene's integrator.
    pub fn integrator(&mut self, object: &'a Object) {
        match object.plugin.as_str() {
            "path" | "volpath" | "volpathmis" => self.path_tracer(object),
            "ptracer" => {
                // How the work is cut, and, in Mitsuba 0.6, that no connections are made: noise alone.
                object.ignore(&["samples_per_pass", "granularity", "brute_force"]);
                self.walks(object, EstimatorKind::Light);
            }
            "bdpt" => self.bidirectional(object),
            "direct" => {
                object.ignore(&["shading_samples", "emitter_samples", "bsdf_samples", "luminaire_samples"]);
                object.ignore(&["strict_normals"]);
                let hide_emitters = self.boolean(object, "hide_emitters", false);
                self.description.integrator = IntegratorDescription {
                    span: object.plugin_span,
                    max_depth: Some(2),
                    hide_emitters,
                    ..IntegratorDescription::default()
                };
            }
            // They record more than radiance; the radiance is that of the integrator inside of them.
            "aov" | "moment" => return self.wrapper(object),
            _ => {
                self.path_tracer(object);
                self.unknown_plugin(object, &KNOWN, "a path tracer is used instead");
            }
        }
        self.refuse_unknown(object);
    }

    /// Mitsuba 0.6's.
    fn bidirectional(&mut self, object: &'a Object) {
        // Whether vertices choose the light they are connected to: noise alone.
        object.ignore(&["sample_direct"]);
        if !self.boolean(object, "light_image", true)
            && let Some(property) = object.property("light_image")
        {
            let message = "connections to the lens cannot be left out";
            let diagnostic = Diagnostic::error("unsupported", message).at(property.value_span, "");
            self.diagnostics.unsupported(diagnostic, "they are made, which changes the noise alone");
        }
        self.walks(object, EstimatorKind::Bidirectional);
    }

    fn path_tracer(&mut self, object: &'a Object) {
        self.walks(object, EstimatorKind::Path);
    }

    fn walks(&mut self, object: &'a Object, estimator: EstimatorKind) {
        // Whether shading normals may let light through from behind the true surface: never, here.
        object.ignore(&["strict_normals"]);
        let max_depth = self.integer_in(object, "max_depth", -1, -1, i64::from(u32::MAX));
        let rr_depth = self.integer_in(object, "rr_depth", 5, 1, i64::from(u32::MAX));
        let hide_emitters = self.boolean(object, "hide_emitters", false);
        self.description.integrator = IntegratorDescription {
            span: object.plugin_span,
            estimator,
            max_depth: u32::try_from(max_depth).ok(),
            roulette: RouletteDescription { start_depth: u32::try_from(rr_depth).ok() },
            hide_emitters,
            ..IntegratorDescription::default()
        };
    }

    fn wrapper(&mut self, object: &'a Object) {
        let message = format!("the integrator \"{}\" is not supported", object.plugin);
        let diagnostic = Diagnostic::error("unknown-plugin", message).at(object.plugin_span, "");
        self.diagnostics.unsupported(diagnostic, "the integrator inside of it is used");
        object.ignore(&["aovs"]);
        if let Some(inner) = self.single(object, Class::Integrator) {
            self.nested(inner, |this, object| this.integrator(object));
        }
        self.refuse_unknown(object);
    }
}
