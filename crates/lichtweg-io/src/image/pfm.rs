//! PFM, the portable float map: `PF` (colour) or `Pf` (grey), width, height, scale, then rows of 32-bit floats from the
//! bottom up. A negative scale means little-endian; its magnitude multiplies the numbers. Format: Debevec,
//! <https://www.pauldebevec.com/Research/HDR/PFM/>.

use lichtweg::scene::description::{Image, Pixels};

use super::ImageError;
use super::read::{LoadedImage, check_size};

/// Decodes a PFM image.
pub(super) fn read(bytes: &[u8]) -> Result<LoadedImage, ImageError> {
    let (words, body) = header(bytes)?;
    let channels: u32 = if words[0] == "PF" { 3 } else { 1 };
    let width: u64 = words[1].parse().map_err(|_| damaged("width", words[1]))?;
    let height: u64 = words[2].parse().map_err(|_| damaged("height", words[2]))?;
    let scale: f32 = words[3].parse().map_err(|_| damaged("scale", words[3]))?;
    if !scale.is_finite() || scale == 0.0 {
        return Err(damaged("scale", words[3]));
    }
    check_size(width, height, u64::from(channels) * 4)?;
    let row_bytes = width as usize * channels as usize * 4;
    let expected = row_bytes * height as usize;
    if body.len() < expected {
        return Err(ImageError::new(
            format!("the file ends after {} of {expected} bytes of pixels", body.len()),
            "the file is truncated; copy it again",
        ));
    }
    let decode = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let factor = scale.abs();
    let mut numbers = Vec::with_capacity(expected / 4);
    for row in body[..expected].chunks_exact(row_bytes).rev() {
        numbers.extend(row.chunks_exact(4).map(|b| factor * decode([b[0], b[1], b[2], b[3]])));
    }
    let image = Image {
        width: width as u32,
        height: height as u32,
        channels,
        pixels: Pixels::F32(numbers),
        srgb: false,
    };
    Ok(LoadedImage { image, warnings: Vec::new() })
}

/// Encodes `width * height * channels` numbers, top row first; `channels` is 1 or 3.
pub(super) fn write(width: usize, height: usize, channels: usize, numbers: &[f32]) -> Vec<u8> {
    let kind = if channels == 3 { "PF" } else { "Pf" };
    let mut bytes = format!("{kind}\n{width} {height}\n-1.0\n").into_bytes();
    for row in numbers.chunks_exact(width * channels).rev() {
        bytes.extend(row.iter().flat_map(|number| number.to_le_bytes()));
    }
    bytes
}

/// The four words of the header, and what comes after the single white-space character behind them.
fn header(bytes: &[u8]) -> Result<([&str; 4], &[u8]), ImageError> {
    let mut words = [""; 4];
    let mut position = 0;
    for word in &mut words {
        let skipped = bytes[position..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let start = position + skipped;
        let length = bytes[start..].iter().take_while(|byte| byte.is_ascii_graphic()).count();
        position = start + length;
        *word = std::str::from_utf8(&bytes[start..position]).unwrap_or_default();
    }
    match bytes.get(position) {
        Some(byte) if byte.is_ascii_whitespace() && matches!(words[0], "PF" | "Pf") => {
            // Windows writers end the line with two characters; no float of a sane image begins with this pair.
            let end = if bytes[position..].starts_with(b"\r\n") { 2 } else { 1 };
            Ok((words, &bytes[position + end..]))
        }
        _ => Err(ImageError::new(
            "the PFM header is incomplete",
            "it should be `PF` or `Pf`, width, height and scale; the file is truncated or damaged",
        )),
    }
}

fn damaged(what: &str, found: &str) -> ImageError {
    ImageError::new(
        format!("the PFM header has \"{}\" for its {what}", found.escape_debug()),
        "the file is damaged; write it again",
    )
}
