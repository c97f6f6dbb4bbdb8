//! The job: a scene, an estimator and a number of samples become an image.

mod bake;
mod image;
mod job;
mod progress;

pub use bake::{BakeSettings, Deposit, IlluminationMap, bake};
pub use image::{Layer, RenderedImage};
pub use job::{FoundPath, Job, LayerSelection, Pyramid, RenderError, Rendering, Statistics, StrategyImage};
pub use progress::Progress;
