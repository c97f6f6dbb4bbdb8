//! What can be hit.

use std::sync::Arc;

use crate::kind::{Instance, MovingMesh, Quadric, UserPrimitives};
use crate::math::Vec3;

/// An indexed triangle mesh. Clones share their arrays.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    /// Vertex positions in world space.
    pub positions: Arc<[Vec3]>,
    /// Three positions a triangle; the counter-clockwise side is the front.
    pub indices: Arc<[[u32; 3]]>,
}

impl TriangleMesh {
    /// A mesh from its arrays; [`crate::Accel::build`] checks them.
    pub fn new(positions: impl Into<Arc<[Vec3]>>, indices: impl Into<Arc<[[u32; 3]]>>) -> Self {
        Self { positions: positions.into(), indices: indices.into() }
    }

    /// The corners of triangle `primitive`. Panics where an index is out of range.
    #[inline]
    pub fn corners(&self, primitive: u32) -> [Vec3; 3] {
        self.indices[primitive as usize].map(|i| self.positions[i as usize])
    }
}

/// One geometry of a scene; a [`crate::Hit`] names it by its index in the list it was built from.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Geometry {
    /// A triangle mesh.
    Triangles(TriangleMesh),
    /// A quadric under an affine map.
    Quadric(Quadric),
    /// A triangle mesh with moving vertices.
    MovingTriangles(MovingMesh),
    /// Another structure, under an affine map that may move.
    Instance(Instance),
    /// Primitives of the caller's own.
    User(Arc<dyn UserPrimitives>),
}

impl Geometry {
    /// Number of primitives; 1 for an instance, whose hits name those of its own structure.
    pub fn primitives(&self) -> usize {
        match self {
            Self::Triangles(mesh) => mesh.indices.len(),
            Self::Quadric(_) | Self::Instance(_) => 1,
            Self::MovingTriangles(mesh) => mesh.indices.len(),
            Self::User(user) => user.count(),
        }
    }
}

impl From<TriangleMesh> for Geometry {
    fn from(mesh: TriangleMesh) -> Self {
        Self::Triangles(mesh)
    }
}

impl From<Quadric> for Geometry {
    fn from(quadric: Quadric) -> Self {
        Self::Quadric(quadric)
    }
}

impl From<MovingMesh> for Geometry {
    fn from(mesh: MovingMesh) -> Self {
        Self::MovingTriangles(mesh)
    }
}

impl From<Instance> for Geometry {
    fn from(instance: Instance) -> Self {
        Self::Instance(instance)
    }
}
