//! Textures: functions of surface coordinates (u, v).

use std::sync::Arc;

use super::{Span, SpectrumDescription};

/// Index of a texture in [`Description::textures`](super::Description::textures).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TextureId(pub u32);

/// A parameter that is either constant or textured.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureInput {
    /// The same everywhere.
    Constant(SpectrumDescription),
    /// Looked up.
    Texture(TextureId),
}

impl TextureInput {
    /// A constant number.
    pub fn number(value: f32) -> Self {
        Self::Constant(SpectrumDescription::Constant(value))
    }

    /// A constant linear sRGB colour.
    pub fn rgb(rgb: [f32; 3]) -> Self {
        Self::Constant(SpectrumDescription::Rgb(rgb))
    }
}

/// A texture and where it was stated.
#[derive(Clone, Debug)]
pub struct TextureDescription {
    /// The author's name for it, if any.
    pub name: Option<String>,
    /// Where it was stated.
    pub span: Span,
    /// What it computes.
    pub kind: TextureKind,
}

/// What a texture computes.
#[derive(Clone, Debug)]
pub enum TextureKind {
    /// The input itself: names a constant.
    Constant(SpectrumDescription),
    /// An image map; v = 0 is the image's bottom row.
    Bitmap {
        /// The pixels.
        image: Arc<Image>,
        /// Applied to (u, v) first.
        to_uv: UvTransform,
        /// Beyond [0, 1].
        wrap: WrapMode,
        /// Between pixels.
        filter: TextureFilter,
        /// Take the stored numbers as they are, even where the image is marked as sRGB-encoded.
        raw: bool,
        /// Multiplies the looked-up value.
        scale: f32,
        /// Replace the value x by 1 - x (pbrt's `invert`), before scaling.
        invert: bool,
    },
    /// Squares of side 1/2 in (u, v) after `to_uv`: Mitsuba's pattern (even squares show `even`).
    Checkerboard {
        /// On squares whose two halves agree: u mod 1 and v mod 1 both below or both at least 1/2.
        even: TextureInput,
        /// On the other squares.
        odd: TextureInput,
        /// Applied to (u, v) first.
        to_uv: UvTransform,
    },
    /// The product of two inputs.
    Scale {
        /// One factor.
        texture: TextureInput,
        /// The other.
        by: TextureInput,
    },
    /// (1 - amount) a + amount b.
    Mix {
        /// Shown where `amount` is 0.
        a: TextureInput,
        /// Shown where `amount` is 1.
        b: TextureInput,
        /// Weight of `b`.
        amount: TextureInput,
    },
}

/// The map (u, v) -> A (u, v) + t, as rows `[A | t]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    /// The rows.
    pub rows: [[f32; 3]; 2],
}

impl Default for UvTransform {
    fn default() -> Self {
        Self { rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] }
    }
}

/// What a bitmap shows outside [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WrapMode {
    /// Itself again.
    #[default]
    Repeat,
    /// Itself mirrored.
    Mirror,
    /// Its border.
    Clamp,
    /// Black (pbrt).
    Black,
}

/// How a bitmap is read between pixel centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextureFilter {
    /// The nearest pixel.
    Nearest,
    /// Linear in both directions.
    #[default]
    Bilinear,
}

/// Decoded pixels, top row first.
#[derive(Clone, Debug)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Interleaved channels: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA.
    pub channels: u32,
    /// The numbers.
    pub pixels: Pixels,
    /// Whether the numbers of the colour channels carry the sRGB transfer curve (8- and 16-bit formats usually do).
    pub srgb: bool,
}

/// Channel values, `width * height * channels` of them; integers stand for value / maximum.
#[derive(Clone, Debug)]
pub enum Pixels {
    /// 8-bit.
    U8(Vec<u8>),
    /// 16-bit.
    U16(Vec<u16>),
    /// Floating point, linear.
    F32(Vec<f32>),
}
