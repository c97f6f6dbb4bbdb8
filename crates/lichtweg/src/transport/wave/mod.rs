//! Path tracing, many walks at a time.
//!
//! A *wave* of walks goes from vertex to vertex together: all rays of one depth are traced as packets, then all vertices
//! are dealt with, sixteen neighbours at a time, then all their connections are traced. Vertices on the commonest
//! surfaces run in registers of sixteen lanes ([`scatter`]); all others are handed, one by one, to
//! [`PathTracer::arrive`]. Walks that end leave no gap, since those that go on move together into the next queue
//! (compare Laine, Karras and Aila, *Megakernels considered harmful*, HPG 2013).
//!
//! A walk's arithmetic and random numbers are those of [`PathTracer::radiance`]: both give the same radiance to the bit,
//! whatever else is in the wave.

mod draws;
mod emission;
pub(super) mod lights;
mod lobes;
pub(super) mod points;
pub(super) mod queue;
mod scatter;

use lichtweg_montecarlo::{Sampler, SamplerKind};
use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::{self, Float, FloatLanes, Kernel, LANES, Lanes, Mask, Wide, Word, WordLanes};
use lichtweg_ray::{HitPacket, Ray, RayPacket};

use super::path::Walk;
use super::{PathObserver, PathTracer, WalkCounts};
use crate::camera::CameraRays;
use crate::color::{Spectra, Spectrum};
use crate::lanes::{lanes_of, lanes_of_vector, vec3};
use crate::scene::Scene;
pub(crate) use draws::Draws;
use queue::{CAPACITY, ConnectionQueue, Paths, WalkLanes, WalkQueue};

/// Walks that go together, and what they bring. Made once a thread and used again.
#[derive(Debug)]
pub struct Wave {
    paths: Paths,
    walks: WalkQueue,
    /// Walks on their way to the vertices after these.
    next: WalkQueue,
    connections: ConnectionQueue,
    /// What the camera rays see only from, and only up to.
    clip: [Vec<f32>; 2],
    /// What sixteen walks each have hit, and which of them bring anything.
    hits: Vec<(HitPacket, u32)>,
    radiance: Vec<Spectrum>,
}

impl Wave {
    /// Walks in a wave, at most.
    pub const CAPACITY: usize = CAPACITY;

    /// An empty wave of walks with random numbers of a kind.
    pub fn new(kind: SamplerKind) -> Self {
        Self {
            paths: Paths::new(kind),
            walks: WalkQueue::new(),
            next: WalkQueue::new(),
            connections: ConnectionQueue::new(),
            clip: [const { Vec::new() }; 2],
            hits: Vec::new(),
            radiance: Vec::new(),
        }
    }

    /// Forgets all walks and their radiance.
    pub fn clear(&mut self) {
        self.walks.clear();
        self.paths.timed = false;
        self.clip.iter_mut().for_each(Vec::clear);
        self.radiance.clear();
    }

    /// Adds a walk along a camera ray of unit direction; its path has the number of walks that were there before. Panics
    /// where the wave is full.
    pub fn push(&mut self, ray: &Ray, sampler: Sampler) {
        debug_assert_eq!(sampler.kind(), self.paths.kind());
        let path = self.radiance.len() as u32;
        let walk = Walk::new(*ray, sampler);
        self.paths.set(path, &walk);
        self.walks.push(&walk, path);
        self.clip[0].push(ray.tnear);
        self.clip[1].push(ray.tfar);
        self.radiance.push(Spectrum::ZERO);
    }

    /// Adds `count` walks of time 0, of at most sixteen, to a wave of a multiple of sixteen walks.
    #[inline(always)]
    pub(crate) fn push_lanes<W: Wide>(&mut self, rays: &CameraRays<W::F32>, draws: &Draws<W>, count: usize) {
        let first = self.radiance.len();
        debug_assert!(first.is_multiple_of(LANES) && draws.kind == self.paths.kind());
        self.paths.set_lanes::<W>(first, draws);
        let one = W::F32::splat(1.0);
        let walks = WalkLanes {
            origin: rays.origin,
            direction: rays.direction,
            throughput: Spectra([one; 4]),
            departure: rays.origin,
            departure_pdf: W::F32::splat(queue::NO_PDF),
            path: W::U32::splat(first as u32) + W::U32::load(&Lanes(NUMBERS)),
            dimension: draws.dimension,
        };
        self.walks.append::<W>(&walks, W::Mask::from_bits(lanes_from(0, count)));
        self.clip[0].extend_from_slice(&rays.tnear.to_lanes().0[..count]);
        self.clip[1].extend_from_slice(&rays.tfar.to_lanes().0[..count]);
        self.radiance.resize(first + count, Spectrum::ZERO);
    }

    /// Walks that were added.
    pub fn len(&self) -> usize {
        self.radiance.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.radiance.is_empty()
    }

    /// Of each path, the radiance found by [`PathTracer::follow`].
    pub fn radiance(&self) -> &[Spectrum] {
        &self.radiance
    }
}

impl PathTracer {
    /// Follows all walks of a wave to their ends, and adds up their radiance.
    pub fn follow(
        &self,
        scene: &Scene,
        wave: &mut Wave,
        counts: &mut WalkCounts,
        observer: &mut impl PathObserver,
    ) {
        wave.paths.timed &= scene.has_instances();
        wave.walks.keep_order();
        for depth in 1..=self.max_depth() {
            if wave.walks.len() == 0 {
                break;
            }
            wide::dispatch(Step { tracer: self, scene, wave, counts, observer, depth });
            std::mem::swap(&mut wave.walks, &mut wave.next);
            wave.walks.sort();
        }
        wave.walks.clear();
    }
}

