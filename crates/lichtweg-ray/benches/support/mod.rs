//! What the benchmarks and examples share.
#![allow(dead_code)]

pub mod embree;
pub mod escape;
pub mod random;
pub mod rays;
pub mod scenes;
pub mod timing;
