//! BSDFs (Mitsuba 3 `src/bsdfs/*.cpp`).

use lichtweg::scene::description::{
    ConductorQuantity, Diagnostic, MaterialDescription, MaterialId, MaterialKind, RoughnessDescription, Span,
    SpectrumDescription, TextureInput,
};

use super::ior::CONDUCTORS;
use super::number::shortened;
use super::suggest::hint;
use super::translate::Translator;
use super::tree::{Class, Object, ObjectId};

const KNOWN: [&str; 12] = [
    "diffuse",
    "dielectric",
    "thindielectric",
    "roughdielectric",
    "conductor",
    "roughconductor",
    "plastic",
    "roughplastic",
    "twosided",
    "mask",
    "bumpmap",
    "normalmap",
];

impl<'a> Translator<'a> {
    /// The material of a BSDF object, made once; the default material where it is wrong.
    pub fn material(&mut self, id: ObjectId) -> MaterialId {
        if let Some(&known) = self.materials.get(&id) {
            return known;
        }
        let made = self.nested(id, |this, object| this.make_material(object));
        let material = made.unwrap_or_else(|| self.grey());
        self.materials.insert(id, material);
        material
    }

    /// What shapes without a BSDF are made of: Mitsuba's diffuse with an albedo of 1/2.
    pub fn grey(&mut self) -> MaterialId {
        if let Some(known) = self.default_material {
            return known;
        }
        let kind = MaterialKind::Diffuse { reflectance: TextureInput::number(0.5) };
        let made =
            self.description.add_material(MaterialDescription { name: None, span: Span::default(), kind });
        self.default_material = Some(made);
        made
    }

    fn make_material(&mut self, object: &'a Object) -> MaterialId {
        let kind = match object.plugin.as_str() {
            "diffuse" => Some(self.diffuse(object)),
            "dielectric" => Some(self.dielectric(object, None)),
            "roughdielectric" => {
                let roughness = self.roughness(object);
                Some(self.dielectric(object, Some(roughness)))
            }
            "thindielectric" => Some(MaterialKind::ThinDielectric {
                eta: self.relative_ior(object, "bk7"),
                specular_reflectance: self.reflectance(object, "specular_reflectance", 1.0),
                specular_transmittance: self.reflectance(object, "specular_transmittance", 1.0),
            }),
            "conductor" => Some(self.conductor(object, None)),
            "roughconductor" => {
                let roughness = self.roughness(object);
                Some(self.conductor(object, Some(roughness)))
            }
            "plastic" => Some(self.plastic(object, None)),
            "roughplastic" => {
                let roughness = self.roughness(object);
                Some(self.plastic(object, Some(roughness)))
            }
            "twosided" => self.two_sided(object),
            "mask" => self.mask(object),
            "bumpmap" => self.bump_map(object),
            "normalmap" => self.normal_map(object),
            _ => {
                self.unknown_plugin(object, &KNOWN, "a grey diffuse material is used instead");
                None
            }
        };
        self.refuse_unknown(object);
        let Some(kind) = kind else { return self.grey() };
        let (name, span) = (object.id.clone(), object.plugin_span);
        self.description.add_material(MaterialDescription { name, span, kind })
    }

    fn diffuse(&mut self, object: &'a Object) -> MaterialKind {
        let given = |name: &str| object.properties.iter().any(|p| p.name == name);
        let old = object.legacy && given("diffuse_reflectance") && !given("reflectance");
        object.ignore(&["reflectance"]);
        let name = if old { "diffuse_reflectance" } else { "reflectance" };
        MaterialKind::Diffuse { reflectance: self.reflectance(object, name, 0.5) }
    }

    fn dielectric(&mut self, object: &'a Object, roughness: Option<RoughnessDescription>) -> MaterialKind {
        MaterialKind::Dielectric {
            eta: self.relative_ior(object, "bk7"),
            roughness,
            specular_reflectance: self.reflectance(object, "specular_reflectance", 1.0),
            specular_transmittance: self.reflectance(object, "specular_transmittance", 1.0),
        }
    }

    fn plastic(&mut self, object: &'a Object, roughness: Option<RoughnessDescription>) -> MaterialKind {
        MaterialKind::Plastic {
            eta: self.relative_ior(object, "polypropylene"),
            diffuse_reflectance: self.reflectance(object, "diffuse_reflectance", 0.5),
            specular_reflectance: self.reflectance(object, "specular_reflectance", 1.0),
            roughness,
            nonlinear: self.boolean(object, "nonlinear", false),
        }
    }

    fn conductor(&mut self, object: &'a Object, roughness: Option<RoughnessDescription>) -> MaterialKind {
        let (eta, k) = self.complex_ior(object);
        if object.legacy && (self.ior(object, "ext_eta", "air") - 1.0).abs() > 0.01 {
            let message = "conductors in another medium than air are not supported";
            let diagnostic =
                Diagnostic::error("unsupported-value", message).at(object.span_of("ext_eta"), "");
            self.diagnostics.unsupported(diagnostic, "air is used instead");
        }
        let specular_reflectance = self.reflectance(object, "specular_reflectance", 1.0);
        MaterialKind::Conductor { eta, k, roughness, specular_reflectance }
    }

