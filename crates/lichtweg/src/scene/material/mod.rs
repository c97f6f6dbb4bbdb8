//! Materials: from a point on a surface to the [`Bsdf`] there.

mod compile;
mod lobe;
mod scatterer;
mod tangents;

use lichtweg_ray::math::{Vec2, Vec3};

use super::description::{Diagnostics, MaterialDescription};
use super::surface::SurfacePoint;
use crate::bsdf::{
    Bsdf, Diffuse as DiffuseBsdf, Frame, MicrofacetKind, Microfacets, RoughConductor, RoughDielectric,
    RoughPlastic, RoughTransmittanceTable, SmoothConductor, SmoothDielectric, SmoothPlastic, ThinDielectric,
};
use crate::color::Spectrum;
use crate::texture::{Input, TextureArena};

use compile::Compiler;
pub(crate) use lobe::{LobeMaterial, LobeModel};
pub use scatterer::Scatterer;
use tangents::Tangents;

/// All materials of a scene.
#[derive(Debug, Default)]
pub struct MaterialArena {
    materials: Vec<Material>,
    traits: Vec<Traits>,
}

/// What holds for a material and all that it wraps.
#[derive(Clone, Copy, Debug, Default)]
struct Traits {
    /// Whether a surface of it has holes.
    has_holes: bool,
    /// Whether it depends on the surface coordinates or their directions.
    uses_coordinates: bool,
    /// Materials on the way to the innermost one.
    depth: u32,
}

/// Materials may wrap each other this deep.
const MAX_DEPTH: u32 = 64;

#[derive(Debug)]
enum Material {
    Diffuse { reflectance: Input },
    Dielectric { eta: f32, roughness: Option<Roughness>, reflectance: Input, transmittance: Input },
    ThinDielectric { eta: f32, reflectance: Input, transmittance: Input },
    Conductor { eta: Input, k: Input, roughness: Option<Roughness>, reflectance: Input },
    SmoothPlastic { eta: f32, internal_reflectance: f32, diffuse: Input, specular: Input, nonlinear: bool },
    RoughPlastic { table: Box<RoughTransmittanceTable>, diffuse: Input, specular: Input, nonlinear: bool },
    TwoSided { front: u32, back: u32 },
    Mask { opacity: Input, nested: u32 },
    Bump { height: Input, scale: f32, nested: u32 },
    NormalMap { normals: Input, nested: u32 },
}

#[derive(Clone, Copy, Debug)]
struct Roughness {
    kind: MicrofacetKind,
    alpha_u: Input,
    alpha_v: Input,
    remap: bool,
}

impl MaterialArena {
    /// Compiles descriptions. A material may wrap earlier ones only; one that does not is reported.
    pub fn compile(
        descriptions: &[MaterialDescription],
        textures: &TextureArena,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut arena = Self::default();
        for description in descriptions {
            let mut compiler = Compiler { arena: &arena, textures, span: description.span, diagnostics };
            let grey = || Material::Diffuse { reflectance: Input::Constant(Spectrum::splat(0.5)) };
            let mut material = compiler.material(&description.kind).unwrap_or_else(grey);
            let mut traits = compiler.arena.traits_of(&material);
            if traits.depth > MAX_DEPTH {
                compiler.fault("deep-material", &format!("more than {MAX_DEPTH} materials wrap each other"));
                (material, traits) = (grey(), Traits::default());
            }
            arena.materials.push(material);
            arena.traits.push(traits);
        }
        arena
    }

    /// Number of materials.
    pub fn len(&self) -> usize {
        self.materials.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.materials.is_empty()
    }

    /// Whether a surface of this material has holes.
    pub fn has_holes(&self, material: u32) -> bool {
        self.traits[material as usize].has_holes
    }

    /// Whether what a material scatters depends on the surface coordinates or their directions.
    pub fn uses_coordinates(&self, material: u32) -> bool {
        self.traits[material as usize].uses_coordinates
    }

    /// How a material reflects that does nothing but reflect by one lobe, and needs no tangents for it.
    pub(crate) fn lobe(&self, material: u32) -> Option<LobeMaterial> {
        match &self.materials[material as usize] {
            Material::TwoSided { front, back } => {
                let of = |id: &u32| self.materials[*id as usize].lobe();
                LobeMaterial::two_sided(&of(front)?, &of(back)?)
            }
            one => one.lobe(),
        }
    }

