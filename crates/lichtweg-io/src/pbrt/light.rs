//! Lights, alone and on shapes (`lights.cpp`).
//!
//! pbrt's factors on an emission of luminance 1, or on an `rgb` as it stands: `scale`, and where they are stated `power` / (4 pi)
//! for a point; `power` over 2 pi (1 - cos start + (cos start - cos end) / 2) for a spot; `illuminance` for a distant
//! light; `illuminance` / pi for a constant environment, and over that of its upper half for an image.
//!
//! Limits: no goniometric and projection lights, no portals, no images on area lights.

use std::f64::consts::PI;

use lichtweg::scene::description::{
    Diagnostic, EnvironmentMapping, LightDescription, LightKind, SpectrumDescription, SpotFalloff,
    TextureInput,
};
use lichtweg_ray::math::{Affine, Vec3};

use super::build::Builder;
use super::octahedral::upward_illuminance;
use super::params::{Params, Type};
use super::report::{Report, suggest};
use super::spectrum::Use;
use super::state::{Entity, LightStatement};

/// What an `AreaLightSource` gives to shapes.
#[derive(Clone, Debug)]
pub(super) struct AreaEmission {
    pub radiance: TextureInput,
    pub scale: f32,
    pub two_sided: bool,
    /// The power that pbrt gives to each shape, and to each triangle of a mesh.
    pub power: Option<f32>,
}

/// Builds the lights that are no shape.
pub(super) fn build_all(builder: &mut Builder, statements: &[LightStatement]) {
    for statement in statements {
        if let Some((kind, scale)) = builder.light(statement) {
            let span = statement.entity.span;
            builder.scene.lights.push(LightDescription { name: None, span, kind, scale });
        }
        statement.entity.params.report_unused(&statement.entity.title(), &mut builder.report);
    }
}

