//! From descriptions to materials.

use lichtweg_ray::math::Vec2;

use super::{Material, MaterialArena, Roughness};
use crate::bsdf::{RoughTransmittanceTable, fresnel};
use crate::color::Role;
use crate::scene::description::{
    Diagnostic, Diagnostics, MaterialId, MaterialKind, RoughnessDescription, Span, TextureInput,
};
use crate::texture::{Input, TextureArena};

/// Compiles one material, given those before it.
pub(super) struct Compiler<'a> {
    pub arena: &'a MaterialArena,
    pub textures: &'a TextureArena,
    /// Where the material was stated.
    pub span: Span,
    pub diagnostics: &'a mut Diagnostics,
}

impl Compiler<'_> {
    /// `None`, and a diagnostic, where something is wrong with it.
    pub fn material(&mut self, kind: &MaterialKind) -> Option<Material> {
        Some(match kind {
            MaterialKind::Diffuse { reflectance } => {
                Material::Diffuse { reflectance: self.input(reflectance)? }
            }
            MaterialKind::Dielectric { eta, roughness, specular_reflectance, specular_transmittance } => {
                Material::Dielectric {
                    eta: self.index(*eta)?,
                    roughness: self.roughness(roughness.as_ref())?,
                    reflectance: self.input(specular_reflectance)?,
                    transmittance: self.input(specular_transmittance)?,
                }
            }
            MaterialKind::ThinDielectric { eta, specular_reflectance, specular_transmittance } => {
                Material::ThinDielectric {
                    eta: self.index(*eta)?,
                    reflectance: self.input(specular_reflectance)?,
                    transmittance: self.input(specular_transmittance)?,
                }
            }
            MaterialKind::Conductor { eta, k, roughness, specular_reflectance } => Material::Conductor {
                eta: self.input(eta)?,
                k: self.input(k)?,
                roughness: self.roughness(roughness.as_ref())?,
                reflectance: self.input(specular_reflectance)?,
            },
            MaterialKind::Plastic {
                eta,
                diffuse_reflectance,
                specular_reflectance,
                roughness,
                nonlinear,
            } => {
                self.plastic(*eta, diffuse_reflectance, specular_reflectance, roughness.as_ref(), *nonlinear)?
            }
            MaterialKind::TwoSided { front, back } => {
                let (front, back) = (self.nested(*front)?, self.nested(*back)?);
                Material::TwoSided { front, back }
            }
            MaterialKind::Mask { opacity, nested } => {
                Material::Mask { opacity: self.input(opacity)?, nested: self.nested(*nested)? }
            }
            MaterialKind::Bump { height, scale, nested } => Material::Bump {
                height: self.input(&TextureInput::Texture(*height))?,
                scale: *scale,
                nested: self.nested(*nested)?,
            },
            MaterialKind::NormalMap { normals, nested } => Material::NormalMap {
                normals: self.input(&TextureInput::Texture(*normals))?,
                nested: self.nested(*nested)?,
            },
        })
    }

    fn plastic(
        &mut self,
        eta: f32,
        diffuse: &TextureInput,
        specular: &TextureInput,
        roughness: Option<&RoughnessDescription>,
        nonlinear: bool,
    ) -> Option<Material> {
        let eta = self.index(eta)?;
        let (diffuse, specular) = (self.input(diffuse)?, self.input(specular)?);
        let Some(roughness) = self.roughness(roughness)? else {
            let internal_reflectance = fresnel::diffuse_reflectance(1.0 / eta);
            return Some(Material::SmoothPlastic { eta, internal_reflectance, diffuse, specular, nonlinear });
        };
        let (Input::Constant(_), Input::Constant(_)) = (roughness.alpha_u, roughness.alpha_v) else {
            self.fault("textured-plastic-roughness", "the roughness of plastic must be constant");
            return None;
        };
        let facets = roughness.facets(Vec2::ZERO, self.textures);
        let table = Box::new(RoughTransmittanceTable::new(facets, eta));
        Some(Material::RoughPlastic { table, diffuse, specular, nonlinear })
    }

    fn input(&mut self, input: &TextureInput) -> Option<Input> {
        self.textures.input(input, Role::Property, self.span, self.diagnostics)
    }

    /// `Some(None)` is smooth.
    fn roughness(&mut self, roughness: Option<&RoughnessDescription>) -> Option<Option<Roughness>> {
        let Some(r) = roughness else { return Some(None) };
        let (alpha_u, alpha_v) = (self.input(&r.alpha_u)?, self.input(&r.alpha_v)?);
        Some(Some(Roughness { kind: r.distribution, alpha_u, alpha_v, remap: r.remap }))
    }

    fn index(&mut self, eta: f32) -> Option<f32> {
        if eta > 0.0 && eta.is_finite() {
            return Some(eta);
        }
        self.fault("bad-ior", "an index of refraction must be positive");
        None
    }

    fn nested(&mut self, id: MaterialId) -> Option<u32> {
        if (id.0 as usize) < self.arena.len() {
            return Some(id.0);
        }
        self.fault("material-order", "a material wraps one that is not stated before it");
        None
    }

    /// Reports what is wrong with the material.
    pub fn fault(&mut self, code: &'static str, message: &str) {
        self.diagnostics.push(Diagnostic::error(code, message).at(self.span, "in this material"));
    }
}
