//! Connections between the vertices of walks from the eye and those of walks from the lights.
//!
//! Pairs come in rows, and groups of pairs of a row share their walks from the lights: each walk from the eye is joined with the
//! walks from the lights of `partners` pairs, itself one of them, each for its share. So for one walk of either kind there are many
//! joint paths, of which only those that are worth it are looked at (compare Davidovič et al. 2014, *Progressive Light Transport
//! Simulation on the GPU*, section 6, and Popov et al. 2015, *Probabilistic Connections for Bidirectional Path Tracing*). The pairs
//! of a group belong to different pixels, so that a pixel's samples stay independent.
//!
//! Vertices that reflect diffusely are connected sixteen at a time: with cosines c at shading and g at geometric normals,
//! distance d and albedos folded into the throughputs, the value is T_z T_y (c_z / pi) (g_y / pi) / d^2, and each sum of the weights is
//! (p r)^b with a number r that the vertex knows, since its density of going back does not depend on the connection.

use std::f32::consts::FRAC_1_PI;

use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::{self, Float, FloatLanes, Kernel, LANES, Lanes, Mask, Wide};

use super::bidirectional::{Bidirectional, ContributionSink, Pair};
use super::connect::{Joiner, Selection};
use super::fault::{Fault, is_seeded};
use super::light_end::LightStart;
use super::vertex::{Trail, Vertex};
use crate::bsdf::Mode;
use crate::color::{Spectra, Spectrum};
use crate::scene::RayCounts;
use crate::scene::description::Heuristic;

/// Paths to be looked at together, about.
const BATCH: usize = 1024;

/// The random numbers that select connections stand behind all those that a walk can use.
const SELECTION_DIMENSION: u32 = 1 << 30;

/// A vertex that reflects diffusely.
#[derive(Clone, Copy, Debug)]
struct Reflector {
    position: Vec3,
    /// The shading normal, on the side that the walk came from.
    normal: Vec3,
    geometric_normal: Vec3,
    /// Throughput times albedo; of walks from a light over pi, and corrected for the shading normal.
    flux: Spectrum,
    /// r.
    root: f32,
}

impl Reflector {
    /// `None` of other vertices; without flux where the walk came from a side that reflects nothing.
    #[inline]
    fn new(vertex: &Vertex<'_>, mode: Mode, heuristic: Heuristic) -> Option<Self> {
        let albedo = vertex.scatterer.lambert()?;
        if is_seeded(Fault::Cosine) || is_seeded(Fault::ShadingNormal) {
            return None;
        }
        let (normal, geometric_normal) = (vertex.scatterer.frame.normal, vertex.point.geometric_normal);
        let cos = normal.dot(vertex.wo);
        let lit = if cos > 0.0 { 1.0 } else { 0.0 };
        let scale = match mode {
            Mode::Radiance => lit,
            // What `Vertex::adjoint_correction` leaves of the cosine at the shading normal.
            Mode::Importance if normal == geometric_normal => lit * FRAC_1_PI,
            Mode::Importance => {
                let slope = cos / geometric_normal.dot(vertex.wo);
                if slope.is_finite() { lit * slope.abs() * FRAC_1_PI } else { 0.0 }
            }
        };
        let sum = vertex.others.sum(heuristic, 1.0, cos.max(0.0) * FRAC_1_PI);
        let root = match heuristic {
            Heuristic::Balance => sum,
            Heuristic::Power => sum.sqrt(),
        };
        Some(Self {
            position: vertex.point.position,
            normal,
            geometric_normal,
            flux: vertex.throughput * albedo * scale,
            root: root as f32,
        })
    }
}

/// Sixteen reflectors of walks from lights, a column a quantity: position, normal, geometric normal, flux, r, number of the vertex.
#[derive(Clone, Debug)]
struct Block {
    columns: [Lanes<f32>; 15],
    /// The vertices.
    vertices: [u32; LANES],
    len: usize,
}

impl Block {
    const EMPTY: Self = Self { columns: [Lanes::splat(0.0); 15], vertices: [Trail::NONE; LANES], len: 0 };

    fn push(&mut self, reflector: &Reflector, number: u32, vertex: u32) {
        let Reflector { position: p, normal: n, geometric_normal: g, flux: Spectra(f), root } = *reflector;
        let row = [p.x, p.y, p.z, n.x, n.y, n.z, g.x, g.y, g.z, f[0], f[1], f[2], f[3], root, number as f32];
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.0[self.len] = value;
        }
        self.vertices[self.len] = vertex;
        self.len += 1;
    }

    fn flux(&self, lane: usize) -> Spectrum {
        Spectra(std::array::from_fn(|i| self.columns[9 + i].0[lane]))
    }
}

