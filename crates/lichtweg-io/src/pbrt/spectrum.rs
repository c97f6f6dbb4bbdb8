//! Spectra and textured parameters.
//!
//! pbrt scales each emission by 1 / its luminance (`SpectrumToPhotometric`, `lights.cpp`), where that of an `rgb` is
//! the luminance of its illuminant, white: then rgb is a radiance as it stands, and all others have luminance 1.
//! Outside of its samples a spectrum is zero in pbrt, and constant in the description: zeros are added at both ends.

use std::path::Path;

use lichtweg::color::{Role, luminance, rgb_spectrum};
use lichtweg::scene::description::{Diagnostic, SpectrumDescription, TextureInput};

use super::build::Builder;
use super::named_spectra::{self, Named};
use super::params::{Param, Params, Type};
use super::report::suggest;
use super::source_file::read_bytes;

/// What a spectrum is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// A fraction of light, at most 1.
    Albedo,
    /// Another property, such as an index of refraction.
    Property,
    /// A light.
    Emission,
}

/// The types a spectrum parameter may have.
const SPECTRAL: [Type; 3] = [Type::Rgb, Type::Spectrum, Type::Blackbody];
const SPECTRAL_OR_TEXTURE: [Type; 4] = [Type::Rgb, Type::Spectrum, Type::Blackbody, Type::Texture];

/// Wavelengths in nanometres beyond which nothing is seen.
const VISIBLE: [f32; 2] = [360.0, 830.0];

impl Builder<'_> {
    /// The spectrum of a name, where it is stated.
    pub fn spectrum(
        &mut self,
        params: &Params,
        name: &'static str,
        role: Use,
    ) -> Option<SpectrumDescription> {
        let param = params.find_any(name, &SPECTRAL)?;
        self.spectrum_of(param, role)
    }

    /// A number at each wavelength, which may come from a spectrum texture.
    pub fn spectrum_input(&mut self, params: &Params, name: &'static str, role: Use) -> Option<TextureInput> {
        let param = params.find_any(name, &SPECTRAL_OR_TEXTURE)?;
        if param.kind == Type::Texture {
            return self.texture_named(param, false);
        }
        self.spectrum_of(param, role).map(TextureInput::Constant)
    }

    /// One number, which may come from a float texture.
    pub fn float_input(&mut self, params: &Params, name: &'static str) -> Option<TextureInput> {
        let param = params.find_any(name, &[Type::Float, Type::Texture])?;
        if param.kind == Type::Texture {
            return self.texture_named(param, true);
        }
        params.float_if(name, &mut self.report).map(TextureInput::number)
    }

    fn texture_named(&mut self, param: &Param, is_float: bool) -> Option<TextureInput> {
        let [name] = param.strings() else {
            let text = format!("\"{}\" takes the name of one texture", param.name);
            self.report.substitute(param.bad_value(text, "expected one name"), "the default is used");
            return None;
        };
        let (table, other) = if is_float {
            (&self.float_textures, &self.spectrum_textures)
        } else {
            (&self.spectrum_textures, &self.float_textures)
        };
        if let Some(id) = table.get(name) {
            return Some(TextureInput::Texture(*id));
        }
        let [kind, other_kind] = if is_float { ["float", "spectrum"] } else { ["spectrum", "float"] };
        let text = format!("there is no {kind} texture \"{name}\"");
        let diagnostic = Diagnostic::error("unknown-name", text).at(param.values_span, "not defined before");
        self.report.substitute(
            if other.contains_key(name) {
                diagnostic.help(format!(
                    "there is a {other_kind} texture of that name; \"{}\" needs a {kind} one",
                    param.name
                ))
            } else {
                suggest(diagnostic, name, table.keys().map(String::as_str))
            },
            "the default is used",
        );
        None
    }

    /// The spectrum that a parameter states.
    pub fn spectrum_of(&mut self, param: &Param, role: Use) -> Option<SpectrumDescription> {
        match (param.kind, param.numbers()) {
            (Type::Rgb, &[r, g, b]) => {
                let rgb = param.color_space.to_srgb([r, g, b]);
                let out_of_range = if [r, g, b].iter().any(|v| *v < 0.0) {
                    Some("a colour cannot be negative")
                } else if role == Use::Albedo && [r, g, b].iter().any(|v| *v > 1.0) {
                    Some("more light than arrives cannot be reflected")
                } else {
                    None
                };
                if let Some(why) = out_of_range {
                    let text = format!("\"{}\" is out of range: {why}", param.name);
                    let most = if role == Use::Albedo { "[0, 1]" } else { "0 or more" };
                    self.report
                        .substitute(param.bad_value(text, format!("expected {most}")), "the default is used");
                    return None;
                }
                Some(SpectrumDescription::Rgb(rgb))
            }
            (Type::Blackbody, &[kelvin]) if kelvin > 0.0 => {
                if role == Use::Emission {
                    return Some(SpectrumDescription::Blackbody { kelvin, scale: 1.0 });
                }
                let text = format!("\"{}\" is no light, and cannot be a black body", param.name);
                self.report
                    .substitute(param.bad_value(text, "expected rgb or spectrum"), "the default is used");
                None
            }
            (Type::Spectrum, numbers @ [_, ..]) => self.sampled(numbers, param, role),
            (Type::Spectrum, []) if param.strings().len() == 1 => {
                self.named(&param.strings()[0], param, role)
            }
            _ => {
                let expected = match param.kind {
                    Type::Rgb => "three numbers",
                    Type::Blackbody => "one temperature above 0 kelvin",
                    _ => "pairs of wavelength and value, or one name",
                };
                let text = format!("\"{}\" takes {expected}", param.name);
                self.report
                    .substitute(param.bad_value(text, format!("expected {expected}")), "the default is used");
                None
            }
        }
    }

    /// Pairs of wavelength and value.
    fn sampled(&mut self, numbers: &[f32], param: &Param, role: Use) -> Option<SpectrumDescription> {
        let wavelengths: Vec<f32> = numbers.iter().step_by(2).copied().collect();
        let values: Vec<f32> = numbers.iter().skip(1).step_by(2).copied().collect();
        let wrong = if !numbers.len().is_multiple_of(2) {
            Some("has a wavelength without a value")
        } else if wavelengths.windows(2).any(|w| w[0] >= w[1]) {
            Some("needs wavelengths in increasing order")
        } else if values.iter().any(|v| *v < 0.0) {
            Some("cannot be negative")
        } else {
            None
        };
        if let Some(wrong) = wrong {
            let text = format!("the spectrum \"{}\" {wrong}", param.name);
            self.report.substitute(
                param.bad_value(text, "expected pairs of wavelength and value"),
                "the default is used",
            );
            return None;
        }
        let spectrum = zero_outside(wavelengths, values);
        if role != Use::Emission {
            return Some(spectrum);
        }
        let normalized = of_luminance_one(spectrum);
        if normalized.is_none() {
            let text = format!("the spectrum \"{}\" has no visible light", param.name);
            self.report
                .substitute(param.bad_value(text, "nothing between 360 and 830 nm"), "the default is used");
        }
        normalized
    }

    /// A spectrum known by name, or in a file.
    fn named(&mut self, name: &str, param: &Param, role: Use) -> Option<SpectrumDescription> {
        let Some(named) = named_spectra::find(name) else { return self.spectrum_file(name, param, role) };
        let (fits, spectrum) = match named {
            Named::Metal(spectrum) => (role == Use::Property, spectrum),
            Named::Glass(eta) => (role == Use::Property, SpectrumDescription::Constant(eta)),
            Named::Illuminant(spectrum, color_alone) => {
                if color_alone && role == Use::Emission {
                    let text = format!("of the illuminant {name} the colour is used, not the spectrum");
                    self.report.push(
                        Diagnostic::note("color-of-spectrum", text).at(param.values_span, "this illuminant"),
                    );
                }
                (role == Use::Emission, spectrum)
            }
        };
        if fits {
            return Some(spectrum);
        }
        let text = format!("{name} is not supported as \"{}\"", param.name);
        self.report.substitute(param.bad_value(text, "another kind of quantity"), "the default is used");
        None
    }

    fn spectrum_file(&mut self, name: &str, param: &Param, role: Use) -> Option<SpectrumDescription> {
        let path = self.path(name);
        match read_numbers(&path) {
            Ok(numbers) if numbers.is_empty() => {
                let text = format!("{} has no numbers", path.display());
                self.report.substitute(param.bad_value(text, "this file"), "the default is used");
                None
            }
            Ok(numbers) => self.sampled(&numbers, param, role),
            Err(why) => {
                let text = format!("\"{name}\" is neither a known spectrum nor a file of one: {why}");
                let diagnostic =
                    Diagnostic::error("unknown-spectrum", text).at(param.values_span, "unknown spectrum");
                let names = named_spectra::names();
                self.report.substitute(
                    suggest(diagnostic, name, names.iter().map(String::as_str)),
                    "the default is used",
                );
                None
            }
        }
    }
}

