//! OpenEXR through the crate `exr`: any channels in, one part of named 32-bit channels out.
//!
//! Written files have one part, ZIP compression of blocks of 16 lines (lossless), and channels `R`, `G`, `B` for the image
//! itself and `layer.X` for the rest. Never DWA: it picks channels to quantise by their names, and so would spoil data
//! layers. The order of custom attributes within a file is not deterministic (the crate keeps them in a hash map); pixels
//! and channels are.
//!
//! Limits: no deep data, no subsampled chroma; of resolution levels the largest, of equal-sized parts all.

use std::io::{Cursor, Seek, Write};
use std::path::Path;

use exr::image::Layer as ExrLayer;
use exr::meta::MetaData;
use exr::meta::header::standard_names;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image,
    IntegerBounds, LayerAttributes, LineOrder, ReadChannels, ReadLayers, SmallVec, Text, Vec2, WritableImage,
    f16, read,
};
use lichtweg::scene::description::{Image as Bitmap, Pixels};

use super::ImageError;
use super::read::{LoadedImage, check_size, read_file};
use super::write::OutputImage;

/// All channels of an EXR file.
#[derive(Clone, Debug, Default)]
pub struct ExrChannels {
    /// Pixels in a row of the data window.
    pub width: u32,
    /// Rows of the data window.
    pub height: u32,
    /// Column and row of the data window's first pixel in the display window's space.
    pub data_offset: [i32; 2],
    /// Width and height of the display window.
    pub display_size: [u32; 2],
    /// Names and numbers of the channels, in the order of the file; `width * height` each, top row first. In files of
    /// several parts the name of the part and a dot come first.
    pub channels: Vec<(String, Vec<f32>)>,
    /// Custom attributes that are text.
    pub metadata: Vec<(String, String)>,
    /// What was left out, one sentence each.
    pub warnings: Vec<String>,
}

impl ExrChannels {
    /// The numbers of a channel.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|(known, _)| known == name).map(|(_, numbers)| numbers.as_slice())
    }
}

/// Reads all channels of an EXR file, numbers of any type as `f32` and unchanged, NaN included.
///
/// # Errors
/// The file cannot be read, is no EXR file, is damaged, has deep data or would take more than 2 GiB.
pub fn read_exr_layers(path: &Path) -> Result<ExrChannels, ImageError> {
    decode(&read_file(path)?).map_err(|error| error.in_file(path))
}

/// Decodes the channels that make up a colour image.
pub(super) fn read_colour(bytes: &[u8]) -> Result<LoadedImage, ImageError> {
    let mut file = decode(bytes)?;
    let names = colour_channels(&file);
    if names.is_empty() {
        return Err(ImageError::new("the EXR file has no channels", "write it with channels R, G and B"));
    }
    if !names.iter().any(|name| is_colour(name)) {
        file.warnings
            .push(format!("the EXR file has no channels R, G, B or Y; `{}` is read as grey", names[0]));
    }
    let planes: Vec<&[f32]> = names.iter().filter_map(|name| file.channel(name)).collect();
    let pixels = file.width as usize * file.height as usize;
    let mut numbers = Vec::with_capacity(pixels * planes.len());
    for pixel in 0..pixels {
        numbers.extend(planes.iter().map(|plane| plane[pixel]));
    }
    let image = Bitmap {
        width: file.width,
        height: file.height,
        channels: planes.len() as u32,
        pixels: Pixels::F32(numbers),
        srgb: false,
    };
    Ok(LoadedImage { image, warnings: file.warnings })
}

fn is_colour(name: &str) -> bool {
    matches!(name.rsplit('.').next(), Some("R" | "Y"))
}

/// `R G B`, `R G B A`, `Y` or `Y A`, unprefixed if there are such, else of the first layer that has them, else whatever
/// channel comes first.
fn colour_channels(file: &ExrChannels) -> Vec<String> {
    let prefixes = file.channels.iter().map(|(name, _)| name.rfind('.').map_or("", |dot| &name[..=dot]));
    for prefix in std::iter::once("").chain(prefixes) {
        for letters in [&["R", "G", "B"][..], &["Y"]] {
            let mut names: Vec<String> = letters.iter().map(|letter| format!("{prefix}{letter}")).collect();
            if names.iter().all(|name| file.channel(name).is_some()) {
                let alpha = format!("{prefix}A");
                names.extend(file.channel(&alpha).is_some().then_some(alpha));
                return names;
            }
        }
    }
    file.channels.iter().take(1).map(|(name, _)| name.clone()).collect()
}

