//! PNG, JPEG, TGA and Radiance HDR through the crate `image`.

use std::io::Cursor;

use image::codecs::hdr::HdrDecoder;
use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::tga::TgaDecoder;
use image::{ColorType, DynamicImage, ImageDecoder, Limits};
use lichtweg::scene::description::{Image, Pixels};

use super::ImageError;
use super::read::{Format, LoadedImage, check_size};

/// Decodes a file of one of the four formats.
pub(super) fn read(bytes: &[u8], format: Format) -> Result<LoadedImage, ImageError> {
    let cursor = Cursor::new(bytes);
    let mut warnings = Vec::new();
    let (decoded, srgb) = match format {
        Format::Png => {
            let decoder = PngDecoder::with_limits(cursor, limits()).map_err(damaged)?;
            (decode(decoder, bytes.len())?, !is_linear_png(bytes, &mut warnings))
        }
        Format::Jpeg => (decode(JpegDecoder::new(cursor).map_err(damaged)?, bytes.len())?, true),
        Format::Tga => (decode(TgaDecoder::new(cursor).map_err(damaged)?, bytes.len())?, true),
        _ => {
            let decoder = HdrDecoder::with_strictness(cursor, false).map_err(damaged)?;
            (decode(decoder, bytes.len())?, false)
        }
    };
    Ok(LoadedImage { image: convert(decoded, srgb), warnings })
}

fn limits() -> Limits {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(1 << 31);
    limits
}

/// No supported format packs more pixels into a byte than this: a PNG of 1-bit pixels, of which Deflate makes at best
/// 1032 bytes out of one.
const MOST_PIXELS_PER_BYTE: u64 = 8 * 1032;

fn decode(mut decoder: impl ImageDecoder, file_bytes: usize) -> Result<DynamicImage, ImageError> {
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    check_size(u64::from(width), u64::from(height), u64::from(color.bytes_per_pixel()))?;
    if u64::from(width) * u64::from(height) > MOST_PIXELS_PER_BYTE * file_bytes as u64 {
        return Err(ImageError::new(
            format!("the header says {width} x {height} pixels, but the file has only {file_bytes} bytes"),
            "the file is truncated or damaged; copy it again",
        ));
    }
    decoder.set_limits(limits()).map_err(damaged)?;
    DynamicImage::from_decoder(decoder).map_err(damaged)
}

fn damaged(error: image::ImageError) -> ImageError {
    ImageError::new(error.to_string(), "the file is truncated, damaged or of a rare variant; write it again")
}

fn convert(decoded: DynamicImage, srgb: bool) -> Image {
    let (width, height) = (decoded.width(), decoded.height());
    let color = decoded.color();
    let channels = u32::from(color.channel_count());
    let pixels = match color {
        ColorType::L16 => Pixels::U16(decoded.into_luma16().into_raw()),
        ColorType::La16 => Pixels::U16(decoded.into_luma_alpha16().into_raw()),
        ColorType::Rgb16 => Pixels::U16(decoded.into_rgb16().into_raw()),
        ColorType::Rgba16 => Pixels::U16(decoded.into_rgba16().into_raw()),
        ColorType::Rgb32F => Pixels::F32(decoded.into_rgb32f().into_raw()),
        ColorType::Rgba32F => Pixels::F32(decoded.into_rgba32f().into_raw()),
        _ => Pixels::U8(decoded.into_bytes()),
    };
    Image { width, height, channels, pixels, srgb }
}

/// Whether a PNG states that its numbers are linear: by `cICP` with transfer function 8, or by `gAMA` of 1 without
/// anything that overrides it (PNG specification, third edition, section 4.3: `cICP`, `iCCP`, `sRGB`, `gAMA`, in this
/// order). Other gammas than sRGB's are read as sRGB, with a warning.
fn is_linear_png(bytes: &[u8], warnings: &mut Vec<String>) -> bool {
    const SIGNATURE_LENGTH: usize = 8;
    const LINEAR: u32 = 100_000;
    const SRGB: u32 = 45_455;
    let mut rest = &bytes[SIGNATURE_LENGTH..];
    let mut gamma = None;
    while let [l0, l1, l2, l3, k0, k1, k2, k3, body @ ..] = rest {
        let length = u32::from_be_bytes([*l0, *l1, *l2, *l3]) as usize;
        match (&[*k0, *k1, *k2, *k3], body) {
            (b"cICP", [_, transfer, ..]) => return *transfer == 8,
            (b"iCCP" | b"sRGB", _) => return false,
            (b"gAMA", [a, b, c, d, ..]) => gamma = Some(u32::from_be_bytes([*a, *b, *c, *d])),
            (b"IDAT" | b"IEND", _) => break,
            _ => {}
        }
        // Behind the body comes a checksum of four bytes.
        rest = body.get(length.saturating_add(4)..).unwrap_or_default();
    }
    match gamma {
        Some(LINEAR) => true,
        Some(gamma) if gamma.abs_diff(SRGB) > SRGB / 50 => {
            let exponent = f64::from(gamma) / f64::from(LINEAR);
            warnings.push(format!("the PNG states a gamma of {exponent}; it is read as sRGB"));
            false
        }
        _ => false,
    }
}