    fn traits_of(&self, material: &Material) -> Traits {
        let nested = match *material {
            Material::TwoSided { front, back } => {
                let (a, b) = (self.traits[front as usize], self.traits[back as usize]);
                Traits {
                    has_holes: a.has_holes || b.has_holes,
                    uses_coordinates: a.uses_coordinates || b.uses_coordinates,
                    depth: a.depth.max(b.depth) + 1,
                }
            }
            Material::Mask { nested, .. }
            | Material::Bump { nested, .. }
            | Material::NormalMap { nested, .. } => {
                let inner = self.traits[nested as usize];
                Traits { depth: inner.depth + 1, ..inner }
            }
            _ => Traits::default(),
        };
        Traits {
            has_holes: nested.has_holes || matches!(material, Material::Mask { .. }),
            uses_coordinates: nested.uses_coordinates || material.uses_coordinates(),
            ..nested
        }
    }

    /// The probability in [0, 1] that the surface is there.
    pub fn opacity(&self, material: u32, point: &SurfacePoint, wo: Vec3, textures: &TextureArena) -> f32 {
        match &self.materials[material as usize] {
            Material::Mask { opacity, nested } => {
                let here = textures.eval_number(*opacity, point.uv).clamp(0.0, 1.0);
                here * self.opacity(*nested, point, wo, textures)
            }
            Material::TwoSided { front, back } => {
                let side = if point.shading_normal.dot(wo) > 0.0 { front } else { back };
                self.opacity(*side, point, wo, textures)
            }
            Material::Bump { nested, .. } | Material::NormalMap { nested, .. } => {
                self.opacity(*nested, point, wo, textures)
            }
            _ => 1.0,
        }
    }

    /// What scatters at a point that is looked at from the direction `wo`; `partials` gives the derivatives of the
    /// position with respect to the surface coordinates.
    #[inline]
    pub fn scatterer<'a>(
        &'a self,
        material: u32,
        point: &SurfacePoint,
        wo: Vec3,
        partials: impl Fn() -> Option<[Vec3; 2]>,
        textures: &TextureArena,
    ) -> Scatterer<'a> {
        let mut tangents = Tangents::new(partials);
        let mut normal = point.shading_normal;
        let mut untilted = None;
        let mut mirrored = false;
        let mut id = material;
        loop {
            let material = &self.materials[id as usize];
            match material {
                Material::TwoSided { front, back } => {
                    let seen_from_front = normal.dot(wo) > 0.0;
                    id = if seen_from_front { *front } else { *back };
                    // Tilting maps inside see the surface as their front side, too.
                    if !seen_from_front {
                        normal = -normal;
                        mirrored = !mirrored;
                    }
                }
                Material::Mask { nested, .. } => id = *nested,
                Material::Bump { height, scale, nested } => {
                    untilted.get_or_insert(normal);
                    normal = tangents.bump(normal, textures.gradient(*height, point.uv) * *scale);
                    id = *nested;
                }
                Material::NormalMap { normals, nested } => {
                    untilted.get_or_insert(normal);
                    let local = textures.eval(*normals, point.uv).to_rgb().map(|c| 2.0 * c - 1.0);
                    let tilted = tangents.frame(normal).to_world(Vec3::from_array(local));
                    normal = tilted.try_normalized().unwrap_or(normal);
                    id = *nested;
                }
                leaf => {
                    let bsdf = leaf.bsdf(point.uv, textures);
                    let frame = if leaf.is_anisotropic() {
                        tangents.frame(normal)
                    } else {
                        Frame::from_normal(normal)
                    };
                    let bitangent = if mirrored { -frame.bitangent } else { frame.bitangent };
                    return Scatterer { frame: Frame { bitangent, ..frame }, bsdf, untilted };
                }
            }
        }
    }
}

impl Material {
    /// Whether the material itself, whatever it wraps, depends on the surface coordinates or their directions.
    fn uses_coordinates(&self) -> bool {
        let textured = |inputs: &[Input]| inputs.iter().any(|i| matches!(i, Input::Texture(_)));
        match *self {
            Self::Diffuse { reflectance } => textured(&[reflectance]),
            Self::Dielectric { reflectance, transmittance, .. } => {
                self.is_anisotropic() || textured(&[reflectance, transmittance])
            }
            Self::ThinDielectric { reflectance, transmittance, .. } => {
                textured(&[reflectance, transmittance])
            }
            Self::Conductor { eta, k, reflectance, .. } => {
                self.is_anisotropic() || textured(&[eta, k, reflectance])
            }
            Self::SmoothPlastic { diffuse, specular, .. } | Self::RoughPlastic { diffuse, specular, .. } => {
                textured(&[diffuse, specular])
            }
            Self::Mask { opacity, .. } => textured(&[opacity]),
            Self::TwoSided { .. } => false,
            Self::Bump { .. } | Self::NormalMap { .. } => true,
        }
    }

