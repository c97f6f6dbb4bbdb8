//! Shadow rays: whether two vertices see each other, and paths that wait for the answer.

use lichtweg_ray::Ray;
use lichtweg_ray::math::Vec3;

use super::light_end::LightEnd;
use super::packets::{self, Order};
use crate::color::Spectrum;
use crate::light::LightSample;
use crate::scene::{RayCounts, Scene, SurfacePoint};

/// Part of a shadow ray's length left out at its end, where its target itself is.
pub const SHADOW_END: f32 = 1e-5;

/// The ray between two surface points, `direction` from the first to the second.
#[inline]
pub fn between(from: &SurfacePoint, to: &SurfacePoint, direction: Vec3, time: f32) -> Ray {
    let origin = from.leave(direction);
    Ray { tfar: 1.0 - SHADOW_END, time, ..Ray::new(origin, to.leave(-direction) - origin) }
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
    /// That a vertex was connected to, by its number in the queue.
    Chosen(u32),
}

/// Paths whose visibility is not known yet.
#[derive(Debug, Default)]
pub struct ShadowQueue {
    rays: Vec<Ray>,
    candidates: Vec<Candidate>,
    chosen: Vec<LightEnd>,
    transmittance: Vec<f32>,
    order: Order,
}

impl ShadowQueue {
    /// Number of paths.
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Appends a path.
    #[inline]
    pub fn push(&mut self, ray: Ray, candidate: Candidate) {
        self.rays.push(ray);
        self.candidates.push(candidate);
    }

    /// Keeps a point on a light.
    #[inline]
    pub fn choose(&mut self, end: LightEnd) -> End {
        self.chosen.push(end);
        End::Chosen(self.chosen.len() as u32 - 1)
    }

    /// Forgets all paths.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.candidates.clear();
        self.chosen.clear();
    }

    /// Looks.
    pub fn trace(&mut self, scene: &Scene, counts: &mut RayCounts) {
        packets::transmittance(scene, &self.rays, &mut self.order, counts, &mut self.transmittance);
    }

    /// The paths through which light passes, and how much: in the order in which they came.
    pub fn visible(&self) -> impl Iterator<Item = (&Candidate, f32)> {
        self.candidates.iter().zip(self.transmittance.iter().copied()).filter(|(_, visible)| *visible > 0.0)
    }

    /// A point on a light that was kept.
    pub fn chosen(&self, number: u32) -> &LightEnd {
        &self.chosen[number as usize]
    }
}
