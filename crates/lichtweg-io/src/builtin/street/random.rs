//! Random numbers for the generator: a counted stream from the project's hash, so that a street is a function of its seed.

use std::ops::Range;

use lichtweg_montecarlo::hash::{combine, hash3, unit_f32};

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random {
    key: u64,
    drawn: u64,
}

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self { key: hash3(seed, 0x57ee7, 0), drawn: 0 }
    }

    /// A stream for a part of the scene, so that what the part draws does not move what follows it.
    pub fn fork(&mut self) -> Self {
        Self { key: self.word(), drawn: 0 }
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        unit_f32((self.word() >> 32) as u32)
    }

    /// Uniform in a range.
    pub fn within(&mut self, range: Range<f32>) -> f32 {
        range.start + (range.end - range.start) * self.unit()
    }

    /// Uniform in [-size, size).
    pub fn jitter(&mut self, size: f32) -> f32 {
        self.within(-size..size)
    }

    /// True with a probability.
    pub fn chance(&mut self, probability: f32) -> bool {
        self.unit() < probability
    }

    /// Uniform among 0 .. count.
    pub fn below(&mut self, count: u8) -> u8 {
        (self.unit() * f32::from(count)) as u8
    }

    fn word(&mut self) -> u64 {
        self.drawn += 1;
        combine(self.key, self.drawn)
    }
}
