//! Textures (Mitsuba 3 `src/textures/bitmap.cpp`, `checkerboard.cpp`; Mitsuba 0.6's `scale`).
//!
//! Mitsuba's texture coordinates have v = 0 in the top row of a bitmap, the description's in the bottom row; every bitmap's
//! `to_uv` is therefore followed by v -> 1 - v, and coordinates elsewhere stay Mitsuba's.

use std::sync::Arc;

use lichtweg::scene::description::{
    Diagnostic, Image, Pixels, Span, SpectrumDescription, TextureDescription, TextureFilter, TextureId,
    TextureInput, TextureKind, UvTransform, WrapMode,
};

use super::assets::{Asset, Place, Target};
use super::include::{find, not_found};
use super::query::values;
use super::translate::Translator;
use super::tree::{Class, Object, ObjectId, Property, Value};

const KNOWN: [&str; 10] =
    ["bitmap", "checkerboard", "scale", "uniform", "rgb", "srgb", "d65", "blackbody", "regular", "irregular"];
const WRAP_MODES: [(&str, WrapMode); 3] =
    [("repeat", WrapMode::Repeat), ("mirror", WrapMode::Mirror), ("clamp", WrapMode::Clamp)];

impl<'a> Translator<'a> {
    /// A parameter that is a number, a colour or a texture.
    pub fn texture_parameter(
        &mut self,
        object: &'a Object,
        name: &'static str,
        default: TextureInput,
    ) -> TextureInput {
        let Some(property) = object.property(name) else { return default };
        match &property.value {
            Value::Object(id) if self.tree.get(*id).class == Class::Texture => {
                self.texture_input(*id).unwrap_or(default)
            }
            Value::Float(_) | Value::Integer(_) | Value::Color(_) | Value::Invalid => {
                let none = SpectrumDescription::Constant(f32::NAN);
                match self.spectrum(object, name, none) {
                    SpectrumDescription::Constant(v) if v.is_nan() => default,
                    spectrum => TextureInput::Constant(spectrum),
                }
            }
            other => {
                let message =
                    format!("\"{name}\": a number, colour or texture expected, got {}", other.kind());
                self.error("wrong-type", message, property.value_span);
                default
            }
        }
    }

    /// A factor on light: not negative, and above 1 only with a warning.
    pub fn reflectance(&mut self, object: &'a Object, name: &'static str, default: f32) -> TextureInput {
        let found = self.texture_parameter(object, name, TextureInput::number(default));
        if let TextureInput::Constant(spectrum) = &found {
            self.refuse_negative(object, name, spectrum);
            if let Some(v) = values(spectrum).iter().find(|v| **v > 1.0) {
                let message = format!("\"{name}\" exceeds 1 with {v}: more light leaves than arrives");
                self.warning("energy-gain", message, object.span_of(name));
            }
        }
        found
    }

    /// A texture object as an input; `None` where it is wrong.
    pub fn texture_input(&mut self, id: ObjectId) -> Option<TextureInput> {
        if let Some(&known) = self.textures.get(&id) {
            return Some(TextureInput::Texture(known));
        }
        let found = self.nested(id, |this, object| this.make_texture(object)).flatten()?;
        if let TextureInput::Texture(texture) = found {
            self.textures.insert(id, texture);
        }
        Some(found)
    }

    /// The same as a texture of its own, even where it is constant.
    pub fn texture_id(&mut self, id: ObjectId) -> Option<TextureId> {
        match self.texture_input(id)? {
            TextureInput::Texture(texture) => Some(texture),
            TextureInput::Constant(spectrum) => {
                let object = self.tree.get(id);
                Some(self.add_texture(object, TextureKind::Constant(spectrum)))
            }
        }
    }

    fn add_texture(&mut self, object: &Object, kind: TextureKind) -> TextureId {
        let (name, span) = (object.id.clone(), object.plugin_span);
        self.description.add_texture(TextureDescription { name, span, kind })
    }

    fn make_texture(&mut self, object: &'a Object) -> Option<TextureInput> {
        let kind = match object.plugin.as_str() {
            "bitmap" => self.bitmap(object),
            "checkerboard" => Some(TextureKind::Checkerboard {
                even: self.texture_parameter(object, "color0", TextureInput::number(0.4)),
                odd: self.texture_parameter(object, "color1", TextureInput::number(0.2)),
                to_uv: self.uv_transform(object),
            }),
            "scale" => self.scaled(object),
            plugin if KNOWN.contains(&plugin) => {
                return self.spectrum_object(object).map(TextureInput::Constant);
            }
            _ => {
                self.unknown_plugin(object, &KNOWN, "mid-grey is used instead");
                return Some(TextureInput::number(0.5));
            }
        };
        self.refuse_unknown(object);
        let Some(kind) = kind else { return Some(TextureInput::number(0.5)) };
        Some(TextureInput::Texture(self.add_texture(object, kind)))
    }

    fn bitmap(&mut self, object: &'a Object) -> Option<TextureKind> {
        object.ignore(&["format", "accel", "cache", "max_anisotropy"]);
        let kind = TextureKind::Bitmap {
            image: Arc::new(no_image()),
            to_uv: flip_v(self.uv_transform(object)),
            wrap: self.wrap_mode(object),
            filter: self.filter_type(object),
            raw: self.raw(object),
            scale: 1.0,
            invert: false,
        };
        let (path, span) = self.image_file(object)?;
        // The texture is added right after.
        let place = Place::Texture(TextureId(self.description.textures.len() as u32));
        self.assets.request(Asset::Image { path }, Target { place, span });
        Some(kind)
    }

