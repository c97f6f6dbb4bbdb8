//! Formats in and out: scenes, meshes and images.

pub mod builtin;
pub mod diagnostics;
pub mod image;
pub mod mesh;
pub mod mitsuba;
pub mod options;
pub mod pbrt;
pub mod scene_file;
