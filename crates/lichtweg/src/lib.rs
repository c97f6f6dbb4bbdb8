//! Light transport.

pub mod bsdf;
pub mod camera;
pub mod color;
pub mod film;
pub mod light;
pub mod render;
pub mod scene;
pub mod texture;
pub mod transport;
