//! Spectra of sixteen lanes, in memory.

use lichtweg_ray::wide::{FloatLanes, Lanes};

use super::{Spectra, Spectrum};

/// A spectrum of each lane, in memory.
pub(crate) struct SpectrumLanes([Lanes<f32>; 4]);

impl SpectrumLanes {
    #[inline(always)]
    pub fn new<F: FloatLanes>(spectra: Spectra<F>) -> Self {
        let [a, b, c, d] = spectra.0;
        Self([a.to_lanes(), b.to_lanes(), c.to_lanes(), d.to_lanes()])
    }

    /// The reverse.
    #[inline(always)]
    pub fn load<F: FloatLanes>(&self) -> Spectra<F> {
        let [a, b, c, d] = &self.0;
        Spectra([F::load(a), F::load(b), F::load(c), F::load(d)])
    }

    #[inline(always)]
    pub fn get(&self, lane: usize) -> Spectrum {
        let [a, b, c, d] = &self.0;
        Spectra([a.0[lane], b.0[lane], c.0[lane], d.0[lane]])
    }

    #[inline(always)]
    pub fn set(&mut self, lane: usize, spectrum: Spectrum) {
        for i in 0..4 {
            self.0[i].0[lane] = spectrum.0[i];
        }
    }
}
