//! Materials (`materials.cpp`, `materials.h`).
//!
//! Diffuse materials and conductors of pbrt reflect on both sides. Facets have the distribution of Trowbridge and
//! Reitz; a roughness with alpha below 1e-3 is smooth. A conductor of `reflectance` r has eta = 1 and
//! k = 2 sqrt(r / (1 - r)), which reflects r at normal incidence.
//!
//! Limits: no layers, no subsurface scattering, no hair, no measured materials, no mixtures; dielectrics do not
//! disperse.

use lichtweg::scene::description::{
    ConductorQuantity, Diagnostic, MaterialDescription, MaterialId, MaterialKind, MicrofacetKind,
    RoughnessDescription, SpectrumDescription, TextureFilter, TextureId, TextureInput, TextureKind,
    UvTransform, WrapMode,
};

use super::build::Builder;
use super::params::{Params, Type};
use super::report::suggest;
use super::spectrum::Use;
use super::state::{Entity, MaterialChoice, MaterialStatement};

/// Sodium's D line, where indices of refraction are usually stated; in nanometres.
const D_LINE: f32 = 589.3;
/// pbrt's `TrowbridgeReitzDistribution::EffectivelySmooth`.
const SMOOTH_ALPHA: f32 = 1e-3;
/// Substitute for what is not supported.
const DIFFUSE: &str = "a diffuse material with its reflectance is used";

/// A material and what of it remains where it has holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum MaskKey {
    /// Bits of a constant opacity.
    Constant(MaterialId, u32),
    /// A textured opacity.
    Texture(MaterialId, TextureId),
}

/// Builds all materials.
pub(super) fn build_all(builder: &mut Builder) {
    let statements = std::mem::take(&mut builder.materials);
    for statement in &statements {
        let material = builder.material(statement);
        builder.built_materials.push(material);
    }
    builder.materials = statements;
}

