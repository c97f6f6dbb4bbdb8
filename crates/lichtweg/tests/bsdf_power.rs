//! The checks reject what they are there to reject: models with one known mistake each, put to the very same checks.

mod bsdf_common;

use bsdf_common::*;
use lichtweg::bsdf::{Bsdf, BsdfSample, Microfacets, Mode};
use lichtweg::color::Spectrum;
use lichtweg_montecarlo::hypothesis::sidak;
use lichtweg_ray::math::Vec3;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    None,
    /// The value without |cos wi|.
    DroppedCosine,
    /// Radiance crosses the interface unscaled, in value and weight alike.
    RadianceUnscaled,
    /// Importance is scaled as radiance is.
    ImportanceScaled,
    /// The density and value of a distribution 3 % rougher than the sampled one.
    RougherDensity,
    /// The density half a per cent high everywhere, the weight in keeping.
    ScaledDensity,
    /// The lobe's probability left out of the density, and of the weight.
    LobeForgotten,
    /// Samples below the horizon turned up instead of dropped.
    FoldedSamples,
    /// The density of visible normals with the rational G1 in place of the exact one (at most 0.35 % off).
    RationalVisibility,
}

struct Mutant {
    bsdf: Bsdf<'static>,
    rougher: Bsdf<'static>,
    facets: Microfacets,
    mistake: Mistake,
}

impl Scatter for Mutant {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, mode: Mode) -> (Spectrum, f32) {
        let (value, pdf) = self.bsdf.eval_pdf(wo, wi, mode);
        let crossed = wo.z * wi.z < 0.0;
        match self.mistake {
            Mistake::DroppedCosine => (value / wi.z.abs(), pdf),
            Mistake::RadianceUnscaled => (self.bsdf.eval_pdf(wo, wi, Mode::Importance).0, pdf),
            Mistake::ImportanceScaled => (self.bsdf.eval_pdf(wo, wi, Mode::Radiance).0, pdf),
            Mistake::RougherDensity => self.rougher.eval_pdf(wo, wi, mode),
            Mistake::ScaledDensity => (value, pdf * 1.005),
            Mistake::LobeForgotten if crossed => (value, pdf * 1.1),
            Mistake::RationalVisibility => {
                (value, pdf * self.facets.masking(wo) / self.facets.visibility(wo))
            }
            _ => (value, pdf),
        }
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], mode: Mode) -> Option<BsdfSample> {
        let drawn = self.bsdf.sample(wo, u_lobe, u, mode);
        if self.mistake == Mistake::FoldedSamples && drawn.is_none() {
            let wi = direction(0.3, std::f32::consts::TAU * u[0]);
            let (value, pdf) = self.bsdf.eval_pdf(wo, wi, mode);
            return Some(BsdfSample { wi, weight: value / pdf, pdf, delta: false, eta: 1.0 });
        }
        let mut sample = drawn?;
        let (value, pdf) = self.eval_pdf(wo, sample.wi, mode);
        match self.mistake {
            Mistake::RadianceUnscaled
            | Mistake::ImportanceScaled
            | Mistake::RougherDensity
            | Mistake::ScaledDensity
            | Mistake::LobeForgotten
            | Mistake::RationalVisibility => {
                sample.weight = value / pdf;
                sample.pdf = pdf;
            }
            _ => {}
        }
        Some(sample)
    }
}

/// Which of the checks fail: density, samples, adjoint.
fn failures(model: &Mutant) -> Vec<&'static str> {
    let directions = [direction(0.97, 0.4), direction(0.4, 2.0), direction(0.1, 4.0)];
    let level = sidak(0.01, directions.len());
    let mut failed = Vec::new();
    for (seed, wo) in (1..).zip(directions) {
        if density_report(model, wo, seed, 500_000).map_or(true, |report| report.rejects(level)) {
            failed.push("density");
        }
        if [Mode::Radiance, Mode::Importance].iter().any(|&mode| check_samples(model, wo, mode).is_err()) {
            failed.push("samples");
        }
        if check_adjoint(model, wo).is_err() {
            failed.push("adjoint");
        }
    }
    failed.sort_unstable();
    failed.dedup();
    failed
}

fn conductor(mistake: Mistake) -> Mutant {
    let bsdf = rough_conductor(Beckmann, [0.6, 0.3], Spectrum::ONE);
    let rougher = rough_conductor(Beckmann, [0.6 * 1.03, 0.3 * 1.03], Spectrum::ONE);
    Mutant { bsdf, rougher, facets: Microfacets::new(Beckmann, 0.6, 0.3), mistake }
}

fn dielectric(mistake: Mistake) -> Mutant {
    let bsdf = rough_dielectric(Ggx, [0.3; 2], 1.5);
    let rougher = rough_dielectric(Ggx, [0.3 * 1.03; 2], 1.5);
    Mutant { bsdf, rougher, facets: Microfacets::new(Ggx, 0.3, 0.3), mistake }
}

#[test]
fn right_models_pass() {
    assert_eq!(failures(&conductor(Mistake::None)), [""; 0]);
    assert_eq!(failures(&dielectric(Mistake::None)), [""; 0]);
}

#[test]
fn a_dropped_cosine_is_found() {
    assert_eq!(failures(&conductor(Mistake::DroppedCosine)), ["adjoint", "samples"]);
    assert_eq!(failures(&dielectric(Mistake::DroppedCosine)), ["adjoint", "samples"]);
}

#[test]
fn a_wrong_squared_index_is_found() {
    assert_eq!(failures(&dielectric(Mistake::RadianceUnscaled)), ["adjoint"]);
    assert_eq!(failures(&dielectric(Mistake::ImportanceScaled)), ["adjoint"]);
}

#[test]
fn wrong_densities_are_found() {
    assert_eq!(failures(&conductor(Mistake::RougherDensity)), ["density"]);
    assert_eq!(failures(&dielectric(Mistake::RougherDensity)), ["density"]);
    assert_eq!(failures(&conductor(Mistake::ScaledDensity)), ["density"]);
    assert_eq!(failures(&dielectric(Mistake::LobeForgotten)), ["density"]);
    assert_eq!(failures(&conductor(Mistake::RationalVisibility)), ["density"]);
}

#[test]
fn samples_that_should_have_been_dropped_are_found() {
    assert_eq!(failures(&conductor(Mistake::FoldedSamples)), ["density"]);
}
