//! Integrators (Mitsuba 3 `src/integrators/path.cpp`, `direct.cpp`, `volpath.cpp`, and the defaults in
//! `src/render/integrator.cpp`).

use lichtweg::scene::description::{Diagnostic, IntegratorDescription, RouletteDescription};

use super::translate::Translator;
use super::tree::{Class, Object};

const KNOWN: [&str; 6] = ["path", "direct", "volpath", "volpathmis", "aov", "moment"];

impl<'a> Translator<'a> {
    /// Translates the scene's integrator.
    pub fn integrator(&mut self, object: &'a Object) {
        match object.plugin.as_str() {
            "path" | "volpath" | "volpathmis" => self.path_tracer(object),
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

    fn path_tracer(&mut self, object: &'a Object) {
        // Whether shading normals may let light through from behind the true surface: never, here.
        object.ignore(&["strict_normals"]);
        let max_depth = self.integer_in(object, "max_depth", -1, -1, i64::from(u32::MAX));
        let rr_depth = self.integer_in(object, "rr_depth", 5, 1, i64::from(u32::MAX));
        let hide_emitters = self.boolean(object, "hide_emitters", false);
        self.description.integrator = IntegratorDescription {
            span: object.plugin_span,
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