/// A reflector of a walk from the eye and sixteen of walks from lights.
struct Join<'j> {
    eye: &'j Reflector,
    block: &'j Block,
    /// Surface vertices that the walks from lights may have.
    longest: f32,
    heuristic: Heuristic,
}

/// What comes of it.
struct Joined {
    /// Lanes that light goes along.
    lit: u32,
    /// Factor on the product of both fluxes.
    factor: Lanes<f32>,
    weight: Lanes<f32>,
    /// The largest weighted value.
    worth: Lanes<f32>,
}

impl Kernel for Join<'_> {
    type Output = Joined;

    #[inline(always)]
    fn run<W: Wide>(self) -> Joined {
        let splat = W::F32::splat;
        let zero = splat(0.0);
        let spread = |v: Vec3| Vector::new(splat(v.x), splat(v.y), splat(v.z));
        let column = |i: usize| W::F32::load(&self.block.columns[i]);
        let vector = |i: usize| Vector::new(column(i), column(i + 1), column(i + 2));
        let eye = self.eye;
        let along = vector(0) - spread(eye.position);
        let per_area = splat(1.0) / along.dot(along);
        let direction = along * per_area.sqrt();
        let cos_eye = direction.dot(spread(eye.normal)).max(zero);
        let cos_light = (zero - direction.dot(vector(3))).max(zero);
        let geometric_eye = direction.dot(spread(eye.geometric_normal)).abs();
        let geometric_light = direction.dot(vector(6)).abs();
        let pdf_eye = cos_eye * splat(FRAC_1_PI);
        let pdf_light = cos_light * splat(FRAC_1_PI);
        let light = pdf_eye * geometric_light * per_area * column(13);
        let eye_side = pdf_light * geometric_eye * per_area * splat(eye.root);
        let (light, eye_side) = match self.heuristic {
            Heuristic::Balance => (light, eye_side),
            Heuristic::Power => (light * light, eye_side * eye_side),
        };
        let weight = splat(1.0) / (splat(1.0) + light + eye_side);
        let possible = zero.lt(cos_light) & column(14).le(splat(self.longest));
        let factor = (pdf_eye * geometric_light * per_area).select(possible, zero);
        let flux = Spectra([column(9), column(10), column(11), column(12)])
            * Spectra([
                splat(eye.flux.0[0]),
                splat(eye.flux.0[1]),
                splat(eye.flux.0[2]),
                splat(eye.flux.0[3]),
            ]);
        let worth = flux.max_element() * factor * weight;
        Joined {
            lit: zero.lt(worth).bits(),
            factor: factor.to_lanes(),
            weight: weight.to_lanes(),
            worth: worth.to_lanes(),
        }
    }
}

/// The vertices of walks from the lights, for each group of pairs.
#[derive(Debug, Default)]
pub(super) struct Partners {
    /// Where the vertices of each walk begin in `by_walk`.
    first: Vec<u32>,
    by_walk: Vec<u32>,
    blocks: Vec<Block>,
    others: Vec<u32>,
    /// Where those of each group begin in `blocks` and in `others`.
    groups: Vec<[u32; 2]>,
    /// Pairs in a row, and groups of them.
    row: usize,
    groups_a_row: usize,
}

