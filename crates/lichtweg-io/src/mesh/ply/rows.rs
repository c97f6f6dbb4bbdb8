//! Whole tables at once: the shortcuts for binary bodies whose rows all have one size.

use lichtweg_ray::math::{Vec2, Vec3};

use super::header::{Element, Kind, Scalar};
use super::source::{Binary, Source, decode};
use crate::mesh::MeshError;
use crate::mesh::text::Cursor;

/// Numbers of a vertex that are kept: x y z nx ny nz u v.
pub(super) const SLOTS: usize = 8;
/// The slot of nx.
pub(super) const NORMAL: usize = 3;
/// The slot of u.
pub(super) const UV: usize = 6;

/// Body encodings, with the shortcuts that some of them have.
pub(super) trait Body: Source {
    /// Reads all vertices at once if that is possible: fills `vertices` and returns true.
    fn vertices_at_once(
        &mut self,
        _element: &Element,
        _slots: &[Option<usize>],
        _vertices: &mut Vertices,
    ) -> Result<bool, MeshError> {
        Ok(false)
    }

    /// Reads triangles as long as the next rows, at most `rows`, are nothing but that; returns how many.
    fn triangle_run(&mut self, _element: &Element, _rows: u64, _triangles: &mut Vec<[u32; 3]>) -> u64 {
        0
    }

    /// Skips a table at once if that is possible.
    fn skip_at_once(&mut self, _element: &Element) -> Result<bool, MeshError> {
        Ok(false)
    }
}

impl Body for Cursor<'_> {}

impl<const BIG: bool> Body for Binary<'_, BIG> {
    fn vertices_at_once(
        &mut self,
        element: &Element,
        slots: &[Option<usize>],
        vertices: &mut Vertices,
    ) -> Result<bool, MeshError> {
        let Some(stride) = element.stride() else { return Ok(false) };
        let mut columns = [None; SLOTS];
        let mut offset = 0;
        for (property, slot) in element.properties.iter().zip(slots) {
            let Kind::Single(scalar) = property.kind else { return Ok(false) };
            if let Some(slot) = *slot {
                columns[slot] = Some((offset, scalar));
            }
            offset += scalar.size();
        }
        // The caller has checked that the product is within the file.
        let rows = self.take(element.count as usize * stride)?;
        for row in rows.chunks_exact(stride) {
            let number = |slot: usize| match columns[slot] {
                Some((offset, scalar)) => decode::<BIG>(&row[offset..], scalar) as f32,
                None => 0.0,
            };
            vertices.push(number);
        }
        Ok(true)
    }

    fn triangle_run(&mut self, element: &Element, rows: u64, triangles: &mut Vec<[u32; 3]>) -> u64 {
        const STRIDE: usize = 13;
        let [property] = &element.properties[..] else { return 0 };
        if !matches!(property.kind, Kind::List { count: Scalar::U8, item: Scalar::I32 | Scalar::U32 }) {
            return 0;
        }
        let before = triangles.len();
        let is_triangle = |row: &&[u8]| row[0] == 3;
        for row in self.rest().chunks_exact(STRIDE).take(rows as usize).take_while(is_triangle) {
            // A negative index wraps to one that is out of range of any mesh, and is reported as such.
            let index = |i: usize| decode::<BIG>(&row[1 + 4 * i..], Scalar::U32) as u32;
            triangles.push([index(0), index(1), index(2)]);
        }
        let read = triangles.len() - before;
        self.take(read * STRIDE).map_or(0, |_| read as u64)
    }

    fn skip_at_once(&mut self, element: &Element) -> Result<bool, MeshError> {
        let Some(stride) = element.stride() else { return Ok(false) };
        self.take(element.count as usize * stride)?;
        Ok(true)
    }
}

/// The columns of the mesh being read.
pub(super) struct Vertices {
    pub positions: Vec<Vec3>,
    pub normals: Option<Vec<Vec3>>,
    pub uvs: Option<Vec<Vec2>>,
}

impl Vertices {
    /// Adds a vertex whose numbers `number` gives by their slot.
    #[inline]
    pub fn push(&mut self, number: impl Fn(usize) -> f32) {
        self.positions.push(Vec3::new(number(0), number(1), number(2)));
        if let Some(normals) = &mut self.normals {
            normals.push(Vec3::new(number(NORMAL), number(NORMAL + 1), number(NORMAL + 2)));
        }
        if let Some(uvs) = &mut self.uvs {
            uvs.push(Vec2::new(number(UV), number(UV + 1)));
        }
    }
}
