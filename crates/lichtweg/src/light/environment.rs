//! Light from infinitely far around the scene.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use lichtweg_montecarlo::{distribution::PiecewiseConstant2D, warp};
use lichtweg_ray::math::{Affine, Vec3, Vector};
use lichtweg_ray::wide::{Float, FloatLanes, Lanes, Wide};

use super::LightSample;
use crate::color::{Spectra, Spectrum, SpectrumLanes, luminance};
use crate::lanes::{atan2, lanes_of, spread, warp::sin_cos_turn};
use crate::scene::description::{EnvironmentMapping, Image};

/// The surroundings.
#[derive(Debug)]
pub enum Environment {
    /// The same from everywhere.
    Constant(ConstantEnvironment),
    /// An image.
    Map(MapEnvironment),
}

impl Environment {
    /// What is there in a direction.
    #[inline]
    pub fn seen(&self, direction: Vec3) -> Seen<'_> {
        match self {
            Self::Constant(e) => Seen { environment: self, at: [0.0; 2], radiance: e.radiance },
            Self::Map(e) => {
                let at = e.square(direction);
                Seen { environment: self, at, radiance: e.radiance(at) }
            }
        }
    }

    /// What is there in some of sixteen directions: radiance, and [`Seen::pdf`] where it is asked for.
    #[inline(always)]
    pub(crate) fn seen_lanes<W: Wide>(
        &self,
        direction: Vector<W::F32>,
        lanes: u32,
        with_pdf: u32,
    ) -> (Spectra<W::F32>, W::F32) {
        let splat = W::F32::splat;
        let map = match self {
            Self::Constant(e) => {
                let [r, g, b, c] = e.radiance.0;
                return (Spectra([splat(r), splat(g), splat(b), splat(c)]), splat(warp::UNIFORM_SPHERE_PDF));
            }
            Self::Map(map) => map,
        };
        let [x, y] = map.square(direction);
        let (x, y) = (x.to_lanes(), y.to_lanes());
        let mut radiance = SpectrumLanes::new(Spectra([splat(0.0); 4]));
        let mut pdf = Lanes::splat(1.0);
        for lane in lanes_of(lanes) {
            let at = [x.0[lane], y.0[lane]];
            radiance.set(lane, map.radiance(at));
            if with_pdf >> lane & 1 != 0 {
                pdf.0[lane] = map.pdf(at);
            }
        }
        (radiance.load(), W::F32::load(&pdf))
    }

    /// See [`Light::sample`](super::Light::sample).
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Option<LightSample> {
        let (direction, radiance, pdf) = match self {
            Self::Constant(e) => {
                (Vec3::from_array(warp::uniform_sphere(u)), e.radiance, warp::UNIFORM_SPHERE_PDF)
            }
            Self::Map(e) => {
                let (at, direction, pdf) = e.sample(u)?;
                (direction, e.radiance(at), pdf)
            }
        };
        (!radiance.is_zero()).then_some(LightSample { direction, target: None, radiance, pdf, delta: false })
    }

    /// Mean radiance over all directions.
    pub fn mean(&self) -> Spectrum {
        match self {
            Self::Constant(e) => e.radiance,
            Self::Map(e) => e.mean,
        }
    }
}

/// The surroundings in some direction.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    environment: &'a Environment,
    /// Where on the square of a map.
    at: [f32; 2],
    /// Radiance that arrives from there.
    pub radiance: Spectrum,
}

impl Seen<'_> {
    /// Density per solid angle with which [`Environment::sample`] chooses the direction.
    #[inline]
    pub fn pdf(&self) -> f32 {
        match self.environment {
            Environment::Constant(_) => warp::UNIFORM_SPHERE_PDF,
            Environment::Map(e) => e.pdf(self.at),
        }
    }
}

/// The same radiance from everywhere.
#[derive(Clone, Copy, Debug)]
pub struct ConstantEnvironment {
    /// In W / (m^2 sr).
    pub radiance: Spectrum,
}

/// An image of the surroundings, sampled by luminance and the solid angle of its texels.
///
/// A latitude-longitude map is read bilinearly, and sampled by the largest texel that reaches into each cell, so that no
/// direction with radiance has density zero; an octahedral map is read by the nearest texel, as pbrt does.
#[derive(Debug)]
pub struct MapEnvironment {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
    mapping: EnvironmentMapping,
    to_world: [Vec3; 3],
    distribution: PiecewiseConstant2D,
    mean: Spectrum,
}