    fn is_anisotropic(&self) -> bool {
        match self {
            Self::Dielectric { roughness: Some(r), .. } | Self::Conductor { roughness: Some(r), .. } => {
                !matches!((r.alpha_u, r.alpha_v), (Input::Constant(u), Input::Constant(v)) if u == v)
            }
            _ => false,
        }
    }

    fn lobe(&self) -> Option<LobeMaterial> {
        match *self {
            Self::Diffuse { reflectance } => Some(LobeMaterial::new(LobeModel::Diffuse, reflectance, &[])),
            Self::Conductor {
                eta: Input::Constant(eta),
                k: Input::Constant(k),
                roughness: Some(roughness),
                reflectance,
            } if !self.is_anisotropic() => {
                let facets = roughness.constant_facets()?;
                let parameters = RoughConductor::parameters(eta, k, &facets);
                Some(LobeMaterial::new(LobeModel::RoughConductor(roughness.kind), reflectance, &parameters))
            }
            _ => None,
        }
    }

    /// The BSDF of a material that wraps no other.
    #[inline]
    fn bsdf(&self, uv: Vec2, textures: &TextureArena) -> Bsdf<'_> {
        let color = |input: &Input| textures.eval(*input, uv);
        match self {
            Self::Diffuse { reflectance } => Bsdf::Diffuse(DiffuseBsdf { reflectance: color(reflectance) }),
            Self::Dielectric { eta, roughness, reflectance, transmittance } => {
                let (eta, specular_reflectance, specular_transmittance) =
                    (*eta, color(reflectance), color(transmittance));
                match roughness {
                    None => Bsdf::SmoothDielectric(SmoothDielectric {
                        eta,
                        specular_reflectance,
                        specular_transmittance,
                    }),
                    Some(r) => Bsdf::RoughDielectric(RoughDielectric {
                        facets: r.facets(uv, textures),
                        eta,
                        specular_reflectance,
                        specular_transmittance,
                    }),
                }
            }
            Self::ThinDielectric { eta, reflectance, transmittance } => {
                Bsdf::ThinDielectric(ThinDielectric {
                    eta: *eta,
                    specular_reflectance: color(reflectance),
                    specular_transmittance: color(transmittance),
                })
            }
            Self::Conductor { eta, k, roughness, reflectance } => {
                let (eta, k, specular_reflectance) = (color(eta), color(k), color(reflectance));
                match roughness {
                    None => Bsdf::SmoothConductor(SmoothConductor { eta, k, specular_reflectance }),
                    Some(r) => Bsdf::RoughConductor(RoughConductor {
                        facets: r.facets(uv, textures),
                        eta,
                        k,
                        specular_reflectance,
                    }),
                }
            }
            Self::SmoothPlastic { eta, internal_reflectance, diffuse, specular, nonlinear } => {
                Bsdf::SmoothPlastic(SmoothPlastic::new(
                    *eta,
                    *internal_reflectance,
                    color(diffuse),
                    color(specular),
                    *nonlinear,
                ))
            }
            Self::RoughPlastic { table, diffuse, specular, nonlinear } => {
                Bsdf::RoughPlastic(RoughPlastic::new(table, color(diffuse), color(specular), *nonlinear))
            }
            Self::TwoSided { .. } | Self::Mask { .. } | Self::Bump { .. } | Self::NormalMap { .. } => {
                unreachable!("wrapping materials are resolved before")
            }
        }
    }
}

impl Roughness {
    #[inline]
    fn facets(&self, uv: Vec2, textures: &TextureArena) -> Microfacets {
        let alpha = |input| self.alpha(textures.eval_number(input, uv));
        Microfacets::new(self.kind, alpha(self.alpha_u), alpha(self.alpha_v))
    }

    /// The same everywhere, where it is.
    fn constant_facets(&self) -> Option<Microfacets> {
        let (Input::Constant(u), Input::Constant(v)) = (self.alpha_u, self.alpha_v) else { return None };
        let [u, v] = [u, v].map(|c| self.alpha(c.0[0]));
        Some(Microfacets::new(self.kind, u, v))
    }

    #[inline]
    fn alpha(&self, value: f32) -> f32 {
        if self.remap { value.max(0.0).sqrt() } else { value }
    }
}
