//! Random numbers, sequences, distributions, running moments and statistical tests.

pub mod hash;
pub mod owen;
pub mod sampler;

pub use sampler::{Sampler, SamplerKind};
