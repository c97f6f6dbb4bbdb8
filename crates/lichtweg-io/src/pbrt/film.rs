//! The film, its sensor and its filter.
//!
//! pbrt's default sensor (`cie1931`) multiplies radiance by exposure time x ISO / 100, the exposure time being that of the
//! camera's shutter (`film.cpp`, `PixelSensor::Create`; `scene.cpp`, `BasicScene::SetOptions`).
//!
//! Limits: no measured sensors and no white balance; `maxcomponentvalue` is not applied.

use lichtweg::scene::description::{Diagnostic, FilmDescription, FilterDescription, FilterKind};

use super::build::Builder;
use super::params::{Type, Values};
use super::report::{Report, suggest};
use super::state::{Entity, Statements};

/// Largest width and height; more would not fit into memory.
const MOST_PIXELS: f64 = 1e9;

/// Describes the film; the camera's shutter is known.
pub(super) fn build(builder: &mut Builder, statements: &Statements) {
    let filter = match &statements.filter {
        Some(entity) => filter(entity, &mut builder.report),
        None => FilterDescription::new(GAUSSIAN, 1.5),
    };
    let [open, close] = builder.scene.camera.shutter;
    let default = Entity { directive: "Film", kind: "rgb".to_owned(), ..Entity::default() };
    let entity = statements.film.as_ref().unwrap_or(&default);
    builder.scene.film = film(entity, filter, close - open, &mut builder.report);
}

fn film(
    entity: &Entity,
    filter: FilterDescription,
    exposure_time: f32,
    report: &mut Report,
) -> FilmDescription {
    let params = &entity.params;
    match entity.kind.as_str() {
        "rgb" | "gbuffer" => {
            params.accept("coordinatesystem", Type::String);
        }
        "spectral" => {
            let diagnostic = Diagnostic::error("unsupported", "spectral films are not supported");
            report.substitute(diagnostic.at(entity.span, "this film"), "an rgb film is used");
            params.accept("nbuckets", Type::Integer);
            params.accept("lambdamin", Type::Float);
            params.accept("lambdamax", Type::Float);
        }
        other => {
            let diagnostic = Diagnostic::error("unknown-type", format!("\"{other}\" is no type of film"))
                .at(entity.span, "unknown film");
            report.substitute(
                if other == "image" {
                    diagnostic.help("this is a film of pbrt-v3; in pbrt-v4 it is called \"rgb\"")
                } else {
                    suggest(diagnostic, other, ["rgb", "gbuffer", "spectral"])
                },
                "an rgb film is used",
            );
        }
    }
    let width = params.integer("xresolution", 1280, 1, report);
    let height = params.integer("yresolution", 720, 1, report);
    if f64::from(width) * f64::from(height) > MOST_PIXELS {
        let text = format!("the film has {width} x {height} pixels, which are too many");
        report.push(Diagnostic::error("bad-value", text).at(entity.span, "this film"));
    }
    // The name of the image is the job's affair; the diagonal matters to lenses alone.
    params.accept("filename", Type::String);
    params.accept("savefp16", Type::Bool);
    params.accept("diagonal", Type::Float);
    if let Some(param) = params.find("maxcomponentvalue", Type::Float) {
        let text = "pixels are not clamped to \"maxcomponentvalue\"";
        report.push(Diagnostic::note("ignored-parameter", text).at(param.span, "not applied"));
    }
    FilmDescription {
        span: entity.span,
        width: width as u32,
        height: height as u32,
        crop: crop(entity, [width, height], report),
        filter,
        scale: sensor_scale(entity, exposure_time, report),
    }
}

/// Exposure time x ISO / 100, and what else the sensor is asked for.
fn sensor_scale(entity: &Entity, exposure_time: f32, report: &mut Report) -> f32 {
    let params = &entity.params;
    if let Some(sensor) = params.string("sensor", report).filter(|s| *s != "cie1931").map(str::to_owned)
        && let Some(param) = params.find("sensor", Type::String)
    {
        let text = format!("the sensor \"{sensor}\" is not supported");
        let diagnostic = Diagnostic::error("unsupported", text).at(param.values_span, "this sensor");
        report.substitute(diagnostic, "the CIE 1931 observer is used");
    }
    if params.float("whitebalance", 0.0, report) != 0.0
        && let Some(param) = params.find("whitebalance", Type::Float)
    {
        let diagnostic = Diagnostic::error("unsupported", "white balance is not supported");
        report.substitute(diagnostic.at(param.span, "this setting"), "colours are left as they are");
    }
    let iso = params.float_where("iso", 100.0, |v| v > 0.0, "must be positive", report);
    let scale = exposure_time * iso / 100.0;
    params.report_unused(&entity.title(), report);
    scale
}

