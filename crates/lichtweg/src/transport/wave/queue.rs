//! Queues of walks and of connections: a cache line each, which sixteen at a time become columns in registers.
//!
//! Lines let walks be taken in any order at no cost, and they are taken sorted by direction: rays that go the same way
//! visit the same parts of the scene.

use lichtweg_montecarlo::{Sampler, SamplerKind, SamplerState};
use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Mask, Row, Wide, Word, WordLanes};
use lichtweg_ray::{Ray, RayPacket};

use super::super::path::{Connection, Departure, Walk};
use super::draws::Draws;
use super::lanes_of;
use crate::color::{Spectra, Spectrum};

/// Walks in a queue, at most. More are sorted better, fewer stay in the cache.
pub const CAPACITY: usize = 2048;

/// In place of a density that does not exist.
pub const NO_PDF: f32 = -1.0;

/// What stays the same along a path, or changes seldom; a table a quantity, by the path's number.
#[derive(Debug)]
pub(super) struct Paths {
    kind: SamplerKind,
    /// Lower and upper halves of the samplers' keys.
    pub key: [Box<[u32]>; 2],
    pub index: Box<[u32]>,
    pub eta: Box<[f32]>,
    /// Of the latest departure, where the choice of lights asks for it.
    pub normal: Box<[Vec3]>,
    pub time: Box<[f32]>,
    /// Whether times are not all zero, and matter.
    pub timed: bool,
}

fn table<T: Copy + Default>() -> Box<[T]> {
    vec![T::default(); CAPACITY].into_boxed_slice()
}

impl Paths {
    pub fn new(kind: SamplerKind) -> Self {
        Self {
            kind,
            key: [table(), table()],
            index: table(),
            eta: table(),
            normal: vec![Vec3::ZERO; CAPACITY].into_boxed_slice(),
            time: table(),
            timed: false,
        }
    }

    pub fn kind(&self) -> SamplerKind {
        self.kind
    }

    pub fn set(&mut self, path: u32, walk: &Walk) {
        let (at, state) = (path as usize, walk.sampler.state());
        (self.key[0][at], self.key[1][at]) = (state.key as u32, (state.key >> 32) as u32);
        self.index[at] = state.index;
        self.eta[at] = walk.eta;
        self.normal[at] = walk.departure.normal;
        self.time[at] = walk.ray.time;
        self.timed |= walk.ray.time != 0.0;
    }
}

impl Paths {
    /// Sets sixteen paths whose times are 0, from one on; what is behind the end is of no meaning.
    #[inline(always)]
    pub fn set_lanes<W: Wide>(&mut self, first: usize, draws: &Draws<W>) {
        let range = first..first + LANES;
        self.key[0][range.clone()].copy_from_slice(&draws.key[0].to_lanes().0);
        self.key[1][range.clone()].copy_from_slice(&draws.key[1].to_lanes().0);
        self.index[range.clone()].copy_from_slice(&draws.index.to_lanes().0);
        self.eta[range.clone()].fill(1.0);
        self.time[range.clone()].fill(0.0);
        self.normal[range].fill(Vec3::ZERO);
    }
}

/// Directions are sorted by their largest component and all their signs.
pub const BUCKETS: usize = 24;

#[inline(always)]
pub fn bucket<F: Float>(d: Vector<F>) -> F::Bits {
    let number = F::Bits::splat;
    let (zero, nothing) = (F::splat(0.0), number(0));
    let [x, y, z] = [d.x.abs(), d.y.abs(), d.z.abs()];
    let axis = number(16).select(x.max(y).lt(z), number(8).select(x.lt(y), nothing));
    let sign = |c: F, bit| number(bit).select(c.lt(zero), nothing);
    axis + sign(d.x, 1) + sign(d.y, 2) + sign(d.z, 4)
}

/// Walks on their way to their next vertices.
///
/// A row: origin, direction, throughput, position and density of the departure, path, next dimension.
#[derive(Debug)]
pub(super) struct WalkQueue {
    len: usize,
    rows: Box<[Row]>,
    bucket: Box<[u8]>,
    /// Walks in each bucket.
    counts: [u16; BUCKETS],
    order: Box<[u16]>,
}

/// Sixteen walks in registers.
#[derive(Clone, Copy)]
pub(super) struct WalkLanes<W: Wide> {
    pub origin: Vector<W::F32>,
    pub direction: Vector<W::F32>,
    pub throughput: Spectra<W::F32>,
    pub departure: Vector<W::F32>,
    pub departure_pdf: W::F32,
    pub path: W::U32,
    pub dimension: W::U32,
}

