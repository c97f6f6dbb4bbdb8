//! Models to test, directions to test them under, and the checks that every scattering model has to pass.
//!
//! The checks take any [`Scatter`], so that deliberately broken models can be put to them too.

#![allow(dead_code, reason = "each test binary uses its part")]

use std::sync::LazyLock;

use lichtweg::bsdf::{
    Bsdf, BsdfSample, Diffuse, MicrofacetKind, Microfacets, Mode, RoughConductor, RoughDielectric,
    RoughPlastic, RoughTransmittanceTable, SmoothConductor, SmoothDielectric, SmoothPlastic, ThinDielectric,
    fresnel,
};
use lichtweg::color::Spectrum;
use lichtweg_montecarlo::hypothesis::{DensityReport, DensityTest, DensityTestError};
use lichtweg_montecarlo::{Moments, Sampler, SamplerKind};
use lichtweg_ray::math::Vec3;

pub use MicrofacetKind::{Beckmann, Ggx};

/// What the checks need of a model.
pub trait Scatter {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, mode: Mode) -> (Spectrum, f32);
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], mode: Mode) -> Option<BsdfSample>;
}

impl Scatter for Bsdf<'_> {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, mode: Mode) -> (Spectrum, f32) {
        Bsdf::eval_pdf(self, wo, wi, mode)
    }
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], mode: Mode) -> Option<BsdfSample> {
        Bsdf::sample(self, wo, u_lobe, u, mode)
    }
}

/// A model with parameters.
pub struct Case {
    pub name: String,
    pub bsdf: Bsdf<'static>,
}

pub const BASE: Spectrum = Spectrum::rgb([0.2, 0.5, 0.8]);
pub const REFLECTANCE_TINT: Spectrum = Spectrum::rgb([0.9, 0.6, 0.3]);
pub const TRANSMITTANCE_TINT: Spectrum = Spectrum::rgb([0.3, 0.6, 0.9]);
pub const METAL_ETA: Spectrum = Spectrum::rgb([0.2, 0.9, 1.1]);
pub const METAL_K: Spectrum = Spectrum::rgb([3.9, 2.4, 2.2]);

pub fn diffuse(reflectance: Spectrum) -> Bsdf<'static> {
    Bsdf::Diffuse(Diffuse { reflectance })
}

pub fn rough_conductor(
    kind: MicrofacetKind,
    [u, v]: [f32; 2],
    specular_reflectance: Spectrum,
) -> Bsdf<'static> {
    let facets = Microfacets::new(kind, u, v);
    Bsdf::RoughConductor(RoughConductor { facets, eta: METAL_ETA, k: METAL_K, specular_reflectance })
}

/// Facets that reflect everything: index 0 + i.
pub fn white_rough_conductor(kind: MicrofacetKind, [u, v]: [f32; 2]) -> Bsdf<'static> {
    let facets = Microfacets::new(kind, u, v);
    let (eta, k) = (Spectrum::ZERO, Spectrum::ONE);
    Bsdf::RoughConductor(RoughConductor { facets, eta, k, specular_reflectance: Spectrum::ONE })
}

pub fn rough_dielectric(kind: MicrofacetKind, [u, v]: [f32; 2], eta: f32) -> Bsdf<'static> {
    tinted_rough_dielectric(kind, [u, v], eta, Spectrum::ONE, Spectrum::ONE)
}

pub fn tinted_rough_dielectric(
    kind: MicrofacetKind,
    [u, v]: [f32; 2],
    eta: f32,
    specular_reflectance: Spectrum,
    specular_transmittance: Spectrum,
) -> Bsdf<'static> {
    let facets = Microfacets::new(kind, u, v);
    Bsdf::RoughDielectric(RoughDielectric { facets, eta, specular_reflectance, specular_transmittance })
}

pub fn smooth_dielectric(eta: f32, reflectance: Spectrum, transmittance: Spectrum) -> Bsdf<'static> {
    Bsdf::SmoothDielectric(SmoothDielectric {
        eta,
        specular_reflectance: reflectance,
        specular_transmittance: transmittance,
    })
}

pub fn thin_dielectric(eta: f32, reflectance: Spectrum, transmittance: Spectrum) -> Bsdf<'static> {
    Bsdf::ThinDielectric(ThinDielectric {
        eta,
        specular_reflectance: reflectance,
        specular_transmittance: transmittance,
    })
}

