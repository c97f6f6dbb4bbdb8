//! Sixteen vertices of walks at once, on surfaces of a single lobe: what [`Vertex`](super::Vertex) is to one.

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{Float, Wide};

use super::vertex::{Others, Scattering, adjoint_correction};
use super::visibility::ShadowPoint;
use super::wave::Draws;
use super::wave::points::Materials;
use crate::bsdf::Mode;
use crate::color::Spectra;

/// Sixteen vertices, and what is left of their walks' random numbers.
pub struct VertexLanes<W: Wide> {
    /// Lanes with a vertex.
    pub(super) lanes: W::Mask,
    pub(super) walk: W::U32,
    /// See [`Vertex::number`](super::Vertex).
    pub(super) number: u32,
    pub(super) points: ShadowPoint<W::F32>,
    pub(super) lobes: LobeLanes<W>,
    pub(super) throughput: Spectra<W::F32>,
    pub(super) others: Others<W::F32>,
    pub(super) time: W::F32,
    pub(super) draws: Draws<W>,
}

/// What scatters at sixteen vertices.
pub struct LobeLanes<W: Wide> {
    pub(super) materials: Materials<W>,
    pub(super) geometric_normal: Vector<W::F32>,
    /// See [`Vertex::wo`](super::Vertex); in the world and in the shading frame.
    pub(super) wo: Vector<W::F32>,
    pub(super) local_wo: Vector<W::F32>,
    pub(super) mode: Mode,
}

impl<W: Wide> LobeLanes<W> {
    #[inline(always)]
    pub(super) fn new(
        materials: Materials<W>,
        geometric_normal: Vector<W::F32>,
        wo: Vector<W::F32>,
        mode: Mode,
    ) -> Self {
        let local_wo = materials.frame.to_local(wo);
        Self { materials, geometric_normal, wo, local_wo, mode }
    }

    /// See [`Vertex::scatter`](super::Vertex).
    #[inline(always)]
    pub(super) fn scatter(&self, wi: Vector<W::F32>) -> Scattering<W::F32> {
        let local = self.materials.frame.to_local(wi);
        let (value, pdf) = self.materials.value_and_pdf(self.local_wo, local);
        Scattering {
            value: value * self.adjoint_correction(wi),
            pdf,
            pdf_back: self.materials.value_and_pdf(local, self.local_wo).1,
            cos: self.geometric_normal.dot(wi).abs(),
        }
    }

    /// See [`Vertex::pdf_back`](super::Vertex).
    #[inline(always)]
    pub(super) fn pdf_back(&self, wi: Vector<W::F32>) -> W::F32 {
        self.materials.value_and_pdf(self.materials.frame.to_local(wi), self.local_wo).1
    }

    /// See [`Vertex::adjoint_correction`](super::Vertex).
    #[inline(always)]
    pub(super) fn adjoint_correction(&self, wi: Vector<W::F32>) -> W::F32 {
        match self.mode {
            Mode::Radiance => W::F32::splat(1.0),
            Mode::Importance => {
                adjoint_correction(self.materials.frame.normal, self.geometric_normal, self.wo, wi)
            }
        }
    }
}
