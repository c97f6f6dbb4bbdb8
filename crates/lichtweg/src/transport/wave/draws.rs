//! The sample values of sixteen walks: [`Sampler`], lane by lane the same values.

use lichtweg_montecarlo::hash::{self, GOLDEN_GAMMA};
use lichtweg_montecarlo::{Sampler, SamplerKind, SamplerState};
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Long, Wide, Word, WordLanes};

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
    /// See [`Sampler::new`].
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
        let u = match self.kind {
            SamplerKind::Independent => unit::<W>(self.bits().high()),
            _ => self.one_by_one(|sampler| [sampler.next_1d(), 0.0])[0],
        };
        self.dimension = self.dimension + W::U32::splat(1);
        u
    }

    #[inline(always)]
    pub fn next_2d(&mut self) -> [W::F32; 2] {
        let u = match self.kind {
            SamplerKind::Independent => {
                let bits = self.bits();
                [unit::<W>(bits.high()), unit::<W>(bits.low())]
            }
            _ => self.one_by_one(Sampler::next_2d),
        };
        self.dimension = self.dimension + W::U32::splat(2);
        u
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

    #[inline(always)]
    fn one_by_one(&self, draw: impl Fn(&mut Sampler) -> [f32; 2]) -> [W::F32; 2] {
        let [low, high] = [self.key[0].to_lanes(), self.key[1].to_lanes()];
        let (index, dimension) = (self.index.to_lanes(), self.dimension.to_lanes());
        let mut out = [Lanes::splat(0.0); 2];
        for lane in 0..LANES {
            let key = u64::from(high.0[lane]) << 32 | u64::from(low.0[lane]);
            let state = SamplerState { key, index: index.0[lane], dimension: dimension.0[lane] };
            let u = draw(&mut Sampler::from_state(self.kind, state));
            (out[0].0[lane], out[1].0[lane]) = (u[0], u[1]);
        }
        [W::F32::load(&out[0]), W::F32::load(&out[1])]
    }
}

/// See [`hash::combine`].
#[inline(always)]
fn combine<W: Wide>(key: W::U64, counter: W::U32) -> W::U64 {
    let splat = W::U64::splat;
    let z = key.wrapping_add(counter.widen().wrapping_mul(splat(GOLDEN_GAMMA)));
    let z = (z ^ z.shr::<30>()).wrapping_mul(splat(0xbf58_476d_1ce4_e5b9));
    let z = (z ^ z.shr::<27>()).wrapping_mul(splat(0x94d0_49bb_1331_11eb));
    z ^ z.shr::<31>()
}

/// Uniform values in [0, 1) from the 24 high bits of words.
#[inline(always)]
fn unit<W: Wide>(bits: W::U32) -> W::F32 {
    bits.shr::<8>().to_float() * W::F32::splat(1.0 / 16_777_216.0)
}