/// Adds zeros beyond the ends of a sampled spectrum where that is within the visible.
fn zero_outside(mut wavelengths: Vec<f32>, mut values: Vec<f32>) -> SpectrumDescription {
    /// Distance of the added samples in nanometres.
    const EDGE: f32 = 0.01;
    let (first, last) = (wavelengths[0], wavelengths[wavelengths.len() - 1]);
    if first > VISIBLE[0] {
        wavelengths.insert(0, first - EDGE);
        values.insert(0, 0.0);
    }
    if last < VISIBLE[1] {
        wavelengths.push(last + EDGE);
        values.push(0.0);
    }
    SpectrumDescription::Sampled { wavelengths, values }
}

/// The same light with luminance 1; `None` where it has none.
fn of_luminance_one(spectrum: SpectrumDescription) -> Option<SpectrumDescription> {
    let total = luminance(rgb_spectrum(&spectrum, Role::Emission)?.to_rgb());
    let SpectrumDescription::Sampled { wavelengths, mut values } = spectrum else { return None };
    values.iter_mut().for_each(|v| *v /= total);
    let usable = total > 0.0 && values.iter().all(|v| v.is_finite());
    usable.then_some(SpectrumDescription::Sampled { wavelengths, values })
}

/// The numbers of a text file; `#` opens a comment.
fn read_numbers(path: &Path) -> Result<Vec<f32>, String> {
    /// Measured spectra have hundreds of samples.
    const MOST_BYTES: u64 = 16 << 20;
    let bytes = read_bytes(path, MOST_BYTES)?;
    let text = String::from_utf8(bytes).map_err(|_| "not a text file".to_owned())?;
    let words = text.lines().flat_map(|line| line.split('#').next().unwrap_or("").split_ascii_whitespace());
    words
        .map(|word| {
            let number = word.parse::<f32>().ok().filter(|v| v.is_finite());
            number.ok_or_else(|| format!("{} holds {word:?}, which is no number", path.display()))
        })
        .collect()
}
