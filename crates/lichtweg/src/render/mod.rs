//! The job: a scene, an estimator and a number of samples become an image.

mod image;
mod job;
mod progress;

pub use image::{Layer, RenderedImage};
pub use job::{Job, LayerSelection, RenderError, Rendering, Statistics};
pub use progress::Progress;