    /// `eta` and `k`, or those of a `material`. Without either, Mitsuba 3 has a perfect mirror, and Mitsuba 0.6 copper.
    fn complex_ior(&mut self, object: &'a Object) -> (TextureInput, TextureInput) {
        let given = |name: &str| object.properties.iter().any(|p| p.name == name);
        let own = given("eta") || given("k");
        let material = self.text(object, "material");
        if let (true, Some((name, span))) = (own, material)
            && name != "none"
        {
            self.error("contradiction", "both \"material\" and \"eta\" or \"k\" are given", span);
        }
        let preset = match material {
            Some(("none", _)) => None,
            Some((name, _)) if CONDUCTORS.contains(&name) => Some(name),
            Some((name, span)) => {
                let message = format!("no conductor is known as '{}'", shortened(name));
                let mut diagnostic = Diagnostic::error("unknown-value", message).at(span, "");
                diagnostic.help.extend(hint(name, "known", &CONDUCTORS));
                self.diagnostics.push(diagnostic);
                None
            }
            None => (object.legacy && !own).then_some("Cu"),
        };
        if let (false, Some(name)) = (own, preset) {
            let of = |quantity| {
                TextureInput::Constant(SpectrumDescription::Conductor { name: name.to_owned(), quantity })
            };
            return (of(ConductorQuantity::Eta), of(ConductorQuantity::K));
        }
        let eta = self.texture_parameter(object, "eta", TextureInput::number(0.0));
        let k = self.texture_parameter(object, "k", TextureInput::number(1.0));
        for (name, input) in [("eta", &eta), ("k", &k)] {
            if let TextureInput::Constant(spectrum) = input {
                self.refuse_negative(object, name, spectrum);
            }
        }
        (eta, k)
    }

    fn two_sided(&mut self, object: &'a Object) -> Option<MaterialKind> {
        let nested = self.nested_of(object, Class::Bsdf);
        if !(1..=2).contains(&nested.len()) {
            let message = format!("the bsdf \"twosided\" takes one or two bsdfs, and has {}", nested.len());
            self.error("wrong-nesting", message, object.plugin_span);
            return None;
        }
        let sides: Vec<MaterialId> = nested.iter().map(|(id, _)| self.material(*id)).collect();
        for (side, (_, span)) in sides.iter().zip(&nested) {
            use MaterialKind::{Dielectric, Mask, ThinDielectric};
            let kind = &self.description.materials[side.0 as usize].kind;
            if matches!(kind, Dielectric { .. } | ThinDielectric { .. } | Mask { .. }) {
                let message = "a material that lets light through has two sides already";
                let diagnostic = Diagnostic::error("wrong-nesting", message).at(*span, "");
                self.diagnostics.unsupported(
                    diagnostic.help("take it out of the \"twosided\""),
                    "a grey diffuse material is used instead",
                );
                return None;
            }
        }
        Some(MaterialKind::TwoSided { front: sides[0], back: *sides.last().unwrap_or(&sides[0]) })
    }

    /// The one BSDF inside of another.
    fn inner(&mut self, object: &'a Object) -> Option<MaterialId> {
        let Some(id) = self.single(object, Class::Bsdf) else {
            let message = format!("the bsdf \"{}\" needs a bsdf inside of it", object.plugin);
            self.error("wrong-nesting", message, object.plugin_span);
            return None;
        };
        Some(self.material(id))
    }

    fn mask(&mut self, object: &'a Object) -> Option<MaterialKind> {
        let opacity = self.reflectance(object, "opacity", 0.5);
        Some(MaterialKind::Mask { opacity, nested: self.inner(object)? })
    }

    fn bump_map(&mut self, object: &'a Object) -> Option<MaterialKind> {
        let scale = self.float(object, "scale", 1.0);
        let height = self.map(object, "bump_texture")?;
        Some(MaterialKind::Bump { height, scale, nested: self.inner(object)? })
    }

    fn normal_map(&mut self, object: &'a Object) -> Option<MaterialKind> {
        let normals = self.map(object, "normalmap")?;
        Some(MaterialKind::NormalMap { normals, nested: self.inner(object)? })
    }

    /// The texture inside of a bump or normal map, under whatever name.
    fn map(
        &mut self,
        object: &'a Object,
        name: &'static str,
    ) -> Option<lichtweg::scene::description::TextureId> {
        object.asked.borrow_mut().push(name);
        let Some(id) = self.single(object, Class::Texture) else {
            let message = format!("the bsdf \"{}\" needs a texture inside of it", object.plugin);
            self.error("wrong-nesting", message, object.plugin_span);
            object.properties.iter().for_each(|p| p.queried.set(true));
            return None;
        };
        self.texture_id(id)
    }
}