impl<W: Wide> WalkLanes<W> {
    /// The rays, without ends.
    #[inline(always)]
    pub fn rays(&self, paths: &Paths, rays: &mut RayPacket) {
        let (o, d) = (self.origin, self.direction);
        rays.origin = [o.x.to_lanes(), o.y.to_lanes(), o.z.to_lanes()];
        rays.direction = [d.x.to_lanes(), d.y.to_lanes(), d.z.to_lanes()];
        rays.tnear = Lanes::splat(0.0);
        rays.tfar = Lanes::splat(f32::INFINITY);
        if paths.timed {
            rays.time = W::F32::gather(&paths.time, self.path).to_lanes();
        }
    }
}

impl WalkQueue {
    pub fn new() -> Self {
        Self {
            len: 0,
            rows: vec![Row::splat(0.0); CAPACITY].into_boxed_slice(),
            bucket: table(),
            counts: [0; BUCKETS],
            order: table(),
        }
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    pub fn clear(&mut self) {
        self.len = 0;
        self.counts = [0; BUCKETS];
    }

    #[inline(always)]
    fn push_row(&mut self, row: &Row, bucket: u8) {
        self.rows[self.len] = *row;
        self.bucket[self.len] = bucket;
        self.counts[usize::from(bucket)] += 1;
        self.len += 1;
    }

    /// Appends a walk, whose path is known to `paths`.
    #[inline]
    pub fn push(&mut self, walk: &Walk, path: u32) {
        let (o, d, t) = (walk.ray.origin, walk.ray.direction, walk.throughput.0);
        let from = walk.departure.position;
        let row = Lanes([
            o.x,
            o.y,
            o.z,
            d.x,
            d.y,
            d.z,
            t[0],
            t[1],
            t[2],
            t[3],
            from.x,
            from.y,
            from.z,
            walk.departure.pdf.unwrap_or(NO_PDF),
            f32::from_bits(path),
            f32::from_bits(walk.sampler.dimension()),
        ]);
        self.push_row(&row, bucket(d) as u8);
    }

    /// Appends the lanes whose mask is true.
    #[inline(always)]
    pub fn append<W: Wide>(&mut self, w: &WalkLanes<W>, mask: W::Mask) {
        let (o, d, from, t) = (w.origin, w.direction, w.departure, w.throughput.0);
        let rows = W::F32::rows([
            o.x,
            o.y,
            o.z,
            d.x,
            d.y,
            d.z,
            t[0],
            t[1],
            t[2],
            t[3],
            from.x,
            from.y,
            from.z,
            w.departure_pdf,
            w.path.as_float(),
            w.dimension.as_float(),
        ]);
        let buckets = bucket(d).to_lanes();
        for lane in lanes_of(mask.bits()) {
            self.push_row(&rows[lane], buckets.0[lane] as u8);
        }
    }

    /// Takes the walks as they came.
    pub fn keep_order(&mut self) {
        (0..self.len).for_each(|i| self.order[i] = i as u16);
    }

    /// Takes the walks by direction.
    pub fn sort(&mut self) {
        let mut start = [0; BUCKETS];
        let mut next = 0;
        for (start, count) in start.iter_mut().zip(self.counts) {
            *start = next;
            next += count;
        }
        for (i, &bucket) in self.bucket[..self.len].iter().enumerate() {
            let to = &mut start[usize::from(bucket)];
            self.order[usize::from(*to)] = i as u16;
            *to += 1;
        }
    }

    #[inline(always)]
    fn row(&self, at: usize) -> &Row {
        &self.rows[usize::from(self.order[at])]
    }

    /// A walk, and which path it is of.
    #[inline]
    pub fn get(&self, at: usize, paths: &Paths) -> (Walk, u32) {
        let r = &self.row(at).0;
        let vector = |i: usize| Vec3::new(r[i], r[i + 1], r[i + 2]);
        let path = r[14].to_bits();
        let i = path as usize;
        let key = u64::from(paths.key[1][i]) << 32 | u64::from(paths.key[0][i]);
        let state = SamplerState { key, index: paths.index[i], dimension: r[15].to_bits() };
        let walk = Walk {
            ray: Ray::new(vector(0), vector(3)).at_time(paths.time[i]),
            throughput: Spectra([r[6], r[7], r[8], r[9]]),
            eta: paths.eta[i],
            departure: Departure {
                position: vector(10),
                normal: paths.normal[i],
                pdf: (r[13] != NO_PDF).then_some(r[13]),
            },
            sampler: Sampler::from_state(paths.kind, state),
        };
        (walk, path)
    }

    /// Which path a walk is of.
    #[inline(always)]
    pub fn path(&self, at: usize) -> usize {
        self.row(at).0[14].to_bits() as usize
    }

    /// Sixteen walks from one on; what is behind the end is of no meaning.
    #[inline(always)]
    pub fn lanes<W: Wide>(&self, at: usize) -> WalkLanes<W> {
        let mut rows = [&self.rows[0]; LANES];
        for (lane, row) in rows.iter_mut().enumerate().take(self.len - at) {
            *row = self.row(at + lane);
        }
        let [ox, oy, oz, dx, dy, dz, t0, t1, t2, t3, x, y, z, departure_pdf, path, dimension] =
            W::F32::columns(&rows);
        WalkLanes {
            origin: Vector::new(ox, oy, oz),
            direction: Vector::new(dx, dy, dz),
            throughput: Spectra([t0, t1, t2, t3]),
            departure: Vector::new(x, y, z),
            departure_pdf,
            path: path.bits(),
            dimension: dimension.bits(),
        }
    }
}

/// Connections whose visibility is not known yet.
///
/// A row: origin, direction, end, contribution, path.
#[derive(Debug)]
pub(super) struct ConnectionQueue {
    len: usize,
    rows: Box<[Row]>,
}

/// Sixteen connections in registers.
#[derive(Clone, Copy)]
pub(super) struct ConnectionLanes<W: Wide> {
    pub origin: Vector<W::F32>,
    pub direction: Vector<W::F32>,
    pub tfar: W::F32,
    pub contribution: Spectra<W::F32>,
    pub path: W::U32,
}

impl ConnectionQueue {
    pub fn new() -> Self {
        Self { len: 0, rows: vec![Row::splat(0.0); CAPACITY].into_boxed_slice() }
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
        let (o, d, c) = (connection.ray.origin, connection.ray.direction, connection.contribution.0);
        let tfar = connection.ray.tfar;
        let path = f32::from_bits(path);
        self.rows[self.len].0[..12]
            .copy_from_slice(&[o.x, o.y, o.z, d.x, d.y, d.z, tfar, c[0], c[1], c[2], c[3], path]);
        self.len += 1;
    }

