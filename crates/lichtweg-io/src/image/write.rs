//! Writing rendered images.

use std::io::{BufWriter, Write};
use std::path::Path;

use image::codecs::hdr::HdrEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, Rgb};

use super::atomic::write_atomically;
use super::{ImageError, exr, pfm};

/// A group of channels of the same image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// Empty for the image itself; `variance`, `albedo`, `normal`, `depth`, … for others.
    pub name: String,
    /// One name a channel: `R`, `G`, `B`; `X`, `Y`, `Z`; `Z`; …
    pub channels: Vec<String>,
    /// The numbers, linear, channels interleaved, top row first: `width * height * channels.len()`.
    pub data: Vec<f32>,
}

/// An image to be written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputImage {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The image itself (the layer without a name) and others.
    pub layers: Vec<Layer>,
    /// Keys and values to keep with the image; only EXR does.
    pub metadata: Vec<(String, String)>,
    /// Where a crop's first pixel is in the full image, in columns and rows; only EXR keeps it.
    pub data_offset: [i32; 2],
    /// Width and height of the full image that a crop is part of.
    pub display_size: [u32; 2],
}

impl OutputImage {
    /// An uncropped image without layers.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, display_size: [width, height], ..Self::default() }
    }
}

/// How radiance becomes the 8-bit numbers of a PNG: x * 2^exposure, clamped to [0, 1], through the sRGB curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToneMap {
    /// Exposure in stops; 0 leaves the radiance as it is.
    pub exposure_stops: f32,
}

impl ToneMap {
    /// The 8-bit number that stands for a linear one; NaN is black.
    fn encode(self, linear: f32) -> u8 {
        let exposed = f64::from(linear) * f64::from(self.exposure_stops).exp2();
        to_byte(srgb_curve(exposed.clamp(0.0, 1.0)))
    }
}

