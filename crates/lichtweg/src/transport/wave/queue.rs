//! Queues of walks and of connections, a column a quantity, so that sixteen neighbours load into registers.

use lichtweg_montecarlo::{Sampler, SamplerKind, SamplerState};
use lichtweg_ray::math::Vec3;
use lichtweg_ray::wide::{Float, LANES, Lanes, Mask, Wide, Word};
use lichtweg_ray::{Ray, RayPacket};

use super::super::path::{Connection, Departure, Walk};
use super::vector::{Spectra, Vector};
use crate::color::Spectrum;

/// Walks in a queue, at most. More amortise the passes over a queue, fewer stay in the cache.
pub const CAPACITY: usize = 1024;

/// A column has room behind its end: lanes are stored sixteen at a time.
const ROOM: usize = CAPACITY + LANES;

/// In place of a density that does not exist.
pub const NO_PDF: f32 = -1.0;

type Column<T> = Box<[T]>;

fn column<T: Copy + Default>() -> Column<T> {
    vec![T::default(); ROOM].into_boxed_slice()
}

fn columns<T: Copy + Default, const N: usize>() -> [Column<T>; N] {
    std::array::from_fn(|_| column())
}

/// Walks on their way to their next vertices.
#[derive(Debug)]
pub(super) struct WalkQueue {
    len: usize,
    origin: [Column<f32>; 3],
    direction: [Column<f32>; 3],
    throughput: [Column<f32>; 4],
    eta: Column<f32>,
    departure: [Column<f32>; 3],
    departure_pdf: Column<f32>,
    time: Column<f32>,
    /// Lower and upper half of the samplers' keys.
    key: [Column<u32>; 2],
    index: Column<u32>,
    dimension: Column<u32>,
    path: Column<u32>,
}

/// Sixteen walks in registers.
#[derive(Clone, Copy)]
pub(super) struct WalkLanes<W: Wide> {
    pub origin: Vector<W::F32>,
    pub direction: Vector<W::F32>,
    pub throughput: Spectra<W::F32>,
    pub eta: W::F32,
    pub departure: Vector<W::F32>,
    pub departure_pdf: W::F32,
    pub time: W::F32,
    pub key: [W::U32; 2],
    pub index: W::U32,
    pub dimension: W::U32,
    pub path: W::U32,
}

#[inline(always)]
fn load3<W: Wide>(from: &[Column<f32>; 3], at: usize) -> Vector<W::F32> {
    let load = |c: &Column<f32>| W::F32::load_slice(&c[at..]);
    Vector::new(load(&from[0]), load(&from[1]), load(&from[2]))
}

#[inline(always)]
fn store3<W: Wide>(to: &mut [Column<f32>; 3], at: usize, v: Vector<W::F32>, mask: W::Mask) {
    v.x.compress(mask).store_slice(&mut to[0][at..]);
    v.y.compress(mask).store_slice(&mut to[1][at..]);
    v.z.compress(mask).store_slice(&mut to[2][at..]);
}

#[inline(always)]
fn set3(to: &mut [Column<f32>; 3], at: usize, v: Vec3) {
    (to[0][at], to[1][at], to[2][at]) = (v.x, v.y, v.z);
}

#[inline(always)]
fn get3(from: &[Column<f32>; 3], at: usize) -> Vec3 {
    Vec3::new(from[0][at], from[1][at], from[2][at])
}

