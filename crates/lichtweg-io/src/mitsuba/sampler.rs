//! Samplers (Mitsuba 3 `src/samplers/*.cpp`, defaults in `src/render/sampler.cpp`).

use lichtweg::scene::description::{Diagnostic, SamplerDescription};
use lichtweg_montecarlo::SamplerKind;

use super::translate::Translator;
use super::tree::Object;

/// Samples a pixel where a scene does not say.
pub(super) const DEFAULT_SAMPLES: u32 = 4;

const KNOWN: [&str; 8] =
    ["independent", "stratified", "multijitter", "orthogonal", "ldsampler", "sobol", "halton", "hammersley"];

impl<'a> Translator<'a> {
    /// Translates a sensor's sampler.
    pub fn sampler(&mut self, object: &'a Object) {
        let most = i64::from(u32::MAX);
        let samples = self.integer_in(object, "sample_count", DEFAULT_SAMPLES.into(), 1, most);
        let seed = self.integer_in(object, "seed", 0, 0, i64::MAX);
        // How patterns are shuffled makes no difference to what they converge to.
        object.ignore(&["jitter", "strength", "scramble", "dimension"]);
        let kind = match object.plugin.as_str() {
            "independent" => SamplerKind::Independent,
            "sobol" => SamplerKind::Sobol,
            name if KNOWN.contains(&name) => {
                let message = format!("the sampler \"{name}\" is replaced by scrambled Sobol' points");
                self.diagnostics.push(Diagnostic::note("replaced", message).at(object.plugin_span, ""));
                SamplerKind::Sobol
            }
            _ => {
                self.unknown_plugin(object, &KNOWN, "independent samples are used instead");
                SamplerKind::Independent
            }
        };
        self.refuse_unknown(object);
        self.description.sampler = SamplerDescription {
            span: object.plugin_span,
            kind,
            samples_per_pixel: samples as u32,
            seed: seed as u64,
        };
    }
}
