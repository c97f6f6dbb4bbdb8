//! Connections between the vertices of walks from the eye and those of walks from the lights: s, t >= 2.
//!
//! Pairs come in rows, and groups of pairs of a row share their walks from the lights: each walk from the eye is joined with the
//! walks from the lights of `partners` pairs, each for its share. So for one walk of either kind there are many
//! joint paths, of which only those that are worth it are looked at (compare Davidovič et al. 2014, *Progressive Light Transport
//! Simulation on the GPU*, section 6, and Popov et al. 2015, *Probabilistic Connections for Bidirectional Path Tracing*). The pairs
//! of a group belong to different pixels, so that a pixel's samples stay independent.
//!
//! A vertex of a walk from the eye is connected to sixteen others at a time ([`Block`]).

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{self, Float, FloatLanes, Kernel, LANES, Lanes, Mask, Wide};

use super::bidirectional::{Bidirectional, ContributionSink, Pair};
use super::connect::{Joiner, keep};
use super::joint::{Joint, Joints, Kind, Label, Reach, connect, lobes_of, reach, reach_lobes};
use super::light_end::LightStart;
use super::packets::{RayLanes, rows_of};
use super::partners::{Block, BlockKind, Partners};
use super::vertex::Vertex;
use super::visibility::{Candidate, End, SHADOW_END, Way};
use crate::bsdf::Mode;
use crate::color::SpectrumLanes;
use crate::color::{Spectra, Spectrum};
use crate::lanes::lanes_of;
use crate::scene::RayCounts;
use crate::scene::description::Heuristic;

/// Paths to be looked at together, about.
const BATCH: usize = 1024;

/// The random numbers that select connections stand behind all those that a walk can use.
const SELECTION_DIMENSION: u32 = 1 << 30;

/// The vertices of walks that are joined: those that wait in rows, and those of walks that went alone.
#[derive(Clone, Copy)]
pub struct Ends<'j, 'a> {
    pub joints: &'j Joints,
    pub alone: &'j [Vertex<'a>],
}

/// A connection that is to be looked at.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    light: u32,
    eye: u32,
    value: Spectrum,
    weight: f32,
}

impl<S: ContributionSink> Joiner<'_, '_, S> {
    /// Every vertex of the walks from the eye with every vertex of the walks from the lights of its group.
    pub fn join(
        &mut self,
        partners: &mut Partners,
        connections: &mut Vec<Connection>,
        row: usize,
        [light, eye]: [Ends<'_, '_>; 2],
        starts: &[Option<LightStart>],
        counts: &mut RayCounts,
    ) {
        let settings = self.settings;
        partners.gather(light.joints, self.pairs, row, settings.partners as usize);
        let mut next = 0;
        while next < eye.joints.len() {
            let pairs = self.pairs;
            connections.clear();
            next = wide::dispatch(Join { settings, pairs, partners, light, eye, next, connections });
            wide::dispatch(Look { joiner: self, light: light.joints, eye: eye.joints, connections });
            self.flush(light.alone, eye.alone, starts, counts);
        }
    }
}

/// Connects the vertices of walks from the eye, from a number on, until there is enough to be looked at; which is next.
struct Join<'j, 'a> {
    settings: &'j Bidirectional,
    pairs: &'j [Pair],
    partners: &'j Partners,
    light: Ends<'j, 'a>,
    eye: Ends<'j, 'a>,
    next: usize,
    connections: &'j mut Vec<Connection>,
}

impl Kernel for Join<'_, '_> {
    type Output = usize;

    #[inline(always)]
    fn run<W: Wide>(self) -> usize {
        let Bidirectional { heuristic, max_depth, partners, .. } = *self.settings;
        let share = 1.0 / partners as f32;
        for (number, label) in self.eye.joints.labels.iter().enumerate().skip(self.next) {
            if self.connections.len() >= BATCH {
                return number;
            }
            let blocks = self.partners.of(label.walk);
            // Edges are one more than surface vertices.
            let longest = max_depth.saturating_sub(label.number + 1);
            if blocks.is_empty() || longest == 0 {
                continue;
            }
            let pair: &Pair = &self.pairs[label.walk as usize];
            let expected = W::F32::splat(pair.expected);
            let mut u = pair.eye.at_dimension(SELECTION_DIMENSION + label.number).next_1d();
            let eye = EyeEnd::<W>::new(&self.eye, number, label);
            for block in blocks {
                let joined = self.join_block::<W>(&eye, block, longest as f32, heuristic, share);
                let Some(Joined { lit, value, weight }) = joined else { continue };
                let (kept, compensation) = keep(expected, (value * weight).max_element(), strata::<W>(u));
                u = fraction(u + GOLDEN_RATIO);
                let kept = lit & kept;
                if !kept.any() {
                    continue;
                }
                let (value, weight) = (SpectrumLanes::new(value * compensation), weight.to_lanes());
                for lane in lanes_of(kept.bits()) {
                    self.connections.push(Connection {
                        light: block.joints[lane],
                        eye: number as u32,
                        value: value.get(lane),
                        weight: weight.0[lane],
                    });
                }
            }
        }
        self.eye.joints.len()
    }
}