fn decode(bytes: &[u8]) -> Result<ExrChannels, ImageError> {
    check_headers(bytes)?;
    /// Starting threads takes longer than decoding this much.
    const WORTH_THREADS: usize = 1 << 18;
    let reader =
        read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let reader = if bytes.len() < WORTH_THREADS { reader.non_parallel() } else { reader };
    let image = reader.from_buffered(Cursor::new(bytes)).map_err(damaged)?;
    let Some(first) = image.layer_data.first() else { return Ok(ExrChannels::default()) };
    let (size, position) = (first.size, first.attributes.layer_position);
    let window = image.attributes.display_window.size;
    let mut file = ExrChannels {
        width: size.0 as u32,
        height: size.1 as u32,
        data_offset: [position.0, position.1],
        display_size: [window.0 as u32, window.1 as u32],
        ..ExrChannels::default()
    };
    let several = image.layer_data.len() > 1;
    for attribute in image.attributes.other.iter().chain(&first.attributes.other) {
        if let (key, AttributeValue::Text(value)) = attribute {
            file.metadata.push((decode_text(key), decode_text(value)));
        }
    }
    file.metadata.sort();
    for layer in image.layer_data {
        let name = layer.attributes.layer_name.as_ref().map(decode_text).unwrap_or_default();
        if layer.size != size {
            file.warnings.push(format!("the part `{name}` of another size is left out"));
            continue;
        }
        let prefix = if several && !name.is_empty() { format!("{name}.") } else { String::new() };
        for channel in layer.channel_data.list {
            let numbers = to_f32(channel.sample_data);
            if numbers.len() != size.area() {
                return Err(ImageError::new(
                    format!("the channel `{}` is subsampled", channel.name),
                    "write the image as RGB",
                ));
            }
            file.channels.push((format!("{prefix}{}", decode_text(&channel.name)), numbers));
        }
    }
    Ok(file)
}

/// Checks from the headers alone that decoding is possible and takes a sane amount of memory.
fn check_headers(bytes: &[u8]) -> Result<(), ImageError> {
    const LEAST_BYTES_PER_CHUNK: usize = 16;
    let headers = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(damaged)?.headers;
    for header in &headers {
        if header.deep {
            return Err(ImageError::new("the EXR file has deep data", "flatten it first"));
        }
        let size = header.layer_size;
        let channels = header.channels.list.len() * headers.len();
        check_size(size.0 as u64, size.1 as u64, 4 * channels as u64)?;
        if header.chunk_count > bytes.len() / LEAST_BYTES_PER_CHUNK {
            return Err(ImageError::new(
                format!("the EXR header says {} chunks, more than the file can hold", header.chunk_count),
                "the file is truncated or damaged; copy it again",
            ));
        }
    }
    Ok(())
}

fn damaged(error: exr::error::Error) -> ImageError {
    ImageError::new(
        format!("EXR: {error}"),
        "the file is truncated, damaged or of a rare variant; write it again",
    )
}

fn to_f32(samples: FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F16(numbers) => numbers.into_iter().map(f16::to_f32).collect(),
        FlatSamples::F32(numbers) => numbers,
        FlatSamples::U32(numbers) => numbers.into_iter().map(|number| number as f32).collect(),
    }
}

/// Writes all layers.
pub(super) fn write(image: &OutputImage, target: impl Write + Seek) -> Result<(), ImageError> {
    let mut channels = SmallVec::new();
    for layer in &image.layers {
        for (index, channel) in layer.channels.iter().enumerate() {
            let name =
                if layer.name.is_empty() { channel.clone() } else { format!("{}.{channel}", layer.name) };
            let numbers = layer.data.iter().skip(index).step_by(layer.channels.len()).copied().collect();
            channels.push(AnyChannel::new(encode_text(&name), FlatSamples::F32(numbers)));
        }
    }
    let mut attributes = LayerAttributes {
        layer_position: Vec2(image.data_offset[0], image.data_offset[1]),
        software_name: Some(Text::from("Lichtweg")),
        ..LayerAttributes::default()
    };
    for (key, value) in &image.metadata {
        attributes.other.insert(attribute_name(key), AttributeValue::Text(encode_text(value)));
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = Vec2(image.width as usize, image.height as usize);
    let layer = ExrLayer::new(size, attributes, encoding, AnyChannels::sort(channels));
    let mut file = Image::from_layer(layer);
    file.attributes.display_window =
        IntegerBounds::new((0, 0), (image.display_size[0] as usize, image.display_size[1] as usize));
    file.write()
        .to_buffered(target)
        .map_err(|error| ImageError::new(format!("EXR: {error}"), "check the space left on the disk"))
}

/// A valid name for a custom attribute: not empty, at most 255 bytes, and none of the standard ones, whose types are
/// fixed (`version` becomes `lichtweg:version`).
fn attribute_name(key: &str) -> Text {
    let is_standard = key.is_empty() || standard_names::ALL.contains(&key.as_bytes()) || key == "software";
    let name = if is_standard { format!("lichtweg:{key}") } else { key.replace('\0', " ") };
    let end = (0..=255).rev().find(|&end| name.is_char_boundary(end)).unwrap_or(0);
    encode_text(&name[..end])
}

/// EXR texts are bytes of no stated encoding; these are UTF-8.
fn encode_text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

fn decode_text(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}
