//! Sampling of every scattering model: directions follow the density, which integrates to the sampled fraction, and
//! weights are value over density.

mod bsdf_common;

use bsdf_common::*;
use lichtweg::bsdf::Mode;
use lichtweg_montecarlo::hypothesis::sidak;

/// Chi-squared and mass tests with 10^6 samples each, at significance 0.01 over all of them together (Sidak).
#[test]
fn directions_follow_their_density() {
    let cases = cases();
    let level = sidak(0.01, cases.iter().map(|c| directions(&c.bsdf).len()).sum());
    let mut failures = Vec::new();
    for case in &cases {
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