impl Builder<'_> {
    /// A light, and the factor on what it emits.
    fn light(&mut self, statement: &LightStatement) -> Option<(LightKind, f32)> {
        const UNSUPPORTED: [&str; 2] = ["goniometric", "projection"];
        const SUPPORTED: [&str; 4] = ["distant", "infinite", "point", "spot"];
        let entity = &statement.entity;
        match entity.kind.as_str() {
            "point" => Some(self.point(statement)),
            "spot" => self.spot(statement),
            "distant" => self.distant(statement),
            "infinite" => self.infinite(statement),
            known if UNSUPPORTED.contains(&known) => {
                let text = format!("{known} lights are not supported");
                let diagnostic = Diagnostic::error("unsupported", text).at(entity.span, "this light");
                self.report.substitute(diagnostic, "the light is left out");
                entity.params.accept_all();
                None
            }
            other => {
                let diagnostic =
                    Diagnostic::error("unknown-type", format!("\"{other}\" is no type of light"))
                        .at(entity.span, "unknown light");
                self.report.substitute(
                    suggest(diagnostic, other, SUPPORTED.into_iter().chain(UNSUPPORTED)),
                    "the light is left out",
                );
                entity.params.accept_all();
                None
            }
        }
    }

    /// The stated emission, by default white of luminance 1.
    fn emission(&mut self, params: &Params, name: &'static str) -> SpectrumDescription {
        self.spectrum(params, name, Use::Emission).unwrap_or(SpectrumDescription::Rgb([1.0; 3]))
    }

    fn point(&mut self, statement: &LightStatement) -> (LightKind, f32) {
        let params = &statement.entity.params;
        let intensity = self.emission(params, "I");
        let mut scale = scale(params, &mut self.report);
        if let Some(power) = positive(params, "power", &mut self.report) {
            scale *= power / (4.0 * PI) as f32;
        }
        let from = params.triple("from", Type::Point3, [0.0; 3], &mut self.report);
        let position = statement.to_world.point(vec3(from));
        (LightKind::Point { position, intensity }, scale)
    }

    fn spot(&mut self, statement: &LightStatement) -> Option<(LightKind, f32)> {
        let params = &statement.entity.params;
        let report = &mut self.report;
        let in_range = |v: f32| v > 0.0 && v <= 180.0;
        let cutoff = params.float_where("coneangle", 30.0, in_range, "must be in (0, 180] degrees", report);
        let within = |v: f32| (0.0..=cutoff).contains(&v);
        let must = "must be in 0 to \"coneangle\"";
        let delta = params.float_where("conedeltaangle", 5.0_f32.min(cutoff), within, must, report);
        let beam_width = cutoff - delta;
        let (from, to) = from_to(params, report);
        let mut scale = scale(params, report);
        if let Some(power) = positive(params, "power", report) {
            let [start, end] = [beam_width, cutoff].map(|a| f64::from(a).to_radians().cos());
            scale *= power / (2.0 * PI * (1.0 - start + (start - end) / 2.0)) as f32;
        }
        let intensity = self.emission(params, "I");
        let axis: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
        let Some(frame) = frame_about(axis, from) else {
            self.report.substitute(no_direction(&statement.entity), "the light is left out");
            return None;
        };
        let to_world = statement.to_world.after(&frame);
        let falloff = SpotFalloff::SmoothCosine;
        Some((LightKind::Spot { to_world, intensity, cutoff, beam_width, falloff }, scale))
    }

    fn distant(&mut self, statement: &LightStatement) -> Option<(LightKind, f32)> {
        let params = &statement.entity.params;
        let irradiance = self.emission(params, "L");
        let mut scale = scale(params, &mut self.report);
        if let Some(illuminance) = positive(params, "illuminance", &mut self.report) {
            scale *= illuminance;
        }
        let (from, to) = from_to(params, &mut self.report);
        let direction = statement.to_world.vector(vec3(std::array::from_fn(|i| to[i] - from[i])));
        if direction == Vec3::ZERO {
            self.report.substitute(no_direction(&statement.entity), "the light is left out");
            return None;
        }
        Some((LightKind::Directional { direction, irradiance }, scale))
    }

    fn infinite(&mut self, statement: &LightStatement) -> Option<(LightKind, f32)> {
        let params = &statement.entity.params;
        let mut scale = scale(params, &mut self.report);
        let illuminance = positive(params, "illuminance", &mut self.report);
        if let Some(param) = params.find("portal", Type::Point3) {
            let diagnostic = Diagnostic::error("unsupported", "portals are not supported");
            self.report.substitute(diagnostic.at(param.span, "this portal"), "light comes from everywhere");
        }
        let Some(file) = params.one("filename", Type::String, &mut self.report) else {
            let radiance = self.emission(params, "L");
            scale *= illuminance.map_or(1.0, |e| e / PI as f32);
            return Some((LightKind::Constant { radiance }, scale));
        };
        if params.has("L") {
            params.find_any("L", &[Type::Rgb, Type::Spectrum, Type::Blackbody]);
            let text = "an infinite light has either \"L\" or \"filename\"";
            self.report.substitute(
                Diagnostic::error("bad-value", text).at(file.span, "both are stated"),
                "the map is used",
            );
        }
        let path = self.path(&file.strings()[0]);
        let image = self.files.image(&path, file, "the light is left out", &mut self.report)?;
        if image.width != image.height {
            let text =
                format!("the map is {} x {} pixels; pbrt's maps are squares", image.width, image.height);
            let diagnostic = file
                .bad_value(text, "no equal-area octahedral map")
                .help("convert maps by latitude and longitude with pbrt's `imgtool makeequiarea`");
            self.report.substitute(diagnostic, "the light is left out");
            return None;
        }
        if let Some(illuminance) = illuminance {
            scale *= illuminance / upward_illuminance(&image) as f32;
            if !scale.is_finite() {
                let text = "the map has no light from above, and cannot have an illuminance";
                self.report.substitute(file.bad_value(text, "dark above"), "the light is left out");
                return None;
            }
        }
        let mapping = EnvironmentMapping::EqualAreaOctahedral;
        Some((LightKind::Environment { image, mapping, to_world: statement.to_world }, scale))
    }

    /// The light that an `AreaLightSource` gives to shapes; `None` if that is none.
    pub fn area_emission(&mut self, entity: &Entity) -> Option<AreaEmission> {
        let params = &entity.params;
        if entity.kind != "diffuse" {
            let text = format!("\"{}\" is no type of area light", entity.kind);
            let diagnostic = Diagnostic::error("unknown-type", text).at(entity.span, "unknown area light");
            let diagnostic = if entity.kind == "area" {
                diagnostic.help("this is a light of older versions; in pbrt-v4 it is called \"diffuse\"")
            } else {
                suggest(diagnostic, &entity.kind, ["diffuse"])
            };
            self.report.substitute(diagnostic, "the shapes emit nothing");
            params.accept_all();
            return None;
        }
        if let Some(file) = params.find("filename", Type::String) {
            let diagnostic = Diagnostic::error("unsupported", "images on area lights are not supported");
            self.report.substitute(diagnostic.at(file.span, "this image"), "the light is white");
        }
        let emission = AreaEmission {
            radiance: TextureInput::Constant(self.emission(params, "L")),
            scale: scale(params, &mut self.report),
            two_sided: params.bool("twosided", false, &mut self.report),
            power: positive(params, "power", &mut self.report),
        };
        params.report_unused(&entity.title(), &mut self.report);
        Some(emission)
    }
}

fn scale(params: &Params, report: &mut Report) -> f32 {
    params.float_where("scale", 1.0, |v| v >= 0.0, "cannot be negative", report)
}

/// A number that pbrt takes as not stated where it is not positive.
fn positive(params: &Params, name: &'static str, report: &mut Report) -> Option<f32> {
    params.float_if(name, report).filter(|v| *v > 0.0)
}

fn from_to(params: &Params, report: &mut Report) -> ([f64; 3], [f64; 3]) {
    let from = params.triple("from", Type::Point3, [0.0; 3], report);
    (from, params.triple("to", Type::Point3, [0.0, 0.0, 1.0], report))
}

fn no_direction(entity: &Entity) -> Diagnostic {
    Diagnostic::error("bad-value", "the light has no direction: \"from\" and \"to\" are the same")
        .at(entity.span, "this light")
}

/// A rotation of +z to `axis`, then a translation to `origin`; `None` where the axis is zero.
fn frame_about(axis: [f64; 3], origin: [f64; 3]) -> Option<Affine> {
    let target = std::array::from_fn(|i| origin[i] + axis[i]);
    // Any second direction will do that is not parallel to the axis.
    let up = if axis[0].abs() < axis[1].abs() { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    Affine::look_at(origin, target, up)
}

fn vec3(v: [f64; 3]) -> Vec3 {
    Vec3::from_array(v.map(|c| c as f32))
}
