//! Emitters that are no shape (Mitsuba 3 `src/emitters/*.cpp`), and the area light inside of a shape.

use std::sync::Arc;

use lichtweg::scene::description::{
    AreaLightDescription, Diagnostic, EmissionScale, EnvironmentMapping, LightDescription, LightKind,
    SpotFalloff, TextureInput,
};
use lichtweg_ray::math::{Affine, Vec3};

use super::assets::{Asset, Place, Target};
use super::texture::no_image;
use super::translate::Translator;
use super::tree::{Object, ObjectId};

const KNOWN: [&str; 6] = ["area", "point", "spot", "directional", "constant", "envmap"];

impl<'a> Translator<'a> {
    /// Translates an emitter that stands by itself.
    pub fn light(&mut self, id: ObjectId) {
        self.nested(id, |this, object| {
            let kind = this.light_kind(object);
            let scale = if object.plugin == "envmap" {
                this.float_in(object, "scale", 1.0, "at least 0", |v| v >= 0.0)
            } else {
                1.0
            };
            object.ignore(&["sampling_weight"]);
            this.refuse_unknown(object);
            if let Some(kind) = kind {
                let (name, span) = (object.id.clone(), object.plugin_span);
                this.description.lights.push(LightDescription { name, span, kind, scale });
            }
        });
    }

    fn light_kind(&mut self, object: &'a Object) -> Option<LightKind> {
        match object.plugin.as_str() {
            "point" => Some(self.point_light(object)),
            "spot" => Some(self.spot_light(object)),
            "directional" => Some(self.directional_light(object)),
            "constant" => {
                object.ignore(&["to_world"]);
                Some(LightKind::Constant { radiance: self.emission(object, "radiance") })
            }
            "envmap" => self.environment(object),
            "area" => {
                object.properties.iter().for_each(|p| p.queried.set(true));
                let message = "an area light belongs into a shape";
                self.error("misplaced-object", message, object.plugin_span);
                None
            }
            _ => {
                self.unknown_plugin(object, &KNOWN, "the emitter is left out");
                None
            }
        }
    }

    fn point_light(&mut self, object: &'a Object) -> LightKind {
        let position = self.vector(object, "position");
        let to_world = self.transform(object, "to_world");
        self.only_one(object, "position", position.is_some(), "to_world", to_world.is_some());
        let position = match (position, to_world) {
            (Some([x, y, z]), _) => Vec3::new(x as f32, y as f32, z as f32),
            (None, Some(t)) => t.point(Vec3::ZERO),
            (None, None) => Vec3::ZERO,
        };
        LightKind::Point { position, intensity: self.emission(object, "intensity") }
    }

    fn spot_light(&mut self, object: &'a Object) -> LightKind {
        let cutoff = self
            .float_in(object, "cutoff_angle", 20.0, "between 0 and 180 degrees", |v| v > 0.0 && v < 180.0);
        let range = format!("at least 0 and less than the cutoff angle, {cutoff}");
        let beam_width =
            self.float_in(object, "beam_width", 0.75 * cutoff, &range, |v| v >= 0.0 && v < cutoff);
        if object.property("texture").is_some() {
            let message = "textures on spot lights are not supported";
            let diagnostic =
                Diagnostic::error("unsupported-value", message).at(object.span_of("texture"), "");
            self.diagnostics.unsupported(diagnostic, "the light has no texture");
        }
        LightKind::Spot {
            to_world: self.invertible(object, "to_world"),
            intensity: self.emission(object, "intensity"),
            cutoff,
            beam_width,
            falloff: SpotFalloff::LinearAngle,
        }
    }

    fn directional_light(&mut self, object: &'a Object) -> LightKind {
        let direction = self.vector(object, "direction");
        let to_world = self.invertible(object, "to_world");
        self.only_one(object, "direction", direction.is_some(), "to_world", to_world != Affine::IDENTITY);
        let direction = match direction {
            Some([x, y, z]) => Vec3::new(x as f32, y as f32, z as f32),
            None => to_world.vector(Vec3::Z),
        };
        if direction.try_normalized().is_none() {
            self.error("out-of-range", "a direction must not be zero", object.span_of("direction"));
        }
        LightKind::Directional { direction, irradiance: self.emission(object, "irradiance") }
    }

    fn environment(&mut self, object: &'a Object) -> Option<LightKind> {
        // How it is sampled changes the noise, not the image; `gamma` and `cache` are of Mitsuba 0.x.
        object.ignore(&["mis_compensation", "gamma", "cache"]);
        object.ignore(&["scale", "sampling_weight"]);
        let to_world = self.invertible(object, "to_world");
        let (path, span) = self.image_file(object)?;
        let place = Place::Light(self.description.lights.len());
        self.assets.request(Asset::Image { path }, Target { place, span });
        Some(LightKind::Environment {
            image: Arc::new(no_image()),
            mapping: EnvironmentMapping::LatitudeLongitude,
            to_world,
        })
    }

    /// The area light inside of a shape; `None` where it is none.
    pub fn area_light(&mut self, object: &'a Object) -> Option<AreaLightDescription> {
        if object.plugin != "area" {
            if KNOWN.contains(&object.plugin.as_str()) {
                object.properties.iter().for_each(|p| p.queried.set(true));
                let message = format!("the emitter \"{}\" cannot be inside of a shape", object.plugin);
                let diagnostic = Diagnostic::error("misplaced-object", message).at(object.plugin_span, "");
                self.diagnostics.unsupported(diagnostic, "the shape emits nothing");
            } else {
                self.unknown_plugin(object, &["area"], "the shape emits nothing");
            }
            return None;
        }
        object.ignore(&["sampling_weight"]);
        // The area lights of Mitsuba 0.3 had an intensity.
        let given = |name: &str| object.properties.iter().any(|p| p.name == name);
        let old = object.legacy && given("intensity") && !given("radiance");
        let name = if old { "intensity" } else { "radiance" };
        let radiance = self.texture_parameter(object, name, TextureInput::number(1.0));
        if let TextureInput::Constant(spectrum) = &radiance {
            self.refuse_negative(object, name, spectrum);
        }
        self.refuse_unknown(object);
        Some(AreaLightDescription {
            span: object.plugin_span,
            radiance,
            two_sided: false,
            scale: EmissionScale::Factor(1.0),
        })
    }

    fn only_one(&mut self, object: &'a Object, one: &str, has_one: bool, other: &str, has_other: bool) {
        if has_one && has_other {
            let message = format!("both \"{one}\" and \"{other}\" are given");
            self.error("contradiction", message, object.span_of(one));
        }
    }
}
