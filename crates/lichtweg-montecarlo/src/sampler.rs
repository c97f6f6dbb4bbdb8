//! Counter-based sample values: a pure function of (seed, stream, sample index, dimension).
//!
//! No state is carried from one sample to the next, so an image is bit-identical for any thread count, tile order,
//! shard split or resume (compare Salmon et al., *Parallel random numbers: as easy as 1, 2, 3*, SC 2011).
//!
//! * `Independent`: value = mix64(key + dimension * gamma), key = hash(seed, stream, sample).
//! * `Sobol`: each draw is a point of its own scrambled (0,2)-sequence in base 2, index-shuffled against the other
//!   draws ("padding"; Burley 2020, see [`crate::owen`]). Even and odd sample indices walk two independently scrambled
//!   sequences, so that each of two half-buffers is well stratified and the two are independent. Numbers of samples
//!   that are powers of two are best.
//!
//! Padding stratifies each 1-D or 2-D draw, not joint projections of several draws. Values have 24 bits: events
//! rarer than 2^-24 need [`Sampler::next_1d_f64`] or two draws.

use crate::hash::{GOLDEN_GAMMA, hash3, mix64, unit_f32, unit_f64};
use crate::owen;

/// Which point set a [`Sampler`] walks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SamplerKind {
    /// Independent uniform values.
    #[default]
    Independent,
    /// Padded, Owen-scrambled Sobol' pairs.
    Sobol,
}

/// The sample values of one sample (one path): a counter over dimensions. Cheap to make and to copy.
///
/// ```
/// use lichtweg_montecarlo::{Sampler, SamplerKind};
/// let (seed, pixel) = (7, 1234);
/// let mut sampler = Sampler::new(SamplerKind::Sobol, seed, pixel, 0);
/// let [x, y] = sampler.next_2d();
/// let u = sampler.next_1d();
/// assert!(x < 1.0 && y < 1.0 && u < 1.0);
/// assert_eq!(sampler.dimension(), 3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    key: u64,
    index: u32,
    dimension: u32,
    kind: SamplerKind,
}

/// Where a [`Sampler`] stands, for those who keep many samplers a column a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplerState {
    /// Hash of seed, stream and sequence.
    pub key: u64,
    /// Index in the sequence.
    pub index: u32,
    /// Number of the next dimension.
    pub dimension: u32,
}

impl Sampler {
    /// The values of sample number `sample` of `stream` (a pixel index, a chunk of light paths, ...) under `seed`.
    #[inline]
    #[must_use]
    pub const fn new(kind: SamplerKind, seed: u64, stream: u64, sample: u32) -> Self {
        // Samples of a Sobol sequence share its key: only the index tells them apart.
        let (sequence, index) = match kind {
            SamplerKind::Independent => (sample, 0),
            SamplerKind::Sobol => (sample & 1, sample >> 1),
        };
        Self { key: hash3(seed, stream, sequence as u64), index, dimension: 0, kind }
    }

    /// Where it stands.
    #[inline]
    #[must_use]
    pub const fn state(&self) -> SamplerState {
        SamplerState { key: self.key, index: self.index, dimension: self.dimension }
    }

    /// Goes on from where a sampler of the same kind stood.
    #[inline]
    #[must_use]
    pub const fn from_state(kind: SamplerKind, state: SamplerState) -> Self {
        Self { key: state.key, index: state.index, dimension: state.dimension, kind }
    }

    /// The same sample, continued at `dimension`: gives a bounce or a subpath a fixed place in the sequence no matter
    /// how many values were drawn before.
    #[inline]
    #[must_use]
    pub const fn at_dimension(self, dimension: u32) -> Self {
        Self { dimension, ..self }
    }

    /// Number of the next dimension: a 1-D draw takes one, a 2-D draw takes two.
    #[inline]
    #[must_use]
    pub const fn dimension(&self) -> u32 {
        self.dimension
    }

    /// The kind of point set.
    #[inline]
    #[must_use]
    pub const fn kind(&self) -> SamplerKind {
        self.kind
    }

    /// Uniform value in [0,1), a multiple of 2^-24.
    #[inline]
    pub const fn next_1d(&mut self) -> f32 {
        let bits = self.draw_bits(1);
        match self.kind {
            SamplerKind::Independent => unit_f32((bits >> 32) as u32),
            SamplerKind::Sobol => unit_f32(self.sobol_1d(bits)),
        }
    }

    /// Uniform point in [0,1)^2, coordinates multiples of 2^-24.
    #[inline]
    pub const fn next_2d(&mut self) -> [f32; 2] {
        let bits = self.draw_bits(2);
        match self.kind {
            SamplerKind::Independent => [unit_f32((bits >> 32) as u32), unit_f32(bits as u32)],
            SamplerKind::Sobol => {
                let index = owen::shuffle_index(self.index, bits as u32);
                let seeds = mix64(bits ^ GOLDEN_GAMMA);
                [
                    unit_f32(owen::van_der_corput(index, (seeds >> 32) as u32)),
                    unit_f32(owen::sobol_second(index, seeds as u32)),
                ]
            }
        }
    }

