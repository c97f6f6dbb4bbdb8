//! Queues of walks and of connections: a cache line each, which sixteen at a time become columns in registers.
//!
//! Lines let walks be taken in any order at no cost, and they are taken sorted by direction: rays that go the same way
//! visit the same parts of the scene.

use lichtweg_montecarlo::{Sampler, SamplerKind, SamplerState};
use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Mask, Row, Wide, Word, WordLanes};
use lichtweg_ray::{Ray, RayPacket};

use super::super::counting_sort::CountingSort;
use super::super::packets::rows_of;
use super::super::path::{Connection, Departure, Walk};
use super::draws::Draws;
use super::{lanes_of, lanes_of_vector};
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

/// Rows in a queue, and the order in which they are taken.
#[derive(Debug)]
struct Rows {
    len: usize,
    rows: Box<[Row]>,
    /// See [`bucket`].
    buckets: Box<[u8]>,
    sorted: CountingSort,
}

impl Rows {
    fn new() -> Self {
        let rows = vec![Row::splat(0.0); CAPACITY].into_boxed_slice();
        Self { len: 0, rows, buckets: table(), sorted: CountingSort::default() }
    }

    fn clear(&mut self) {
        self.len = 0;
    }

    #[inline(always)]
    fn push(&mut self, row: &Row, bucket: u8) {
        self.rows[self.len] = *row;
        self.buckets[self.len] = bucket;
        self.len += 1;
    }

    /// Appends the lanes whose mask is true.
    #[inline(always)]
    fn append<W: Wide>(&mut self, columns: [W::F32; LANES], direction: Vector<W::F32>, mask: W::Mask) {
        let rows = W::F32::rows(columns);
        let buckets = bucket(direction).to_lanes();
        for lane in lanes_of(mask.bits()) {
            self.push(&rows[lane], buckets.0[lane] as u8);
        }
    }

    /// As they came.
    fn keep_order(&mut self) {
        self.sorted.sort(1, std::iter::repeat_n(0, self.len));
    }

    /// By direction.
    fn sort(&mut self) {
        self.sorted.sort(BUCKETS, self.buckets[..self.len].iter().map(|&bucket| bucket.into()));
    }

    #[inline(always)]
    fn get(&self, at: usize) -> &Row {
        &self.rows[self.sorted.order()[at] as usize]
    }

    /// The columns of sixteen from one on; what is behind the end is of no meaning.
    #[inline(always)]
    fn columns<F: FloatLanes>(&self, at: usize) -> [F; LANES] {
        F::columns(&rows_of(&self.sorted.order()[at..], |i| &self.rows[i]))
    }
}

/// Walks on their way to their next vertices.
///
/// A row: origin, direction, throughput, position and density of the departure, path, next dimension.
#[derive(Debug)]
pub(super) struct WalkQueue(Rows);

/// A walk as its row has it; or as many as `F` has lanes.
#[derive(Clone, Copy)]
pub(super) struct WalkLanes<F: Float> {
    pub origin: Vector<F>,
    pub direction: Vector<F>,
    pub throughput: Spectra<F>,
    pub departure: Vector<F>,
    pub departure_pdf: F,
    pub path: F::Bits,
    pub dimension: F::Bits,
}

impl<F: Float> WalkLanes<F> {
    /// From the columns of rows.
    #[inline(always)]
    fn new(c: &[F; LANES]) -> Self {
        Self {
            origin: Vector::new(c[0], c[1], c[2]),
            direction: Vector::new(c[3], c[4], c[5]),
            throughput: Spectra([c[6], c[7], c[8], c[9]]),
            departure: Vector::new(c[10], c[11], c[12]),
            departure_pdf: c[13],
            path: c[14].bits(),
            dimension: c[15].bits(),
        }
    }

    #[inline(always)]
    fn columns(&self) -> [F; LANES] {
        let (o, d, from) = (self.origin, self.direction, self.departure);
        let ([r, g, b, c], pdf) = (self.throughput.0, self.departure_pdf);
        let (path, dimension) = (self.path.as_float(), self.dimension.as_float());
        [o.x, o.y, o.z, d.x, d.y, d.z, r, g, b, c, from.x, from.y, from.z, pdf, path, dimension]
    }
}

impl<F: FloatLanes> WalkLanes<F> {
    /// The rays, without ends.
    #[inline(always)]
    pub fn rays(&self, paths: &Paths, rays: &mut RayPacket) {
        rays.origin = lanes_of_vector(self.origin);
        rays.direction = lanes_of_vector(self.direction);
        rays.tnear = Lanes::splat(0.0);
        rays.tfar = Lanes::splat(f32::INFINITY);
        if paths.timed {
            rays.time = F::gather(&paths.time, self.path).to_lanes();
        }
    }
}

