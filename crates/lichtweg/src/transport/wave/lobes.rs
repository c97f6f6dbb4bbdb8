//! The lobes at sixteen points: each model in its own lanes.
//!
//! To add a model: its [`Lobe`] in `bsdf`, its number and row in `scene/material/lobe.rs`, and its arm in [`Materials::visit`].

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{Float, LANES, Mask, Wide};

use super::points::Materials;
use crate::bsdf::{Diffuse, Lobe, Proposal, RoughConductor};
use crate::color::Spectra;
use crate::scene::LobeModel;

/// What is asked of every model.
trait Visit<W: Wide> {
    /// The lobes of the lanes of a mask.
    fn lobe(&mut self, lanes: W::Mask, lobe: &impl Lobe<W::F32>);
}

impl<W: Wide> Materials<W> {
    #[inline(always)]
    fn visit(&self, visit: &mut impl Visit<W>) {
        let columns: &[W::F32; LANES] = &self.columns;
        for model in LobeModel::ALL {
            let lanes = model.is_in(columns);
            if !lanes.any() {
                continue;
            }
            match model {
                LobeModel::Diffuse => visit.lobe(lanes, &Diffuse::from_columns(columns)),
                LobeModel::RoughConductor(kind) => {
                    visit.lobe(lanes, &RoughConductor::from_columns(kind, columns));
                }
            }
        }
    }

    /// See [`Lobe::value_and_pdf`].
    #[inline(always)]
    pub fn value_and_pdf(&self, wo: Vector<W::F32>, wi: Vector<W::F32>) -> (Spectra<W::F32>, W::F32) {
        let zero = W::F32::splat(0.0);
        let mut visit = Evaluate::<W> { wo, wi, value: Spectra([zero; 4]), pdf: zero };
        self.visit(&mut visit);
        (visit.value, visit.pdf)
    }

    /// See [`Lobe::propose`].
    #[inline(always)]
    pub fn propose(&self, wo: Vector<W::F32>, u: [W::F32; 2]) -> Proposal<W::F32> {
        let zero = W::F32::splat(0.0);
        let nothing =
            Proposal { wi: wo, weight: Spectra([zero; 4]), pdf: zero, valid: W::Mask::from_bits(0) };
        let mut visit = Propose::<W> { wo, u, found: nothing };
        self.visit(&mut visit);
        visit.found
    }
}

struct Evaluate<W: Wide> {
    wo: Vector<W::F32>,
    wi: Vector<W::F32>,
    value: Spectra<W::F32>,
    pdf: W::F32,
}

impl<W: Wide> Visit<W> for Evaluate<W> {
    #[inline(always)]
    fn lobe(&mut self, lanes: W::Mask, lobe: &impl Lobe<W::F32>) {
        let (value, pdf) = lobe.value_and_pdf(self.wo, self.wi);
        self.value = value.select(lanes, self.value);
        self.pdf = pdf.select(lanes, self.pdf);
    }
}

struct Propose<W: Wide> {
    wo: Vector<W::F32>,
    u: [W::F32; 2],
    found: Proposal<W::F32>,
}

impl<W: Wide> Visit<W> for Propose<W> {
    #[inline(always)]
    fn lobe(&mut self, lanes: W::Mask, lobe: &impl Lobe<W::F32>) {
        let new = lobe.propose(self.wo, self.u);
        let found = &mut self.found;
        found.wi = new.wi.select(lanes, found.wi);
        found.weight = new.weight.select(lanes, found.weight);
        found.pdf = new.pdf.select(lanes, found.pdf);
        found.valid = lanes & new.valid | found.valid.and_not(lanes);
    }
}
