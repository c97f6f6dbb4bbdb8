//! The lobes at sixteen points: each model in its own lanes.
//!
//! To add a model: its [`Lobe`] in `bsdf`, its number and row in `scene/material/lobe.rs`, and its arm in [`Materials::visit`].

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{Float, LANES, Mask, Wide};

use super::points::Materials;
use crate::bsdf::{Diffuse, Lobe, Proposal, RoughConductor};
use crate::color::Spectra;
use crate::scene::LobeModel;

/// The models there are, with the lanes of each.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Models([(LobeModel, u32); 3]);

impl Models {
    /// Without lanes.
    pub const NONE: Self = {
        let [a, b, c] = LobeModel::ALL;
        Self([(a, 0), (b, 0), (c, 0)])
    };

    /// Those that the columns of [`LobeMaterial::rows`](crate::scene::LobeMaterial) tell, in some lanes.
    #[inline(always)]
    pub fn of<F: Float>(columns: &[F; LANES], lanes: u32) -> Self {
        Self(LobeModel::ALL.map(|model| (model, model.is_in(columns).bits() & lanes)))
    }

    /// The same model in all lanes.
    #[inline(always)]
    pub fn only(model: LobeModel) -> Self {
        let mut models = Self::NONE;
        (0..LANES).for_each(|lane| models.set(lane, model));
        models
    }

    /// Which model a lane has.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Option<LobeModel> {
        self.0.iter().find(|(_, lanes)| lanes >> lane & 1 != 0).map(|(model, _)| *model)
    }

    /// The lanes of diffuse reflectors.
    #[inline(always)]
    pub fn diffuse(&self) -> u32 {
        self.0[0].1
    }

    /// Says which model a lane has.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, model: LobeModel) {
        for (one, lanes) in &mut self.0 {
            *lanes |= u32::from(*one == model) << lane;
        }
    }
}

/// What is asked of every model.
trait Visit<W: Wide> {
    /// The lobes of the lanes of a mask.
    fn lobe(&mut self, lanes: W::Mask, lobe: &impl Lobe<W::F32>);
}

impl<W: Wide> Materials<W> {
    #[inline(always)]
    fn visit(&self, visit: &mut impl Visit<W>) {
        let columns: &[W::F32; LANES] = &self.columns;
        for (model, lanes) in self.models.0 {
            if lanes == 0 {
                continue;
            }
            let lanes = W::Mask::from_bits(lanes);
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
