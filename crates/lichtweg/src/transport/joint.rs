//! Vertices that wait for connections, a row of memory each, and how a connection sees them.
//!
//! A connection of a vertex z of a walk from the eye and a vertex y of a walk from a light has the value T_z f_z T_y f_y / d^2,
//! with T the throughputs, f the scattering functions times the cosines to the geometric normals, and d the distance. Each sum
//! of its weight is a product of the density of one vertex, the cosine and the [root](Others::root) of the other, and 1 / d^2
//! ([`connect`]).
//!
//! Vertices that reflect diffusely keep the product of throughput and albedo, and their root, which does not depend on where
//! they are connected to.

use std::f32::consts::FRAC_1_PI;

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Mask, Row, Wide, WordLanes};

use super::fault;
use super::mis;
use super::vertex::{Others, Trail, Vertex};
use super::vertex_lanes::{LobeLanes, VertexLanes};
use super::visibility::ShadowPoint;
use super::wave::points::Materials;
use crate::bsdf::{Diffuse, Frame, Mode};
use crate::color::Spectra;
use crate::lanes::lanes_of;
use crate::lanes::warp;
use crate::scene::LobeModel;
use crate::scene::description::Heuristic;

/// How a connection sees a vertex; or as many as `F` has lanes.
#[derive(Clone, Copy)]
pub struct Reach<F> {
    /// Throughput times scattering function times the cosine to the geometric normal.
    pub value: Spectra<F>,
    /// Density per solid angle of going along the connection.
    pub pdf: F,
    /// |cos| to the geometric normal.
    pub cos: F,
    /// See [`Others::root`].
    pub root: F,
}

/// Value over density of a connection, and its weight; `per_area` is 1 / d^2.
#[inline(always)]
pub fn connect<F: Float>(
    heuristic: Heuristic,
    light: &Reach<F>,
    eye: &Reach<F>,
    per_area: F,
) -> (Spectra<F>, F) {
    let light_side = eye.pdf * light.cos * per_area * light.root;
    let eye_side = light.pdf * eye.cos * per_area * eye.root;
    let weight = mis::share(heuristic, F::splat(1.0), light_side, eye_side);
    (eye.value * light.value * per_area, weight)
}

/// A vertex as its row has it; or as many as `F` has lanes.
#[derive(Clone, Copy)]
pub struct Joint<F> {
    pub point: ShadowPoint<F>,
    /// The shading normal, on the side that the walk came from.
    pub normal: Vector<F>,
    /// The throughput; of a diffuse reflector times its albedo, and of a walk from a light over pi, corrected for the shading normal.
    pub flux: Spectra<F>,
    /// The other strategies; of a diffuse reflector their root, as `connected`.
    pub others: Others<F>,
}

impl<F: Float> Joint<F> {
    /// From the columns of rows.
    #[inline(always)]
    pub fn new(c: &[F; LANES]) -> Self {
        Self {
            point: ShadowPoint {
                position: Vector::new(c[0], c[1], c[2]),
                geometric_normal: Vector::new(c[6], c[7], c[8]),
                error: c[13],
            },
            normal: Vector::new(c[3], c[4], c[5]),
            flux: Spectra([c[9], c[10], c[11], c[12]]),
            others: Others { connected: c[14], shorter: c[15] },
        }
    }

    #[inline(always)]
    fn columns(&self) -> [F; LANES] {
        let ShadowPoint { position: p, geometric_normal: g, error } = self.point;
        let (n, [r, gr, b, c], others) = (self.normal, self.flux.0, self.others);
        [p.x, p.y, p.z, n.x, n.y, n.z, g.x, g.y, g.z, r, gr, b, c, error, others.connected, others.shorter]
    }

    /// The joint of a diffuse reflector of an albedo. Without flux where the walk came from a side that reflects nothing.
    #[inline(always)]
    fn reflector(self, albedo: Spectra<F>, wo: Vector<F>, mode: Mode, heuristic: Heuristic) -> Self {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let cos = self.normal.dot(wo);
        let lit = one.select(zero.lt(cos), zero);
        let scale = match mode {
            Mode::Radiance => lit,
            Mode::Importance => {
                // What the correction of the adjoint leaves of the cosine at the shading normal.
                let (n, g) = (self.normal, self.point.geometric_normal);
                let same = n.x.equal(g.x) & n.y.equal(g.y) & n.z.equal(g.z);
                let slope = (cos / g.dot(wo)).abs();
                let slope = slope.select(slope.lt(F::splat(f32::INFINITY)), zero);
                lit * one.select(same, slope) * F::splat(FRAC_1_PI)
            }
        };
        let root = self.others.root(heuristic, warp::cosine_hemisphere_pdf(cos));
        let others = Others { connected: root, shorter: zero };
        Self { flux: self.flux * albedo * scale, others, ..self }
    }

    /// How a connection sees a diffuse reflector.
    #[inline(always)]
    pub fn reflect(&self, direction: Vector<F>, mode: Mode) -> Reach<F> {
        let zero = F::splat(0.0);
        let pdf = warp::cosine_hemisphere_pdf(direction.dot(self.normal));
        let cos = direction.dot(self.point.geometric_normal).abs();
        let factor = match mode {
            Mode::Radiance => pdf,
            Mode::Importance => cos.select(zero.lt(pdf), zero),
        };
        Reach { value: self.flux * factor, pdf, cos, root: self.others.connected }
    }
}

