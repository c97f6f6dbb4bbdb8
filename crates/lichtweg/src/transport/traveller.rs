//! Walks on their way to their next vertices: two cache lines each, which sixteen at a time become columns in registers.

use lichtweg_montecarlo::{Sampler, SamplerKind, SamplerState};
use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Row, Wide, Word};

use super::packets::{RayLanes, rows_of};
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
        let SamplerState { key, index, dimension } = self.sampler.state();
        let lanes = TravellerLanes {
            ray: d.ray.into(),
            throughput: d.throughput,
            pdf: d.pdf,
            cos: d.cos,
            infinite: if d.infinite { 1.0 } else { 0.0 },
            position: d.position,
            normal: d.normal,
            link: d.link,
            chain: d.chain,
            eta,
            scale,
            walk,
            last,
            key: [key as u32, (key >> 32) as u32],
            index,
            dimension,
        };
        let [a, b] = lanes.columns();
        [Lanes(a), Lanes(b)]
    }

    /// With random numbers of a kind.
    #[inline]
    pub(super) fn from_rows([Lanes(a), Lanes(b)]: &TravellerRows, kind: SamplerKind) -> Self {
        let lanes = TravellerLanes::<f32>::new(a, b);
        let TravellerLanes { key: [low, high], index, dimension, .. } = lanes;
        let departure = Departure {
            ray: lanes.ray.into(),
            position: lanes.position,
            throughput: lanes.throughput,
            pdf: lanes.pdf,
            cos: lanes.cos,
            infinite: lanes.infinite != 0.0,
            link: lanes.link,
            chain: lanes.chain,
            normal: lanes.normal,
        };
        let state = SamplerState { key: u64::from(high) << 32 | u64::from(low), index, dimension };
        let sampler = Sampler::from_state(kind, state);
        let TravellerLanes { walk, last, eta, scale, .. } = lanes;
        Self { walk, departure, sampler, last, eta, scale }
    }
}

/// A traveller as its rows have it; or as many as `F` has lanes.
#[derive(Clone, Copy)]
pub struct TravellerLanes<F: Float> {
    pub ray: RayLanes<F>,
    pub throughput: Spectra<F>,
    pub pdf: F,
    pub cos: F,
    /// Not zero where the vertex is infinitely far.
    pub infinite: F,
    pub position: Vector<F>,
    pub normal: Vector<F>,
    pub link: F,
    pub chain: F,
    pub eta: F,
    pub scale: F,
    pub walk: F::Bits,
    pub last: F::Bits,
    /// Of the state of the sampler, as are the next two: lower and upper half.
    key: [F::Bits; 2],
    index: F::Bits,
    pub dimension: F::Bits,
}

impl<F: Float> TravellerLanes<F> {
    /// From the columns of rows.
    #[inline(always)]
    fn new(a: &[F; LANES], b: &[F; LANES]) -> Self {
        Self {
            ray: RayLanes::new(a),
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
            key: [b[12].bits(), b[13].bits()],
            index: b[14].bits(),
            dimension: b[15].bits(),
        }
    }

    #[inline(always)]
    fn columns(&self) -> [[F; LANES]; 2] {
        let ([r, g, b, c], p, n) = (self.throughput.0, self.position, self.normal);
        let (walk, last) = (self.walk.as_float(), self.last.as_float());
        let [low, high] = [self.key[0].as_float(), self.key[1].as_float()];
        let (index, dimension) = (self.index.as_float(), self.dimension.as_float());
        let Self { link, chain, eta, scale, .. } = *self;
        [
            self.ray.columns([r, g, b, c, self.pdf, self.cos, self.infinite]),
            [p.x, p.y, p.z, n.x, n.y, n.z, link, chain, eta, scale, walk, last, low, high, index, dimension],
        ]
    }
}

impl<F: FloatLanes> TravellerLanes<F> {
    /// Those of some numbers; what is behind them means nothing.
    #[inline(always)]
    pub fn load(travellers: &[TravellerRows], numbers: &[u32]) -> Self {
        let a = F::columns(&rows_of(numbers, |i| &travellers[i][0]));
        let b = F::columns(&rows_of(numbers, |i| &travellers[i][1]));
        Self::new(&a, &b)
    }

    /// The rows of all lanes.
    #[inline(always)]
    pub fn rows(&self) -> [[Row; LANES]; 2] {
        let [a, b] = self.columns();
        [F::rows(a), F::rows(b)]
    }

    /// What is left of their random numbers, of a kind.
    #[inline(always)]
    pub fn draws<W: Wide<F32 = F, U32 = F::Bits>>(&self, kind: SamplerKind) -> Draws<W> {
        Draws { kind, key: self.key, index: self.index, dimension: self.dimension }
    }
}

#[cfg(test)]
mod tests {
    use lichtweg_ray::math::Vec3;

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
