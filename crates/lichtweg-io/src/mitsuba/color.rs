//! Colours and spectra written as values: `<rgb>`, `<srgb>`, `<spectrum>`, `<blackbody>`.

use std::path::Path;

use lichtweg::color::blackbody_luminance;
use lichtweg::scene::description::{Diagnostic, SpectrumDescription};

use super::element::Element;
use super::include::{find, not_found};
use super::number::{parse_float, parse_floats, shortened, tokens};
use super::tree::{ObjectId, Value};
use super::walk::Walk;
use crate::mesh::read_regular_file;

impl Walk<'_> {
    /// Reads a colour as a parameter of `parent`.
    pub fn color(&mut self, element: &Element, parent: ObjectId) {
        // `intent` told Mitsuba 0.x whether to treat a colour as a light's or a surface's; the parameter's use tells here.
        let complete = match element.tag.as_str() {
            "spectrum" => self.check(element, &["name"], &["value", "filename", "intent"]),
            "blackbody" => self.check(element, &["name", "temperature"], &["scale"]),
            _ => self.check(element, &["name", "value"], &["intent"]),
        };
        let value = if complete { self.color_value(element) } else { None };
        match value {
            Some(value) => {
                let span = element.span_of("value");
                self.add(parent, element, Value::Color(value), span);
            }
            None => self.add_invalid(element, parent),
        }
    }

    fn color_value(&mut self, element: &Element) -> Option<SpectrumDescription> {
        if element.tag == "blackbody" {
            return self.blackbody(element);
        }
        if element.tag == "spectrum" && element.has("value") == element.has("filename") {
            let message = "<spectrum> needs either \"value\" or \"filename\"";
            self.error("missing-attribute", message, element.span);
            return None;
        }
        if let Some((name, span)) = element.get("filename") {
            let Some(path) = find(&self.search, name) else {
                self.diagnostics.push(not_found(name, span, &self.search));
                return None;
            };
            let found = read_spectrum(&path);
            return found.map_err(|message| self.error("bad-spectrum", message, span)).ok();
        }
        let (text, span) = element.get("value")?;
        let found = match element.tag.as_str() {
            "srgb" => parse_rgb(text).map(|rgb| SpectrumDescription::Rgb(rgb.map(srgb_to_linear))),
            "spectrum" if self.legacy => parse_legacy_spectrum(text),
            "spectrum" => parse_spectrum(text),
            _ => parse_rgb(text).map(SpectrumDescription::Rgb),
        };
        if found.is_ok() && element.tag == "rgb" && text.trim().starts_with('#') {
            let note = Diagnostic::note("hex-rgb", "the numbers of this <rgb> are taken as linear")
                .at(span, "")
                .help("write <srgb> if the colour comes from a colour picker");
            self.diagnostics.push(note);
        }
        found.map_err(|message| self.error("bad-value", message, span)).ok()
    }

    /// `<blackbody temperature="5000" scale="1"/>` of Mitsuba 0.x.
    fn blackbody(&mut self, element: &Element) -> Option<SpectrumDescription> {
        let (text, span) = element.get("temperature")?;
        let text = text.trim().trim_end_matches(['K', 'k']);
        let found = parse_float(text).and_then(|kelvin| {
            let scale = element.value("scale").map_or(Ok(1.0), parse_float)?;
            blackbody(kelvin, scale)
        });
        found.map_err(|message| self.error("bad-value", message, span)).ok()
    }
}

/// Planck's law for a temperature in kelvin, in W / (m^2 sr nm), times a scale.
pub(super) fn blackbody(kelvin: f64, scale: f64) -> Result<SpectrumDescription, String> {
    if !(1.0..=1e6).contains(&kelvin) {
        return Err(format!("temperature between 1 and 1000000 kelvin expected, got {kelvin}"));
    }
    Ok(SpectrumDescription::Blackbody {
        kelvin: kelvin as f32,
        scale: finite(scale * blackbody_luminance(kelvin))?,
    })
}

/// One number, three numbers, or `#rrggbb`.
fn parse_rgb(text: &str) -> Result<[f32; 3], String> {
    if let Some(digits) = text.trim().strip_prefix('#') {
        let byte = |i: usize| digits.get(2 * i..2 * i + 2).and_then(|d| u8::from_str_radix(d, 16).ok());
        return match (digits.len(), byte(0), byte(1), byte(2)) {
            (6, Some(r), Some(g), Some(b)) => Ok([r, g, b].map(|c| f32::from(c) / 255.0)),
            _ => Err(format!("colour like #ff8000 expected, got '{}'", shortened(text.trim()))),
        };
    }
    match parse_floats(text)?[..] {
        [v] => finite(v).map(|v| [v; 3]),
        [r, g, b] => Ok([finite(r)?, finite(g)?, finite(b)?]),
        ref other => Err(format!("1 or 3 numbers expected, got {}", other.len())),
    }
}

