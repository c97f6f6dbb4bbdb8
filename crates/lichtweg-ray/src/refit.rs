//! Moves the vertices of a finished structure without building it anew.
//!
//! Corners and leaf boxes are taken from the new positions by all threads, then the boxes of inner nodes
//! from those of their children, the last node first: children stand behind their parents. The tree keeps
//! its shape, so queries slow down as things move far from where they were when it was built. Leaves that a
//! high-quality build gave only pieces of triangles get the boxes of whole triangles: what is to move is
//! better built with [`BuildQuality::Fast`](crate::BuildQuality::Fast).

use std::sync::Arc;

use rayon::prelude::*;

use crate::accel::Accel;
use crate::build::{is_sound, padded};
use crate::bvh::{Block, Node, Numbering};
use crate::geometry::{Geometry, TriangleMesh};
use crate::kind::{Kind, in_range};
use crate::math::{Bounds3, Vec3};

/// Why a structure could not be refitted; it is as it was before.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefitError {
    /// There is no triangle mesh of this index.
    #[error("geometry {geometry} is no triangle mesh")]
    NotAMesh {
        /// The index asked for.
        geometry: u32,
    },
    /// The mesh has another number of vertices.
    #[error("geometry {geometry} has {vertices} vertices, not {given}")]
    VertexCount {
        /// Index of the geometry.
        geometry: u32,
        /// The number of its vertices.
        vertices: usize,
        /// The number of positions given.
        given: usize,
    },
    /// A triangle that the build left out can be hit now: build anew.
    #[error("geometry {geometry}, triangle {primitive} was left out of the build and can be hit now")]
    Appeared {
        /// Index of the geometry.
        geometry: u32,
        /// Index of the triangle.
        primitive: u32,
    },
}

impl Accel {
    /// Gives meshes new vertex positions, each named by the index of its geometry; all else stays. Answers are
    /// those of a new build. Triangles that are not finite, too large or without area now cannot be hit until
    /// they are moved again.
    ///
    /// # Errors
    /// A geometry is no triangle mesh or has another number of vertices, or a triangle that was left out of
    /// the build could be hit now. The structure is unchanged then.
    pub fn refit(&mut self, moved: &[(u32, Arc<[Vec3]>)]) -> Result<(), RefitError> {
        let mut meshes = vec![None; self.geometries.len()];
        for (geometry, positions) in moved {
            let geometry = *geometry;
            let Some(Geometry::Triangles(mesh)) = self.geometries.get(geometry as usize) else {
                return Err(RefitError::NotAMesh { geometry });
            };
            let (vertices, given) = (mesh.positions.len(), positions.len());
            if vertices != given {
                return Err(RefitError::VertexCount { geometry, vertices, given });
            }
            meshes[geometry as usize] = Some(TriangleMesh { positions: positions.clone(), ..mesh.clone() });
        }
        let motion = Motion { meshes, numbering: self.bvh.numbering.clone() };
        motion.appeared(&self.bvh.blocks)?;
        self.bvh.blocks.par_iter_mut().for_each(|block| motion.move_corners(block));
        let reach_before = self.bvh.reach;
        self.refit_bounds();
        self.refit_leaves(&motion);
        if self.bvh.reach > reach_before {
            self.widen_instances();
        }
        self.refit_inner_nodes();
        for (old, new) in self.geometries.iter_mut().zip(motion.meshes) {
            if let Some(mesh) = new {
                *old = Geometry::Triangles(mesh);
            }
        }
        Ok(())
    }

    fn refit_leaves(&mut self, motion: &Motion) {
        let blocks = &self.bvh.blocks;
        self.bvh.nodes.par_iter_mut().for_each(|node| {
            for slot in 0..node.children.len() {
                let child = node.children[slot];
                if !child.is_leaf() || child.is_other() {
                    continue;
                }
                let (first, count) = child.leaf();
                let leaf = &blocks[first..first + count];
                if leaf.iter().any(|block| motion.concerns(block)) {
                    let bounds = leaf.iter().flat_map(triangles).map(|corners| padded(Bounds3::of(corners)));
                    node.set(slot, &bounds.fold(Bounds3::EMPTY, Bounds3::union), child);
                }
            }
        });
    }