pub fn smooth_conductor(eta: Spectrum, k: Spectrum, specular_reflectance: Spectrum) -> Bsdf<'static> {
    Bsdf::SmoothConductor(SmoothConductor { eta, k, specular_reflectance })
}

pub fn plastic(eta: f32, base: Spectrum, tint: Spectrum, nonlinear: bool) -> Bsdf<'static> {
    let internal = fresnel::diffuse_reflectance(1.0 / eta);
    Bsdf::SmoothPlastic(SmoothPlastic::new(eta, internal, base, tint, nonlinear))
}

pub fn rough_plastic(
    coat: &'static RoughTransmittanceTable,
    base: Spectrum,
    tint: Spectrum,
    nonlinear: bool,
) -> Bsdf<'static> {
    Bsdf::RoughPlastic(RoughPlastic::new(coat, base, tint, nonlinear))
}

macro_rules! coats {
    ($($name:ident: $kind:ident, $alpha:literal, $eta:literal;)+) => {$(
        pub static $name: LazyLock<RoughTransmittanceTable> =
            LazyLock::new(|| RoughTransmittanceTable::new(Microfacets::new($kind, $alpha, $alpha), $eta));
    )+};
}
coats! {
    COAT_GGX_03_150: Ggx, 0.3, 1.5;
    COAT_BECKMANN_01_190: Beckmann, 0.1, 1.9;
    COAT_BECKMANN_07_133: Beckmann, 0.7, 1.33;
}

/// The models that have a density, with parameters from polished to rough. Names are those of the reference tables.
pub fn cases() -> Vec<Case> {
    let white = Spectrum::ONE;
    let case = |name: &str, bsdf| Case { name: name.into(), bsdf };
    vec![
        case("diffuse", diffuse(BASE)),
        case("roughconductor_ggx_0.05", rough_conductor(Ggx, [0.05; 2], white)),
        case("roughconductor_ggx_0.7_0.2_tinted", rough_conductor(Ggx, [0.7, 0.2], REFLECTANCE_TINT)),
        case("roughconductor_beckmann_0.05", rough_conductor(Beckmann, [0.05; 2], white)),
        case("roughconductor_beckmann_0.3_0.1", rough_conductor(Beckmann, [0.3, 0.1], white)),
        case("roughconductor_beckmann_0.7", rough_conductor(Beckmann, [0.7; 2], white)),
        case("roughdielectric_ggx_0.3_eta_1.5", rough_dielectric(Ggx, [0.3; 2], 1.5)),
        case("roughdielectric_ggx_0.05_eta_1.33", rough_dielectric(Ggx, [0.05; 2], 1.33)),
        case("roughdielectric_ggx_0.7_0.1_eta_0.6", rough_dielectric(Ggx, [0.7, 0.1], 0.6)),
        case(
            "roughdielectric_beckmann_0.2_0.5_eta_0.75",
            tinted_rough_dielectric(Beckmann, [0.2, 0.5], 0.75, REFLECTANCE_TINT, TRANSMITTANCE_TINT),
        ),
        case("plastic_eta_1.5", plastic(1.5, BASE, white, false)),
        case("plastic_eta_1.9_nonlinear", plastic(1.9, BASE, REFLECTANCE_TINT, true)),
        case("roughplastic_ggx_0.3_eta_1.5", rough_plastic(&COAT_GGX_03_150, BASE, white, false)),
        case(
            "roughplastic_beckmann_0.1_eta_1.9_nonlinear",
            rough_plastic(&COAT_BECKMANN_01_190, BASE, REFLECTANCE_TINT, true),
        ),
        case("roughplastic_beckmann_0.7_eta_1.33", rough_plastic(&COAT_BECKMANN_07_133, BASE, white, false)),
    ]
}

/// The unit vector of height `z` and azimuth `phi`.
pub fn direction(z: f32, phi: f32) -> Vec3 {
    let r = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    Vec3::new(r * phi.cos(), r * phi.sin(), z)
}

/// Near-normal to grazing, and the same from below for models that have an inside.
pub fn directions(bsdf: &Bsdf<'_>) -> Vec<Vec3> {
    let above = [(1.0, 0.0), (0.9, 0.4), (0.4, 2.0), (0.02, 5.5)].map(|(z, phi)| direction(z, phi));
    let two_sided =
        matches!(bsdf, Bsdf::RoughDielectric(_) | Bsdf::SmoothDielectric(_) | Bsdf::ThinDielectric(_));
    let below = above.iter().filter(|_| two_sided).map(|&w| -w);
    above.into_iter().chain(below).collect()
}