/// The part to render as `[x, y, width, height]`; `cropwindow` prevails over `pixelbounds`.
fn crop(entity: &Entity, size: [i32; 2], report: &mut Report) -> Option<[u32; 4]> {
    let params = &entity.params;
    let [w, h] = size.map(f64::from);
    let mut bounds: Option<[f64; 4]> = None;
    let mut stated = None;
    if let Some(param) = params.array("pixelbounds", Type::Integer, report) {
        stated = Some(param);
        if let Values::Integers(v) = &param.values
            && let &[x0, x1, y0, y1] = v.as_slice()
        {
            bounds = Some([x0, x1, y0, y1].map(f64::from));
        }
    }
    if let Some(param) = params.array("cropwindow", Type::Float, report) {
        stated = Some(param);
        bounds = None;
        if let &[x0, x1, y0, y1] = param.numbers() {
            // In single precision, as in pbrt.
            let edge = |v: f32, size: i32| f64::from((size as f32 * v.clamp(0.0, 1.0)).ceil());
            let (left, right) = (edge(x0.min(x1), size[0]), edge(x0.max(x1), size[0]));
            let (top, bottom) = (edge(y0.min(y1), size[1]), edge(y0.max(y1), size[1]));
            bounds = Some([left, right, top, bottom]);
        }
    }
    let param = stated?;
    let Some([x0, x1, y0, y1]) = bounds else {
        let text = format!("\"{}\" takes 4 numbers: x from and to, y from and to", param.name);
        report.substitute(param.bad_value(text, "expected 4 numbers"), "the whole image is rendered");
        return None;
    };
    let (x0, x1, y0, y1) = (x0.max(0.0), x1.min(w), y0.max(0.0), y1.min(h));
    if x0 >= x1 || y0 >= y1 {
        report.substitute(
            param.bad_value(format!("\"{}\" leaves nothing of the image", param.name), "empty"),
            "the whole image is rendered",
        );
        return None;
    }
    Some([x0, y0, x1 - x0, y1 - y0].map(|v| v as u32))
}

const GAUSSIAN: FilterKind = FilterKind::Gaussian { standard_deviation: 0.5 };

/// pbrt's filters and their default radii (`filters.cpp`).
fn filter(entity: &Entity, report: &mut Report) -> FilterDescription {
    let params = &entity.params;
    let (kind, radius) = match entity.kind.as_str() {
        "box" => (FilterKind::Box, 0.5),
        "triangle" => (FilterKind::Tent, 2.0),
        "gaussian" => {
            let standard_deviation =
                params.float_where("sigma", 0.5, |v| v > 0.0, "must be positive", report);
            (FilterKind::Gaussian { standard_deviation }, 1.5)
        }
        "mitchell" => {
            let third = 1.0 / 3.0;
            let (b, c) = (params.float("B", third, report), params.float("C", third, report));
            (FilterKind::Mitchell { b, c }, 2.0)
        }
        "sinc" => {
            let lobes = params.float_where("tau", 3.0, |v| v > 0.0, "must be positive", report);
            (FilterKind::Lanczos { lobes }, 4.0)
        }
        other => {
            let known = ["box", "gaussian", "mitchell", "sinc", "triangle"];
            let diagnostic = Diagnostic::error("unknown-type", format!("\"{other}\" is no type of filter"))
                .at(entity.span, "unknown filter");
            report.substitute(suggest(diagnostic, other, known), "a Gaussian filter is used");
            params.accept_all();
            (GAUSSIAN, 1.5)
        }
    };
    let mut side =
        |name| params.float_where(name, radius, |v| v > 0.0 && v <= 64.0, "must be in (0, 64]", report);
    let radius = [side("xradius"), side("yradius")];
    params.report_unused(&entity.title(), report);
    FilterDescription { kind, radius }
}
