//! `lichtweg path`: the paths of one sample, with all their factors.

use std::io::Write;

use clap::Args;
use lichtweg::render::FoundPath;
use lichtweg::transport::VertexKind;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::setup::{Setup, SetupArgs};

const EXAMPLES: &str = "\
Examples:
  lichtweg path scene.xml --pixel 64,64 --sample 3
  lichtweg path scene.xml --pixel 64,64 --json | jq '.paths[0].factors'

A path's estimate is emission x product of G x product of f x response / (density x survival); its share of the image is \
that times its weight times the filter's weight.";

/// Tell the paths of a sample of a pixel: vertices, factors, densities and weights
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct PathArgs {
    #[command(flatten)]
    setup: SetupArgs,

    /// Pixel, from the top left corner
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel)]
    pixel: [u32; 2],

    /// Number of the sample
    #[arg(long, value_name = "N", default_value = "0")]
    sample: u32,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

fn parse_pixel(text: &str) -> Result<[u32; 2], String> {
    let parsed =
        text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    parsed.ok_or_else(|| "expected X,Y in pixels from the top left corner, for example 64,32".to_owned())
}

/// Tells them.
pub fn run(args: &PathArgs) -> Result<(), Failure> {
    args.setup.with(|_| (), |setup| tell(args, &setup))
}

fn tell(args: &PathArgs, setup: &Setup) -> Result<(), Failure> {
    let [width, height] = setup.job.size();
    let [x, y] = args.pixel;
    if x >= width || y >= height {
        return Err(Failure::Usage(format!("--pixel {x},{y}: the image has {width}x{height} pixels")));
    }
    let (paths, filter_weight) = setup.job.paths(&setup.description, &setup.scene, args.pixel, args.sample);
    let mut out = std::io::stdout().lock();
    if args.json {
        let json = json!({
            "pixel": args.pixel,
            "sample": args.sample,
            "seed": setup.description.sampler.seed,
            "filter_weight": filter_weight,
            "paths": paths.iter().map(as_json).collect::<Vec<_>>(),
        });
        writeln!(out, "{json:#}")?;
        return Ok(());
    }
    writeln!(
        out,
        "pixel {x},{y}, sample {}: {} paths, filter weight {filter_weight}",
        args.sample,
        paths.len()
    )?;
    for path in &paths {
        write!(out, "\n{}", as_text(path))?;
    }
    Ok(())
}

fn kind(kind: VertexKind) -> (&'static str, Option<u32>) {
    match kind {
        VertexKind::Light(index) => ("light", Some(index)),
        VertexKind::Surface(index) => ("surface", Some(index)),
        VertexKind::Lens => ("lens", None),
    }
}

fn as_json(found: &FoundPath) -> Value {
    let path = &found.path;
    let vertices: Vec<Value> = path
        .vertices
        .iter()
        .map(|v| {
            let (kind, index) = kind(v.kind);
            json!({
                "kind": kind,
                "index": index,
                "position": v.position.map(|p| p.to_array()),
                "normal": v.normal.map(|n| n.to_array()),
                "single_direction": v.delta,
                "scattering": v.scattering.to_rgb(),
                "pdf_from_light": v.pdf_from_light,
                "pdf_from_eye": v.pdf_from_eye,
            })
        })
        .collect();
    let strategies: Vec<Value> = path
        .strategies
        .iter()
        .enumerate()
        .map(|(s, strategy)| {
            json!({ "s": s, "t": path.vertices.len() - s, "pdf": strategy.pdf, "weight": strategy.weight })
        })
        .collect();
    json!({
        "s": path.s,
        "t": path.t,
        "edges": path.geometry.len(),
        "falls_on": found.place,
        "vertices": vertices,
        "factors": {
            "emission": path.emission.to_rgb(),
            "geometry": path.geometry,
            "response": path.response,
            "survival": path.survival,
        },
        "strategies": strategies,
        "estimate_by_factors": path.estimate(),
        "estimate": found.value,
        "weight": found.weight,
    })
}

fn as_text(found: &FoundPath) -> String {
    let path = &found.path;
    let rgb = |c: [f32; 3]| format!("{:.6} {:.6} {:.6}", c[0], c[1], c[2]);
    let mut out = String::new();
    let mut line = |text: String| {
        out.push_str(&text);
        out.push('\n');
    };
    let place = found.place.map_or("this pixel".to_owned(), |[x, y]| format!("film {x:.2},{y:.2}"));
    line(format!("s = {}, t = {}: {} edges, in {place}", path.s, path.t, path.geometry.len()));
    line(format!(
        "  S = {}    R = {:.6e}    survival = {:.6}",
        rgb(path.emission.to_rgb()),
        path.response,
        path.survival
    ));
    for (i, v) in path.vertices.iter().enumerate() {
        let (kind, index) = kind(v.kind);
        let name = index.map_or(kind.to_owned(), |index| format!("{kind} {index}"));
        let position = v.position.map_or("infinitely far".to_owned(), |p| rgb(p.to_array()));
        let delta = if v.delta { ", single direction" } else { "" };
        line(format!("  x{i} {name} at {position}{delta}"));
        line(format!("     p from light {:.6e}    p from eye {:.6e}", v.pdf_from_light, v.pdf_from_eye));
        if matches!(v.kind, VertexKind::Surface(_)) {
            line(format!("     f = {}", rgb(v.scattering.to_rgb())));
        }
        if let Some(geometry) = path.geometry.get(i) {
            line(format!("     G to x{} = {geometry:.6e}", i + 1));
        }
    }
    for (s, strategy) in path.strategies.iter().enumerate().filter(|(_, strategy)| strategy.pdf > 0.0) {
        let t = path.vertices.len() - s;
        line(format!("  strategy ({s}, {t}): density {:.6e}, weight {:.6}", strategy.pdf, strategy.weight));
    }
    line(format!("  by factors  {}", rgb(path.estimate().map(|v| v as f32))));
    line(format!("  estimate    {} x weight {:.6}", rgb(found.value), found.weight));
    out
}
