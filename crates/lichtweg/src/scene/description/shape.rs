//! Shapes and the light they emit.

use std::sync::Arc;

use lichtweg_ray::Placement;
use lichtweg_ray::math::{Affine, Vec2, Vec3};

use super::{MaterialId, Span, TextureInput};

/// A shape, what it is made of and what it emits.
#[derive(Clone, Debug)]
pub struct ShapeDescription {
    /// The author's name for it, if any.
    pub name: Option<String>,
    /// Where it was stated.
    pub span: Span,
    /// Its form, in its own space.
    pub geometry: GeometryDescription,
    /// From its own space to the world.
    pub to_world: Affine,
    /// Turn the surface inside out: reverses geometric and shading normals.
    pub flip_normals: bool,
    /// What it is made of.
    pub material: MaterialId,
    /// What it emits; nothing where it belongs to a group.
    pub emission: Option<AreaLightDescription>,
    /// The group it belongs to: it is then placed with the instances of that, and not by itself.
    pub group: Option<GroupId>,
}

/// Names a group of shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GroupId(pub u32);

/// A group of shapes, placed in the world: any number of instances share its memory.
#[derive(Clone, Debug)]
pub struct InstanceDescription {
    /// Where it was stated.
    pub span: Span,
    /// The shapes.
    pub group: GroupId,
    /// From the space of the group to the world, over times on the clock of the camera's shutter.
    pub to_world: Placement,
}

/// The form of a shape. The side the normal points to is the outside; a mirroring `to_world` keeps it so.
#[derive(Clone, Debug)]
pub enum GeometryDescription {
    /// Triangles; counter-clockwise winding seen from the outside.
    Mesh(Arc<Mesh>),
    /// The unit sphere, cut at heights `z_min` and `z_max` in [-1, 1] and beyond azimuth `phi_max` in (0, 360] degrees.
    Sphere {
        /// Lower cut.
        z_min: f32,
        /// Upper cut.
        z_max: f32,
        /// Largest azimuth in degrees.
        phi_max: f32,
    },
    /// The unit disk in the plane z = 0, normal +z, without its part inside `inner_radius`.
    Disk {
        /// Radius of the hole in [0, 1).
        inner_radius: f32,
        /// Largest azimuth in degrees.
        phi_max: f32,
    },
    /// The open cylinder of unit radius around the z axis, normals outward.
    Cylinder {
        /// Lower end.
        z_min: f32,
        /// Upper end.
        z_max: f32,
        /// Largest azimuth in degrees.
        phi_max: f32,
    },
}

/// An indexed triangle mesh.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Vertex normals of any length, one a position, or empty: faceted.
    pub normals: Vec<Vec3>,
    /// Vertex texture coordinates, one a position, or empty: those of each triangle are then (0,0), (1,0), (1,1).
    pub uvs: Vec<Vec2>,
    /// Three positions a triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// The light a shape emits, from the side its normal points to.
#[derive(Clone, Debug)]
pub struct AreaLightDescription {
    /// Where it was stated.
    pub span: Span,
    /// Emitted radiance in W / (m^2 sr), before `scale`.
    pub radiance: TextureInput,
    /// Emit from both sides.
    pub two_sided: bool,
    /// What `radiance` is multiplied with.
    pub scale: EmissionScale,
}

/// How a light's stated colour becomes radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmissionScale {
    /// A plain factor.
    Factor(f32),
    /// The factor with which the shape's total emitted luminous power (of CIE Y) is this.
    Power(f32),
}