impl WalkQueue {
    pub fn new() -> Self {
        Self(Rows::new())
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.0.len
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Appends a walk, whose path is known to `paths`.
    #[inline]
    pub fn push(&mut self, walk: &Walk, path: u32) {
        let lanes = WalkLanes {
            origin: walk.ray.origin,
            direction: walk.ray.direction,
            throughput: walk.throughput,
            departure: walk.departure.position,
            departure_pdf: walk.departure.pdf.unwrap_or(NO_PDF),
            path,
            dimension: walk.sampler.dimension(),
        };
        self.0.push(&Lanes(lanes.columns()), bucket(lanes.direction) as u8);
    }

    /// Appends the lanes whose mask is true.
    #[inline(always)]
    pub fn append<W: Wide>(&mut self, walks: &WalkLanes<W::F32>, mask: W::Mask) {
        self.0.append::<W>(walks.columns(), walks.direction, mask);
    }

    /// Takes the walks as they came.
    pub fn keep_order(&mut self) {
        self.0.keep_order();
    }

    /// Takes the walks by direction.
    pub fn sort(&mut self) {
        self.0.sort();
    }

    /// A walk, and which path it is of.
    #[inline]
    pub fn get(&self, at: usize, paths: &Paths) -> (Walk, u32) {
        let lanes = WalkLanes::new(&self.0.get(at).0);
        let i = lanes.path as usize;
        let key = u64::from(paths.key[1][i]) << 32 | u64::from(paths.key[0][i]);
        let state = SamplerState { key, index: paths.index[i], dimension: lanes.dimension };
        let pdf = lanes.departure_pdf;
        let walk = Walk {
            ray: Ray::new(lanes.origin, lanes.direction).at_time(paths.time[i]),
            throughput: lanes.throughput,
            eta: paths.eta[i],
            departure: Departure {
                position: lanes.departure,
                normal: paths.normal[i],
                pdf: (pdf != NO_PDF).then_some(pdf),
            },
            sampler: Sampler::from_state(paths.kind, state),
        };
        (walk, lanes.path)
    }

    /// Which path a walk is of.
    #[inline(always)]
    pub fn path(&self, at: usize) -> usize {
        WalkLanes::new(&self.0.get(at).0).path as usize
    }

    /// Sixteen walks from one on; what is behind the end is of no meaning.
    #[inline(always)]
    pub fn lanes<F: FloatLanes>(&self, at: usize) -> WalkLanes<F> {
        WalkLanes::new(&self.0.columns(at))
    }
}

/// Connections whose visibility is not known yet.
///
/// A row: origin, direction, end, contribution, path.
#[derive(Debug)]
pub(super) struct ConnectionQueue(Rows);

/// A connection as its row has it; or as many as `F` has lanes.
#[derive(Clone, Copy)]
pub(super) struct ConnectionLanes<F: Float> {
    pub origin: Vector<F>,
    pub direction: Vector<F>,
    pub tfar: F,
    pub contribution: Spectra<F>,
    pub path: F::Bits,
}

impl<F: Float> ConnectionLanes<F> {
    /// From the columns of rows.
    #[inline(always)]
    fn new(c: &[F; LANES]) -> Self {
        Self {
            origin: Vector::new(c[0], c[1], c[2]),
            direction: Vector::new(c[3], c[4], c[5]),
            tfar: c[6],
            contribution: Spectra([c[7], c[8], c[9], c[10]]),
            path: c[11].bits(),
        }
    }

    #[inline(always)]
    fn columns(&self) -> [F; LANES] {
        let (o, d, [r, g, b, c], path) =
            (self.origin, self.direction, self.contribution.0, self.path.as_float());
        [o.x, o.y, o.z, d.x, d.y, d.z, self.tfar, r, g, b, c, path, path, path, path, path]
    }
}

impl ConnectionQueue {
    pub fn new() -> Self {
        Self(Rows::new())
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.0.len
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Appends a connection of a path.
    #[inline]
    pub fn push(&mut self, connection: &Connection, path: u32) {
        let Connection { ray, contribution } = *connection;
        let (origin, direction, tfar) = (ray.origin, ray.direction, ray.tfar);
        let lanes = ConnectionLanes { origin, direction, tfar, contribution, path };
        self.0.push(&Lanes(lanes.columns()), bucket(direction) as u8);
    }

    /// Appends the lanes whose mask is true.
    #[inline(always)]
    pub fn append<W: Wide>(&mut self, connections: &ConnectionLanes<W::F32>, mask: W::Mask) {
        self.0.append::<W>(connections.columns(), connections.direction, mask);
    }

    /// Takes the connections by direction.
    pub fn sort(&mut self) {
        self.0.sort();
    }

    /// The rays of sixteen connections from one on.
    #[inline(always)]
    pub fn rays<F: FloatLanes>(&self, at: usize, paths: &Paths, rays: &mut RayPacket) {
        let lanes = ConnectionLanes::new(&self.0.columns::<F>(at));
        rays.origin = lanes_of_vector(lanes.origin);
        rays.direction = lanes_of_vector(lanes.direction);
        rays.tnear = Lanes::splat(0.0);
        rays.tfar = lanes.tfar.to_lanes();
        if paths.timed {
            rays.time = F::gather(&paths.time, lanes.path).to_lanes();
        }
    }

    /// What a connection contributes, and the path it is of.
    #[inline(always)]
    pub fn contribution(&self, at: usize) -> (Spectrum, usize) {
        let lanes = ConnectionLanes::new(&self.0.get(at).0);
        (lanes.contribution, lanes.path as usize)
    }
}
