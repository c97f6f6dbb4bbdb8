//! Gathers triangles into one mesh for each material, faceted or smooth, through nested placements.

use std::collections::BTreeMap;

use lichtweg::scene::description::Mesh;
use lichtweg_ray::math::{Affine, Vec3};

use super::palette::Material;
use crate::mesh::smooth_normals;

/// Triangles thinner than this (twice their area over the square of their longest side) are left out: they show nothing.
const THINNEST: f32 = 1e-4;

/// How neighbouring facets meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shading {
    /// At an edge.
    Faceted,
    /// Without one, where they share a vertex.
    Smooth,
}

/// Meshes in the making.
#[derive(Debug)]
pub struct Builder {
    meshes: BTreeMap<(Material, Shading), Mesh>,
    placement: Affine,
    /// Factor on the number of small things: leaves, stones, tiles.
    detail: f32,
}

impl Builder {
    /// Nothing yet.
    pub fn new(detail: f32) -> Self {
        Self { meshes: BTreeMap::new(), placement: Affine::IDENTITY, detail }
    }

    /// A count at the level of detail, at least 1.
    pub fn count(&self, count: f32) -> usize {
        (count * self.detail).round().max(1.0) as usize
    }

    /// A count along one of two dimensions at the level of detail, at least `least`.
    pub fn count_along(&self, count: f32, least: usize) -> usize {
        ((count * self.detail.sqrt()).round() as usize).max(least)
    }

    /// A length of one of many small things that cover a surface, at the level of detail.
    pub fn length(&self, length: f32) -> f32 {
        length / self.detail.sqrt()
    }

    /// Builds with the origin moved.
    pub fn at(&mut self, x: f32, y: f32, z: f32, build: impl FnOnce(&mut Self)) {
        self.within(Affine::translation(x.into(), y.into(), z.into()), build);
    }

    /// Builds with the axes turned about the vertical; a quarter turn takes +z to +x.
    pub fn turned(&mut self, degrees: f32, build: impl FnOnce(&mut Self)) {
        self.within(Affine::rotation([0.0, 1.0, 0.0], degrees.into()), build);
    }

    /// Builds with the axes tilted about x; a quarter turn takes +y to +z.
    pub fn tilted(&mut self, degrees: f32, build: impl FnOnce(&mut Self)) {
        self.within(Affine::rotation([1.0, 0.0, 0.0], degrees.into()), build);
    }

    fn within(&mut self, placement: Affine, build: impl FnOnce(&mut Self)) {
        let outer = self.placement;
        self.placement = outer.after(&placement);
        build(self);
        self.placement = outer;
    }

    /// Adds triangles, counter-clockwise seen from outside, without those that have no area.
    pub fn add(
        &mut self,
        material: Material,
        shading: Shading,
        positions: impl IntoIterator<Item = Vec3>,
        triangles: impl IntoIterator<Item = [u32; 3]>,
    ) {
        let mesh = self.meshes.entry((material, shading)).or_default();
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(positions.into_iter().map(|p| self.placement.point(p)));
        let placed = triangles.into_iter().map(|t| t.map(|i| i + first));
        mesh.triangles.extend(placed.filter(|t| has_area(t.map(|i| mesh.positions[i as usize]))));
    }

    /// Adds a flat quadrilateral, counter-clockwise seen from outside.
    pub fn quad(&mut self, material: Material, corners: [Vec3; 4]) {
        self.add(material, Shading::Faceted, corners, [[0, 1, 2], [0, 2, 3]]);
    }

    /// The meshes, smooth ones with their normals.
    pub fn finish(mut self) -> impl Iterator<Item = (Material, Shading, Mesh)> {
        for ((_, shading), mesh) in &mut self.meshes {
            if *shading == Shading::Smooth {
                smooth_normals(mesh);
            }
        }
        self.meshes.into_iter().map(|((material, shading), mesh)| (material, shading, mesh))
    }
}

fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let longest = (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared());
    (b - a).cross(c - a).length() > THINNEST * longest
}
