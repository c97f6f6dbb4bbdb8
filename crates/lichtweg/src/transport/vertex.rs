//! Vertices of walks, and what each knows of the other ways to make the path that leads to it.
//!
//! A path x_0 ... x_k (x_0 on a light, x_k on the lens) can be made by joining the first s vertices of a walk from the light with
//! the last t = k + 1 - s of a walk from the eye. Let p_i be the density per area with which the walk from one end makes its
//! vertex i, and q_i that with which the walk from the other end would. The strategy with one vertex less on this side has a
//! density that is q / p times that of this one, and so on down to none (Veach 1997, section 10.2.1):
//!
//! sum_i = (q_i / p_i)^b (c_i + sum_{i-1}),
//!
//! with b the exponent of the heuristic and c_i = 1 where vertices i - 1 and i can be connected, 0 where one of them scatters in
//! single directions only. The weight of a strategy is 1 / (1 + sum on the side of the light + sum on the side of the eye).
//!
//! As q_i depends on what comes two vertices later, a walk carries the rest (after Georgiev 2012, "Implementing Vertex Connection
//! and Merging", section 4): with r the density per solid angle at vertex i of going back to i - 1, and g the geometric
//! factor from there to area,
//!
//! sum_i = q_i^b (A_i + r^b B_i), A_i = c_i / p_i^b, B_i = g_{i-1}^b (c_{i-1} + sum_{i-2}) / (p_{i-1} p_i)^b.
//!
//! Single directions (mirrors) have densities that are not finite. They cancel in the products of quotients; where they
//! do not, c is 0. The probability of the lobe takes their place.
//!
//! All of these are kept as the numbers which raised by b are those of the formulas ([`norm`]): they then are mere areas, and `f32`
//! holds them whatever the exponent.
//!
//! Roulette and holes are left out of all densities: weights need to sum to one only.

use lichtweg_montecarlo::warp;
use lichtweg_ray::Ray;
use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::Float;

use super::fault::{Fault, is_seeded};
use super::mis::norm;
use crate::bsdf::Mode;
use crate::color::{Spectra, Spectrum};
use crate::light::Receiver;
use crate::scene::description::Heuristic;
use crate::scene::{Scatterer, SurfacePoint};

/// What a vertex knows of the strategies with fewer vertices on its side: what raised by b is A and B of the sum above. Or as many
/// vertices as `F` has lanes.
#[derive(Clone, Copy, Debug)]
pub struct Others<F = f32> {
    /// A: the vertex before, connected to this one.
    pub connected: F,
    /// B: all with still fewer.
    pub shorter: F,
}

impl<F: Float> Others<F> {
    /// What a vertex knows that a walk reaches with the density `pdf` from a vertex of a [`Departure::chain`], with c = `link`.
    /// `there` and `back` turn densities per solid angle into those per area at this vertex and at that before.
    #[inline(always)]
    pub fn arrive(pdf: F, chain: F, link: F, there: F, back: F) -> Self {
        let scale = F::splat(1.0) / (pdf * there);
        Self { connected: link * scale, shorter: back * chain * scale }
    }

    /// Whether there is a density, in spite of rounding.
    #[inline(always)]
    pub fn is_finite(&self) -> F::Mask {
        (self.connected + self.shorter).lt(F::splat(f32::INFINITY))
    }

    /// Stands for the strategies with fewer vertices on this side, relative to this one, over the density with which the walk from the
    /// other end makes the vertex; `pdf_back` is that with which it goes on to the vertex before.
    #[inline(always)]
    pub fn root(&self, heuristic: Heuristic, pdf_back: F) -> F {
        norm(heuristic, self.connected, pdf_back * self.shorter)
    }
}

