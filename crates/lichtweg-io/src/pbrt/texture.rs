//! Textures (`textures.cpp`).
//!
//! Float and spectrum textures have separate names. As in pbrt, image maps exist before all others, then come float
//! and then spectrum textures, each kind in the order of the file; a texture can use those before it.
//!
//! pbrt looks images up at (s, 1 - t), so that v = 0 is the bottom row, as in the description. Its checkerboard has squares
//! of side 1 in (s, t), the description's have 1/2. Encodings apply to PNG files; other 8-bit files are always sRGB.
//!
//! Limits: (u, v) mappings only; no procedural textures but those below. The mean of a coloured image read as numbers
//! is that of the description, not pbrt's (R + G + B) / 3.

use std::sync::Arc;

use lichtweg::scene::description::{
    Diagnostic, Image, Pixels, Span, SpectrumDescription, TextureDescription, TextureFilter, TextureId,
    TextureInput, TextureKind, UvTransform, WrapMode,
};

use super::build::Builder;
use super::params::{Params, Type};
use super::report::suggest;
use super::source_file::has_extension;
use super::spectrum::Use;
use super::state::TextureStatement;

/// Builds all textures.
pub(super) fn build_all(builder: &mut Builder, statements: Vec<TextureStatement>) {
    let (images, others): (Vec<_>, Vec<_>) =
        statements.into_iter().partition(|t| t.entity.kind == "imagemap");
    let (floats, spectra): (Vec<_>, Vec<_>) = others.into_iter().partition(|t| t.is_float);
    for statement in images.into_iter().chain(floats).chain(spectra) {
        let texture = builder.texture(&statement);
        let table =
            if statement.is_float { &mut builder.float_textures } else { &mut builder.spectrum_textures };
        table.insert(statement.name, texture);
    }
}

/// How stored numbers become linear ones.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Srgb,
    Linear,
    Gamma(f32),
}

/// What stands for a texture that cannot be had.
const HALF: TextureKind = TextureKind::Constant(SpectrumDescription::Constant(0.5));

