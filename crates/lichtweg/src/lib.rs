//! Light transport.

pub mod bsdf;
pub mod camera;
pub mod color;
pub mod film;
mod lanes;
pub mod light;
pub mod render;
pub mod scene;
pub mod texture;
pub mod transport;

/// The crate by its own name, for what unit tests share with those in `tests`.
#[cfg(test)]
extern crate self as lichtweg;
