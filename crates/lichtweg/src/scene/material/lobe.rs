//! Materials of a single reflecting lobe, as sixteen walks at once look them up: everything constant in one cache line a side.

use lichtweg_ray::wide::{Float, Row};

use crate::bsdf::{Diffuse, MicrofacetKind, Microfacets, RoughConductor};
use crate::color::{Spectra, Spectrum};
use crate::texture::Input;

/// Which [`Lobe`](crate::bsdf::Lobe) it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LobeModel {
    Diffuse,
    RoughConductor(MicrofacetKind),
}

/// A material that does nothing but reflect by one lobe, on one side or on both.
#[derive(Clone, Debug)]
pub(crate) struct LobeMaterial {
    pub model: LobeModel,
    /// The colour that reflection is multiplied by, of the front and of the back: all that may be textured.
    pub reflectance: [Input; 2],
    /// Of the front and of the back: the reflectance, where constant, in elements 0 to 3, the model's other parameters behind it,
    /// the model's number in the last but one, and 1 in the last where the back reflects.
    pub rows: [Row; 2],
}

impl LobeModel {
    /// Those there are.
    pub const ALL: [Self; 3] = [
        Self::Diffuse,
        Self::RoughConductor(MicrofacetKind::Beckmann),
        Self::RoughConductor(MicrofacetKind::Ggx),
    ];

    /// As it is written in rows; a row of zeros is of no model.
    #[inline(always)]
    fn number(self) -> f32 {
        match self {
            Self::Diffuse => 1.0,
            Self::RoughConductor(MicrofacetKind::Beckmann) => 2.0,
            Self::RoughConductor(MicrofacetKind::Ggx) => 3.0,
        }
    }

    /// Where the columns of rows are of this model.
    #[inline(always)]
    pub fn is_in<F: Float>(self, columns: &[F; 16]) -> F::Mask {
        columns[MODEL].equal(F::splat(self.number()))
    }
}

/// Where a row says which model it is of.
const MODEL: usize = 14;
/// Where a row says that the back reflects.
const TWO_SIDED: usize = 15;

impl LobeMaterial {
    /// A model that reflects on its front alone, by a reflectance and parameters that follow it in a row.
    pub(super) fn new(model: LobeModel, reflectance: Input, parameters: &[f32]) -> Self {
        let mut row = Row::splat(0.0);
        if let Input::Constant(c) = reflectance {
            row.0[..4].copy_from_slice(&c.0);
        }
        row.0[4..4 + parameters.len()].copy_from_slice(parameters);
        row.0[MODEL] = model.number();
        Self { model, reflectance: [reflectance; 2], rows: [row; 2] }
    }

    /// The fronts of two materials back to back; `None` where the models differ.
    pub(super) fn two_sided(front: &Self, back: &Self) -> Option<Self> {
        let mut rows = [front.rows[0], back.rows[0]];
        rows.iter_mut().for_each(|row| row.0[TWO_SIDED] = 1.0);
        let reflectance = [front.reflectance[0], back.reflectance[0]];
        (front.model == back.model).then_some(Self { model: front.model, reflectance, rows })
    }

    /// Whether the rows do not say it all.
    #[inline(always)]
    pub fn is_textured(&self) -> bool {
        self.reflectance.iter().any(|input| matches!(input, Input::Texture(_)))
    }

    /// Where the row of columns says that the back reflects.
    #[inline(always)]
    pub fn is_two_sided<F: Float>(columns: &[F; 16]) -> F::Mask {
        F::splat(0.0).lt(columns[TWO_SIDED])
    }
}

#[inline(always)]
fn spectra<F: Float>(c: &[F; 16], at: usize) -> Spectra<F> {
    Spectra([c[at], c[at + 1], c[at + 2], c[at + 3]])
}

impl<F: Float> Diffuse<F> {
    /// From the columns of rows.
    #[inline(always)]
    pub(crate) fn from_columns(columns: &[F; 16]) -> Self {
        Self { reflectance: spectra(columns, 0) }
    }
}

impl RoughConductor {
    /// What [`RoughConductor::from_columns`] reads behind the reflectance.
    pub(super) fn parameters(eta: Spectrum, k: Spectrum, facets: &Microfacets) -> [f32; 10] {
        let ([a, b, c, d], [p, q, r, s]) = (eta.0, k.0);
        [a, b, c, d, p, q, r, s, facets.alpha_u, facets.alpha_v]
    }
}

impl<F: Float> RoughConductor<F> {
    /// From the columns of rows.
    #[inline(always)]
    pub(crate) fn from_columns(kind: MicrofacetKind, columns: &[F; 16]) -> Self {
        Self {
            specular_reflectance: spectra(columns, 0),
            eta: spectra(columns, 4),
            k: spectra(columns, 8),
            facets: Microfacets { kind, alpha_u: columns[12], alpha_v: columns[13] },
        }
    }
}
