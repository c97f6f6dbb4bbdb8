//! Materials: from a point on a surface to the [`Bsdf`] there.

use lichtweg_ray::math::{Vec2, Vec3};

use super::description::{
    Diagnostic, Diagnostics, MaterialDescription, MaterialId, MaterialKind, RoughnessDescription, Span,
    TextureInput,
};
use super::surface::{Form, SurfacePoint};
use crate::bsdf::{
    Bsdf, BsdfSample, Diffuse, Frame, MicrofacetKind, Microfacets, Mode, RoughConductor, RoughDielectric,
    RoughPlastic, RoughTransmittanceTable, SmoothConductor, SmoothDielectric, SmoothPlastic, ThinDielectric,
    fresnel,
};
use crate::color::{Role, Spectrum};
use crate::texture::{Input, TextureArena};

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

/// A BSDF and the frame it lives in. Directions of its methods are in the world.
#[derive(Clone, Copy, Debug)]
pub struct Scatterer<'a> {
    /// The shading frame; left-handed on the back of a two-sided surface, which mirrors the material's front.
    pub frame: Frame,
    /// What scatters there.
    pub bsdf: Bsdf<'a>,
    /// The shading normal before bump and normal maps, if any tilted it: directions on different sides of the two normals
    /// carry nothing, or light would leak through the surface.
    untilted: Option<Vec3>,
}

impl Scatterer<'_> {
    /// f |cos| and the density of sampling `wi` per solid angle, without delta lobes.
    #[inline]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3, mode: Mode) -> (Spectrum, f32) {
        let (local_wo, local_wi) = (self.frame.to_local(wo), self.frame.to_local(wi));
        if !self.consistent(wo, local_wo) || !self.consistent(wi, local_wi) {
            return (Spectrum::ZERO, 0.0);
        }
        self.bsdf.eval_pdf(local_wo, local_wi, mode)
    }

    /// A direction in the world ([`BsdfSample::wi`] is then in the world too).
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], mode: Mode) -> Option<BsdfSample> {
        let local_wo = self.frame.to_local(wo);
        if !self.consistent(wo, local_wo) {
            return None;
        }
        let sample = self.bsdf.sample(local_wo, u_lobe, u, mode)?;
        let wi = self.frame.to_world(sample.wi);
        self.consistent(wi, sample.wi).then_some(BsdfSample { wi, ..sample })
    }

    #[inline]
    fn consistent(&self, world: Vec3, local: Vec3) -> bool {
        self.untilted.is_none_or(|n| n.dot(world) * local.z > 0.0)
    }
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

    /// What scatters at a point that is looked at from the direction `wo`.
    #[inline]
    pub fn scatterer<'a>(
        &'a self,
        material: u32,
        point: &SurfacePoint,
        wo: Vec3,
        form: &Form,
        textures: &TextureArena,
    ) -> Scatterer<'a> {
        let mut tangents = Tangents { form, point, partials: None };
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

/// Surface tangents at a point, computed when first needed.
struct Tangents<'a> {
    form: &'a Form,
    point: &'a SurfacePoint,
    partials: Option<Option<[Vec3; 2]>>,
}

impl Tangents<'_> {
    fn partials(&mut self) -> Option<[Vec3; 2]> {
        *self.partials.get_or_insert_with(|| self.form.partials(self.point))
    }

    /// The frame about `normal` whose tangent follows dp/du.
    fn frame(&mut self, normal: Vec3) -> Frame {
        match self.partials() {
            Some([dp_du, _]) => Frame::from_normal_tangent(normal, dp_du),
            None => Frame::from_normal(normal),
        }
    }

    /// The normal of the surface displaced along `normal` by a height with a given gradient (Blinn 1978), neglecting the
    /// curvature of the surface itself.
    fn bump(&mut self, normal: Vec3, gradient: Vec2) -> Vec3 {
        let Some([dp_du, dp_dv]) = self.partials() else { return normal };
        let lifted = |dp: Vec3, slope: f32| dp + normal * (slope - normal.dot(dp));
        let tilted = lifted(dp_du, gradient.x).cross(lifted(dp_dv, gradient.y));
        match tilted.try_normalized() {
            Some(n) if n.dot(normal) < 0.0 => -n,
            Some(n) => n,
            None => normal,
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

    /// The BSDF of a material that wraps no other.
    #[inline]
    fn bsdf(&self, uv: Vec2, textures: &TextureArena) -> Bsdf<'_> {
        let color = |input: &Input| textures.eval(*input, uv);
        match self {
            Self::Diffuse { reflectance } => Bsdf::Diffuse(Diffuse { reflectance: color(reflectance) }),
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
        let alpha = |input| {
            let value = textures.eval_number(input, uv);
            if self.remap { value.max(0.0).sqrt() } else { value }
        };
        Microfacets::new(self.kind, alpha(self.alpha_u), alpha(self.alpha_v))
    }
}

struct Compiler<'a> {
    arena: &'a MaterialArena,
    textures: &'a TextureArena,
    span: Span,
    diagnostics: &'a mut Diagnostics,
}

impl Compiler<'_> {
    fn material(&mut self, kind: &MaterialKind) -> Option<Material> {
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

    fn fault(&mut self, code: &'static str, message: &str) {
        self.diagnostics.push(Diagnostic::error(code, message).at(self.span, "in this material"));
    }
}
