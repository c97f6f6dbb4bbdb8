//! Shadow rays: whether two vertices see each other, and paths that wait for the answer.

use lichtweg_ray::Ray;
use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Mask, Row};

use super::light_end::LightEnd;
use super::packets::{self, Order, RAY, RayLanes};
use crate::color::Spectrum;
use crate::lanes::lanes_of;
use crate::light::LightSample;
use crate::scene::offset::offset;
use crate::scene::{RayCounts, Scene, SurfacePoint};

/// Part of a shadow ray's length left out at its end, where its target itself is.
pub const SHADOW_END: f32 = 1e-5;

/// A point as shadow rays need it, or as many as `F` has lanes.
#[derive(Clone, Copy)]
pub struct ShadowPoint<F> {
    pub position: Vector<F>,
    /// See [`SurfacePoint::error`].
    pub error: F,
    pub geometric_normal: Vector<F>,
}

impl<F: Float> ShadowPoint<F> {
    /// See [`SurfacePoint::leave`].
    #[inline(always)]
    pub fn leave(&self, direction: Vector<F>) -> Vector<F> {
        offset(self.position, self.error, self.geometric_normal, direction)
    }

    /// Origin and direction of the ray to another point, as far as it.
    #[inline(always)]
    pub fn toward(&self, to: &Self) -> [Vector<F>; 2] {
        let direction = (to.position - self.position).normalized();
        let origin = self.leave(direction);
        [origin, to.leave(-direction) - origin]
    }
}

impl From<&SurfacePoint> for ShadowPoint<f32> {
    fn from(point: &SurfacePoint) -> Self {
        let SurfacePoint { position, error, geometric_normal, .. } = *point;
        Self { position, error, geometric_normal }
    }
}

/// The ray from a surface point to a light.
#[inline]
pub fn to_light(point: &SurfacePoint, sample: &LightSample, time: f32) -> Ray {
    let origin = point.leave(sample.direction);
    let ray = match sample.target {
        Some(target) => Ray { tfar: 1.0 - SHADOW_END, ..Ray::new(origin, target - origin) },
        None => Ray::new(origin, sample.direction),
    };
    Ray { time, ..ray }
}

/// A path that contributes where nothing is in the way.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Number of the sample.
    pub sample: u32,
    /// See [`Contribution`](super::Contribution).
    pub s: u32,
    /// See [`Contribution`](super::Contribution).
    pub t: u32,
    /// See [`Contribution`](super::Contribution).
    pub film: Option<[f32; 2]>,
    /// Value over density, were it visible.
    pub value: Spectrum,
    /// Its weight among the strategies.
    pub weight: f32,
    /// Where it leads along, by its number in the queue.
    pub way: Option<u32>,
}

/// Where a path leads along.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// The point on the lens.
    pub lens: Vec3,
    /// The point on the light.
    pub end: End,
    /// Last vertex of the walk from the light, as [`Trail`](super::Trail) knows it.
    pub light: u32,
    /// Last vertex of the walk from the eye.
    pub eye: u32,
}

/// The point on a light.
#[derive(Clone, Copy, Debug)]
pub enum End {
    /// Where a walk began.
    Start(u32),
    /// That a vertex was connected to.
    Chosen(LightEnd),
}

/// Where paths lead along, if anybody asks.
#[derive(Debug, Default)]
pub struct Ways(Vec<Way>);

impl Ways {
    /// Keeps one, and says its number.
    #[inline]
    pub fn keep(&mut self, way: Way) -> u32 {
        self.0.push(way);
        self.0.len() as u32 - 1
    }
}

/// Paths whose visibility is not known yet.
#[derive(Debug, Default)]
pub struct ShadowQueue {
    rays: Vec<Row>,
    candidates: Vec<Candidate>,
    ways: Ways,
    transmittance: Vec<f32>,
    order: Order,
}

impl ShadowQueue {
    /// Appends a path.
    #[inline]
    pub fn push(&mut self, ray: Ray, candidate: Candidate) {
        self.rays.push(Lanes(RayLanes::from(ray).columns([0.0; LANES - RAY])));
        self.candidates.push(candidate);
    }

    /// Appends the paths of the lanes whose mask is true.
    #[inline(always)]
    pub fn append<F: FloatLanes>(
        &mut self,
        rays: &RayLanes<F>,
        mask: F::Mask,
        mut candidate: impl FnMut(&mut Ways, usize) -> Candidate,
    ) {
        let rows = F::rows(rays.columns([F::splat(0.0); LANES - RAY]));
        for lane in lanes_of(mask.bits()) {
            self.rays.push(rows[lane]);
            self.candidates.push(candidate(&mut self.ways, lane));
        }
    }

    /// Keeps where a path leads along.
    #[inline]
    pub fn keep(&mut self, way: Way) -> u32 {
        self.ways.keep(way)
    }

    /// Forgets all paths.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.candidates.clear();
        self.ways.0.clear();
    }

    /// Looks.
    pub fn trace(&mut self, scene: &Scene, counts: &mut RayCounts) {
        packets::transmittance(scene, &self.rays, &mut self.order, counts, &mut self.transmittance);
    }

    /// The paths through which light passes, and how much: in the order in which they came.
    pub fn visible(&self) -> impl Iterator<Item = (&Candidate, f32)> {
        self.candidates.iter().zip(self.transmittance.iter().copied()).filter(|(_, visible)| *visible > 0.0)
    }

    /// Where a path leads along.
    pub fn way(&self, candidate: &Candidate) -> Option<&Way> {
        Some(&self.ways.0[candidate.way? as usize])
    }
}