impl Builder<'_> {
    fn texture(&mut self, statement: &TextureStatement) -> TextureId {
        const UNSUPPORTED: [&str; 8] =
            ["bilerp", "directionmix", "dots", "fbm", "marble", "ptex", "windy", "wrinkled"];
        const SUPPORTED: [&str; 5] = ["checkerboard", "constant", "imagemap", "mix", "scale"];
        let (entity, is_float) = (&statement.entity, statement.is_float);
        let params = &entity.params;
        let kind = match entity.kind.as_str() {
            "constant" => match self.operand(params, "value", is_float, 1.0) {
                TextureInput::Constant(value) => TextureKind::Constant(value),
                texture => TextureKind::Scale { texture, by: TextureInput::number(1.0) },
            },
            "scale" => TextureKind::Scale {
                texture: self.operand(params, "tex", is_float, 1.0),
                by: self.operand(params, "scale", true, 1.0),
            },
            "mix" => TextureKind::Mix {
                a: self.operand(params, "tex1", is_float, 0.0),
                b: self.operand(params, "tex2", is_float, 1.0),
                amount: self.operand(params, "amount", true, 0.5),
            },
            "checkerboard" => self.checkerboard(statement),
            "imagemap" => self.image_map(statement),
            known if UNSUPPORTED.contains(&known) => {
                let text = format!("{known} textures are not supported");
                let diagnostic = Diagnostic::error("unsupported", text).at(entity.span, "this texture");
                self.report.substitute(diagnostic, "it is 0.5 everywhere");
                params.accept_all();
                HALF
            }
            other => {
                let diagnostic =
                    Diagnostic::error("unknown-type", format!("\"{other}\" is no type of texture"))
                        .at(entity.span, "unknown texture");
                self.report.substitute(
                    suggest(diagnostic, other, SUPPORTED.into_iter().chain(UNSUPPORTED)),
                    "the texture is 0.5 everywhere",
                );
                params.accept_all();
                HALF
            }
        };
        params.report_unused(&entity.title(), &mut self.report);
        self.add_texture(Some(&statement.name), entity.span, kind)
    }

    /// Adds a texture to the scene.
    pub fn add_texture(&mut self, name: Option<&str>, span: Span, kind: TextureKind) -> TextureId {
        self.scene.add_texture(TextureDescription { name: name.map(str::to_owned), span, kind })
    }

    /// An operand of another texture.
    fn operand(&mut self, params: &Params, name: &'static str, is_float: bool, default: f32) -> TextureInput {
        let stated = if is_float {
            self.float_input(params, name)
        } else {
            self.spectrum_input(params, name, Use::Property)
        };
        stated.unwrap_or(TextureInput::number(default))
    }

    fn checkerboard(&mut self, statement: &TextureStatement) -> TextureKind {
        let (entity, is_float) = (&statement.entity, statement.is_float);
        let params = &entity.params;
        if params.integer("dimension", 2, 2, &mut self.report) != 2 {
            let text = "checkerboards in space are not supported";
            let diagnostic = Diagnostic::error("unsupported", text).at(entity.span, "this texture");
            self.report.substitute(diagnostic, "it is taken as a checkerboard in u and v");
        }
        let even = self.operand(params, "tex1", is_float, 1.0);
        let odd = self.operand(params, "tex2", is_float, 0.0);
        let mut to_uv = self.uv_mapping(statement);
        to_uv.rows.iter_mut().flatten().for_each(|v| *v *= 0.5);
        TextureKind::Checkerboard { even, odd, to_uv }
    }

    /// The mapping from surface to texture coordinates.
    fn uv_mapping(&mut self, statement: &TextureStatement) -> UvTransform {
        let params = &statement.entity.params;
        let mapping = params.string("mapping", &mut self.report).unwrap_or("uv").to_owned();
        if mapping != "uv" {
            let diagnostic = if ["cylindrical", "planar", "spherical"].contains(&mapping.as_str()) {
                Diagnostic::error("unsupported", format!("{mapping} mappings of textures are not supported"))
            } else {
                let diagnostic = Diagnostic::error("unknown-type", format!("\"{mapping}\" is no mapping"));
                suggest(diagnostic, &mapping, ["uv", "cylindrical", "planar", "spherical"])
            };
            let diagnostic = diagnostic.at(statement.entity.span, "this texture");
            self.report.substitute(diagnostic, "the shape's own u and v are used");
            params.accept("v1", Type::Vector3);
            params.accept("v2", Type::Vector3);
        }
        let mut number = |name, default| params.float(name, default, &mut self.report);
        let (su, sv) = (number("uscale", 1.0), number("vscale", 1.0));
        let (du, dv) = (number("udelta", 0.0), number("vdelta", 0.0));
        if mapping == "uv" {
            UvTransform { rows: [[su, 0.0, du], [0.0, sv, dv]] }
        } else {
            UvTransform::default()
        }
    }

    fn image_map(&mut self, statement: &TextureStatement) -> TextureKind {
        let params = &statement.entity.params;
        let to_uv = self.uv_mapping(statement);
        // Anisotropic lookups stand for themselves.
        params.accept("maxanisotropy", Type::Float);
        let filters = [
            ("bilinear", TextureFilter::Bilinear),
            ("point", TextureFilter::Nearest),
            ("trilinear", TextureFilter::Bilinear),
            ("EWA", TextureFilter::Bilinear),
            ("ewa", TextureFilter::Bilinear),
        ];
        let filter = params.choice("filter", &filters, &mut self.report);
        let wraps = [("repeat", WrapMode::Repeat), ("black", WrapMode::Black), ("clamp", WrapMode::Clamp)];
        let wrap = params.choice("wrap", &wraps, &mut self.report);
        let scale = params.float("scale", 1.0, &mut self.report);
        let invert = params.bool("invert", false, &mut self.report);
        let encoding = self.encoding(params);
        let Some(file) = params.one("filename", Type::String, &mut self.report) else {
            if !params.has("filename") {
                let diagnostic =
                    Diagnostic::error("missing-parameter", "an imagemap needs a \"string filename\"");
                self.report.substitute(
                    diagnostic.at(statement.entity.span, "no file"),
                    "the texture is 0.5 everywhere",
                );
            }
            return HALF;
        };
        let path = self.path(&file.strings()[0]);
        let substitute = "the texture is 0.5 everywhere";
        let Some(mut image) = self.files.image(&path, file, substitute, &mut self.report) else {
            return HALF;
        };
        let is_png = has_extension(&path, "png");
        // Of other files pbrt drops the alpha channel.
        if statement.is_float
            && (is_png || has_extension(&path, "exr"))
            && let Some(alpha) = meaningful_alpha(&image)
        {
            image = Arc::new(alpha);
        }
        let raw = match encoding.filter(|_| is_png) {
            Some(Encoding::Linear) => true,
            Some(Encoding::Gamma(exponent)) => {
                image = Arc::new(decoded(&image, exponent));
                false
            }
            _ => false,
        };
        let bitmap = |scale, invert| TextureKind::Bitmap { image, to_uv, wrap, filter, raw, scale, invert };
        if !invert || scale == 1.0 {
            return bitmap(scale, invert);
        }
        // pbrt scales before it inverts: 1 - s x = (1 - s) 1 + s (1 - x).
        let inverted = self.add_texture(None, statement.entity.span, bitmap(1.0, true));
        TextureKind::Mix {
            a: TextureInput::number(1.0),
            b: TextureInput::Texture(inverted),
            amount: TextureInput::number(scale),
        }
    }

    fn encoding(&mut self, params: &Params) -> Option<Encoding> {
        let word = params.string("encoding", &mut self.report)?.to_owned();
        match word.as_str() {
            "sRGB" => return Some(Encoding::Srgb),
            "linear" => return Some(Encoding::Linear),
            _ => {}
        }
        let exponent = word.strip_prefix("gamma ").and_then(|g| g.trim().parse::<f32>().ok());
        if let Some(exponent) = exponent.filter(|g| *g > 0.0 && g.is_finite()) {
            return Some(Encoding::Gamma(exponent));
        }
        if let Some(param) = params.find("encoding", Type::String) {
            let text = format!("\"{word}\" is no encoding");
            self.report.substitute(
                param.bad_value(text, "expected \"sRGB\", \"linear\" or \"gamma <exponent>\""),
                "the usual encoding of the file is assumed",
            );
        }
        None
    }
}