/// A walk that is about to leave a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// Where to, and from where: a little off the surface.
    pub ray: Ray,
    /// The vertex itself.
    pub position: Vec3,
    /// Value of the walk so far over its density, this direction included.
    pub throughput: Spectrum,
    /// Density of the direction per solid angle; of the ray's place, per area across it, from infinitely far.
    pub pdf: f32,
    /// |cos| between the direction and the normal; 1 where there is none.
    pub cos: f32,
    /// Whether the vertex is infinitely far away.
    pub infinite: bool,
    /// c of the next vertex.
    pub link: f32,
    /// What raised by b is (c_i + sum_{i-1}) / p_i^b, with x_i the vertex.
    pub chain: f32,
    /// See [`Receiver::normal`]; zero where a walk begins.
    pub normal: Vec3,
}

impl Departure {
    /// See [`Others::arrive`].
    #[inline]
    pub fn arrive(&self, there: f32, back: f32) -> Others {
        Others::arrive(self.pdf, self.chain, self.link, there, back)
    }

    /// The vertex, for the choice of lights.
    #[inline]
    pub fn receiver(&self) -> Receiver {
        Receiver { position: self.position, normal: self.normal }
    }
}

/// A surface point that a walk has come to.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<'a> {
    /// Where.
    pub point: SurfacePoint,
    /// What scatters there, looked at from `wo`.
    pub scatterer: Scatterer<'a>,
    /// Unit direction to the vertex before.
    pub wo: Vec3,
    /// Value of the walk over its density, up to here and without the scattering here.
    pub throughput: Spectrum,
    /// The other strategies.
    pub others: Others,
    /// How the walk went on.
    pub onward: Option<Onward>,
    /// Which of the walks that go together this is of.
    pub walk: u32,
    /// Surface vertices up to this one.
    pub number: u32,
    /// Where the one before is, among the vertices of all these walks.
    pub(super) before: u32,
}

/// A walk up to one of its surface vertices, which lie scattered among those of all walks that go together.
#[derive(Clone, Copy, Debug)]
pub struct Trail<'p, 'a> {
    vertices: &'p [Vertex<'a>],
    last: u32,
}

impl<'p, 'a> Trail<'p, 'a> {
    /// No vertex.
    pub(super) const NONE: u32 = u32::MAX;

    /// A walk without surface vertices.
    pub const EMPTY: Self = Self { vertices: &[], last: Self::NONE };

    /// Up to a vertex, or [`Trail::NONE`].
    #[inline]
    pub(super) fn new(vertices: &'p [Vertex<'a>], last: u32) -> Self {
        Self { vertices, last }
    }

    /// Its last vertex.
    #[inline]
    pub fn last(self) -> Option<&'p Vertex<'a>> {
        self.vertices.get(self.last as usize)
    }

    /// Where this is among all vertices.
    #[inline]
    pub(super) fn index(self) -> u32 {
        self.last
    }

    /// The walk without its last vertex.
    #[inline]
    pub fn before(self) -> Self {
        Self { last: self.last().map_or(Self::NONE, |v| v.before), ..self }
    }

    /// Number of vertices.
    #[inline]
    pub fn len(self) -> u32 {
        self.last().map_or(0, |v| v.number)
    }

    /// Whether there is none.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.last().is_none()
    }

    /// The vertices, from the walk's end on.
    pub fn to_vec(self) -> Vec<Vertex<'a>> {
        let mut vertices = Vec::with_capacity(self.len() as usize);
        let mut trail = self;
        while let Some(vertex) = trail.last() {
            vertices.push(*vertex);
            trail = trail.before();
        }
        vertices.reverse();
        vertices
    }
}

/// How a walk went on from a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Onward {
    /// Unit direction.
    pub direction: Vec3,
    /// Its density per solid angle; of a single direction the probability of its lobe.
    pub pdf: f32,
    /// Whether it was a single direction.
    pub delta: bool,
    /// Factor on the throughput, without that of roulette.
    pub weight: Spectrum,
    /// Probability of surviving roulette; the throughput was divided by it.
    pub survival: f32,
}

