//! Lights: the factor S of a light path, and how to choose points on them.
//!
//! Next-event estimation asks a light for a direction to it ([`Light::sample`]); a walk that runs into a light asks for its
//! radiance and for the density with which the former would have chosen the same direction. Densities are per solid
//! angle at the receiving point; lights at a single point or direction are `delta` and have none.

mod area;
mod cone;
mod delta;
mod emission;
mod environment;
mod few;
mod selection;
mod tree;

use lichtweg_ray::math::Vec3;
use lichtweg_ray::wide::Row;

use crate::color::Spectrum;
use crate::scene::{Scene, SurfacePoint};

pub use area::{AreaLight, EmissionSampling};
pub(crate) use area::{LightRows, Sight};
pub(crate) use cone::Cone;
pub use delta::{Directional, Point, Spot};
pub(crate) use emission::pdf_leaving;
pub use emission::{Emission, EmissionDensity, Surroundings};
pub use environment::{ConstantEnvironment, Environment, MapEnvironment};
pub use selection::{Candidate, LightChoice, LightSelection};
pub use tree::{LightBounds, Receiver};

/// A light.
#[derive(Debug)]
pub enum Light {
    /// A shape that emits.
    Area(AreaLight),
    /// A point.
    Point(Point),
    /// A point with a cone.
    Spot(Spot),
    /// Parallel light.
    Directional(Directional),
    /// Everything around the scene.
    Environment(Environment),
}

/// A direction towards a light, chosen for a receiving point.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// The point on the light that a ray may go to without hitting the light itself; `None` if infinitely far.
    pub target: Option<Vec3>,
    /// Radiance that arrives from there, unless occluded; for delta lights the irradiance on a plane perpendicular to it.
    pub radiance: Spectrum,
    /// Density of the direction per solid angle; 1 for delta lights.
    pub pdf: f32,
    /// Whether this is the only direction light comes from.
    pub delta: bool,
}

impl Light {
    /// Chooses a direction from `from` to this light, by a uniform pair. `None` where nothing can arrive.
    #[inline]
    pub fn sample(&self, from: Vec3, u: [f32; 2], scene: &Scene) -> Option<LightSample> {
        self.sample_part(from, None, u, scene).map(|(sample, _)| sample)
    }

    /// The same with the point on the light, if it is a shape. Where a triangle of it is given, the point lies on that one; the
    /// density then is that of points all over the light, see [`LightChoice::probability`].
    #[inline]
    pub fn sample_part(
        &self,
        from: Vec3,
        triangle: Option<u32>,
        u: [f32; 2],
        scene: &Scene,
    ) -> Option<(LightSample, Option<SurfacePoint>)> {
        let sample = match self {
            Self::Area(light) => {
                return light.sample(from, triangle, u, scene).map(|(sample, point)| (sample, Some(point)));
            }
            Self::Point(light) => light.sample(from)?,
            Self::Spot(light) => light.sample(from)?,
            Self::Directional(light) => light.sample(),
            Self::Environment(light) => light.sample(u)?,
        };
        Some((sample, None))
    }

    /// See [`AreaLight::emission_row`].
    #[inline]
    pub(crate) fn row(&self) -> Option<&Row> {
        match self {
            Self::Area(light) => light.row.as_ref(),
            _ => None,
        }
    }

    /// Whether it is at a single point or in a single direction, so that no walk can run into it.
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Point(_) | Self::Spot(_) | Self::Directional(_))
    }
}
