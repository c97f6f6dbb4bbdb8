//! The sample values of sixteen walks: [`Sampler`](lichtweg_montecarlo::Sampler), lane by lane the same values.

use lichtweg_montecarlo::SamplerKind;
use lichtweg_montecarlo::hash::{self, GOLDEN_GAMMA};
use lichtweg_ray::wide::{Float, Long, Wide, Word, WordLanes};

use crate::lanes::owen;

/// Sixteen samplers.
#[derive(Clone, Copy)]
pub(crate) struct Draws<W: Wide> {
    pub kind: SamplerKind,
    /// Lower and upper half.
    pub key: [W::U32; 2],
    pub index: W::U32,
    pub dimension: W::U32,
}

impl<W: Wide> Draws<W> {
    /// See [`Sampler::new`](lichtweg_montecarlo::Sampler::new).
    #[inline(always)]
    pub fn new(kind: SamplerKind, seed: u64, stream: W::U32, sample: W::U32) -> Self {
        let number = W::U32::splat;
        let (sequence, index) = match kind {
            SamplerKind::Independent => (sample, number(0)),
            SamplerKind::Sobol => (sample & number(1), sample.shr::<1>()),
        };
        let key = combine::<W>(W::U64::splat(hash::first(seed)), stream);
        let key = combine::<W>(key, sequence);
        Self { kind, key: [key.low(), key.high()], index, dimension: number(0) }
    }

    #[inline(always)]
    pub fn next_1d(&mut self) -> W::F32 {
        let bits = self.bits();
        self.skip(1);
        unit::<W>(match self.kind {
            SamplerKind::Independent => bits.high(),
            SamplerKind::Sobol => {
                owen::van_der_corput(owen::shuffle_index(self.index, bits.low()), bits.high())
            }
        })
    }

    #[inline(always)]
    pub fn next_2d(&mut self) -> [W::F32; 2] {
        let bits = self.bits();
        self.skip(2);
        match self.kind {
            SamplerKind::Independent => [unit::<W>(bits.high()), unit::<W>(bits.low())],
            SamplerKind::Sobol => {
                let index = owen::shuffle_index(self.index, bits.low());
                let seeds = mix::<W>(bits ^ W::U64::splat(GOLDEN_GAMMA));
                [
                    unit::<W>(owen::van_der_corput(index, seeds.high())),
                    unit::<W>(owen::sobol_second(index, seeds.low())),
                ]
            }
        }
    }

    /// Leaves out some dimensions.
    #[inline(always)]
    pub fn skip(&mut self, count: u32) {
        self.dimension = self.dimension + W::U32::splat(count);
    }

    /// `mix64` of the keys and dimensions.
    #[inline(always)]
    fn bits(&self) -> W::U64 {
        combine::<W>(self.key[1].widen().shl::<32>() | self.key[0].widen(), self.dimension)
    }
}

/// See [`hash::combine`].
#[inline(always)]
fn combine<W: Wide>(key: W::U64, counter: W::U32) -> W::U64 {
    let splat = W::U64::splat;
    mix::<W>(key.wrapping_add(counter.widen().wrapping_mul(splat(GOLDEN_GAMMA))))
}

/// See [`hash::mix64`].
#[inline(always)]
fn mix<W: Wide>(z: W::U64) -> W::U64 {
    let splat = W::U64::splat;
    let z = (z ^ z.shr::<30>()).wrapping_mul(splat(0xbf58_476d_1ce4_e5b9));
    let z = (z ^ z.shr::<27>()).wrapping_mul(splat(0x94d0_49bb_1331_11eb));
    z ^ z.shr::<31>()
}

/// Uniform values in [0, 1) from the 24 high bits of words.
#[inline(always)]
fn unit<W: Wide>(bits: W::U32) -> W::F32 {
    bits.shr::<8>().to_float() * W::F32::splat(1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use lichtweg_montecarlo::Sampler;
    use lichtweg_ray::wide::{FloatLanes, Kernel, LANES, Lanes, dispatch};

    use super::*;

    /// The first values of samples from one on, draw by draw.
    struct First(SamplerKind, u32);

    impl Kernel for First {
        type Output = [Lanes<f32>; 6];

        #[inline(always)]
        fn run<W: Wide>(self) -> Self::Output {
            let Self(kind, first) = self;
            let samples = std::array::from_fn(|i| first + i as u32);
            let mut draws = Draws::<W>::new(kind, 5, W::U32::splat(77), W::U32::load(&Lanes(samples)));
            let ([a, b], c) = (draws.next_2d(), draws.next_1d());
            draws.skip(3);
            let ([d, e], f) = (draws.next_2d(), draws.next_1d());
            [a.to_lanes(), b.to_lanes(), c.to_lanes(), d.to_lanes(), e.to_lanes(), f.to_lanes()]
        }
    }

    #[test]
    fn lanes_draw_what_samplers_draw() {
        for (kind, first) in [SamplerKind::Independent, SamplerKind::Sobol]
            .into_iter()
            .flat_map(|kind| [0, 16, 1000, u32::MAX - 16].map(|first| (kind, first)))
        {
            let lanes = dispatch(First(kind, first));
            for lane in 0..LANES {
                let mut one = Sampler::new(kind, 5, 77, first + lane as u32);
                let ([a, b], c) = (one.next_2d(), one.next_1d());
                let mut one = one.at_dimension(6);
                let ([d, e], f) = (one.next_2d(), one.next_1d());
                assert_eq!(
                    lanes.map(|l| l.0[lane]),
                    [a, b, c, d, e, f],
                    "{kind:?}, sample {}",
                    first + lane as u32
                );
            }
        }
    }
}