/// From linear to sRGB-encoded, both in [0, 1] (IEC 61966-2-1).
fn srgb_curve(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Rounds from [0, 1] to 0 … 255; the cast takes NaN to 0.
fn to_byte(encoded: f64) -> u8 {
    (encoded.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Writes an image in the format that the extension of `path` names, replacing any file there at once and only when
/// complete.
///
/// - `.exr`: all layers as 32-bit floats, lossless, with metadata and crop window;
/// - `.png`: the image itself, 8-bit through `tone_map`, alpha linear;
/// - `.jpg`, `.jpeg`: the same without alpha, lossy, for the web;
/// - `.hdr`, `.pfm`: the image itself, linear; one or three channels (alpha is dropped); in `.hdr` NaN and negative numbers are 0.
///
/// # Errors
/// Unknown extension, a layer whose length does not fit, channels named twice, no image itself where the format needs it,
/// or a file that cannot be written.
pub fn write_image(path: &Path, image: &OutputImage, tone_map: &ToneMap) -> Result<(), ImageError> {
    let extension =
        path.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_ascii_lowercase();
    let write = match extension.as_str() {
        "exr" => write_exr,
        "png" => write_png,
        "jpg" | "jpeg" => write_jpeg,
        "hdr" => write_hdr,
        "pfm" => write_pfm,
        _ => {
            let named = if extension.is_empty() { "none".to_owned() } else { format!("`.{extension}`") };
            return Err(ImageError::new(
                format!("the extension ({named}) names no format that can be written"),
                "choose .exr (all layers), .png or .jpg (8-bit), .hdr or .pfm",
            )
            .in_file(path));
        }
    };
    check(image)
        .and_then(|()| write_atomically(path, |target| write(image, tone_map, target)))
        .map_err(|error| error.in_file(path))
}

type Target = BufWriter<std::fs::File>;

fn write_exr(image: &OutputImage, _: &ToneMap, target: &mut Target) -> Result<(), ImageError> {
    exr::write(image, target)
}

fn write_png(image: &OutputImage, tone_map: &ToneMap, target: &mut Target) -> Result<(), ImageError> {
    let beauty = beauty(image)?;
    let channels = beauty.channels.len();
    let color = match channels {
        1 => ExtendedColorType::L8,
        2 => ExtendedColorType::La8,
        3 => ExtendedColorType::Rgb8,
        _ => ExtendedColorType::Rgba8,
    };
    let alpha = if channels % 2 == 0 { channels - 1 } else { channels };
    let encode = |(index, &number): (usize, &f32)| {
        if index % channels == alpha { to_byte(f64::from(number)) } else { tone_map.encode(number) }
    };
    let bytes: Vec<u8> = beauty.data.iter().enumerate().map(encode).collect();
    PngEncoder::new(target).write_image(&bytes, image.width, image.height, color).map_err(encoding_error)
}

/// Of 100: what is lost is less than the noise of a render.
const JPEG_QUALITY: u8 = 92;

fn write_jpeg(image: &OutputImage, tone_map: &ToneMap, target: &mut Target) -> Result<(), ImageError> {
    let (channels, numbers) = opaque(beauty(image)?);
    let bytes: Vec<u8> = numbers.into_iter().map(|number| tone_map.encode(number)).collect();
    let color = if channels == 1 { ExtendedColorType::L8 } else { ExtendedColorType::Rgb8 };
    JpegEncoder::new_with_quality(target, JPEG_QUALITY)
        .write_image(&bytes, image.width, image.height, color)
        .map_err(encoding_error)
}

/// A mantissa of 255/256 and an exponent of 127.
const LARGEST_RGBE: f32 = 255.0 / 256.0 * 1.701_411_8e38;

fn write_hdr(image: &OutputImage, _: &ToneMap, target: &mut Target) -> Result<(), ImageError> {
    let (channels, numbers) = opaque(beauty(image)?);
    // The format knows neither negative nor subnormal numbers nor infinity.
    let representable = |x: f32| if x >= f32::MIN_POSITIVE { x.min(LARGEST_RGBE) } else { 0.0 };
    let pixel = |p: &[f32]| Rgb([p[0], p[channels / 2], p[channels - 1]].map(representable));
    let rgb: Vec<Rgb<f32>> = numbers.chunks_exact(channels).map(pixel).collect();
    HdrEncoder::new(target).encode(&rgb, image.width as usize, image.height as usize).map_err(encoding_error)
}

fn write_pfm(image: &OutputImage, _: &ToneMap, target: &mut Target) -> Result<(), ImageError> {
    let (channels, numbers) = opaque(beauty(image)?);
    let bytes = pfm::write(image.width as usize, image.height as usize, channels, &numbers);
    target.write_all(&bytes).map_err(|error| encoding_error(image::ImageError::IoError(error)))
}

fn encoding_error(error: image::ImageError) -> ImageError {
    ImageError::new(format!("cannot be written: {error}"), "check the space left on the disk")
}

/// The layer without a name.
fn beauty(image: &OutputImage) -> Result<&Layer, ImageError> {
    let layer = image.layers.iter().find(|layer| layer.name.is_empty());
    layer.filter(|layer| (1..=4).contains(&layer.channels.len())).ok_or_else(|| {
        ImageError::new("there is no layer of one to four channels without a name", "write an .exr file")
    })
}

/// One or three channels: those of the layer without its alpha.
fn opaque(layer: &Layer) -> (usize, Vec<f32>) {
    let all = layer.channels.len();
    let kept = if all < 3 { 1 } else { 3 };
    (kept, layer.data.chunks_exact(all).flat_map(|pixel| pixel[..kept].iter().copied()).collect())
}

fn check(image: &OutputImage) -> Result<(), ImageError> {
    let inconsistent =
        |message: String| Err(ImageError::new(message, "this is an error of the program; report it"));
    if image.width == 0 || image.height == 0 || image.layers.is_empty() {
        return inconsistent(format!(
            "an image of {} x {} pixels and {} layers",
            image.width,
            image.height,
            image.layers.len()
        ));
    }
    let pixels = image.width as usize * image.height as usize;
    let mut names = std::collections::HashSet::new();
    for layer in &image.layers {
        if layer.channels.is_empty() || layer.data.len() != pixels * layer.channels.len() {
            return inconsistent(format!(
                "layer `{}` has {} numbers for {pixels} pixels of {} channels",
                layer.name,
                layer.data.len(),
                layer.channels.len()
            ));
        }
        for channel in &layer.channels {
            if channel.is_empty() || !names.insert((&layer.name, channel)) {
                return inconsistent(format!(
                    "layer `{}` has a channel named `{channel}` twice or not at all",
                    layer.name
                ));
            }
        }
    }
    Ok(())
}