    /// Appends the lanes whose mask is true.
    #[inline(always)]
    pub fn append<W: Wide>(&mut self, w: &ConnectionLanes<W>, mask: W::Mask) {
        let (o, d, c, path) = (w.origin, w.direction, w.contribution.0, w.path.as_float());
        let rows = W::F32::rows([
            o.x, o.y, o.z, d.x, d.y, d.z, w.tfar, c[0], c[1], c[2], c[3], path, path, path, path, path,
        ]);
        for lane in lanes_of(mask.bits()) {
            self.rows[self.len] = rows[lane];
            self.len += 1;
        }
    }

    /// The rays of sixteen connections from one on.
    #[inline(always)]
    pub fn rays<W: Wide>(&self, at: usize, paths: &Paths, rays: &mut RayPacket) {
        let mut rows = [&self.rows[0]; LANES];
        for (row, here) in rows.iter_mut().zip(&self.rows[at..self.len]) {
            *row = here;
        }
        let [ox, oy, oz, dx, dy, dz, tfar, _, _, _, _, path, ..] = W::F32::columns(&rows);
        rays.origin = [ox.to_lanes(), oy.to_lanes(), oz.to_lanes()];
        rays.direction = [dx.to_lanes(), dy.to_lanes(), dz.to_lanes()];
        rays.tnear = Lanes::splat(0.0);
        rays.tfar = tfar.to_lanes();
        if paths.timed {
            rays.time = W::F32::gather(&paths.time, path.bits()).to_lanes();
        }
    }

    /// What a connection contributes, and the path it is of.
    #[inline(always)]
    pub fn contribution(&self, at: usize) -> (Spectrum, usize) {
        let r = &self.rows[at].0;
        (Spectra([r[7], r[8], r[9], r[10]]), r[11].to_bits() as usize)
    }
}
