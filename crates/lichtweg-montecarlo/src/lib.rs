//! Random numbers, sequences, distributions, running moments and statistical tests: what every random walk needs,
//! in light transport as in linear systems.
//!
//! | module | what | after |
//! |---|---|---|
//! | [`sampler`] | counter-based sample values: a pure function of (seed, stream, sample, dimension) | Salmon et al. 2011; Burley 2020 |
//! | [`hash`], [`owen`] | the mixing function, and Owen-scrambled Sobol' pairs, under it | Stafford 2011; Laine and Karras 2011 |
//! | [`distribution`] | alias and cumulative tables, piecewise constant densities in one and two dimensions | Vose 1991 |
//! | [`warp`] | maps from the unit square to disk, hemisphere, sphere, cone, triangle | Shirley and Chiu 1997; Heitz 2019 |
//! | [`moments`] | running mean and variance, confidence intervals, compensated sums | Welford 1962; Chan et al. 1979 |
//! | [`roulette`] | when to end a walk without bias | Arvo and Kirk 1990 |
//! | [`hypothesis`] | chi-squared, t, z and binomial tests; samplers against densities | Pearson 1900; Welch 1947; Holm 1979 |
//! | [`special`] | gamma, beta and error functions, normal and Student distributions | Abramowitz and Stegun; Loader 2000 |
//!
//! No dependencies, no `unsafe`, no global state; nothing in the sampling path allocates.
//!
//! # Example
//!
//! The area of the unit disk, with an honest interval, and with the same result on any machine and in any order:
//!
//! ```
//! use lichtweg_montecarlo::{Moments, Sampler, SamplerKind};
//!
//! let seed = 2024;
//! let hits: Moments = (0..10_000)
//!     .map(|sample| {
//!         let [x, y] = Sampler::new(SamplerKind::Independent, seed, 0, sample).next_2d();
//!         if x * x + y * y < 1.0 { 4.0 } else { 0.0 }
//!     })
//!     .collect();
//! let (low, high) = hits.confidence_interval(0.9999);
//! assert!(low < std::f64::consts::PI && std::f64::consts::PI < high);
//! ```

pub mod distribution;
pub mod hash;
pub mod hypothesis;
pub mod moments;
pub mod owen;
pub mod roulette;
pub mod sampler;
pub mod special;
pub mod warp;

pub use moments::{CompensatedSum, Moments};
pub use roulette::Roulette;
pub use sampler::{Sampler, SamplerKind, SamplerState};