/// A vertex of a walk from the eye, in all lanes.
struct EyeEnd<'j, 'a, W: Wide> {
    joint: Joint<W::F32>,
    kind: EyeKind<'j, 'a, W>,
}

enum EyeKind<'j, 'a, W: Wide> {
    Reflector,
    Lobe { wo: Vector<W::F32>, material: [W::F32; LANES] },
    General(&'j Vertex<'a>),
}

impl<'j, 'a, W: Wide> EyeEnd<'j, 'a, W> {
    #[inline(always)]
    fn new(ends: &Ends<'j, 'a>, number: usize, label: &Label) -> Self {
        let kind = match label.kind {
            Kind::Reflector => EyeKind::Reflector,
            Kind::Lobe(lobe) => {
                let [wo, material] = &ends.joints.lobes[lobe as usize];
                let [x, y, z, ..] = spread::<W>(wo);
                EyeKind::Lobe { wo: Vector::new(x, y, z), material: spread::<W>(material) }
            }
            Kind::General => EyeKind::General(&ends.alone[label.vertex as usize]),
        };
        Self { joint: Joint::new(&spread::<W>(&ends.joints.rows[number])), kind }
    }
}

/// Each element of a row in all lanes.
#[inline(always)]
fn spread<W: Wide>(Lanes(row): &Lanes<f32>) -> [W::F32; LANES] {
    let mut out = [W::F32::splat(0.0); LANES];
    for i in 0..LANES {
        out[i] = W::F32::splat(row[i]);
    }
    out
}

/// Columns in registers.
#[inline(always)]
fn load<W: Wide>(columns: &[Lanes<f32>; LANES]) -> [W::F32; LANES] {
    let mut out = [W::F32::splat(0.0); LANES];
    for i in 0..LANES {
        out[i] = W::F32::load(&columns[i]);
    }
    out
}

/// Steps of this part of one fill it evenly.
const GOLDEN_RATIO: f32 = 0.618_034;

fn fraction(x: f32) -> f32 {
    x - x.floor()
}

/// Uniform numbers, one in each sixteenth: of connections that are looked at with the same probability, nearly the same number always is.
#[inline(always)]
fn strata<W: Wide>(u: f32) -> W::F32 {
    let one = W::F32::splat(1.0);
    let shifted = W::F32::splat(u) + W::F32::load(&SIXTEENTHS);
    let wrapped = shifted - one;
    wrapped.select(one.le(shifted), shifted)
}

/// In an order in which neighbours are far from each other.
static SIXTEENTHS: Lanes<f32> = Lanes([
    0.0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875, 0.0625, 0.5625, 0.3125, 0.8125, 0.1875, 0.6875, 0.4375,
    0.9375,
]);

/// What comes of sixteen connections.
struct Joined<W: Wide> {
    /// Where light goes along.
    lit: W::Mask,
    value: Spectra<W::F32>,
    weight: W::F32,
}

