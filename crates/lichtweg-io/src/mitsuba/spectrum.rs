//! Spectra written as objects: `<spectrum type="blackbody" name="radiance">` (Mitsuba 3 `src/spectra/*.cpp`).

use lichtweg::scene::description::SpectrumDescription;

use super::color::{blackbody, sampled};
use super::number::parse_floats;
use super::translate::Translator;
use super::tree::{Object, Value};

const KNOWN: [&str; 7] = ["uniform", "rgb", "srgb", "d65", "blackbody", "regular", "irregular"];

impl<'a> Translator<'a> {
    /// A spectrum object; `None` where it is wrong.
    pub fn spectrum_object(&mut self, object: &'a Object) -> Option<SpectrumDescription> {
        let found = match object.plugin.as_str() {
            "uniform" => {
                object.ignore(&["wavelength_min", "wavelength_max"]);
                Some(SpectrumDescription::Constant(self.float(object, "value", 1.0)))
            }
            "rgb" | "srgb" => {
                let name =
                    if object.properties.iter().any(|p| p.name == "value") { "value" } else { "color" };
                Some(self.spectrum(object, name, SpectrumDescription::Constant(1.0)))
            }
            "d65" => {
                // White in RGB, which is what light is relative to.
                let scale = self.float(object, "scale", 1.0);
                let color = self.spectrum(object, "color", SpectrumDescription::Constant(1.0));
                Some(scaled(color, scale))
            }
            "blackbody" => self.blackbody_object(object),
            "regular" => self.regular(object),
            "irregular" => self.irregular(object),
            _ => {
                self.unknown_plugin(object, &KNOWN, "mid-grey is used instead");
                Some(SpectrumDescription::Constant(0.5))
            }
        };
        self.refuse_unknown(object);
        found
    }

    fn blackbody_object(&mut self, object: &'a Object) -> Option<SpectrumDescription> {
        object.ignore(&["wavelength_min", "wavelength_max"]);
        let scale = self.float(object, "scale", 1.0);
        let Some(kelvin) = self.optional_float(object, "temperature") else {
            if !object.properties.iter().any(|p| p.name == "temperature") {
                let message = "the spectrum \"blackbody\" needs the parameter \"temperature\"";
                self.error("missing-parameter", message, object.plugin_span);
            }
            return None;
        };
        let found = blackbody(kelvin.into(), scale.into());
        found.map_err(|message| self.error("out-of-range", message, object.span_of("temperature"))).ok()
    }

    fn regular(&mut self, object: &'a Object) -> Option<SpectrumDescription> {
        let low = f64::from(self.float(object, "wavelength_min", 360.0));
        let high = f64::from(self.float(object, "wavelength_max", 830.0));
        let values = self.numbers(object, "values")?;
        let step = (high - low) / (values.len().max(2) - 1) as f64;
        let pairs: Vec<_> = values.iter().enumerate().map(|(i, v)| (low + step * i as f64, *v)).collect();
        sampled(&pairs).map_err(|message| self.error("bad-value", message, object.span_of("values"))).ok()
    }

    fn irregular(&mut self, object: &'a Object) -> Option<SpectrumDescription> {
        let wavelengths = self.numbers(object, "wavelengths")?;
        let values = self.numbers(object, "values")?;
        if wavelengths.len() != values.len() {
            let message =
                format!("{} wavelengths need as many values, got {}", wavelengths.len(), values.len());
            self.error("bad-value", message, object.span_of("values"));
            return None;
        }
        let pairs: Vec<_> = wavelengths.into_iter().zip(values).collect();
        sampled(&pairs)
            .map_err(|message| self.error("bad-value", message, object.span_of("wavelengths")))
            .ok()
    }

    fn numbers(&mut self, object: &'a Object, name: &'static str) -> Option<Vec<f64>> {
        if let Some(Value::Float(v)) = object.property(name).map(|p| &p.value) {
            return Some(vec![*v]);
        }
        let (text, span) = self.required_text(object, name)?;
        parse_floats(text).map_err(|message| self.error("bad-value", message, span)).ok()
    }
}

fn scaled(spectrum: SpectrumDescription, by: f32) -> SpectrumDescription {
    match spectrum {
        SpectrumDescription::Constant(v) => SpectrumDescription::Constant(v * by),
        SpectrumDescription::Rgb(rgb) => SpectrumDescription::Rgb(rgb.map(|c| c * by)),
        SpectrumDescription::Sampled { wavelengths, values } => {
            SpectrumDescription::Sampled { wavelengths, values: values.iter().map(|v| v * by).collect() }
        }
        SpectrumDescription::Blackbody { kelvin, scale } => {
            SpectrumDescription::Blackbody { kelvin, scale: scale * by }
        }
        conductor @ SpectrumDescription::Conductor { .. } => conductor,
    }
}
