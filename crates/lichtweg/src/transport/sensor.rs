//! The eye as an end of walks from the lights.

use lichtweg_ray::Ray;
use lichtweg_ray::math::{Vec3, Vector};
use lichtweg_ray::wide::Float;

use super::fault::{Fault, is_seeded};
use super::vertex::Departure;
use super::visibility::{SHADOW_END, ShadowPoint};
use crate::camera::{Camera, View};
use crate::color::Spectrum;
use crate::scene::SurfacePoint;

/// A camera, and how densely its film is sampled.
#[derive(Clone, Copy, Debug)]
pub struct Sensor<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// Density of the film points of eye samples, per film, for each of the walks that are made from the lights: what the
    /// measurement of a pixel needs, and what makes the densities of both kinds of walks comparable.
    pub film_pdf: f32,
    /// The part of the film that pixels to be rendered respond to: from and to, in film coordinates.
    pub reach: [[f32; 2]; 2],
    /// About the radiance that the film shows, if that is known.
    pub expectation: Option<&'a Expectation>,
}

/// About the radiance of each pixel of a window of the film.
#[derive(Clone, Debug)]
pub struct Expectation {
    /// Full film size.
    pub size: [u32; 2],
    /// x, y, width, height.
    pub window: [u32; 4],
    /// Row by row; the largest of all channels.
    pub radiance: Vec<f32>,
}

impl Expectation {
    /// That of the pixel that a place of the film in [0, 1]^2 belongs to, or of the next one.
    #[inline]
    pub fn at(&self, film: [f32; 2]) -> f32 {
        let [x0, y0, width, height] = self.window;
        let pixel = |i: usize, first: u32, count: u32| {
            ((film[i] * self.size[i] as f32) as u32).clamp(first, first + count - 1) - first
        };
        self.radiance[(pixel(1, y0, height) * width + pixel(0, x0, width)) as usize]
    }
}

/// A point on the lens that looks at something. Or as many as `F` has lanes.
#[derive(Clone, Copy, Debug)]
pub struct Look<F = f32> {
    /// The point on the lens.
    pub lens: Vector<F>,
    /// Unit direction to it.
    pub to_lens: Vector<F>,
    /// Where it is seen.
    pub film: [F; 2],
    /// Density per solid angle with which walks from the eye go from this point of the lens in this direction. It is the
    /// importance We cos over the density of the lens point, too.
    pub pdf: F,
    /// Cosine to the axis.
    pub cos: F,
    /// Distances between which the camera sees.
    clip: [F; 2],
}

impl<'a> Sensor<'a> {
    /// Takes `samples` of each pixel of a window from the eye and as many walks from the lights as eye samples.
    pub fn new(camera: &'a Camera, size: [u32; 2], window: [u32; 4], filter_radius: [f32; 2]) -> Self {
        let pixels = |i: usize| size[i] as f32;
        let walks = window[2] as f32 * window[3] as f32;
        let bound = |i: usize, at: u32, sign: f32| (at as f32 + sign * (filter_radius[i] + 0.5)) / pixels(i);
        let [x, y, width, height] = window;
        Self {
            camera,
            film_pdf: pixels(0) * pixels(1) / walks,
            reach: [
                [bound(0, x, -1.0), bound(1, y, -1.0)],
                [bound(0, x + width, 1.0), bound(1, y + height, 1.0)],
            ],
            expectation: None,
        }
    }

    /// The same, with what is known of the film.
    pub fn expecting(self, expectation: Option<&'a Expectation>) -> Self {
        Self { expectation, ..self }
    }

    /// About the radiance at a place of the film; 0 where nothing is known of it.
    #[inline]
    pub fn expected(&self, film: [f32; 2]) -> f32 {
        self.expectation.map_or(0.0, |e| e.at(film))
    }

