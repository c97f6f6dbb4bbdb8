//! Lights that a walk cannot run into: points and directions.

use lichtweg_ray::math::Vec3;

use super::LightSample;
use crate::color::Spectrum;
use crate::scene::description::SpotFalloff;

/// A point that shines alike in all directions.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Where.
    pub position: Vec3,
    /// Radiant intensity in W / sr.
    pub intensity: Spectrum,
}

impl Point {
    /// See [`Light::sample`](super::Light::sample).
    #[inline]
    pub fn sample(&self, from: Vec3) -> Option<LightSample> {
        sample_point(self.position, from, |_| self.intensity)
    }
}

/// A point that shines in a cone.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// Where.
    pub position: Vec3,
    /// Unit direction of the axis.
    pub axis: Vec3,
    /// Radiant intensity on the axis in W / sr.
    pub intensity: Spectrum,
    /// Half-angle in radians beyond which it is dark.
    pub cutoff: f32,
    /// Half-angle in radians up to which it has full intensity.
    pub beam_width: f32,
    /// What happens between.
    pub falloff: SpotFalloff,
}

impl Spot {
    /// See [`Light::sample`](super::Light::sample).
    #[inline]
    pub fn sample(&self, from: Vec3) -> Option<LightSample> {
        sample_point(self.position, from, |out| self.intensity * self.falloff(out.dot(self.axis)))
    }

    /// Width of the cone.
    #[inline]
    pub fn one_minus_cos_cutoff(&self) -> f32 {
        // 1 - cos t = 2 sin^2 (t / 2), which does not cancel.
        2.0 * (0.5 * self.cutoff).sin().powi(2)
    }

    /// Intensity relative to the axis, by the cosine of the angle to it.
    pub fn falloff(&self, cos_angle: f32) -> f32 {
        let angle = cos_angle.clamp(-1.0, 1.0).acos();
        if angle <= self.beam_width {
            return 1.0;
        }
        if angle >= self.cutoff {
            return 0.0;
        }
        match self.falloff {
            SpotFalloff::LinearAngle => (self.cutoff - angle) / (self.cutoff - self.beam_width),
            SpotFalloff::SmoothCosine => {
                let (dark, full) = (self.cutoff.cos(), self.beam_width.cos());
                let t = ((cos_angle - dark) / (full - dark)).clamp(0.0, 1.0);
                t * t * (3.0 - 2.0 * t)
            }
        }
    }
}

#[inline]
fn sample_point(position: Vec3, from: Vec3, intensity: impl FnOnce(Vec3) -> Spectrum) -> Option<LightSample> {
    let to_light = position - from;
    let distance_squared = to_light.length_squared();
    let direction = to_light.try_normalized()?;
    let intensity = intensity(-direction);
    if intensity.is_zero() {
        return None;
    }
    Some(LightSample {
        direction,
        target: Some(position),
        radiance: intensity / distance_squared,
        pdf: 1.0,
        delta: true,
    })
}

/// Parallel light.
#[derive(Clone, Copy, Debug)]
pub struct Directional {
    /// Unit direction the light travels in.
    pub direction: Vec3,
    /// Irradiance on a plane perpendicular to it.
    pub irradiance: Spectrum,
}

impl Directional {
    /// See [`Light::sample`](super::Light::sample).
    #[inline]
    pub fn sample(&self) -> LightSample {
        LightSample {
            direction: -self.direction,
            target: None,
            radiance: self.irradiance,
            pdf: 1.0,
            delta: true,
        }
    }
}