/// How a connection sees sixteen vertices of a single lobe.
#[inline(always)]
pub fn reach_lobes<W: Wide>(
    joint: &Joint<W::F32>,
    lobes: &LobeLanes<W>,
    direction: Vector<W::F32>,
    heuristic: Heuristic,
) -> Reach<W::F32> {
    let scattering = lobes.scatter(direction);
    Reach {
        value: joint.flux * scattering.value,
        pdf: scattering.pdf,
        cos: scattering.cos,
        root: joint.others.root(heuristic, scattering.pdf_back),
    }
}

/// How a connection sees a vertex of any kind.
#[inline]
pub fn reach(vertex: &Vertex<'_>, direction: Vector<f32>, mode: Mode, heuristic: Heuristic) -> Reach<f32> {
    let scattering = vertex.scatter(direction, mode);
    Reach {
        value: vertex.throughput * scattering.value,
        pdf: scattering.pdf,
        cos: scattering.cos,
        root: vertex.others.root(heuristic, scattering.pdf_back),
    }
}

/// What is known of a waiting vertex besides its row.
#[derive(Clone, Copy, Debug)]
pub struct Label {
    /// See [`Vertex::walk`].
    pub walk: u32,
    /// See [`Vertex::number`].
    pub number: u32,
    /// Its number among the vertices of the walks that went alone, if it is of one of these.
    pub vertex: u32,
    pub kind: Kind,
}

/// How a vertex scatters.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Diffusely.
    Reflector,
    /// By a single lobe, whose rows have this number.
    Lobe(u32),
    /// In any other way: its vertex tells.
    General,
}

/// Waiting vertices.
#[derive(Debug, Default)]
pub struct Joints {
    pub rows: Vec<Row>,
    pub labels: Vec<Label>,
    /// Of single lobes: direction to the vertex before, material.
    pub lobes: Vec<[Row; 2]>,
}

impl Joints {
    pub fn clear(&mut self) {
        self.rows.clear();
        self.labels.clear();
        self.lobes.clear();
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Appends the vertices of the lanes that reflect anything.
    #[inline(always)]
    pub fn append<W: Wide>(&mut self, vertices: &VertexLanes<W>, heuristic: Heuristic) {
        let Materials { frame, columns } = &vertices.lobes.materials;
        let joint = Joint {
            point: vertices.points,
            normal: frame.normal,
            flux: vertices.throughput,
            others: vertices.others,
        };
        let lobes = &vertices.lobes;
        let walk = vertices.walk.to_lanes();
        let diffuse = (vertices.lanes & LobeModel::Diffuse.is_in(columns)).bits();
        if diffuse != 0 {
            let albedo = Diffuse::from_columns(columns).reflectance;
            let joint = joint.reflector(albedo, lobes.wo, lobes.mode, heuristic);
            let rows = W::F32::rows(joint.columns());
            for lane in lanes_of(diffuse & joint.flux.is_lit().bits()) {
                self.rows.push(rows[lane]);
                let (walk, number, kind) = (walk.0[lane], vertices.number, Kind::Reflector);
                self.labels.push(Label { walk, number, vertex: Trail::NONE, kind });
            }
        }
        let others = vertices.lanes.bits() & !diffuse;
        if others != 0 {
            let zero = W::F32::splat(0.0);
            let (rows, materials) = (W::F32::rows(joint.columns()), W::F32::rows(*columns));
            let wo = lobes.wo;
            let (x, y, z) = (wo.x, wo.y, wo.z);
            let wo = W::F32::rows([
                x, y, z, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero,
            ]);
            for lane in lanes_of(others) {
                self.rows.push(rows[lane]);
                let kind = Kind::Lobe(self.lobes.len() as u32);
                self.lobes.push([wo[lane], materials[lane]]);
                let (walk, number) = (walk.0[lane], vertices.number);
                self.labels.push(Label { walk, number, vertex: Trail::NONE, kind });
            }
        }
    }

    /// Appends a vertex that went alone, of this number among such, if anything can be connected to it.
    pub fn push(&mut self, vertex: &Vertex<'_>, index: u32, mode: Mode, heuristic: Heuristic) {
        let joint = Joint {
            point: ShadowPoint::from(&vertex.point),
            normal: vertex.scatterer.frame.normal,
            flux: vertex.throughput,
            others: vertex.others,
        };
        let (joint, kind) = match vertex.scatterer.lambert() {
            Some(albedo) if !fault::is_any_seeded() => {
                (joint.reflector(albedo, vertex.wo, mode, heuristic), Kind::Reflector)
            }
            _ => (joint, Kind::General),
        };
        if vertex.scatterer.bsdf.connects() && !joint.flux.is_zero() {
            self.rows.push(Lanes(joint.columns()));
            let (walk, number) = (vertex.walk, vertex.number);
            self.labels.push(Label { walk, number, vertex: index, kind });
        }
    }
}

/// The lobes of sixteen vertices from the columns of their rows.
#[inline(always)]
pub fn lobes_of<W: Wide>(
    joint: &Joint<W::F32>,
    wo: Vector<W::F32>,
    material: [W::F32; LANES],
    mode: Mode,
) -> LobeLanes<W> {
    // Lobes that tell one tangent from another are of no such material: any frame will do.
    let frame = Frame::from_normal(joint.normal);
    let materials = Materials { frame, columns: material };
    LobeLanes::new(materials, joint.point.geometric_normal, wo, mode)
}