    /// Adds the margin of boxes of instances that depends on the size of the whole scene, once more.
    fn widen_instances(&mut self) {
        let (items, kinds, reach) = (&self.items, &self.kinds, self.bvh.reach);
        self.bvh.nodes.par_iter_mut().for_each(|node| {
            for slot in 0..node.children.len() {
                let child = node.children[slot];
                if !child.is_leaf() || !child.is_other() {
                    continue;
                }
                let (first, count) = child.leaf();
                let margin =
                    items[first..first + count].iter().map(|item| match &kinds[item.geometry as usize] {
                        Kind::Instance(instance) => instance.margin(reach),
                        _ => 0.0,
                    });
                node.set(slot, &node.bounds(slot).widened(margin.fold(0.0, f32::max)), child);
            }
        });
    }

    fn refit_inner_nodes(&mut self) {
        for i in (0..self.bvh.nodes.len()).rev() {
            let (head, below) = self.bvh.nodes.split_at_mut(i + 1);
            let node: &mut Node = &mut head[i];
            for slot in 0..node.children.len() {
                let child = node.children[slot];
                if !child.is_leaf() {
                    node.set(slot, &below[child.node() - i - 1].hull(), child);
                }
            }
        }
    }

    fn refit_bounds(&mut self) {
        let of_block = |block: &Block| Bounds3::of(triangles(block).flatten());
        let triangles = self.bvh.blocks.par_iter().map(of_block).reduce(|| Bounds3::EMPTY, Bounds3::union);
        let boxes = self.kinds.iter().flat_map(Kind::boxes).filter(in_range);
        self.bounds = boxes.fold(triangles, Bounds3::union);
        self.bvh.reach = self.bounds.reach();
    }
}

/// The new meshes, one a geometry that moved.
struct Motion {
    meshes: Vec<Option<TriangleMesh>>,
    numbering: Numbering,
}

impl Motion {
    /// The new corners of a triangle of a mesh that moved.
    fn corners(&self, id: u32) -> Option<[Vec3; 3]> {
        if id == Block::NO_ID {
            return None;
        }
        let (geometry, primitive) = self.numbering.locate(id);
        Some(self.meshes[geometry as usize].as_ref()?.corners(primitive))
    }

    fn concerns(&self, block: &Block) -> bool {
        block.ids.iter().any(|&id| self.corners(id).is_some())
    }

    fn move_corners(&self, block: &mut Block) {
        for lane in 0..block.ids.len() {
            let id = block.ids[lane];
            if let Some(corners) = self.corners(id) {
                let corners = if is_sound(corners) { corners } else { [Vec3::splat(f32::NAN); 3] };
                block.set(lane, corners, id);
            }
        }
    }

    /// An error where a triangle that is in no block could be hit.
    fn appeared(&self, blocks: &[Block]) -> Result<(), RefitError> {
        let total: usize = self.meshes.iter().flatten().map(|mesh| mesh.indices.len()).sum();
        let mut present: Vec<u32> =
            blocks.iter().flat_map(|b| b.ids).filter(|&i| self.corners(i).is_some()).collect();
        present.par_sort_unstable();
        present.dedup();
        if present.len() == total {
            return Ok(());
        }
        for (geometry, mesh) in (0..).zip(&self.meshes) {
            let Some(mesh) = mesh else { continue };
            for primitive in 0..mesh.indices.len() as u32 {
                let is_absent = present.binary_search(&self.numbering.number(geometry, primitive)).is_err();
                if is_absent && is_sound(mesh.corners(primitive)) {
                    return Err(RefitError::Appeared { geometry, primitive });
                }
            }
        }
        Ok(())
    }
}

/// The corners of the triangles of a block that can be hit.
fn triangles(block: &Block) -> impl Iterator<Item = [Vec3; 3]> {
    (0..block.ids.len()).map(|lane| block.triangle(lane)).filter(|corners| corners[0].is_finite())
}
