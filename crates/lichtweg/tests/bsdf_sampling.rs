//! Sampling of every scattering model: directions follow the density, which integrates to the sampled fraction, and
//! weights are value over density.

mod bsdf_common;

use bsdf_common::*;
use lichtweg::bsdf::Mode;
use lichtweg_montecarlo::hypothesis::sidak;

/// Chi-squared and mass tests of one family of models with 10^6 samples each, at significance 0.01 over those of all families
/// together (Sidak).
fn directions_follow_their_density(family: &str) {
    let cases = cases();
    let level = sidak(0.01, cases.iter().map(|c| directions(&c.bsdf).len()).sum());
    let members: Vec<_> = cases.iter().filter(|c| c.name.starts_with(family)).collect();
    assert!(!members.is_empty());
    let mut failures = Vec::new();
    for case in members {
        for (seed, wo) in (1..).zip(directions(&case.bsdf)) {
            match density_report(&case.bsdf, wo, seed, 1_000_000) {
                Ok(report) if !report.rejects(level) => {}
                Ok(report) => failures.push(format!("{} {wo:?}: {report}", case.name)),
                Err(error) => failures.push(format!("{} {wo:?}: {error}", case.name)),
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

macro_rules! families {
    ($($test:ident: $family:literal;)+) => {
        $(#[test]
        fn $test() {
            directions_follow_their_density($family);
        })+

        #[test]
        fn no_model_is_left_out() {
            assert!(cases().iter().all(|case| [$($family),+].iter().any(|f| case.name.starts_with(f))));
        }
    };
}
families! {
    diffuse_directions: "diffuse";
    ggx_conductor_directions: "roughconductor_ggx";
    beckmann_conductor_directions: "roughconductor_beckmann";
    ggx_dielectric_directions: "roughdielectric_ggx";
    beckmann_dielectric_directions: "roughdielectric_beckmann";
    smooth_plastic_directions: "plastic";
    rough_plastic_directions: "roughplastic";
}

#[test]
fn samples_carry_their_density_and_weight() {
    let mut failures = Vec::new();
    for case in cases() {
        for wo in directions(&case.bsdf) {
            for mode in [Mode::Radiance, Mode::Importance] {
                if let Err(error) = check_samples(&case.bsdf, wo, mode) {
                    failures.push(format!("{}: {error}", case.name));
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
