//! The sampler and the integrator.
//!
//! `independent` stays what it is; every other sampler of pbrt is a stratified one, for which Sobol' points stand. pbrt counts
//! bounces, the description path edges: its `maxdepth` d is d + 1 here. Russian roulette may end a path of pbrt at
//! its second vertex (`cpu/integrators.cpp`).
//!
//! Limits: path tracing only; media are reported where they are stated, so that `volpath` is `path`.

use lichtweg::scene::description::{
    Diagnostic, IntegratorDescription, LightStrategy, RouletteDescription, SamplerDescription,
};
use lichtweg_montecarlo::SamplerKind;

use super::build::Builder;
use super::params::Type;
use super::report::{Report, suggest};
use super::state::{Entity, Statements};

/// Describes the sampler and the integrator.
pub(super) fn build(builder: &mut Builder, statements: &Statements) {
    let default = Entity { directive: "Sampler", kind: "zsobol".to_owned(), ..Entity::default() };
    let entity = statements.sampler.as_ref().unwrap_or(&default);
    builder.scene.sampler = sampler(entity, statements.seed, &mut builder.report);
    let default = Entity { directive: "Integrator", kind: "volpath".to_owned(), ..Entity::default() };
    let entity = statements.integrator.as_ref().unwrap_or(&default);
    builder.scene.integrator = integrator(entity, &mut builder.report);
}

fn sampler(entity: &Entity, seed: i64, report: &mut Report) -> SamplerDescription {
    const SOBOL_LIKE: [&str; 6] = ["halton", "paddedsobol", "pmj02bn", "sobol", "stratified", "zsobol"];
    let params = &entity.params;
    let mut kind = SamplerKind::Sobol;
    let mut default_samples = 16;
    match entity.kind.as_str() {
        "independent" => (kind, default_samples) = (SamplerKind::Independent, 4),
        known if SOBOL_LIKE.contains(&known) => {}
        other => {
            let diagnostic = Diagnostic::error("unknown-type", format!("\"{other}\" is no type of sampler"))
                .at(entity.span, "unknown sampler");
            report.substitute(
                match other {
                    "lowdiscrepancy" | "02sequence" | "maxmindist" | "random" => diagnostic
                        .help("this is a sampler of pbrt-v3; pbrt-v4 has \"zsobol\" and \"independent\""),
                    _ => suggest(diagnostic, other, SOBOL_LIKE.into_iter().chain(["independent"])),
                },
                "Sobol' points are used",
            );
            params.accept_all();
        }
    }
    let samples = if entity.kind == "stratified" {
        params.accept("jitter", Type::Bool);
        let side = [params.integer("xsamples", 4, 1, report), params.integer("ysamples", 4, 1, report)];
        side[0].saturating_mul(side[1])
    } else {
        params.integer("pixelsamples", default_samples, 1, report)
    };
    params.accept("randomization", Type::String);
    let seed = i64::from(params.integer("seed", seed.clamp(0, i64::from(i32::MAX)) as i32, i32::MIN, report));
    params.report_unused(&entity.title(), report);
    SamplerDescription { span: entity.span, kind, samples_per_pixel: samples as u32, seed: seed as u64 }
}

fn integrator(entity: &Entity, report: &mut Report) -> IntegratorDescription {
    const UNSUPPORTED: [&str; 10] = [
        "ambientocclusion",
        "ao",
        "bdpt",
        "function",
        "lightpath",
        "mlt",
        "randomwalk",
        "simplevolpath",
        "sppm",
        "specular",
    ];
    let params = &entity.params;
    let mut light = LightStrategy::Mis;
    let mut start_depth = Some(2);
    match entity.kind.as_str() {
        "path" | "volpath" => {
            // How lights are chosen matters to the noise alone.
            params.accept("lightsampler", Type::String);
            if params.bool("regularize", false, report)
                && let Some(param) = params.find("regularize", Type::Bool)
            {
                let diagnostic = Diagnostic::error("unsupported", "regularization is not supported");
                report.substitute(diagnostic.at(param.span, "this setting"), "materials stay as they are");
            }
        }
        "simplepath" => {
            let sample_lights = params.bool("samplelights", true, report);
            light = if sample_lights { LightStrategy::Nee } else { LightStrategy::Naive };
            params.accept("samplebsdf", Type::Bool);
            start_depth = None;
        }
        other => {
            if UNSUPPORTED.contains(&other) {
                let text = format!("the integrator \"{other}\" is not supported");
                let diagnostic = Diagnostic::error("unsupported", text).at(entity.span, "this integrator");
                report.substitute(diagnostic, "the path integrator is used");
            } else {
                let diagnostic =
                    Diagnostic::error("unknown-type", format!("\"{other}\" is no type of integrator"))
                        .at(entity.span, "unknown integrator");
                let known = UNSUPPORTED.into_iter().chain(["path", "simplepath", "volpath"]);
                report.substitute(match other {
                    "directlighting" => diagnostic.help(
                        "this is an integrator of pbrt-v3; in pbrt-v4 it is \"path\" with a maxdepth of 1",
                    ),
                    _ => suggest(diagnostic, other, known),
                }, "the path integrator is used");
            }
            params.accept_all();
        }
    }
    let bounces = params.integer("maxdepth", 5, 0, report);
    params.report_unused(&entity.title(), report);
    IntegratorDescription {
        span: entity.span,
        light,
        max_depth: Some(bounces as u32 + 1),
        roulette: RouletteDescription { start_depth },
        ..IntegratorDescription::default()
    }
}
