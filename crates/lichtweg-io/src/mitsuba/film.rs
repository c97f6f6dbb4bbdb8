//! Films and reconstruction filters (Mitsuba 3 `src/render/film.cpp`, `src/films/hdrfilm.cpp`, `src/rfilters/*.cpp`).

use lichtweg::scene::description::{FilmDescription, FilterDescription, FilterKind};

use super::translate::Translator;
use super::tree::{Class, Object};

/// Largest width and height in pixels.
const LARGEST: i64 = 65_536;

const FILMS: [&str; 2] = ["hdrfilm", "ldrfilm"];
const FILTERS: [&str; 6] = ["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"];

/// Parameters that concern how the image is written, not what is in it.
const OUTPUT_ONLY: [&str; 19] = [
    "file_format",
    "pixel_format",
    "component_format",
    "banner",
    "compensate",
    "sample_border",
    "high_quality_edges",
    "attach_log",
    "gamma",
    "exposure",
    "key",
    "burn",
    "tonemap_method",
    "has_alpha",
    "alpha",
    "variable",
    "digits",
    "channel_names",
    "chromaticities",
];

impl<'a> Translator<'a> {
    /// Translates a sensor's film.
    pub fn film(&mut self, object: &'a Object) {
        let width = self.integer_in(object, "width", 768, 1, LARGEST) as u32;
        let height = self.integer_in(object, "height", 576, 1, LARGEST) as u32;
        let crop = self.crop(object, width, height);
        object.ignore(&OUTPUT_ONLY);
        let annotates = |name: &str| name.starts_with("label[") || name.starts_with("metadata[");
        object.properties.iter().filter(|p| annotates(&p.name)).for_each(|p| p.queried.set(true));
        let filter = match self.single(object, Class::Filter) {
            Some(id) => self.nested(id, |this, object| this.filter(object)).unwrap_or_default(),
            None => FilterDescription::default(),
        };
        if !FILMS.contains(&object.plugin.as_str()) {
            self.unknown_plugin(object, &FILMS, "\"hdrfilm\" is used instead");
        }
        self.refuse_unknown(object);
        self.description.film = FilmDescription {
            span: object.plugin_span,
            width,
            height,
            crop,
            filter,
            ..FilmDescription::default()
        };
    }

    fn crop(&mut self, object: &'a Object, width: u32, height: u32) -> Option<[u32; 4]> {
        let names = ["crop_offset_x", "crop_offset_y", "crop_width", "crop_height"];
        let given = names.into_iter().find(|name| object.properties.iter().any(|p| p.name == *name));
        let x = self.integer_in(object, names[0], 0, 0, LARGEST) as u32;
        let y = self.integer_in(object, names[1], 0, 0, LARGEST) as u32;
        let w = self.integer_in(object, names[2], width.into(), 1, LARGEST) as u32;
        let h = self.integer_in(object, names[3], height.into(), 1, LARGEST) as u32;
        let given = given?;
        if x + w > width || y + h > height {
            let message =
                format!("the crop window {w}x{h} at ({x}, {y}) exceeds the film of {width}x{height}");
            self.error("out-of-range", message, object.span_of(given));
            return None;
        }
        Some([x, y, w, h])
    }

    fn filter(&mut self, object: &'a Object) -> FilterDescription {
        let positive = |v: f32| v > 0.0 && v <= 100.0;
        let range = "greater than 0 and at most 100";
        let filter = match object.plugin.as_str() {
            "box" => {
                FilterDescription::new(FilterKind::Box, self.float_in(object, "radius", 0.5, range, positive))
            }
            "tent" => FilterDescription::new(
                FilterKind::Tent,
                self.float_in(object, "radius", 1.0, range, positive),
            ),
            "gaussian" => {
                let standard_deviation = self.float_in(object, "stddev", 0.5, range, positive);
                let radius = 4.0 * standard_deviation;
                FilterDescription::new(FilterKind::Gaussian { standard_deviation }, radius)
            }
            "mitchell" => {
                let b = self.float(object, "B", 1.0 / 3.0);
                let c = self.float(object, "C", 1.0 / 3.0);
                FilterDescription::new(FilterKind::Mitchell { b, c }, 2.0)
            }
            "catmullrom" => FilterDescription::new(FilterKind::CatmullRom, 2.0),
            "lanczos" => {
                // The window's first zero lies at the radius.
                let lobes = self.integer_in(object, "lobes", 3, 1, 100) as f32;
                FilterDescription::new(FilterKind::Lanczos { lobes }, lobes)
            }
            _ => {
                self.unknown_plugin(object, &FILTERS, "\"gaussian\" is used instead");
                FilterDescription::default()
            }
        };
        self.refuse_unknown(object);
        filter
    }
}
