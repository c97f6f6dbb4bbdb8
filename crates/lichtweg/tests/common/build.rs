//! Descriptions in a few words.

use std::sync::Arc;

use lichtweg::scene::description::{
    AreaLightDescription, Description, EmissionScale, GeometryDescription, Image, LightDescription,
    LightKind, MaterialDescription, MaterialId, MaterialKind, Mesh, MicrofacetKind, Pixels,
    RoughnessDescription, ShapeDescription, Span, TextureDescription, TextureFilter, TextureInput,
    TextureKind, UvTransform, WrapMode,
};
use lichtweg_ray::math::{Affine, Vec2, Vec3};

/// Adds objects to a description.
pub trait Build {
    fn material(&mut self, kind: MaterialKind) -> MaterialId;
    fn diffuse(&mut self, reflectance: [f32; 3]) -> MaterialId;
    fn two_sided(&mut self, front: MaterialId) -> MaterialId;
    fn texture(&mut self, kind: TextureKind) -> TextureInput;
    fn shape(
        &mut self,
        geometry: GeometryDescription,
        to_world: Affine,
        material: MaterialId,
    ) -> &mut ShapeDescription;
    fn light(&mut self, kind: LightKind);
}

impl Build for Description {
    fn material(&mut self, kind: MaterialKind) -> MaterialId {
        self.add_material(MaterialDescription { name: None, span: Span::default(), kind })
    }

    fn diffuse(&mut self, reflectance: [f32; 3]) -> MaterialId {
        self.material(MaterialKind::Diffuse { reflectance: TextureInput::rgb(reflectance) })
    }

    fn two_sided(&mut self, front: MaterialId) -> MaterialId {
        self.material(MaterialKind::TwoSided { front, back: front })
    }

    fn texture(&mut self, kind: TextureKind) -> TextureInput {
        TextureInput::Texture(self.add_texture(TextureDescription {
            name: None,
            span: Span::default(),
            kind,
        }))
    }

    fn shape(
        &mut self,
        geometry: GeometryDescription,
        to_world: Affine,
        material: MaterialId,
    ) -> &mut ShapeDescription {
        self.shapes.push(ShapeDescription {
            name: None,
            span: Span::default(),
            geometry,
            to_world,
            flip_normals: false,
            material,
            emission: None,
            group: None,
        });
        self.shapes.last_mut().expect("just pushed")
    }

    fn light(&mut self, kind: LightKind) {
        self.lights.push(LightDescription { name: None, span: Span::default(), kind, scale: 1.0 });
    }
}

/// Emission of one colour from the front side.
pub fn glow(radiance: [f32; 3]) -> Option<AreaLightDescription> {
    glow_input(TextureInput::rgb(radiance))
}

/// Emission from the front side.
pub fn glow_input(radiance: TextureInput) -> Option<AreaLightDescription> {
    let (span, scale) = (Span::default(), EmissionScale::Factor(1.0));
    Some(AreaLightDescription { span, radiance, two_sided: false, scale })
}

/// The whole unit sphere.
pub const SPHERE: GeometryDescription =
    GeometryDescription::Sphere { z_min: -1.0, z_max: 1.0, phi_max: 360.0 };

/// The whole unit disk, normal +z.
pub const DISK: GeometryDescription = GeometryDescription::Disk { inner_radius: 0.0, phi_max: 360.0 };

/// The unit cylinder from z = 0 to 1.
pub const CYLINDER: GeometryDescription =
    GeometryDescription::Cylinder { z_min: 0.0, z_max: 1.0, phi_max: 360.0 };

/// The square [-1, 1]^2 in z = 0, normal +z, (u, v) from 0 to 1.
pub fn rectangle() -> GeometryDescription {
    grid(1, |x, y| Vec3::new(x, y, 0.0), false)
}

/// The faces of the cube [-1, 1]^3, each like [`rectangle`].
pub fn cube() -> GeometryDescription {
    let mut mesh = Mesh::default();
    let turns = [
        Affine::IDENTITY,
        Affine::rotation([0.0, 1.0, 0.0], 90.0),
        Affine::rotation([0.0, 1.0, 0.0], 180.0),
        Affine::rotation([0.0, 1.0, 0.0], 270.0),
        Affine::rotation([1.0, 0.0, 0.0], 90.0),
        Affine::rotation([1.0, 0.0, 0.0], 270.0),
    ];
    for turn in turns {
        let start = mesh.positions.len() as u32;
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            mesh.positions.push(turn.point(Vec3::new(x, y, 1.0)));
            mesh.uvs.push(Vec2::new(0.5 * (x + 1.0), 0.5 * (y + 1.0)));
        }
        mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i| start + i)));
    }
    GeometryDescription::Mesh(Arc::new(mesh))
}