impl WalkQueue {
    pub fn new() -> Self {
        Self {
            len: 0,
            origin: columns(),
            direction: columns(),
            throughput: columns(),
            eta: column(),
            departure: columns(),
            departure_pdf: column(),
            time: column(),
            key: columns(),
            index: column(),
            dimension: column(),
            path: column(),
        }
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    #[inline]
    pub fn push(&mut self, walk: &Walk, path: u32) {
        let at = self.len;
        set3(&mut self.origin, at, walk.ray.origin);
        set3(&mut self.direction, at, walk.ray.direction);
        for (column, value) in self.throughput.iter_mut().zip(walk.throughput.0) {
            column[at] = value;
        }
        self.eta[at] = walk.eta;
        set3(&mut self.departure, at, walk.departure.position);
        self.departure_pdf[at] = walk.departure.pdf.unwrap_or(NO_PDF);
        self.time[at] = walk.ray.time;
        let state = walk.sampler.state();
        (self.key[0][at], self.key[1][at]) = (state.key as u32, (state.key >> 32) as u32);
        (self.index[at], self.dimension[at]) = (state.index, state.dimension);
        self.path[at] = path;
        self.len += 1;
    }

    /// A walk, and which path it is of. Its ray has no end: that matters to camera rays alone, see [`WalkQueue::rays`].
    #[inline]
    pub fn get(&self, at: usize, kind: SamplerKind) -> (Walk, u32) {
        let pdf = self.departure_pdf[at];
        let key = u64::from(self.key[1][at]) << 32 | u64::from(self.key[0][at]);
        let state = SamplerState { key, index: self.index[at], dimension: self.dimension[at] };
        let walk = Walk {
            ray: Ray { time: self.time[at], ..Ray::new(get3(&self.origin, at), get3(&self.direction, at)) },
            throughput: Spectrum([0, 1, 2, 3].map(|i| self.throughput[i][at])),
            eta: self.eta[at],
            departure: Departure { position: get3(&self.departure, at), pdf: (pdf != NO_PDF).then_some(pdf) },
            sampler: Sampler::from_state(kind, state),
        };
        (walk, self.path[at])
    }

    /// Sixteen walks from one on; what is behind the end is of no meaning.
    #[inline(always)]
    pub fn lanes<W: Wide>(&self, at: usize) -> WalkLanes<W> {
        let load = |c: &Column<f32>| W::F32::load_slice(&c[at..]);
        let word = |c: &Column<u32>| W::U32::load_slice(&c[at..]);
        let t = &self.throughput;
        WalkLanes {
            origin: load3::<W>(&self.origin, at),
            direction: load3::<W>(&self.direction, at),
            throughput: Spectra([load(&t[0]), load(&t[1]), load(&t[2]), load(&t[3])]),
            eta: load(&self.eta),
            departure: load3::<W>(&self.departure, at),
            departure_pdf: load(&self.departure_pdf),
            time: load(&self.time),
            key: [word(&self.key[0]), word(&self.key[1])],
            index: word(&self.index),
            dimension: word(&self.dimension),
            path: word(&self.path),
        }
    }

    /// Appends the lanes whose mask is true.
    #[inline(always)]
    pub fn append<W: Wide>(&mut self, w: &WalkLanes<W>, mask: W::Mask) {
        let at = self.len;
        store3::<W>(&mut self.origin, at, w.origin, mask);
        store3::<W>(&mut self.direction, at, w.direction, mask);
        for i in 0..4 {
            w.throughput.0[i].compress(mask).store_slice(&mut self.throughput[i][at..]);
        }
        w.eta.compress(mask).store_slice(&mut self.eta[at..]);
        store3::<W>(&mut self.departure, at, w.departure, mask);
        w.departure_pdf.compress(mask).store_slice(&mut self.departure_pdf[at..]);
        w.time.compress(mask).store_slice(&mut self.time[at..]);
        w.key[0].compress(mask).store_slice(&mut self.key[0][at..]);
        w.key[1].compress(mask).store_slice(&mut self.key[1][at..]);
        w.index.compress(mask).store_slice(&mut self.index[at..]);
        w.dimension.compress(mask).store_slice(&mut self.dimension[at..]);
        w.path.compress(mask).store_slice(&mut self.path[at..]);
        self.len += mask.bits().count_ones() as usize;
    }

    /// The rays of sixteen walks from one on, without ends.
    #[inline(always)]
    pub fn rays<W: Wide>(&self, at: usize, rays: &mut RayPacket) {
        let load = |c: &Column<f32>| W::F32::load_slice(&c[at..]).to_lanes();
        for axis in 0..3 {
            rays.origin[axis] = load(&self.origin[axis]);
            rays.direction[axis] = load(&self.direction[axis]);
        }
        rays.time = load(&self.time);
        rays.tnear = Lanes::splat(0.0);
        rays.tfar = Lanes::splat(f32::INFINITY);
    }
}

/// Connections whose visibility is not known yet.
#[derive(Debug)]
pub(super) struct ConnectionQueue {
    len: usize,
    origin: [Column<f32>; 3],
    direction: [Column<f32>; 3],
    tfar: Column<f32>,
    time: Column<f32>,
    contribution: [Column<f32>; 4],
    path: Column<u32>,
}

/// Sixteen connections in registers.
#[derive(Clone, Copy)]
pub(super) struct ConnectionLanes<W: Wide> {
    pub origin: Vector<W::F32>,
    pub direction: Vector<W::F32>,
    pub tfar: W::F32,
    pub time: W::F32,
    pub contribution: Spectra<W::F32>,
    pub path: W::U32,
}

impl ConnectionQueue {
    pub fn new() -> Self {
        Self {
            len: 0,
            origin: columns(),
            direction: columns(),
            tfar: column(),
            time: column(),
            contribution: columns(),
            path: column(),
        }
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    #[inline]
    pub fn push(&mut self, connection: &Connection, path: u32) {
        let at = self.len;
        set3(&mut self.origin, at, connection.ray.origin);
        set3(&mut self.direction, at, connection.ray.direction);
        self.tfar[at] = connection.ray.tfar;
        self.time[at] = connection.ray.time;
        for (column, value) in self.contribution.iter_mut().zip(connection.contribution.0) {
            column[at] = value;
        }
        self.path[at] = path;
        self.len += 1;
    }

    /// Appends the lanes whose mask is true.
    #[inline(always)]
    pub fn append<W: Wide>(&mut self, c: &ConnectionLanes<W>, mask: W::Mask) {
        let at = self.len;
        store3::<W>(&mut self.origin, at, c.origin, mask);
        store3::<W>(&mut self.direction, at, c.direction, mask);
        c.tfar.compress(mask).store_slice(&mut self.tfar[at..]);
        c.time.compress(mask).store_slice(&mut self.time[at..]);
        for i in 0..4 {
            c.contribution.0[i].compress(mask).store_slice(&mut self.contribution[i][at..]);
        }
        c.path.compress(mask).store_slice(&mut self.path[at..]);
        self.len += mask.bits().count_ones() as usize;
    }

    /// The rays of sixteen connections from one on.
    #[inline(always)]
    pub fn rays<W: Wide>(&self, at: usize, rays: &mut RayPacket) {
        let load = |c: &Column<f32>| W::F32::load_slice(&c[at..]).to_lanes();
        for axis in 0..3 {
            rays.origin[axis] = load(&self.origin[axis]);
            rays.direction[axis] = load(&self.direction[axis]);
        }
        rays.tnear = Lanes::splat(0.0);
        rays.tfar = load(&self.tfar);
        rays.time = load(&self.time);
    }

    /// What a connection contributes, and the path it is of.
    #[inline(always)]
    pub fn contribution(&self, at: usize) -> (Spectrum, u32) {
        let c = &self.contribution;
        (Spectrum([c[0][at], c[1][at], c[2][at], c[3][at]]), self.path[at])
    }
}