/// The alpha channel as an image of its own, where there is one that is not 1 everywhere: what pbrt reads from such
/// an image as numbers (`util/mipmap.cpp`).
fn meaningful_alpha(image: &Image) -> Option<Image> {
    let channels = image.channels as usize;
    if channels != 4 {
        return None;
    }
    fn last_of<T: Copy + PartialEq>(values: &[T], channels: usize, one: T) -> Option<Vec<T>> {
        let alpha: Vec<T> = values.chunks_exact(channels).map(|pixel| pixel[channels - 1]).collect();
        alpha.iter().any(|a| *a != one).then_some(alpha)
    }
    let pixels = match &image.pixels {
        Pixels::U8(v) => Pixels::U8(last_of(v, channels, u8::MAX)?),
        Pixels::U16(v) => Pixels::U16(last_of(v, channels, u16::MAX)?),
        Pixels::F32(v) => Pixels::F32(last_of(v, channels, 1.0)?),
    };
    Some(Image { channels: 1, pixels, ..*image })
}

/// The image with each number raised to a power.
fn decoded(image: &Image, exponent: f32) -> Image {
    let power = |v: f32| v.max(0.0).powf(exponent);
    let pixels = match &image.pixels {
        Pixels::U8(v) => {
            let table: Vec<f32> = (0..=u8::MAX).map(|i| power(f32::from(i) / 255.0)).collect();
            v.iter().map(|i| table[usize::from(*i)]).collect()
        }
        Pixels::U16(v) => v.iter().map(|i| power(f32::from(*i) / 65535.0)).collect(),
        Pixels::F32(v) => v.iter().map(|x| power(*x)).collect(),
    };
    Image { pixels: Pixels::F32(pixels), srgb: false, ..*image }
}