fn sampler(seed: u64, index: u32) -> Sampler {
    Sampler::new(SamplerKind::Independent, seed, 0, index)
}

/// Tests `sample` against the density under `wo`: chi-squared of the shape, and the sampled fraction against the integral.
pub fn density_report(
    model: &impl Scatter,
    wo: Vec3,
    seed: u64,
    samples: u32,
) -> Result<DensityReport, DensityTestError> {
    let test = DensityTest { seed, samples, ..DensityTest::default() };
    test.sphere(
        |s| {
            let drawn = model.sample(wo, s.next_1d(), s.next_2d(), Mode::Radiance)?;
            (!drawn.delta).then_some(drawn.wi.to_array())
        },
        |wi| model.eval_pdf(wo, Vec3::from_array(wi), Mode::Radiance).1,
    )
}

/// Whether samples carry the density and weight that `eval_pdf` gives for their direction, to a relative 10^-3.
///
/// Where a density is steep the rounding of the direction changes it by more; one sample in 10^4 may be off, by 10^-2.
pub fn check_samples(model: &impl Scatter, wo: Vec3, mode: Mode) -> Result<(), String> {
    let (mut drawn, mut coarse) = (0u32, 0u32);
    for i in 0..20_000 {
        let mut s = sampler(3, i);
        let Some(sample) = model.sample(wo, s.next_1d(), s.next_2d(), mode) else { continue };
        if sample.delta {
            continue;
        }
        drawn += 1;
        let (value, pdf) = model.eval_pdf(wo, sample.wi, mode);
        let quotient = value / pdf;
        let error = (0..4)
            .map(|l| relative_error(sample.weight.0[l], quotient.0[l]))
            .fold(relative_error(sample.pdf, pdf), f32::max);
        coarse += u32::from(error > 1e-3);
        if error.is_nan() || error > 1e-2 {
            return Err(format!("{mode:?} wo {wo:?}: {sample:?}, but value {value:?}, density {pdf}"));
        }
    }
    if coarse > 2 + drawn / 10_000 {
        return Err(format!(
            "{mode:?} wo {wo:?}: {coarse} of {drawn} samples disagree with their density or value"
        ));
    }
    Ok(())
}

/// Whether f*(wo, wi) = f(wi, wo): importance is scattered by the adjoint of what scatters radiance. To a relative 10^-3;
/// in one mode alone this is Helmholtz reciprocity.
pub fn check_adjoint(model: &impl Scatter, wo: Vec3) -> Result<(), String> {
    let mut compared = 0;
    for i in 0..2000 {
        let mut s = sampler(5, i);
        let Some(sample) = model.sample(wo, s.next_1d(), s.next_2d(), Mode::Radiance) else { continue };
        let wi = sample.wi;
        // A cosine near zero magnifies the rounding of the direction; a delta lobe has no value.
        if sample.delta || wi.z.abs() < 0.02 {
            continue;
        }
        let forward = model.eval_pdf(wo, wi, Mode::Importance).0 / wi.z.abs();
        let backward = model.eval_pdf(wi, wo, Mode::Radiance).0 / wo.z.abs();
        compared += 1;
        for l in 0..4 {
            let error = relative_error(forward.0[l], backward.0[l]);
            if error.is_nan() || error > 1e-3 {
                return Err(format!("wo {wo:?} wi {wi:?}: {forward:?} against {backward:?}"));
            }
        }
    }
    if compared > 100 { Ok(()) } else { Err(format!("wo {wo:?}: only {compared} pairs to compare")) }
}

/// Fraction of the flux arriving from `wo` that is scattered: the mean weight of importance, per lane.
pub fn albedo(model: &impl Scatter, wo: Vec3, samples: u32) -> [Moments; 4] {
    let mut lanes: [Moments; 4] = Default::default();
    for i in 0..samples {
        let mut s = sampler(11, i);
        let weight = model
            .sample(wo, s.next_1d(), s.next_2d(), Mode::Importance)
            .map_or(Spectrum::ZERO, |sample| sample.weight);
        lanes.iter_mut().zip(weight.0).for_each(|(lane, w)| lane.push(f64::from(w)));
    }
    lanes
}

/// |a - b| relative to b, and 0 where both vanish.
pub fn relative_error(a: f32, b: f32) -> f32 {
    if a == b { 0.0 } else { (a - b).abs() / b.abs() }
}
