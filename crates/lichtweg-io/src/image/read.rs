//! Reading an image of any supported format.

use std::path::Path;

use lichtweg::scene::description::{Image, Pixels};

use super::{ImageError, exr, pfm, raster};

/// An image from a file.
#[derive(Clone, Debug)]
pub struct LoadedImage {
    /// The pixels, at least one, all finite.
    pub image: Image,
    /// What was replaced, left out or assumed, one sentence each.
    pub warnings: Vec<String>,
}

/// Formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Png,
    Jpeg,
    Tga,
    Hdr,
    Pfm,
    Exr,
}

/// Decoded images may take this many bytes.
const MAX_BYTES: u64 = 1 << 31;

/// Reads a PNG, JPEG, TGA, Radiance HDR, PFM or OpenEXR image.
///
/// The contents tell which it is; the extension counts only for TGA, which has no signature. Integers are marked as
/// sRGB-encoded, unless a PNG states a gamma of 1; floating-point numbers are linear. Of an EXR file the channels
/// `R G B A`, `Y A` or those of the first layer that has such are read, in the extent of the data window. Numbers that
/// are NaN or infinite become 0, with a warning.
///
/// # Errors
/// The file cannot be read, is of no supported format, is damaged, has no pixels or would take more than 2 GiB.
pub fn read_image(path: &Path) -> Result<LoadedImage, ImageError> {
    let bytes = read_file(path)?;
    let extension = path.extension().and_then(|extension| extension.to_str());
    parse_image(&bytes, extension).map_err(|error| error.in_file(path))
}

/// Decodes an image in memory, as [`read_image`] does; `extension` is that of its file name, if it has one.
///
/// # Errors
/// As [`read_image`].
pub fn parse_image(bytes: &[u8], extension: Option<&str>) -> Result<LoadedImage, ImageError> {
    let mut loaded = match recognise(bytes, extension)? {
        Format::Exr => exr::read_colour(bytes),
        Format::Pfm => pfm::read(bytes),
        format => raster::read(bytes, format),
    }?;
    replace_non_finite(&mut loaded);
    Ok(loaded)
}

pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, ImageError> {
    crate::mesh::read_regular_file(path)
        .map_err(|(found, help)| ImageError::new(format!("cannot be read: {found}"), help).in_file(path))
}

fn recognise(bytes: &[u8], extension: Option<&str>) -> Result<Format, ImageError> {
    let signatures: [(&[u8], Format); 6] = [
        (b"\x89PNG\r\n\x1a\n", Format::Png),
        (b"\xff\xd8\xff", Format::Jpeg),
        (b"#?", Format::Hdr),
        (b"PF", Format::Pfm),
        (b"Pf", Format::Pfm),
        (b"\x76\x2f\x31\x01", Format::Exr),
    ];
    if let Some((_, format)) = signatures.iter().find(|(signature, _)| bytes.starts_with(signature)) {
        return Ok(*format);
    }
    let has_tga_footer = bytes.ends_with(b"TRUEVISION-XFILE.\0");
    if has_tga_footer || extension.is_some_and(|extension| extension.eq_ignore_ascii_case("tga")) {
        return Ok(Format::Tga);
    }
    let found = match bytes {
        [] => "the file is empty".to_owned(),
        _ => format!("the contents are {}", name_of_unsupported(bytes)),
    };
    Err(ImageError::new(
        found,
        "supported are PNG, JPEG, TGA, Radiance HDR, PFM and OpenEXR; convert the image",
    ))
}

fn name_of_unsupported(bytes: &[u8]) -> &'static str {
    let signatures: [(&[u8], &str); 9] = [
        (b"GIF8", "GIF"),
        (b"BM", "BMP"),
        (b"II*\0", "TIFF"),
        (b"MM\0*", "TIFF"),
        (b"RIFF", "WebP or another RIFF format"),
        (b"DDS ", "DDS"),
        (b"8BPS", "a Photoshop document"),
        (b"\xabKTX", "KTX"),
        (b"<", "HTML or XML"),
    ];
    let known = signatures.iter().find(|(signature, _)| bytes.starts_with(signature));
    known.map_or("of no known image format", |(_, name)| name)
}

/// Refuses images without pixels and those that would take too much memory, before anything is allocated.
pub(super) fn check_size(width: u64, height: u64, bytes_per_pixel: u64) -> Result<(), ImageError> {
    if width == 0 || height == 0 {
        return Err(ImageError::new(
            format!("the image has no pixels: it is {width} x {height}"),
            "the file is damaged; write it again",
        ));
    }
    let bytes = (u128::from(width) * u128::from(height)).saturating_mul(u128::from(bytes_per_pixel));
    if width > u64::from(u32::MAX) || height > u64::from(u32::MAX) || bytes > u128::from(MAX_BYTES) {
        return Err(ImageError::new(
            format!("the image is {width} x {height} and would take {bytes} bytes"),
            "make it smaller; 2 GiB are the most. If it should be small, the file is damaged",
        ));
    }
    Ok(())
}

fn replace_non_finite(loaded: &mut LoadedImage) {
    let Pixels::F32(numbers) = &mut loaded.image.pixels else { return };
    let Some(first) = numbers.iter().position(|x| !x.is_finite()) else { return };
    let mut count = 0_usize;
    for number in numbers.iter_mut().filter(|x| !x.is_finite()) {
        *number = 0.0;
        count += 1;
    }
    let pixel = first / loaded.image.channels as usize;
    let width = loaded.image.width as usize;
    loaded.warnings.push(format!(
        "{count} of {} numbers are NaN or infinite, first in column {} of row {} (from 0, top left); 0 is used",
        numbers.len(),
        pixel % width,
        pixel / width
    ));
}
