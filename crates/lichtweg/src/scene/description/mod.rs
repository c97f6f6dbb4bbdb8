//! The neutral description of a scene: what every reader produces and [`Scene`](super::Scene) is compiled from.
//!
//! A description is plain data: objects in arenas, joined by typed indices, each with the place in the
//! source it came from, so that an error found while compiling still points at the user's own line. It knows
//! no file format, and reads no file: meshes and images arrive decoded.
//!
//! Conventions, to which readers convert: right-handed world, lengths in scene units, angles in degrees, colours
//! linear sRGB, camera looking along its +z with +y up and +x to the left (Mitsuba's).

mod camera;
mod diagnostic;
mod integrator;
mod light;
mod material;
mod shape;
mod spectrum;
mod texture;

use lichtweg_ray::Placement;

pub use camera::{CameraDescription, FieldOfView, FilmDescription, FilterDescription, FilterKind, FovAxis};
pub use diagnostic::{Diagnostic, Diagnostics, Severity, SourceFile, SourceMap, Span};
pub use integrator::{
    EstimatorKind, Heuristic, IntegratorDescription, LightChoiceKind, LightStrategy, RouletteDescription,
    SamplerDescription,
};
pub use light::{EnvironmentMapping, LightDescription, LightKind, SpotFalloff};
pub use material::{MaterialDescription, MaterialId, MaterialKind, MicrofacetKind, RoughnessDescription};
pub use shape::{
    AreaLightDescription, CurvesDescription, EmissionScale, GeometryDescription, GroupId,
    InstanceDescription, Mesh, ShapeDescription,
};
pub use spectrum::{ConductorQuantity, SpectrumDescription};
pub use texture::{
    Image, Pixels, TextureDescription, TextureFilter, TextureId, TextureInput, TextureKind, UvTransform,
    WrapMode,
};

/// Everything that is in a scene file, and how its author asked for it to be rendered.
#[derive(Clone, Debug, Default)]
pub struct Description {
    /// A short name, from the file's, for default output names.
    pub name: String,
    /// The eye.
    pub camera: CameraDescription,
    /// The image.
    pub film: FilmDescription,
    /// Where random numbers come from, and how many samples a pixel takes.
    pub sampler: SamplerDescription,
    /// The estimator.
    pub integrator: IntegratorDescription,
    /// Textures, referred to by [`TextureId`].
    pub textures: Vec<TextureDescription>,
    /// Materials, referred to by [`MaterialId`].
    pub materials: Vec<MaterialDescription>,
    /// Shapes, with their area lights.
    pub shapes: Vec<ShapeDescription>,
    /// Number of groups of shapes, referred to by [`GroupId`].
    pub groups: u32,
    /// Groups placed in the world.
    pub instances: Vec<InstanceDescription>,
    /// Lights that are no shape.
    pub lights: Vec<LightDescription>,
    /// Keep the texture coordinates of shapes that nothing looks at.
    pub keep_coordinates: bool,
}

impl Description {
    /// Adds a texture and returns its index.
    pub fn add_texture(&mut self, texture: TextureDescription) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Adds a material and returns its index.
    pub fn add_material(&mut self, material: MaterialDescription) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a group, empty as yet.
    pub fn add_group(&mut self) -> GroupId {
        self.groups += 1;
        GroupId(self.groups - 1)
    }

    /// Whether anything but the camera moves.
    pub fn moves(&self) -> bool {
        self.instances.iter().any(|i| matches!(i.to_world, Placement::Moving(_)))
    }
}