impl Builder<'_> {
    /// The material of a shape; `None` where there is no surface.
    pub fn chosen_material(&mut self, choice: &MaterialChoice) -> Option<MaterialId> {
        match choice {
            MaterialChoice::Default => Some(self.default_material()),
            MaterialChoice::Index(index) => self.built_materials[*index],
            MaterialChoice::Named(name, span) => {
                if let Some(index) = self.named_materials.get(&**name) {
                    return self.built_materials[*index];
                }
                if self.missing_materials.insert(name.clone()) {
                    let diagnostic =
                        Diagnostic::error("unknown-name", format!("there is no material \"{name}\""))
                            .at(*span, "never defined");
                    let known = self.named_materials.keys().map(String::as_str);
                    self.report
                        .substitute(suggest(diagnostic, name, known), "a grey diffuse material is used");
                }
                Some(self.default_material())
            }
        }
    }

    fn default_material(&mut self) -> MaterialId {
        if let Some(id) = self.default_material {
            return id;
        }
        let none = Entity::default();
        let inner =
            self.add_material(None, &none, MaterialKind::Diffuse { reflectance: TextureInput::number(0.5) });
        let id = self.two_sided(None, &none, inner);
        self.default_material = Some(id);
        id
    }

    /// The material with an opacity.
    pub fn masked(&mut self, nested: MaterialId, opacity: TextureInput) -> MaterialId {
        let key = match &opacity {
            TextureInput::Constant(SpectrumDescription::Constant(v)) => {
                MaskKey::Constant(nested, v.to_bits())
            }
            TextureInput::Texture(id) => MaskKey::Texture(nested, *id),
            TextureInput::Constant(_) => return nested,
        };
        if let Some(id) = self.masks.get(&key) {
            return *id;
        }
        let span = self.scene.materials[nested.0 as usize].span;
        let kind = MaterialKind::Mask { opacity, nested };
        let id = self.scene.add_material(MaterialDescription { name: None, span, kind });
        self.masks.insert(key, id);
        id
    }

    /// A surface that reflects nothing, for lights without a material.
    pub fn black(&mut self) -> MaterialId {
        self.add_material(
            None,
            &Entity::default(),
            MaterialKind::Diffuse { reflectance: TextureInput::number(0.0) },
        )
    }

    fn add_material(&mut self, name: Option<&str>, entity: &Entity, kind: MaterialKind) -> MaterialId {
        let name = name.map(str::to_owned);
        self.scene.add_material(MaterialDescription { name, span: entity.span, kind })
    }

    fn two_sided(&mut self, name: Option<&str>, entity: &Entity, inner: MaterialId) -> MaterialId {
        self.add_material(name, entity, MaterialKind::TwoSided { front: inner, back: inner })
    }

    fn material(&mut self, statement: &MaterialStatement) -> Option<MaterialId> {
        let entity = &statement.entity;
        let params = &entity.params;
        params.accept("type", Type::String);
        let kind = match entity.kind.as_str() {
            "" | "interface" | "none" => {
                params.report_unused(&entity.title(), &mut self.report);
                return None;
            }
            "diffuse" => {
                let reflectance = self.spectrum_input(params, "reflectance", Use::Albedo);
                MaterialKind::Diffuse { reflectance: reflectance.unwrap_or(TextureInput::number(0.5)) }
            }
            "dielectric" => MaterialKind::Dielectric {
                eta: self.index_of_refraction(params),
                roughness: self.roughness(params),
                specular_reflectance: TextureInput::number(1.0),
                specular_transmittance: TextureInput::number(1.0),
            },
            "thindielectric" => MaterialKind::ThinDielectric {
                eta: self.index_of_refraction(params),
                specular_reflectance: TextureInput::number(1.0),
                specular_transmittance: TextureInput::number(1.0),
            },
            "conductor" => self.conductor(entity),
            other => self.substitute(entity, other),
        };
        let both_sides = matches!(kind, MaterialKind::Diffuse { .. } | MaterialKind::Conductor { .. });
        let mut id = self.add_material(None, entity, kind);
        if both_sides {
            id = self.two_sided(None, entity, id);
        }
        id = self.tilted(entity, id);
        self.scene.materials[id.0 as usize].name = statement.name.clone();
        params.report_unused(&entity.title(), &mut self.report);
        Some(id)
    }

    /// What stands for a material that is not supported.
    fn substitute(&mut self, entity: &Entity, kind: &str) -> MaterialKind {
        const UNSUPPORTED: [&str; 7] = [
            "coatedconductor",
            "coateddiffuse",
            "diffusetransmission",
            "hair",
            "measured",
            "mix",
            "subsurface",
        ];
        const SUPPORTED: [&str; 5] = ["conductor", "dielectric", "diffuse", "interface", "thindielectric"];
        const OLD: [(&str, &str); 10] = [
            ("glass", "dielectric"),
            ("kdsubsurface", "subsurface"),
            ("matte", "diffuse"),
            ("metal", "conductor"),
            ("mirror", "conductor"),
            ("plastic", "coateddiffuse"),
            ("substrate", "coateddiffuse"),
            ("translucent", "diffusetransmission"),
            ("uber", "coateddiffuse"),
            ("fourier", "measured"),
        ];
        if UNSUPPORTED.contains(&kind) {
            let text = format!("{kind} materials are not supported");
            let diagnostic = Diagnostic::error("unsupported", text).at(entity.span, "this material");
            self.report.substitute(diagnostic, DIFFUSE);
        } else {
            let diagnostic = Diagnostic::error("unknown-type", format!("\"{kind}\" is no type of material"))
                .at(entity.span, "unknown material");
            self.report.substitute(
                match OLD.iter().find(|(old, _)| *old == kind) {
                    Some((_, new)) => diagnostic
                        .help(format!("this is a material of pbrt-v3; in pbrt-v4 it is called \"{new}\"")),
                    None => suggest(diagnostic, kind, SUPPORTED.into_iter().chain(UNSUPPORTED)),
                },
                DIFFUSE,
            );
        }
        let reflectance = self.spectrum_input(&entity.params, "reflectance", Use::Albedo);
        entity.params.accept_all();
        MaterialKind::Diffuse { reflectance: reflectance.unwrap_or(TextureInput::number(0.5)) }
    }

    fn conductor(&mut self, entity: &Entity) -> MaterialKind {
        let params = &entity.params;
        let roughness = self.roughness(params);
        let mut specular_reflectance = TextureInput::number(1.0);
        let copper = |quantity| {
            TextureInput::Constant(SpectrumDescription::Conductor { name: "Cu".to_owned(), quantity })
        };
        let (eta, k) = match self.spectrum_input(params, "reflectance", Use::Albedo) {
            None => {
                let eta = self.spectrum_input(params, "eta", Use::Property);
                let k = self.spectrum_input(params, "k", Use::Property);
                (
                    eta.unwrap_or_else(|| copper(ConductorQuantity::Eta)),
                    k.unwrap_or_else(|| copper(ConductorQuantity::K)),
                )
            }
            Some(_) if params.has("eta") || params.has("k") => {
                params.find_any("eta", &[Type::Spectrum, Type::Rgb, Type::Texture]);
                params.find_any("k", &[Type::Spectrum, Type::Rgb, Type::Texture]);
                let text = "a conductor has either a \"reflectance\" or \"eta\" and \"k\"";
                self.report.substitute(
                    Diagnostic::error("bad-value", text).at(entity.span, "has both"),
                    "it is taken as copper",
                );
                (copper(ConductorQuantity::Eta), copper(ConductorQuantity::K))
            }
            Some(TextureInput::Constant(reflectance)) => {
                (TextureInput::number(1.0), TextureInput::Constant(absorption(reflectance)))
            }
            Some(texture @ TextureInput::Texture(_)) => {
                let text = "a textured \"reflectance\" of conductors is not supported";
                let diagnostic = Diagnostic::error("unsupported", text).at(entity.span, "this material");
                self.report.substitute(diagnostic, "it reflects the same at all angles");
                specular_reflectance = texture;
                // Reflects everything.
                (TextureInput::number(0.0), TextureInput::number(1.0))
            }
        };
        MaterialKind::Conductor { eta, k, roughness, specular_reflectance }
    }

    /// `None` where the surface is smooth.
    fn roughness(&mut self, params: &Params) -> Option<RoughnessDescription> {
        let both = self.roughness_input(params, "roughness").unwrap_or(TextureInput::number(0.0));
        let alpha_u = self.roughness_input(params, "uroughness").unwrap_or(both.clone());
        let alpha_v = self.roughness_input(params, "vroughness").unwrap_or(both);
        let remap = params.bool("remaproughness", true, &mut self.report);
        let is_smooth = |input: &TextureInput| match input {
            TextureInput::Constant(SpectrumDescription::Constant(r)) => {
                (if remap { r.sqrt() } else { *r }) < SMOOTH_ALPHA
            }
            _ => false,
        };
        let smooth = is_smooth(&alpha_u) && is_smooth(&alpha_v);
        (!smooth).then_some(RoughnessDescription {
            distribution: MicrofacetKind::Ggx,
            alpha_u,
            alpha_v,
            remap,
        })
    }

    fn roughness_input(&mut self, params: &Params, name: &'static str) -> Option<TextureInput> {
        let input = self.float_input(params, name)?;
        if let TextureInput::Constant(SpectrumDescription::Constant(value)) = &input
            && *value < 0.0
        {
            params.float_where(name, 0.0, |v| v >= 0.0, "cannot be negative", &mut self.report);
            return None;
        }
        Some(input)
    }

    /// One index of refraction; of a spectrum, that at the D line.
    fn index_of_refraction(&mut self, params: &Params) -> f32 {
        const DEFAULT: f32 = 1.5;
        let kinds = [Type::Float, Type::Spectrum, Type::Rgb, Type::Texture];
        let Some(param) = params.find_any("eta", &kinds) else { return DEFAULT };
        match param.kind {
            Type::Float => {
                return params.float_where("eta", DEFAULT, |v| v > 0.0, "must be positive", &mut self.report);
            }
            Type::Texture => {
                let diagnostic = Diagnostic::error("unsupported", "a textured \"eta\" is not supported");
                self.report.substitute(diagnostic.at(param.span, "this index"), "it is 1.5 everywhere");
                return DEFAULT;
            }
            _ => {}
        }
        let eta = match self.spectrum_of(param, Use::Property) {
            Some(SpectrumDescription::Constant(eta)) => eta,
            Some(SpectrumDescription::Sampled { wavelengths, values }) => {
                value_at(D_LINE, &wavelengths, &values)
            }
            Some(SpectrumDescription::Rgb([_, g, _])) => g,
            Some(_) => {
                self.report.substitute(
                    param.bad_value("the \"eta\" of a dielectric cannot be that of a metal", "a metal"),
                    "it is 1.5",
                );
                return DEFAULT;
            }
            None => return DEFAULT,
        };
        if eta <= 0.0 {
            self.report.substitute(
                param.bad_value(format!("\"eta\" must be positive, but is {eta}"), "not positive"),
                "it is 1.5",
            );
            return DEFAULT;
        }
        let text = format!("dielectrics do not disperse: the index is {eta} at all wavelengths");
        self.report.push(Diagnostic::note("no-dispersion", text).at(param.values_span, "at 589.3 nm"));
        eta
    }

    /// The material under `displacement` or `normalmap`.
    fn tilted(&mut self, entity: &Entity, nested: MaterialId) -> MaterialId {
        let params = &entity.params;
        let mut id = nested;
        // A constant height tilts nothing.
        if let Some(TextureInput::Texture(height)) = self.float_input(params, "displacement") {
            id = self.add_material(None, entity, MaterialKind::Bump { height, scale: 1.0, nested: id });
        }
        let Some(file) = params.one("normalmap", Type::String, &mut self.report) else { return id };
        if id != nested {
            let text = "a material has either a \"displacement\" or a \"normalmap\"";
            self.report.substitute(
                Diagnostic::error("bad-value", text).at(file.span, "both are stated"),
                "the displacement is used",
            );
            return id;
        }
        let path = self.path(&file.strings()[0]);
        let substitute = "the surface is not tilted";
        if let Some(image) = self.files.image(&path, file, substitute, &mut self.report) {
            let kind = TextureKind::Bitmap {
                image,
                to_uv: UvTransform::default(),
                wrap: WrapMode::Repeat,
                filter: TextureFilter::Bilinear,
                raw: true,
                scale: 1.0,
                invert: false,
            };
            let normals = self.add_texture(None, file.span, kind);
            id = self.add_material(None, entity, MaterialKind::NormalMap { normals, nested: id });
        }
        id
    }
}

