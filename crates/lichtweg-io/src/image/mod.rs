//! Images in and out.
//!
//! [`read_image`] recognises a file by its contents and yields one colour image for a texture or an environment;
//! [`read_exr_layers`] yields every channel of an EXR file. [`write_image`] chooses the format by the extension.

mod atomic;
mod error;
mod exr;
mod pfm;
mod raster;
mod read;
mod write;

pub use self::exr::{ExrChannels, read_exr_layers};
pub use error::ImageError;
pub use read::{LoadedImage, parse_image, read_image};
pub use write::{Layer, OutputImage, ToneMap, write_image};

#[cfg(test)]
mod tests;