    /// The same with the camera as it stands at some time.
    #[inline]
    pub fn with<'c>(&self, camera: &'c Camera) -> Sensor<'c>
    where
        'a: 'c,
    {
        Sensor { camera, ..*self }
    }

    /// A walk from the eye along a camera ray; `once` is c of the strategies in which the light finds the lens.
    pub fn depart(&self, ray: Ray, once: f32) -> Departure {
        let cos = ray.direction.dot(self.camera.forward());
        let view = self.camera.view(ray.origin, ray.direction);
        Departure {
            ray,
            position: ray.origin,
            // The film point is drawn as the pixel's filter asks, and the camera's response is normalised to it.
            throughput: Spectrum::ONE,
            pdf: view.map_or(0.0, |v| self.pdf(&v)),
            cos,
            infinite: false,
            link: once,
            // c of the strategy in which the light walks into the lens.
            chain: self.camera.lens_pdf().map_or(0.0, |pdf| once / pdf),
            normal: Vec3::ZERO,
        }
    }

    /// Density per solid angle of walks from the eye.
    #[inline(always)]
    fn pdf<F: Float>(&self, view: &View<F>) -> F {
        let pdf = F::splat(self.film_pdf) * view.film_per_solid_angle;
        if is_seeded(Fault::Importance) { pdf * view.cos * view.cos * view.cos } else { pdf }
    }

    /// How a point of the lens looks in a direction; `None` where that is behind it or off the film.
    pub fn look(&self, lens: Vec3, direction: Vec3) -> Option<Look> {
        let (look, seen) = self.looks(lens, direction);
        seen.then_some(look)
    }

    /// [`Sensor::look`] of a camera that does not move, at any width, and where there is something to see.
    #[inline(always)]
    fn looks<F: Float>(&self, lens: Vector<F>, direction: Vector<F>) -> (Look<F>, F::Mask) {
        let view = self.camera.views(lens, direction);
        let splat = F::splat;
        let [from, to] = self.reach;
        let [x, y] = view.film;
        let inside = x.ge(splat(from[0])) & x.lt(splat(to[0])) & y.ge(splat(from[1])) & y.lt(splat(to[1]));
        let look = Look {
            lens,
            to_lens: -direction,
            film: view.film,
            pdf: self.pdf(&view),
            cos: view.cos,
            clip: self.camera.clip(view.cos),
        };
        (look, inside & splat(0.0).lt(view.cos))
    }

    /// The look from a point of the lens at a point in space, and the square of the distance.
    pub fn look_at(&self, lens: Vec3, position: Vec3) -> Option<(Look, f32)> {
        let (look, distance_squared, seen) = self.looks_at(lens, position);
        seen.then_some((look, distance_squared))
    }

    /// [`Sensor::look_at`] of a camera that does not move, at any width, and where there is something to see.
    #[inline(always)]
    pub(super) fn looks_at<F: Float>(&self, lens: Vector<F>, position: Vector<F>) -> (Look<F>, F, F::Mask) {
        let along = position - lens;
        let distance_squared = along.length_squared();
        let distance = distance_squared.sqrt();
        let (look, seen) = self.looks(lens, along / distance);
        let near_enough = look.clip[0].lt(distance) & distance.le(look.clip[1]);
        (look, distance_squared, seen & near_enough)
    }
}

impl<F: Float> Look<F> {
    /// Direction of the shadow ray from the lens to a surface point, as far as it, and where on it the camera begins to see.
    #[inline(always)]
    pub(super) fn toward(&self, point: &ShadowPoint<F>) -> (Vector<F>, F) {
        let along = point.leave(self.to_lens) - self.lens;
        (along, self.clip[0] / along.length())
    }
}

impl Look {
    /// The shadow ray between a surface point and the lens.
    pub fn shadow_ray(&self, point: &SurfacePoint, time: f32) -> Ray {
        let (along, tnear) = self.toward(&point.into());
        Ray { tnear, tfar: 1.0 - SHADOW_END, time, ..Ray::new(self.lens, along) }
    }

    /// The shadow ray between infinitely far and the lens, as far as the camera sees surfaces.
    pub fn shadow_ray_from_far(&self, time: f32) -> Ray {
        let [tnear, tfar] = self.clip;
        Ray { tnear, tfar, time, ..Ray::new(self.lens, -self.to_lens) }
    }
}