/// A number, or `wavelength:value` pairs.
pub(super) fn parse_spectrum(text: &str) -> Result<SpectrumDescription, String> {
    let parts: Vec<&str> = tokens(text).collect();
    match parts[..] {
        [] => Err("number or wavelength:value pairs expected, got nothing".to_owned()),
        [one] if !one.contains(':') => Ok(SpectrumDescription::Constant(finite(parse_float(one)?)?)),
        _ if parts.len() == 3 && !text.contains(':') => {
            Err("a number or wavelength:value pairs expected; three numbers are written as <rgb>".to_owned())
        }
        _ => {
            let pairs: Result<Vec<_>, String> = parts
                .iter()
                .map(|part| {
                    let (wavelength, value) = part
                        .split_once(':')
                        .ok_or_else(|| format!("wavelength:value expected, got '{}'", shortened(part)))?;
                    Ok((parse_float(wavelength)?, parse_float(value)?))
                })
                .collect();
            sampled(&pairs?)
        }
    }
}

/// Mitsuba 0.x, built for three channels as it usually was, took three plain numbers as RGB, and hexadecimal digits.
fn parse_legacy_spectrum(text: &str) -> Result<SpectrumDescription, String> {
    let plain_triple = !text.contains(':') && tokens(text).count() == 3;
    if plain_triple || text.trim().starts_with('#') {
        return parse_rgb(text).map(SpectrumDescription::Rgb);
    }
    parse_spectrum(text)
}

/// A text file of lines `wavelength value`, with comments after `#`.
fn read_spectrum(path: &Path) -> Result<SpectrumDescription, String> {
    let bytes =
        read_regular_file(path).map_err(|(found, _)| format!("cannot read {}: {found}", path.display()))?;
    let text = String::from_utf8_lossy(&bytes);
    let mut pairs = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("").trim();
        if line.is_empty() {
            continue;
        }
        let place = |message: String| format!("{}: line {}: {message}", path.display(), i + 1);
        match parse_floats(line).map_err(place)?[..] {
            [wavelength, value] => pairs.push((wavelength, value)),
            _ => return Err(place("a wavelength and a value expected".to_owned())),
        }
    }
    sampled(&pairs).map_err(|message| format!("{}: {message}", path.display()))
}

/// A spectrum from pairs of wavelength and value.
pub(super) fn sampled(pairs: &[(f64, f64)]) -> Result<SpectrumDescription, String> {
    if pairs.len() < 2 {
        return Err(format!("at least 2 wavelengths expected, got {}", pairs.len()));
    }
    let wavelengths = pairs.iter().map(|p| finite(p.0)).collect::<Result<Vec<f32>, _>>()?;
    let values = pairs.iter().map(|p| finite(p.1)).collect::<Result<Vec<f32>, _>>()?;
    if let Some(w) = wavelengths.windows(2).find(|w| w[1] <= w[0]) {
        return Err(format!("increasing wavelengths expected, got {} after {}", w[1], w[0]));
    }
    Ok(SpectrumDescription::Sampled { wavelengths, values })
}

/// A number that single precision can hold.
fn finite(value: f64) -> Result<f32, String> {
    let single = value as f32;
    if single.is_finite() { Ok(single) } else { Err(format!("{value:e} is beyond the range of numbers")) }
}

/// The sRGB transfer curve (IEC 61966-2-1).
fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_colours() {
        assert_eq!(parse_rgb("0.5"), Ok([0.5; 3]));
        assert_eq!(parse_rgb("0.1, 0.2 0.3"), Ok([0.1, 0.2, 0.3]));
        assert_eq!(parse_rgb("#ff0080"), Ok([1.0, 0.0, 128.0 / 255.0]));
        for wrong in ["", "1 2", "#ff00", "#gggggg", "1 2 x", "#é0000", "1e300"] {
            assert!(parse_rgb(wrong).is_err(), "{wrong}");
        }
        assert!((srgb_to_linear(0.5) - 0.214_041).abs() < 1e-6);
    }

    #[test]
    fn reads_spectra() {
        assert_eq!(parse_spectrum("2"), Ok(SpectrumDescription::Constant(2.0)));
        let want = SpectrumDescription::Sampled { wavelengths: vec![400.0, 700.0], values: vec![0.1, 0.2] };
        assert_eq!(parse_spectrum("400:0.1, 700:0.2"), Ok(want));
        for wrong in ["", "400:1", "700:1 400:1", "1 2 3", "400:x 500:1"] {
            assert!(parse_spectrum(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_legacy_spectrum("1 2 3"), Ok(SpectrumDescription::Rgb([1.0, 2.0, 3.0])));
        assert!(blackbody(0.0, 1.0).is_err() && blackbody(1e9, 1.0).is_err());
    }
}