/// k = 2 sqrt(r / (1 - r)), at each wavelength.
fn absorption(reflectance: SpectrumDescription) -> SpectrumDescription {
    /// The largest reflectance that still has a k (pbrt's value).
    const MOST: f32 = 0.9999;
    let k = |r: f32| {
        let r = r.clamp(0.0, MOST);
        2.0 * (r / (1.0 - r)).sqrt()
    };
    match reflectance {
        SpectrumDescription::Constant(r) => SpectrumDescription::Constant(k(r)),
        SpectrumDescription::Rgb(rgb) => SpectrumDescription::Rgb(rgb.map(k)),
        SpectrumDescription::Sampled { wavelengths, values } => {
            SpectrumDescription::Sampled { wavelengths, values: values.into_iter().map(k).collect() }
        }
        other => other,
    }
}

/// The linear interpolant of a sampled spectrum.
fn value_at(wavelength: f32, wavelengths: &[f32], values: &[f32]) -> f32 {
    let above = wavelengths.partition_point(|w| *w <= wavelength);
    if above == 0 || above == wavelengths.len() {
        return values[above.min(values.len() - 1)];
    }
    let t = (wavelength - wavelengths[above - 1]) / (wavelengths[above] - wavelengths[above - 1]);
    values[above - 1] + t * (values[above] - values[above - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectance_comes_back_at_normal_incidence() {
        for r in [0.0_f32, 0.2, 0.5, 0.9] {
            let SpectrumDescription::Constant(k) = absorption(SpectrumDescription::Constant(r)) else {
                panic!("a constant stays one")
            };
            // |(1 - n) / (1 + n)|^2 with n = 1 + i k
            assert!((k * k / (4.0 + k * k) - r).abs() < 1e-6);
        }
    }

    #[test]
    fn interpolates() {
        let (w, v) = ([400.0, 500.0, 700.0], [1.0, 2.0, 4.0]);
        for (at, want) in [(300.0, 1.0), (400.0, 1.0), (450.0, 1.5), (600.0, 3.0), (700.0, 4.0), (800.0, 4.0)]
        {
            assert_eq!(value_at(at, &w, &v), want);
        }
    }
}