    /// The file in `filename`, which must exist.
    pub fn image_file(&mut self, object: &'a Object) -> Option<(std::path::PathBuf, Span)> {
        let (name, span) = self.required_text(object, "filename")?;
        let found = find(&object.search, name);
        if found.is_none() {
            let substitute =
                if object.class == Class::Texture { "mid-grey is used instead" } else { "it is left out" };
            self.diagnostics.unsupported(not_found(name, span, &object.search), substitute);
        }
        Some((found?, span))
    }

    fn wrap_mode(&mut self, object: &'a Object) -> WrapMode {
        // Mitsuba 0.x could wrap the directions differently, and had constants outside.
        let name =
            if object.properties.iter().any(|p| p.name == "wrap_mode") { "wrap_mode" } else { "wrap_mode_u" };
        let wrap = self.choice(object, name, WrapMode::Repeat, &WRAP_MODES);
        if object.legacy
            && name == "wrap_mode_u"
            && self.choice(object, "wrap_mode_v", wrap, &WRAP_MODES) != wrap
        {
            let message = "different wrap modes along u and v are not supported";
            let diagnostic =
                Diagnostic::error("unsupported-value", message).at(object.span_of("wrap_mode_v"), "");
            self.diagnostics.unsupported(diagnostic, "the mode along u is used for both");
        }
        wrap
    }

    fn filter_type(&mut self, object: &'a Object) -> TextureFilter {
        let both = [("bilinear", TextureFilter::Bilinear), ("nearest", TextureFilter::Nearest)];
        // Mitsuba 0.x filtered over pixels' footprints; many samples a pixel do the same.
        let legacy =
            [both[0], both[1], ("ewa", TextureFilter::Bilinear), ("trilinear", TextureFilter::Bilinear)];
        let choices = if object.legacy { &legacy[..] } else { &both[..] };
        self.choice(object, "filter_type", TextureFilter::Bilinear, choices)
    }

    /// `raw`; or the `gamma` of Mitsuba 0.x, where 1 is linear, -1 is what the file says, and anything else is sRGB.
    fn raw(&mut self, object: &'a Object) -> bool {
        let raw = self.boolean(object, "raw", false);
        if !object.properties.iter().any(|p| p.name == "gamma") {
            return raw;
        }
        let gamma = self.float(object, "gamma", -1.0);
        if gamma != 1.0 && gamma != -1.0 && (gamma - 2.2).abs() > 0.05 {
            let message = format!("a gamma of {gamma} is not supported");
            let diagnostic = Diagnostic::error("unsupported-value", message).at(object.span_of("gamma"), "");
            self.diagnostics.unsupported(diagnostic, "the file's own encoding is used");
        }
        raw || gamma == 1.0
    }

    /// A bitmap or colour times a factor, of Mitsuba 0.x.
    fn scaled(&mut self, object: &'a Object) -> Option<TextureKind> {
        let by = self.texture_parameter(object, "scale", TextureInput::number(1.0));
        let nested = self.single(object, Class::Texture);
        let texture = match nested {
            Some(id) => self.texture_input(id)?,
            None => {
                let is_value = |p: &&Property| !matches!(p.value, Value::Object(_)) && !p.queried.get();
                let Some(property) = object.properties.iter().find(is_value) else {
                    self.error(
                        "missing-parameter",
                        "the texture \"scale\" needs a texture to scale",
                        object.plugin_span,
                    );
                    return None;
                };
                property.queried.set(true);
                match &property.value {
                    Value::Color(c) => TextureInput::Constant(c.clone()),
                    Value::Float(v) => TextureInput::number(*v as f32),
                    other => {
                        let message = format!("a texture or colour expected, got {}", other.kind());
                        self.error("wrong-type", message, property.value_span);
                        return None;
                    }
                }
            }
        };
        Some(TextureKind::Scale { texture, by })
    }

    fn uv_transform(&mut self, object: &'a Object) -> UvTransform {
        let legacy = ["uoffset", "voffset", "uscale", "vscale"];
        if object.legacy && object.properties.iter().any(|p| legacy.contains(&p.name.as_str())) {
            // Mitsuba 0.6 scaled before it shifted (`src/libhw/basicshader.cpp`, `Texture2D`).
            let (u, v) = (self.float(object, "uoffset", 0.0), self.float(object, "voffset", 0.0));
            let (su, sv) = (self.float(object, "uscale", 1.0), self.float(object, "vscale", 1.0));
            return UvTransform { rows: [[su, 0.0, u], [0.0, sv, v]] };
        }
        let Some(t) = self.transform(object, "to_uv") else { return UvTransform::default() };
        let row = |r: [f64; 4]| [r[0] as f32, r[1] as f32, r[3] as f32];
        UvTransform { rows: [row(t.rows[0]), row(t.rows[1])] }
    }
}

/// Followed by v -> 1 - v.
fn flip_v(to_uv: UvTransform) -> UvTransform {
    let [u, [a, b, c]] = to_uv.rows;
    UvTransform { rows: [u, [-a, -b, 1.0 - c]] }
}

/// Stands for an image until it is read.
pub(super) fn no_image() -> Image {
    Image { width: 1, height: 1, channels: 1, pixels: Pixels::U8(vec![128]), srgb: false }
}
