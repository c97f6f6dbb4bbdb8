//! Lights that are no shape.

use std::sync::Arc;

use lichtweg_ray::math::{Affine, Vec3};

use super::{Image, Span, SpectrumDescription};

/// A light and where it was stated.
#[derive(Clone, Debug)]
pub struct LightDescription {
    /// The author's name for it, if any.
    pub name: Option<String>,
    /// Where it was stated.
    pub span: Span,
    /// What it is.
    pub kind: LightKind,
    /// Multiplies what it emits.
    pub scale: f32,
}

/// What a light is.
#[derive(Clone, Debug)]
pub enum LightKind {
    /// A point that shines alike in all directions.
    Point {
        /// Where, in the world.
        position: Vec3,
        /// Radiant intensity in W / sr.
        intensity: SpectrumDescription,
    },
    /// A point that shines in a cone about the +z axis of its own space.
    Spot {
        /// From its own space to the world.
        to_world: Affine,
        /// Radiant intensity on the axis in W / sr.
        intensity: SpectrumDescription,
        /// Half-angle in degrees beyond which it is dark.
        cutoff: f32,
        /// Half-angle in degrees up to which it has full intensity.
        beam_width: f32,
        /// What happens between.
        falloff: SpotFalloff,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// The direction the light travels in, in the world; any length.
        direction: Vec3,
        /// Irradiance on a plane perpendicular to it in W / m^2.
        irradiance: SpectrumDescription,
    },
    /// The same radiance from everywhere around the scene.
    Constant {
        /// Radiance in W / (m^2 sr).
        radiance: SpectrumDescription,
    },
    /// An image of the surroundings.
    Environment {
        /// Radiance, linear.
        image: Arc<Image>,
        /// How directions become pixels.
        mapping: EnvironmentMapping,
        /// From the map's own space to the world.
        to_world: Affine,
    },
}

/// The edge of a spot light between `beam_width` and `cutoff`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpotFalloff {
    /// Linear in the angle (Mitsuba).
    LinearAngle,
    /// Smoothstep in the cosine of the angle (pbrt).
    SmoothCosine,
}

/// How directions of an environment become pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnvironmentMapping {
    /// Latitude and longitude, Mitsuba's: +y up; u = atan2(x, -z) / (2 pi), v = acos(y) / pi downwards.
    LatitudeLongitude,
    /// The equal-area octahedral square of Clarberg 2008 as pbrt-v4 uses it, +z in the middle.
    EqualAreaOctahedral,
}