impl Join<'_, '_> {
    #[inline(always)]
    fn join_block<W: Wide>(
        &self,
        eye: &EyeEnd<'_, '_, W>,
        block: &Block,
        longest: f32,
        heuristic: Heuristic,
        share: f32,
    ) -> Option<Joined<W>> {
        let splat = W::F32::splat;
        let light = Joint::new(&load::<W>(&block.columns));
        let along = light.point.position - eye.joint.point.position;
        let per_area = splat(1.0) / along.length_squared();
        let direction = along * per_area.sqrt();
        let mut possible = W::F32::load(&block.numbers).le(splat(longest));
        // All but general vertices reflect on the side of their normals alone.
        let zero = splat(0.0);
        if !matches!(eye.kind, EyeKind::General(_)) {
            possible = possible & zero.lt(eye.joint.normal.dot(direction));
        }
        if !matches!(block.kind, BlockKind::General) {
            possible = possible & light.normal.dot(direction).lt(zero);
        }
        if !possible.any() {
            return None;
        }
        let at_eye = match &eye.kind {
            EyeKind::Reflector => eye.joint.reflect(direction, Mode::Radiance),
            EyeKind::Lobe { wo, material } => {
                let lobes = lobes_of::<W>(&eye.joint, *wo, *material, Mode::Radiance);
                reach_lobes(&eye.joint, &lobes, direction, heuristic)
            }
            EyeKind::General(vertex) => one_by_one::<W>(direction, possible.bits(), |_, direction| {
                reach(vertex, direction, Mode::Radiance, heuristic)
            }),
        };
        let back = -direction;
        let at_light = match block.kind {
            BlockKind::Reflectors => light.reflect(back, Mode::Importance),
            BlockKind::Lobes(number) => {
                let [wo, material] = self.partners.lobes(number);
                let [x, y, z, ..] = load::<W>(wo);
                let (wo, material) = (Vector::new(x, y, z), load::<W>(material));
                let lobes = lobes_of::<W>(&light, wo, material, Mode::Importance);
                reach_lobes(&light, &lobes, back, heuristic)
            }
            BlockKind::General => one_by_one::<W>(back, possible.bits(), |lane, direction| {
                let label = &self.light.joints.labels[block.joints[lane] as usize];
                reach(&self.light.alone[label.vertex as usize], direction, Mode::Importance, heuristic)
            }),
        };
        let (value, weight) = connect(heuristic, &at_light, &at_eye, per_area);
        let value = value * splat(share);
        Some(Joined { lit: possible & value.is_lit(), value, weight })
    }
}

/// What is found lane by lane.
#[inline(always)]
fn one_by_one<W: Wide>(
    direction: Vector<W::F32>,
    lanes: u32,
    reach: impl Fn(usize, Vector<f32>) -> Reach<f32>,
) -> Reach<W::F32> {
    let [x, y, z] = [direction.x.to_lanes(), direction.y.to_lanes(), direction.z.to_lanes()];
    let mut columns = [Lanes::splat(0.0); 7];
    for lane in lanes_of(lanes) {
        let Reach { value: Spectra([a, b, c, d]), pdf, cos, root } =
            reach(lane, Vector::new(x.0[lane], y.0[lane], z.0[lane]));
        for (column, value) in columns.iter_mut().zip([a, b, c, d, pdf, cos, root]) {
            column.0[lane] = value;
        }
    }
    let load = W::F32::load;
    let [a, b, c, d, pdf, cos, root] = &columns;
    Reach {
        value: Spectra([load(a), load(b), load(c), load(d)]),
        pdf: load(pdf),
        cos: load(cos),
        root: load(root),
    }
}

/// Lets connections wait for their shadow rays.
struct Look<'l, 'p, 'a, S> {
    joiner: &'l mut Joiner<'p, 'a, S>,
    light: &'l Joints,
    eye: &'l Joints,
    connections: &'l [Connection],
}

impl<S: ContributionSink> Kernel for Look<'_, '_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { joiner, light, eye, connections } = self;
        let mut numbers = [[0; LANES]; 2];
        for connections in connections.chunks(LANES) {
            let mut time = Lanes::splat(0.0);
            for (lane, connection) in connections.iter().enumerate() {
                (numbers[0][lane], numbers[1][lane]) = (connection.light, connection.eye);
                time.0[lane] = joiner.pair(eye.labels[connection.eye as usize].walk).ray.time;
            }
            let count = connections.len();
            let y = Joint::new(&W::F32::columns(&rows_of(&numbers[0][..count], |i| &light.rows[i])));
            let z = Joint::new(&W::F32::columns(&rows_of(&numbers[1][..count], |i| &eye.rows[i])));
            let [origin, direction] = z.point.toward(&y.point);
            let (tnear, tfar) = (W::F32::splat(0.0), W::F32::splat(1.0 - SHADOW_END));
            let rays = RayLanes { origin, direction, tnear, tfar, time: W::F32::load(&time) };
            let pairs = joiner.pairs;
            joiner.queue.append(&rays, W::Mask::from_bits((1 << count) - 1), |queue, lane| {
                let Connection { light: y, eye: z, value, weight } = connections[lane];
                let (y, z) = (&light.labels[y as usize], &eye.labels[z as usize]);
                let lens = || pairs[z.walk as usize].ray.origin;
                let way = || Way { lens: lens(), end: End::Start(y.walk), light: y.vertex, eye: z.vertex };
                let way = S::ROUTES.then(|| queue.keep(way()));
                Candidate { sample: z.walk, s: y.number + 1, t: z.number + 1, film: None, value, weight, way }
            });
        }
    }
}