/// A mesh of `n` by `n` squares over the square [-1, 1]^2, each vertex put in place by `position`, with vertex normals if
/// `smooth`.
pub fn grid(n: u32, position: impl Fn(f32, f32) -> Vec3, smooth: bool) -> GeometryDescription {
    let at = |i: u32| i as f32 / n as f32 * 2.0 - 1.0;
    let mut mesh = Mesh::default();
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (at(i), at(j));
            mesh.positions.push(position(x, y));
            mesh.uvs.push(Vec2::new(0.5 * (x + 1.0), 0.5 * (y + 1.0)));
            if smooth {
                const H: f32 = 1e-2;
                let along_x = position(x + H, y) - position(x - H, y);
                let along_y = position(x, y + H) - position(x, y - H);
                mesh.normals.push(along_x.cross(along_y).normalized());
            }
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    GeometryDescription::Mesh(Arc::new(mesh))
}

/// A map made of others: the last is applied first, as in a product of matrices.
pub fn chain(maps: &[Affine]) -> Affine {
    maps.iter().fold(Affine::IDENTITY, |product, map| product.after(map))
}

/// A translation after a scaling.
pub fn placed([x, y, z]: [f64; 3], [sx, sy, sz]: [f64; 3]) -> Affine {
    chain(&[Affine::translation(x, y, z), Affine::scaling(sx, sy, sz)])
}

/// Turns +z (the normal of a rectangle or disk) down to -y.
pub fn facing_down() -> Affine {
    Affine::rotation([1.0, 0.0, 0.0], 90.0)
}

/// Turns +z up to +y.
pub fn facing_up() -> Affine {
    Affine::rotation([1.0, 0.0, 0.0], -90.0)
}

/// A texture of floating-point pixels, top row first.
pub fn bitmap(width: u32, pixels: &[[f32; 3]], filter: TextureFilter) -> TextureKind {
    TextureKind::Bitmap {
        image: float_image(width, pixels),
        to_uv: UvTransform::default(),
        wrap: WrapMode::Clamp,
        filter,
        raw: true,
        scale: 1.0,
        invert: false,
    }
}

/// An image of floating-point pixels, top row first.
pub fn float_image(width: u32, pixels: &[[f32; 3]]) -> Arc<Image> {
    Arc::new(Image {
        width,
        height: pixels.len() as u32 / width,
        channels: 3,
        pixels: Pixels::F32(pixels.iter().flatten().copied().collect()),
        srgb: false,
    })
}

/// `repeats` by `repeats` tiles of four squares.
pub fn checkerboard(even: [f32; 3], odd: [f32; 3], repeats: f32) -> TextureKind {
    TextureKind::Checkerboard {
        even: TextureInput::rgb(even),
        odd: TextureInput::rgb(odd),
        to_uv: UvTransform { rows: [[repeats, 0.0, 0.0], [0.0, repeats, 0.0]] },
    }
}

/// A microfacet surface.
pub fn rough(distribution: MicrofacetKind, alpha_u: f32, alpha_v: f32) -> Option<RoughnessDescription> {
    let [alpha_u, alpha_v] = [alpha_u, alpha_v].map(TextureInput::number);
    Some(RoughnessDescription { distribution, alpha_u, alpha_v, remap: false })
}

/// Glass of index `eta`.
pub fn glass(eta: f32, roughness: Option<RoughnessDescription>) -> MaterialKind {
    let [specular_reflectance, specular_transmittance] = [1.0, 1.0].map(TextureInput::number);
    MaterialKind::Dielectric { eta, roughness, specular_reflectance, specular_transmittance }
}

/// A metal like aluminium.
pub fn metal(roughness: Option<RoughnessDescription>) -> MaterialKind {
    MaterialKind::Conductor {
        eta: TextureInput::rgb([1.35, 0.96, 0.62]),
        k: TextureInput::rgb([7.5, 6.4, 5.3]),
        roughness,
        specular_reflectance: TextureInput::number(1.0),
    }
}

/// Plastic of index 1.5.
pub fn plastic(reflectance: [f32; 3], roughness: Option<RoughnessDescription>) -> MaterialKind {
    MaterialKind::Plastic {
        eta: 1.5,
        diffuse_reflectance: TextureInput::rgb(reflectance),
        specular_reflectance: TextureInput::number(1.0),
        roughness,
        nonlinear: true,
    }
}