impl Partners {
    /// From the vertices of the walks of some pairs, in rows.
    fn gather(&mut self, light: &[Vertex<'_>], pairs: usize, row: usize, settings: &Bidirectional) {
        self.sort(light, pairs);
        let partners = settings.partners as usize;
        (self.row, self.groups_a_row) = (row, row.div_ceil(partners));
        self.blocks.clear();
        self.others.clear();
        self.groups.clear();
        for first in (0..pairs).step_by(row) {
            for group in 0..self.groups_a_row {
                self.groups.push([self.blocks.len() as u32, self.others.len() as u32]);
                let mut room = 0;
                for partner in 0..partners {
                    let walk = first + (group + partner * self.groups_a_row) % row;
                    for i in self.first[walk]..self.first[walk + 1] {
                        let index = self.by_walk[i as usize];
                        let vertex = &light[index as usize];
                        if vertex.number.saturating_add(2) > settings.max_depth {
                            continue;
                        }
                        let Some(reflector) = Reflector::new(vertex, Mode::Importance, settings.heuristic)
                        else {
                            if vertex.scatterer.bsdf.connects() {
                                self.others.push(index);
                            }
                            continue;
                        };
                        if reflector.flux.is_zero() {
                            continue;
                        }
                        if room == 0 {
                            self.blocks.push(Block::EMPTY);
                            room = LANES;
                        }
                        if let Some(block) = self.blocks.last_mut() {
                            block.push(&reflector, vertex.number, index);
                            room -= 1;
                        }
                    }
                }
            }
        }
        self.groups.push([self.blocks.len() as u32, self.others.len() as u32]);
    }

    /// Puts the vertices of each walk together.
    fn sort(&mut self, light: &[Vertex<'_>], walks: usize) {
        self.first.clear();
        self.first.resize(walks + 2, 0);
        for vertex in light {
            self.first[vertex.walk as usize + 2] += 1;
        }
        for i in 2..self.first.len() {
            self.first[i] += self.first[i - 1];
        }
        self.by_walk.clear();
        self.by_walk.resize(light.len(), 0);
        for (i, vertex) in light.iter().enumerate() {
            let to = &mut self.first[vertex.walk as usize + 1];
            self.by_walk[*to as usize] = i as u32;
            *to += 1;
        }
    }

    /// What a pair is joined with: blocks of reflectors, and other vertices.
    #[inline]
    fn of(&self, pair: u32) -> (&[Block], &[u32]) {
        let pair = pair as usize;
        let group = pair / self.row * self.groups_a_row + pair % self.row % self.groups_a_row;
        let ([block, other], [next_block, next_other]) = (self.groups[group], self.groups[group + 1]);
        (&self.blocks[block as usize..next_block as usize], &self.others[other as usize..next_other as usize])
    }
}

impl<S: ContributionSink> Joiner<'_, '_, S> {
    /// s, t >= 2: every vertex of the walks from the eye with every vertex of the walks from the lights of its group.
    pub fn join(
        &mut self,
        partners: &mut Partners,
        row: usize,
        light: &[Vertex<'_>],
        eye: &[Vertex<'_>],
        starts: &[Option<LightStart>],
        counts: &mut RayCounts,
    ) {
        partners.gather(light, self.pairs.len(), row, self.settings);
        for (i, z) in eye.iter().enumerate() {
            // Edges are one more than surface vertices.
            let longest = self.settings.max_depth.saturating_sub(z.number + 1);
            let (blocks, others) = partners.of(z.walk);
            if longest == 0 || (blocks.is_empty() && others.is_empty()) || !z.scatterer.bsdf.connects() {
                continue;
            }
            let pair: &Pair = &self.pairs[z.walk as usize];
            let mut selection = Selection::new(pair.expected, || {
                pair.eye.at_dimension(SELECTION_DIMENSION + z.number).next_1d()
            });
            let trail = Trail::new(eye, i as u32);
            match Reflector::new(z, Mode::Radiance, self.settings.heuristic) {
                Some(reflector) => {
                    if reflector.flux.is_zero() {
                        continue;
                    }
                    for block in blocks {
                        self.join_reflectors(&reflector, block, longest, trail, light, &mut selection);
                    }
                }
                None => {
                    for block in blocks {
                        self.join_others(&block.vertices[..block.len], longest, trail, light, &mut selection);
                    }
                }
            }
            self.join_others(others, longest, trail, light, &mut selection);
            if self.queue.len() >= BATCH {
                self.flush(light, eye, starts, counts);
            }
        }
        self.flush(light, eye, starts, counts);
    }

    fn join_reflectors(
        &mut self,
        reflector: &Reflector,
        block: &Block,
        longest: u32,
        z: Trail<'_, '_>,
        light: &[Vertex<'_>],
        selection: &mut Selection,
    ) {
        let Bidirectional { heuristic, partners, .. } = *self.settings;
        let share = 1.0 / partners as f32;
        let joined = wide::dispatch(Join { eye: reflector, block, longest: longest as f32, heuristic });
        for lane in (0..LANES).filter(|lane| joined.lit >> lane & 1 != 0) {
            let Some(compensation) = selection.keep(joined.worth.0[lane] * share) else { continue };
            let y = Trail::new(light, block.vertices[lane]);
            let factor = joined.factor.0[lane] * share * compensation;
            self.look(y, z, reflector.flux * block.flux(lane) * factor, joined.weight.0[lane]);
        }
    }

    fn join_others(
        &mut self,
        vertices: &[u32],
        longest: u32,
        z: Trail<'_, '_>,
        light: &[Vertex<'_>],
        selection: &mut Selection,
    ) {
        let Some(at_eye) = z.last() else { return };
        for &vertex in vertices {
            let y = &light[vertex as usize];
            if y.number > longest {
                continue;
            }
            let Some((value, weight)) = self.connect(y, at_eye) else { continue };
            let Some(compensation) = selection.keep((value * weight).max_element()) else { continue };
            self.look(Trail::new(light, vertex), z, value * compensation, weight);
        }
    }
}
