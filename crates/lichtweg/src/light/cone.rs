//! Whole spheres as lights seen from outside: directions are uniform in the cone that they fill (Shirley, Wang and Zimmerman
//! 1996). For any width.

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::Float;

use crate::bsdf::Frame;
use crate::lanes::warp;
use crate::scene::Sphere;

/// The directions in which a sphere is seen.
pub(crate) struct Cone<F: Float> {
    axis: Vector<F>,
    distance: F,
    one_minus_cos: F,
    /// Whether there is one: not from inside the sphere, nor so near that the cone is no better than its surface.
    pub valid: F::Mask,
}

impl<F: Float> Cone<F> {
    /// The cone that a sphere fills.
    #[inline(always)]
    pub fn new(sphere: &Sphere<F>, from: Vector<F>) -> Self {
        let to_center = sphere.center - from;
        let distance_squared = to_center.length_squared();
        let sin_squared = sphere.radius * sphere.radius / distance_squared;
        let distance = distance_squared.sqrt();
        Self {
            axis: to_center / distance,
            distance,
            one_minus_cos: warp::one_minus_cos(sin_squared),
            valid: sin_squared.lt(F::splat(0.999_999)),
        }
    }

    /// Density per solid angle of the directions.
    #[inline(always)]
    pub fn pdf(&self) -> F {
        warp::uniform_cone_pdf(self.one_minus_cos)
    }

    /// The point of the sphere that is seen in a uniform direction, and the normal there.
    #[inline(always)]
    pub fn point(&self, sphere: &Sphere<F>, u: [F; 2]) -> [Vector<F>; 2] {
        let zero = F::splat(0.0);
        let (d, radius) = (self.distance, sphere.radius);
        let local = warp::uniform_cone(u, self.one_minus_cos);
        let direction = Frame::from_normal(self.axis).to_world(local);
        // The nearer intersection with the sphere, as the direction from its centre (Pharr et al. 2023, section 6.2.4).
        let sin_theta_squared = local.x * local.x + local.y * local.y;
        let along = d * local.z - (radius * radius - d * d * sin_theta_squared).max(zero).sqrt();
        sphere.in_direction((direction * along - self.axis * d).normalized())
    }
}
