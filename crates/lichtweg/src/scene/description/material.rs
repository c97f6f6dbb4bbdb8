//! Materials: how surfaces scatter.

use super::{Span, TextureId, TextureInput};

/// Index of a material in [`Description::materials`](super::Description::materials).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MaterialId(pub u32);

/// A material and where it was stated.
#[derive(Clone, Debug)]
pub struct MaterialDescription {
    /// The author's name for it, if any.
    pub name: Option<String>,
    /// Where it was stated.
    pub span: Span,
    /// How it scatters.
    pub kind: MaterialKind,
}

/// How a material scatters. Defaults of each format are the readers' business.
#[derive(Clone, Debug)]
pub enum MaterialKind {
    /// Lambertian, reflecting on its front side only.
    Diffuse {
        /// Albedo.
        reflectance: TextureInput,
    },
    /// The boundary between two dielectrics, smooth or (with `roughness`) microfaceted (Walter et al. 2007).
    Dielectric {
        /// Index of refraction inside over outside; the normal points outside.
        eta: f32,
        /// Smooth where `None`.
        roughness: Option<RoughnessDescription>,
        /// Factor on reflection (1 is physical).
        specular_reflectance: TextureInput,
        /// Factor on transmission (1 is physical).
        specular_transmittance: TextureInput,
    },
    /// A thin slab of dielectric with parallel sides: reflects, or passes light on without a bend.
    ThinDielectric {
        /// Index of refraction of the slab over its surroundings.
        eta: f32,
        /// Factor on reflection (1 is physical).
        specular_reflectance: TextureInput,
        /// Factor on transmission (1 is physical).
        specular_transmittance: TextureInput,
    },
    /// A conductor with complex index eta + i k, smooth or microfaceted; reflects on its front side only.
    Conductor {
        /// Real part of the index (relative to the outside).
        eta: TextureInput,
        /// Imaginary part.
        k: TextureInput,
        /// Smooth where `None`.
        roughness: Option<RoughnessDescription>,
        /// Factor on reflection (1 is physical).
        specular_reflectance: TextureInput,
    },
    /// A diffuse base under a dielectric coat, smooth or microfaceted; Mitsuba's `plastic` and `roughplastic`.
    Plastic {
        /// Index of refraction of the coat over the outside.
        eta: f32,
        /// Albedo of the base.
        diffuse_reflectance: TextureInput,
        /// Factor on the coat's reflection (1 is physical).
        specular_reflectance: TextureInput,
        /// Smooth where `None`.
        roughness: Option<RoughnessDescription>,
        /// Let the colour shift of internal reflection grow with the albedo.
        nonlinear: bool,
    },
    /// One material on the front side, one (often the same) on the back.
    TwoSided {
        /// Seen from where the normal points to.
        front: MaterialId,
        /// Seen from behind.
        back: MaterialId,
    },
    /// A material with holes.
    Mask {
        /// 1 where the surface is, 0 where it is not, partial presence between.
        opacity: TextureInput,
        /// The material of the surface.
        nested: MaterialId,
    },
    /// Normals tilted by the gradient of a height field (Blinn 1978).
    Bump {
        /// Height in scene units.
        height: TextureId,
        /// Multiplies the height.
        scale: f32,
        /// The material under the tilted normal.
        nested: MaterialId,
    },
    /// Normals read from an image in tangent space, (r, g, b) = (n + 1) / 2.
    NormalMap {
        /// The image.
        normals: TextureId,
        /// The material under the new normal.
        nested: MaterialId,
    },
}

/// A microfacet surface.
#[derive(Clone, Debug)]
pub struct RoughnessDescription {
    /// The distribution of facet normals.
    pub distribution: MicrofacetKind,
    /// Roughness along the tangent (dp/du).
    pub alpha_u: TextureInput,
    /// Roughness along the bitangent.
    pub alpha_v: TextureInput,
    /// The inputs are perceptual roughness r with alpha = sqrt(r) (pbrt's `remaproughness`).
    pub remap: bool,
}

/// A distribution of facet normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MicrofacetKind {
    /// Beckmann and Spizzichino 1963: Gaussian slopes.
    Beckmann,
    /// Trowbridge and Reitz 1975, Walter et al. 2007: long tails.
    Ggx,
}
