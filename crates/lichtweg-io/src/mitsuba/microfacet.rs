//! Roughness parameters shared by all microfacet materials (Mitsuba 3 `include/mitsuba/render/microfacet.h`).

use lichtweg::scene::description::{
    Diagnostic, MicrofacetKind, RoughnessDescription, SpectrumDescription, TextureInput,
};

use super::query::values;
use super::translate::Translator;
use super::tree::{Object, Value};

const DISTRIBUTIONS: [(&str, MicrofacetKind); 2] =
    [("beckmann", MicrofacetKind::Beckmann), ("ggx", MicrofacetKind::Ggx)];

impl<'a> Translator<'a> {
    /// `distribution`, and `alpha` or `alpha_u` with `alpha_v`.
    pub fn roughness(&mut self, object: &'a Object) -> RoughnessDescription {
        // Which normals are sampled changes the noise, not the image.
        object.ignore(&["sample_visible"]);
        let distribution = self.distribution(object);
        let given = |name: &str| object.properties.iter().any(|p| p.name == name);
        let (alpha_u, alpha_v) = if given("alpha_u") || given("alpha_v") {
            if given("alpha") {
                let message = "both \"alpha\" and \"alpha_u\" with \"alpha_v\" are given";
                self.error("contradiction", message, object.span_of("alpha"));
                object.ignore(&["alpha"]);
            }
            for (name, other) in [("alpha_u", "alpha_v"), ("alpha_v", "alpha_u")] {
                if !given(name) {
                    let message = format!("\"{other}\" needs \"{name}\" beside it");
                    self.error("missing-parameter", message, object.span_of(other));
                }
            }
            (self.alpha(object, "alpha_u"), self.alpha(object, "alpha_v"))
        } else {
            let alpha = self.alpha(object, "alpha");
            (alpha.clone(), alpha)
        };
        RoughnessDescription { distribution, alpha_u, alpha_v, remap: false }
    }

    fn distribution(&mut self, object: &'a Object) -> MicrofacetKind {
        let old = |text: &str| matches!(text, "phong" | "as");
        if let Some(Value::Text(text)) = object.property("distribution").map(|p| &p.value)
            && object.legacy
            && old(text)
        {
            let message = format!("the microfacet distribution '{text}' of Mitsuba 0.x is not supported");
            let diagnostic =
                Diagnostic::error("unknown-value", message).at(object.span_of("distribution"), "");
            self.diagnostics.unsupported(diagnostic, "\"beckmann\" is used instead");
            return MicrofacetKind::Beckmann;
        }
        self.choice(object, "distribution", MicrofacetKind::Beckmann, &DISTRIBUTIONS)
    }

    fn alpha(&mut self, object: &'a Object, name: &'static str) -> TextureInput {
        let default = TextureInput::number(0.1);
        let found = self.texture_parameter(object, name, default.clone());
        if let TextureInput::Constant(spectrum) = &found {
            let positive = |v: &f32| *v > 0.0 && v.is_finite();
            let number = matches!(spectrum, SpectrumDescription::Constant(_) | SpectrumDescription::Rgb(_));
            if !number || !values(spectrum).iter().all(positive) {
                let message = format!("\"{name}\" must be greater than 0");
                self.error("out-of-range", message, object.span_of(name));
                return default;
            }
        }
        found
    }
}