/// One edge of every walk.
struct Step<'a, O> {
    tracer: &'a PathTracer,
    scene: &'a Scene,
    wave: &'a mut Wave,
    counts: &'a mut WalkCounts,
    observer: &'a mut O,
    depth: u32,
}

/// The lanes of a group that starts at `at` among `len`.
#[inline(always)]
fn lanes_from(at: usize, len: usize) -> u32 {
    (1 << (len - at).min(LANES)) - 1
}

/// The numbers of the lanes.
const NUMBERS: [u32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

#[inline(always)]
fn load_vector<W: Wide>(v: &[Lanes<f32>; 3]) -> Vector<W::F32> {
    Vector::new(W::F32::load(&v[0]), W::F32::load(&v[1]), W::F32::load(&v[2]))
}

#[inline(always)]
fn set_vector(to: &mut [Lanes<f32>; 3], lane: usize, v: Vec3) {
    (to[0].0[lane], to[1].0[lane], to[2].0[lane]) = (v.x, v.y, v.z);
}

impl<O: PathObserver> Kernel for Step<'_, O> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(mut self) {
        self.wave.next.clear();
        self.wave.connections.clear();
        let walks = self.wave.walks.len();
        self.counts.edges += walks as u64;
        self.trace::<W>();
        let hits = std::mem::take(&mut self.wave.hits);
        for (at, (hits, active)) in (0..walks).step_by(LANES).zip(&hits) {
            if *active != 0 {
                let lanes = self.wave.walks.lanes(at);
                self.vertices::<W>(lanes, at, *active, hits);
            }
        }
        self.wave.hits = hits;
        self.connect::<W>();
    }
}

impl<O: PathObserver> Step<'_, O> {
    /// What the walks hit. All of them before any is dealt with, so that the code of one thing at a time is in the cache.
    #[inline(always)]
    fn trace<W: Wide>(&mut self) {
        let Wave { walks, paths, hits, clip, .. } = &mut *self.wave;
        let counts = &mut self.counts.rays;
        // Only light that it runs into makes a difference to a walk that ends.
        let last = self.depth >= self.tracer.max_depth();
        hits.clear();
        let mut rays = RayPacket::default();
        for at in (0..walks.len()).step_by(LANES) {
            walks.lanes::<W::F32>(at).rays(paths, &mut rays);
            let active = lanes_from(at, walks.len());
            if self.depth == 1 {
                for lane in lanes_of(active) {
                    let path = walks.path(at + lane);
                    (rays.tnear.0[lane], rays.tfar.0[lane]) = (clip[0][path], clip[1][path]);
                }
            }
            hits.push(if last {
                self.scene.light_packet(&rays, active, counts)
            } else {
                counts.closest += u64::from(active.count_ones());
                (self.scene.accel().closest_packet(&rays, active), active)
            });
        }
    }

    /// What sixteen walks do at their vertices.
    #[inline(always)]
    fn vertices<W: Wide>(&mut self, walks: WalkLanes<W::F32>, at: usize, active: u32, hits: &HitPacket) {
        let fast = if W::REGISTERS && !self.observer.watches(self.depth) {
            self.simple_vertices::<W>(walks, active, hits)
        } else {
            0
        };
        for lane in lanes_of(active & !fast) {
            self.vertex(at + lane, hits, lane);
        }
    }

    /// What one walk does at its vertex.
    fn vertex(&mut self, at: usize, hits: &HitPacket, lane: usize) {
        let Self { tracer, scene, wave, counts, observer, depth } = self;
        let (mut walk, path) = wave.walks.get(at, &wave.paths);
        if *depth == 1 {
            let [tnear, tfar] = &wave.clip;
            (walk.ray.tnear, walk.ray.tfar) = (tnear[path as usize], tfar[path as usize]);
        }
        let point = hits
            .get(lane)
            .and_then(|hit| scene.point(&walk.ray, &hit, &mut counts.rays, || walk.sampler.next_1d()));
        let arrival = tracer.arrive(scene, path, *depth, &mut walk, point.as_ref(), *observer);
        wave.radiance[path as usize] += arrival.emitted;
        if let Some(connection) = arrival.connection {
            wave.connections.push(&connection, path);
        }
        if arrival.goes_on {
            wave.paths.eta[path as usize] = walk.eta;
            wave.paths.normal[path as usize] = walk.departure.normal;
            wave.next.push(&walk, path);
        }
    }

    /// Adds what nothing is in the way of.
    #[inline(always)]
    fn connect<W: Wide>(&mut self) {
        let Self { scene, wave, counts, .. } = self;
        let count = wave.connections.len();
        wave.connections.sort();
        let mut rays = RayPacket::default();
        for at in (0..count).step_by(LANES) {
            wave.connections.rays::<W::F32>(at, &wave.paths, &mut rays);
            let active = lanes_from(at, count);
            if scene.has_holes() {
                for lane in lanes_of(active) {
                    let transmittance = scene.transmittance(&rays.get(lane), &mut counts.rays);
                    let (contribution, path) = wave.connections.contribution(at + lane);
                    wave.radiance[path] += contribution * transmittance;
                }
                continue;
            }
            counts.rays.occlusion += u64::from(active.count_ones());
            let occluded = scene.accel().occluded_packet(&rays, active);
            for lane in lanes_of(active & !occluded) {
                let (contribution, path) = wave.connections.contribution(at + lane);
                wave.radiance[path] += contribution;
            }
        }
    }
}
