//! Walks on their way to their next vertices: two cache lines each, which sixteen at a time become columns in registers.

use lichtweg_montecarlo::{Sampler, SamplerKind, SamplerState};
use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Row, Wide, Word};

use super::packets::{RAY, RayLanes, ray_row, row_ray, rows_of};
use super::vertex::{Departure, Trail};
use super::wave::Draws;
use crate::color::Spectra;

/// A walk on its way to its next vertex.
#[derive(Clone, Copy, Debug)]
pub struct Traveller {
    /// Which of the walks that go together.
    pub walk: u32,
    /// From its end or its latest vertex.
    pub departure: Departure,
    /// What is left of its random numbers.
    pub sampler: Sampler,
    /// Its latest vertex, as [`Trail`] knows it.
    pub(super) last: u32,
    /// Undoes, for roulette, the scaling of radiance that a later refraction will undo anyway.
    pub(super) eta: f32,
    /// Makes the throughput relative to that at the start.
    pub(super) scale: f32,
}

/// A traveller in memory: the ray, throughput, density, cosine, and whether it comes from infinitely far; position, normal, link,
/// chain, eta, scale, walk, last vertex, and the state of the sampler.
pub type TravellerRows = [Row; 2];

impl Traveller {
    /// About to leave its end.
    pub fn new(walk: u32, departure: Departure, sampler: Sampler) -> Self {
        let scale = 1.0 / departure.throughput.max_element();
        Self { walk, departure, sampler, last: Trail::NONE, eta: 1.0, scale }
    }

    #[inline]
    pub(super) fn rows(&self) -> TravellerRows {
        let Self { departure: d, walk, last, eta, scale, .. } = *self;
        let (state, Spectra(t), p, n) = (self.sampler.state(), d.throughput, d.position, d.normal);
        let mut rows = [ray_row(&d.ray), Row::splat(0.0)];
        let infinite = if d.infinite { 1.0 } else { 0.0 };
        rows[0].0[RAY..].copy_from_slice(&[t[0], t[1], t[2], t[3], d.pdf, d.cos, infinite]);
        let bits = f32::from_bits;
        let (low, high) = (state.key as u32, (state.key >> 32) as u32);
        rows[1].0 = [
            p.x,
            p.y,
            p.z,
            n.x,
            n.y,
            n.z,
            d.link,
            d.chain,
            eta,
            scale,
            bits(walk),
            bits(last),
            bits(low),
            bits(high),
            bits(state.index),
            bits(state.dimension),
        ];
        rows
    }

    /// With random numbers of a kind.
    #[inline]
    pub(super) fn from_rows([a, Lanes(b)]: &TravellerRows, kind: SamplerKind) -> Self {
        let t = &a.0[RAY..];
        let vector = |i: usize| Vec3::new(b[i], b[i + 1], b[i + 2]);
        let word = |i: usize| b[i].to_bits();
        let key = u64::from(word(13)) << 32 | u64::from(word(12));
        let departure = Departure {
            ray: row_ray(a),
            position: vector(0),
            throughput: Spectra([t[0], t[1], t[2], t[3]]),
            pdf: t[4],
            cos: t[5],
            infinite: t[6] != 0.0,
            link: b[6],
            chain: b[7],
            normal: vector(3),
        };
        let state = SamplerState { key, index: word(14), dimension: word(15) };
        let sampler = Sampler::from_state(kind, state);
        Self { walk: word(10), departure, sampler, last: word(11), eta: b[8], scale: b[9] }
    }
}

/// Sixteen travellers in registers.
#[derive(Clone, Copy)]
pub struct TravellerLanes<W: Wide> {
    pub ray: RayLanes<W>,
    pub throughput: Spectra<W::F32>,
    pub pdf: W::F32,
    pub cos: W::F32,
    /// Not zero where the vertex is infinitely far.
    pub infinite: W::F32,
    pub position: Vector<W::F32>,
    pub normal: Vector<W::F32>,
    pub link: W::F32,
    pub chain: W::F32,
    pub eta: W::F32,
    pub scale: W::F32,
    pub walk: W::U32,
    pub last: W::U32,
    pub draws: Draws<W>,
}

impl<W: Wide> TravellerLanes<W> {
    /// Those of some numbers; what is behind them means nothing.
    #[inline(always)]
    pub fn load(travellers: &[TravellerRows], numbers: &[u32], kind: SamplerKind) -> Self {
        let a: [W::F32; LANES] = W::F32::columns(&rows_of(numbers, |i| &travellers[i][0]));
        let b: [W::F32; LANES] = W::F32::columns(&rows_of(numbers, |i| &travellers[i][1]));
        Self {
            ray: RayLanes::new(&a),
            throughput: Spectra([a[9], a[10], a[11], a[12]]),
            pdf: a[13],
            cos: a[14],
            infinite: a[15],
            position: Vector::new(b[0], b[1], b[2]),
            normal: Vector::new(b[3], b[4], b[5]),
            link: b[6],
            chain: b[7],
            eta: b[8],
            scale: b[9],
            walk: b[10].bits(),
            last: b[11].bits(),
            draws: Draws {
                kind,
                key: [b[12].bits(), b[13].bits()],
                index: b[14].bits(),
                dimension: b[15].bits(),
            },
        }
    }

    /// The rows of all lanes.
    #[inline(always)]
    pub fn rows(&self) -> [[Row; LANES]; 2] {
        let ([r, g, b, c], p, n) = (self.throughput.0, self.position, self.normal);
        let Draws { key: [low, high], index, dimension, .. } = self.draws;
        [
            W::F32::rows(self.ray.columns([r, g, b, c, self.pdf, self.cos, self.infinite])),
            W::F32::rows([
                p.x,
                p.y,
                p.z,
                n.x,
                n.y,
                n.z,
                self.link,
                self.chain,
                self.eta,
                self.scale,
                self.walk.as_float(),
                self.last.as_float(),
                low.as_float(),
                high.as_float(),
                index.as_float(),
                dimension.as_float(),
            ]),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Spectrum;

    #[test]
    fn rows_keep_travellers() {
        let mut sampler = Sampler::new(SamplerKind::Sobol, 1, 2, 3);
        sampler.next_1d();
        let departure = Departure {
            ray: lichtweg_ray::Ray::new(Vec3::new(1.0, 2.0, 3.0), Vec3::Y).between(0.5, 9.0).at_time(0.25),
            position: Vec3::new(4.0, 5.0, 6.0),
            throughput: Spectrum::rgb([0.1, 0.2, 0.3]),
            pdf: 0.7,
            cos: 0.8,
            infinite: true,
            link: 0.9,
            chain: 1.1,
            normal: Vec3::Z,
        };
        let traveller = Traveller { last: 7, eta: 1.5, ..Traveller::new(13, departure, sampler) };
        let back = Traveller::from_rows(&traveller.rows(), SamplerKind::Sobol);
        assert_eq!(format!("{back:?}"), format!("{traveller:?}"));
    }
}