/// What happens at a vertex between the direction it was reached from and another one. Or at as many as `F` has lanes.
#[derive(Clone, Copy, Debug)]
pub struct Scattering<F = f32> {
    /// The scattering function times the cosine to the geometric normal.
    pub value: Spectra<F>,
    /// Density per solid angle of going there.
    pub pdf: F,
    /// Density per solid angle of going from there to the vertex before.
    pub pdf_back: F,
    /// |cos| to the geometric normal.
    pub cos: F,
}

/// What makes the scattering function adjoint where the shading normal is not the geometric one: walks from the eye carry
/// f |cos_s(light)|, so that walks from a light have to carry f |cos_s(light)| |cos_g(eye)| / |cos_g(light)| (Veach 1997,
/// section 5.3, equation 5.19), which is this times f |cos_s(eye)|.
#[inline(always)]
pub(super) fn adjoint_correction<F: Float>(
    shading: Vector<F>,
    geometric: Vector<F>,
    wo: Vector<F>,
    wi: Vector<F>,
) -> F {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let same = shading.x.equal(geometric.x) & shading.y.equal(geometric.y) & shading.z.equal(geometric.z);
    let slope = shading.dot(wo) * geometric.dot(wi) / (geometric.dot(wo) * shading.dot(wi));
    let slope = slope.abs();
    one.select(same, slope.select(slope.lt(F::splat(f32::INFINITY)), zero))
}

impl Vertex<'_> {
    /// Scattering towards the unit direction `wi`, of a walk that carries `mode`; single directions are left out.
    #[inline]
    pub fn scatter(&self, wi: Vec3, mode: Mode) -> Scattering {
        if let Some(albedo) = self.scatterer.lambert()
            && mode == Mode::Radiance
        {
            return self.reflect(albedo, wi);
        }
        let (mut value, pdf) = self.scatterer.eval_pdf(self.wo, wi, mode);
        let cos = self.point.geometric_normal.dot(wi).abs();
        if value.is_zero() {
            return Scattering { value, pdf, pdf_back: 0.0, cos };
        }
        if is_seeded(Fault::Cosine) && mode == Mode::Importance {
            value = value / cos.max(1e-3);
        }
        let value = value * self.adjoint_correction(wi, mode);
        Scattering { value, pdf, pdf_back: self.scatterer.pdf(wi, self.wo), cos }
    }

    /// [`Vertex::scatter`] of Lambert's reflector.
    #[inline]
    fn reflect(&self, albedo: Spectrum, wi: Vec3) -> Scattering {
        let normal = self.scatterer.frame.normal;
        let [from, to] = [self.wo, wi].map(|w| warp::cosine_hemisphere_pdf(normal.dot(w)));
        let pdf = if from > 0.0 { to } else { 0.0 };
        let pdf_back = if to > 0.0 { from } else { 0.0 };
        Scattering { value: albedo * pdf, pdf, pdf_back, cos: self.point.geometric_normal.dot(wi).abs() }
    }

    /// Density per solid angle of going from `wi` to the vertex before.
    #[inline]
    pub fn pdf_back(&self, wi: Vec3) -> f32 {
        match self.scatterer.lambert() {
            Some(albedo) => self.reflect(albedo, wi).pdf_back,
            None => self.scatterer.pdf(wi, self.wo),
        }
    }

    /// [`adjoint_correction`] of a walk that carries `mode`.
    #[inline]
    pub fn adjoint_correction(&self, wi: Vec3, mode: Mode) -> f32 {
        if mode == Mode::Radiance || is_seeded(Fault::ShadingNormal) {
            return 1.0;
        }
        adjoint_correction(self.scatterer.frame.normal, self.point.geometric_normal, self.wo, wi)
    }

    /// The vertex, for the choice of lights.
    #[inline]
    pub fn receiver(&self) -> Receiver {
        Receiver { position: self.point.position, normal: self.scatterer.receiving_normal() }
    }
}
