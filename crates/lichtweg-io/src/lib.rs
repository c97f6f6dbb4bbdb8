//! Formats in and out: scenes, meshes and images.

pub mod diagnostics;
pub mod image;
pub mod mesh;
pub mod mitsuba;
pub mod pbrt;