impl MapEnvironment {
    /// A map whose space is turned into the world by `to_world`, every value multiplied by `scale`. `None` where the image is
    /// black or has a value that is no radiance, or the map no rotation or reflection.
    pub fn new(image: &Image, mapping: EnvironmentMapping, to_world: &Affine, scale: f32) -> Option<Self> {
        let (width, height) = (image.width as usize, image.height as usize);
        let mut texels = image.to_linear_rgb(true);
        texels.iter_mut().for_each(|t| *t = t.map(|v| v * scale));
        if !texels.iter().flatten().all(|v| (0.0..f32::INFINITY).contains(v)) {
            return None;
        }
        let mut axes = [Vec3::ZERO; 3];
        for (axis, unit) in axes.iter_mut().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
            *axis = to_world.vector(unit).try_normalized()?;
        }
        let weights = match mapping {
            EnvironmentMapping::LatitudeLongitude => latitude_longitude_weights(&texels, width, height),
            EnvironmentMapping::EqualAreaOctahedral => texels.iter().map(|t| max(*t)).collect(),
        };
        let distribution = PiecewiseConstant2D::new(width, height, &weights).ok()?;
        let mean = mean(&texels, width, height, mapping);
        Some(Self { width, height, texels, mapping, to_world: axes, distribution, mean })
    }

    /// Where a direction is on the square.
    #[inline(always)]
    fn square<F: Float>(&self, direction: Vector<F>) -> [F; 2] {
        let local = self.to_local(direction);
        match self.mapping {
            EnvironmentMapping::LatitudeLongitude => latitude_longitude(local),
            EnvironmentMapping::EqualAreaOctahedral => octahedral_square(local),
        }
    }

    /// Radiance that arrives from a place on the square.
    fn radiance(&self, [x, y]: [f32; 2]) -> Spectrum {
        let (x, y) = (x * self.width as f32, y * self.height as f32);
        Spectrum::rgb(match self.mapping {
            EnvironmentMapping::LatitudeLongitude => self.bilinear(x - 0.5, y - 0.5),
            EnvironmentMapping::EqualAreaOctahedral => {
                let (x, y) = ((x as usize).min(self.width - 1), (y as usize).min(self.height - 1));
                self.texels[y * self.width + x]
            }
        })
    }

    /// Density per solid angle with which [`MapEnvironment::sample`] chooses a place on the square.
    fn pdf(&self, at: [f32; 2]) -> f32 {
        let pdf = self.distribution.pdf(at);
        match self.mapping {
            EnvironmentMapping::LatitudeLongitude => latitude_longitude_pdf(pdf, sin_cos_turn(0.5 * at[1]).0),
            EnvironmentMapping::EqualAreaOctahedral => pdf * warp::UNIFORM_SPHERE_PDF,
        }
    }

    /// A place on the square, its direction and density per solid angle.
    fn sample(&self, u: [f32; 2]) -> Option<([f32; 2], Vec3, f32)> {
        let (at, pdf) = self.distribution.sample(u);
        let (local, pdf) = match self.mapping {
            EnvironmentMapping::LatitudeLongitude => {
                let (sin_theta, cos_theta) = sin_cos_turn(0.5 * at[1]);
                let (sin_phi, cos_phi) = sin_cos_turn(at[0]);
                let local = Vec3::new(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta);
                (local, latitude_longitude_pdf(pdf, sin_theta))
            }
            EnvironmentMapping::EqualAreaOctahedral => {
                (octahedral_direction(at), pdf * warp::UNIFORM_SPHERE_PDF)
            }
        };
        let [x, y, z] = self.to_world;
        (pdf > 0.0).then(|| (at, x * local.x + y * local.y + z * local.z, pdf))
    }

    #[inline(always)]
    fn to_local<F: Float>(&self, direction: Vector<F>) -> Vector<F> {
        let [x, y, z] = self.to_world;
        Vector::new(direction.dot(spread(x)), direction.dot(spread(y)), direction.dot(spread(z)))
    }

    /// Between texel centres, at coordinates of -1/2 or more; round the horizon, and clamped at the poles.
    fn bilinear(&self, x: f32, y: f32) -> [f32; 3] {
        // The columns and rows before and behind, counted from one.
        let (x1, y1) = ((x + 1.0) as usize, (y + 1.0) as usize);
        let (s, t) = (x + 1.0 - x1 as f32, y + 1.0 - y1 as f32);
        let left = if x1 == 0 { self.width } else { x1.min(self.width) } - 1;
        let right = if x1 < self.width { x1 } else { 0 };
        let (above, below) = (y1.clamp(1, self.height) - 1, y1.min(self.height - 1));
        let at = |x: usize, y: usize| self.texels[y * self.width + x];
        let (a, b, c, d) = (at(left, above), at(right, above), at(left, below), at(right, below));
        std::array::from_fn(|i| (a[i] * (1.0 - s) + b[i] * s) * (1.0 - t) + (c[i] * (1.0 - s) + d[i] * s) * t)
    }
}

/// (u, v) in [0, 1)^2 of a unit direction: Mitsuba's convention.
#[inline(always)]
fn latitude_longitude<F: Float>(d: Vector<F>) -> [F; 2] {
    let splat = F::splat;
    let u = atan2(d.x, -d.z) * splat(0.5 * FRAC_1_PI);
    let v = atan2((d.x * d.x + d.z * d.z).sqrt(), d.y) * splat(FRAC_1_PI);
    let below_one = splat(1.0 - f32::EPSILON);
    [(u + splat(1.0)).select(u.lt(splat(0.0)), u).min(below_one), v.min(below_one)]
}