    /// Uniform value in [0,1) with 53 bits, for rare events and for choices among very many.
    #[inline]
    pub const fn next_1d_f64(&mut self) -> f64 {
        let bits = self.draw_bits(1);
        match self.kind {
            SamplerKind::Independent => unit_f64(bits),
            SamplerKind::Sobol => {
                // The sequence has 32 digits; those below are independent of one sample to the next.
                let tail = mix64(bits.wrapping_add(self.index as u64)) >> 32;
                unit_f64((self.sobol_1d(bits) as u64) << 32 | tail)
            }
        }
    }

    /// The 64 random bits of the current dimension; moves on by `count` dimensions.
    #[inline(always)]
    const fn draw_bits(&mut self, count: u32) -> u64 {
        let bits = mix64(self.key.wrapping_add((self.dimension as u64).wrapping_mul(GOLDEN_GAMMA)));
        self.dimension = self.dimension.wrapping_add(count);
        bits
    }

    #[inline(always)]
    const fn sobol_1d(&self, bits: u64) -> u32 {
        owen::van_der_corput(owen::shuffle_index(self.index, bits as u32), (bits >> 32) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [SamplerKind; 2] = [SamplerKind::Independent, SamplerKind::Sobol];

    #[test]
    fn is_a_pure_function_of_its_arguments() {
        for kind in KINDS {
            let forward: Vec<[f32; 2]> =
                (0..100).map(|i| Sampler::new(kind, 3, 14, i).at_dimension(6).next_2d()).collect();
            for i in (0..100_u32).rev() {
                let mut sampler = Sampler::new(kind, 3, 14, i);
                for _ in 0..2 {
                    let _ = (sampler.next_1d(), sampler.next_2d());
                }
                assert_eq!(sampler.dimension(), 6);
                assert_eq!(sampler.next_2d(), forward[i as usize]);
            }
        }
    }

    /// Frozen values: a change of the sample function changes every image and must be deliberate.
    #[test]
    fn sample_values_are_stable() {
        let bits = |kind| {
            let mut sampler = Sampler::new(kind, 1, 2, 3);
            [sampler.next_1d(), sampler.next_2d()[0], sampler.next_2d()[1]].map(|u| (u * 16_777_216.0) as u32)
        };
        assert_eq!(bits(SamplerKind::Independent), [15_027_846, 8_073_962, 8_936_104]);
        assert_eq!(bits(SamplerKind::Sobol), [13_250_576, 2_369_823, 11_077_365]);
    }

    #[test]
    fn stays_below_one() {
        for kind in KINDS {
            for sample in 0..1 << 16 {
                let mut sampler = Sampler::new(kind, 5, 5, sample);
                let [x, y] = sampler.next_2d();
                let values = [x, y, sampler.next_1d()];
                assert!(values.iter().all(|u| (0.0..1.0).contains(u)), "{kind:?} {sample} {values:?}");
                assert!((0.0..1.0).contains(&sampler.next_1d_f64()));
            }
        }
    }

    /// Every aligned block of 2^m points of either half has one point in each elementary box of area 2^-m.
    #[test]
    fn sobol_pairs_are_nets() {
        for (m, half, dimension) in (1..=10_u32).flat_map(|m| [(m, 0, 0), (m, 1, 0), (m, 0, 7), (m, 1, 7)]) {
            for block in [0, 1, 5] {
                let points: Vec<[f32; 2]> = (0..1_u32 << m)
                    .map(|i| ((block << m) + i) * 2 + half)
                    .map(|sample| Sampler::new(SamplerKind::Sobol, 9, 1, sample))
                    .map(|sampler| sampler.at_dimension(dimension).next_2d())
                    .collect();
                for columns in 0..=m {
                    let mut hit = vec![false; 1 << m];
                    for [x, y] in &points {
                        let column = (x * (1_u32 << columns) as f32) as usize;
                        let row = (y * (1_u32 << (m - columns)) as f32) as usize;
                        let cell = row << columns | column;
                        assert!(!hit[cell], "two points in one box: m {m}, half {half}, columns {columns}");
                        hit[cell] = true;
                    }
                }
            }
        }
    }

    #[test]
    fn sobol_values_are_stratified() {
        for half in 0..2 {
            let mut hit = [false; 256];
            for i in 0..256 {
                let u = Sampler::new(SamplerKind::Sobol, 2, 8, 2 * i + half).at_dimension(4).next_1d();
                let stratum = (u * 256.0) as usize;
                assert!(!std::mem::replace(&mut hit[stratum], true));
            }
        }
    }
}
