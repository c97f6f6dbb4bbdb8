//! The sampler and the integrator.
//!
//! `independent` stays what it is; every other sampler of pbrt is a stratified one, for which Sobol' points stand. pbrt counts
//! bounces, the description path edges: its `maxdepth` d is d + 1 here. Russian roulette may end a path of pbrt at
//! its second vertex (`cpu/integrators.cpp`), but none of `bdpt`, whose edges are counted alike.
//!
//! Light samplers: `uniform` and `power` are what they say. `bvh`, pbrt's default, leaves the choice to the program: by place where
//! lights are many. `exhaustive` looks at every light, for which the tree stands, with the same importances.
//!
//! Limits: media are reported where they are stated, so that `volpath` is `path`.

use lichtweg::scene::description::{
    Diagnostic, EstimatorKind, IntegratorDescription, LightChoiceKind, LightStrategy, RouletteDescription,
    SamplerDescription,
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

/// What pbrt's light samplers are here; its default comes first.
const LIGHT_SAMPLERS: [(&str, LightChoiceKind); 4] = [
    ("bvh", LightChoiceKind::Auto),
    ("uniform", LightChoiceKind::Uniform),
    ("power", LightChoiceKind::Power),
    ("exhaustive", LightChoiceKind::Tree),
];

/// Reports a switch that is on and has no counterpart.
fn refuse(entity: &Entity, name: &'static str, text: &str, substitute: &str, report: &mut Report) {
    if entity.params.bool(name, false, report)
        && let Some(param) = entity.params.find(name, Type::Bool)
    {
        let diagnostic = Diagnostic::error("unsupported", text).at(param.span, "this setting");
        report.substitute(diagnostic, substitute);
    }
}

fn refuse_regularization(entity: &Entity, report: &mut Report) {
    refuse(entity, "regularize", "regularization is not supported", "materials stay as they are", report);
}

fn integrator(entity: &Entity, report: &mut Report) -> IntegratorDescription {
    const UNSUPPORTED: [&str; 8] =
        ["ambientocclusion", "ao", "function", "mlt", "randomwalk", "simplevolpath", "sppm", "specular"];
    let params = &entity.params;
    let mut estimator = EstimatorKind::Path;
    let mut light = LightStrategy::Mis;
    let mut light_choice = LightChoiceKind::Auto;
    let mut start_depth = Some(2);
    match entity.kind.as_str() {
        "path" | "volpath" => {
            light_choice = params.choice("lightsampler", &LIGHT_SAMPLERS, report);
            refuse_regularization(entity, report);
        }
        "bdpt" => {
            estimator = EstimatorKind::Bidirectional;
            start_depth = None;
            refuse_regularization(entity, report);
            for setting in ["visualizestrategies", "visualizeweights"] {
                let text = "a render writes no images of strategies; the command \"pyramid\" does";
                refuse(entity, setting, text, "the image alone is written", report);
            }
        }
        "lightpath" => estimator = EstimatorKind::Light,
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
                let known =
                    UNSUPPORTED.into_iter().chain(["bdpt", "lightpath", "path", "simplepath", "volpath"]);
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
        estimator,
        light,
        light_choice,
        max_depth: Some(bounces as u32 + 1),
        roulette: RouletteDescription { start_depth },
        ..IntegratorDescription::default()
    }
}