/// Per solid angle: the unit square is stretched over 2 pi by pi, and shrunk by the sine towards the poles.
fn latitude_longitude_pdf(pdf_square: f32, sin_theta: f32) -> f32 {
    if sin_theta > 0.0 { pdf_square / (TAU * PI * sin_theta) } else { 0.0 }
}

/// Of each texel: the largest value among the texels that bilinear look-ups in its cell can touch, by solid angle.
fn latitude_longitude_weights(texels: &[[f32; 3]], width: usize, height: usize) -> Vec<f32> {
    let along_row: Vec<f32> = (0..texels.len())
        .map(|i| {
            let (row, x) = (i / width * width, i % width);
            let at = |x: usize| max(texels[row + x]);
            at(x).max(at((x + 1) % width)).max(at((x + width - 1) % width))
        })
        .collect();
    (0..texels.len())
        .map(|i| {
            let y = i / width;
            let at = |y: usize| along_row[y * width + i % width];
            let largest = at(y).max(at(y.saturating_sub(1))).max(at((y + 1).min(height - 1)));
            largest * ((y as f32 + 0.5) * PI / height as f32).sin()
        })
        .collect()
}

fn mean(texels: &[[f32; 3]], width: usize, height: usize, mapping: EnvironmentMapping) -> Spectrum {
    let mut sum = [0.0f64; 4];
    for (i, texel) in texels.iter().enumerate() {
        let weight = match mapping {
            EnvironmentMapping::LatitudeLongitude => {
                (((i / width) as f64 + 0.5) * std::f64::consts::PI / height as f64).sin()
            }
            EnvironmentMapping::EqualAreaOctahedral => 1.0,
        };
        for (s, v) in sum.iter_mut().zip(texel) {
            *s += weight * f64::from(*v);
        }
        sum[3] += weight;
    }
    Spectrum::rgb([0, 1, 2].map(|i| (sum[i] / sum[3]) as f32))
}

fn max(rgb: [f32; 3]) -> f32 {
    // The luminance of a pure blue is too small a share of its noise.
    luminance(rgb).max(rgb[0].max(rgb[1]).max(rgb[2]) / 3.0)
}

/// The equal-area octahedral map of a unit direction to [0, 1]^2 (Clarberg 2008, "Fast Equal-Area Mapping of the (Hemi)Sphere
/// using SIMD").
#[inline(always)]
fn octahedral_square<F: Float>(d: Vector<F>) -> [F; 2] {
    let (zero, half, one) = (F::splat(0.0), F::splat(0.5), F::splat(1.0));
    let r = (one - d.z.abs()).max(zero).sqrt();
    // Angle within a quadrant, as a fraction of it.
    let fraction = atan2(d.y.abs(), d.x.abs()) * F::splat(2.0 * FRAC_1_PI);
    let (u, v) = (r - fraction * r, fraction * r);
    let below = d.z.lt(zero);
    let (u, v) = ((one - v).select(below, u), (one - u).select(below, v));
    [half * (u.copysign(d.x) + one), half * (v.copysign(d.y) + one)]
}

/// The inverse of [`octahedral_square`].
fn octahedral_direction([x, y]: [f32; 2]) -> Vec3 {
    let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    let (au, av) = (u.abs(), v.abs());
    // Distance to the square's inner diagonal: positive on the upper half of the sphere.
    let signed = 1.0 - (au + av);
    let r = 1.0 - signed.abs();
    let turns = if r == 0.0 { 1.0 } else { (av - au) / r + 1.0 } * 0.125;
    let z = (1.0 - r * r).copysign(signed);
    let s = r * (2.0 - r * r).max(0.0).sqrt();
    let (sin, cos) = sin_cos_turn(turns);
    Vec3::new((cos * s).copysign(u), (sin * s).copysign(v), z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octahedral_maps_are_inverse() {
        for i in 0..400 {
            let p = [(i % 20) as f32 / 20.0 + 0.013, (i / 20) as f32 / 20.0 + 0.021];
            let d = octahedral_direction(p);
            assert!((d.length() - 1.0).abs() < 1e-5);
            let q = octahedral_square(d);
            assert!((p[0] - q[0]).abs() < 1e-4 && (p[1] - q[1]).abs() < 1e-4, "{p:?} {d:?} {q:?}");
        }
        assert_eq!(octahedral_direction([0.5, 0.5]), Vec3::Z);
    }

    #[test]
    fn latitude_longitude_looks_where_mitsuba_does() {
        let [u, v] = latitude_longitude(Vec3::X);
        assert!((u - 0.25).abs() < 1e-6 && (v - 0.5).abs() < 1e-6);
        assert_eq!(latitude_longitude(Vec3::Y)[1], 0.0);
    }
}
