//! Triangle meshes from files: Wavefront OBJ, Stanford PLY and Mitsuba's `.serialized`; and Mitsuba's curves.
//!
//! Every reader returns one [`Mesh`]: polygons cut into triangle fans, one index a corner. Each comes in two forms,
//! `read_*` for a path and `parse_*` for bytes already in memory.
//!
//! **Texture coordinates.** With `flip_v` every v becomes 1 - v. Mitsuba's `flip_tex_coords` is true by default for
//! OBJ and false for PLY and `.serialized`, but its bitmaps have v = 0 in the *top* row, whereas here (and in OBJ
//! itself, and in pbrt) it is the bottom row. So a Mitsuba `obj` with its default needs no flip here, and one without
//! `flip_tex_coords` does; the reader of the scene decides.
//!
//! **Normals.** What the file says is kept, of whatever length. A normal that is zero or not finite is replaced by
//! the mean of the faces around it, with a warning. Files without normals yield meshes without;
//! [`smooth_normals`] adds them where a format asks for that.
//!
//! Limits: everything that is not a triangle surface (lines, points, free-form surfaces, materials, vertex colours) is
//! left out.

mod curves;
mod error;
mod file;
mod finish;
mod normals;
mod obj;
mod ply;
mod primitive;
mod serialized;
mod text;

use std::path::Path;

use lichtweg::scene::description::Mesh;

pub use curves::{parse_curves, read_curves};
pub use error::{MeshError, Place};
pub(crate) use file::read_regular_file;
pub use normals::smooth_normals;
pub use obj::parse_obj;
pub use ply::parse_ply;
pub use primitive::{cube, rectangle};
pub use serialized::parse_serialized;

/// A mesh from a file.
#[derive(Clone, Debug, Default)]
pub struct LoadedMesh {
    /// The triangles; at least one, all indices in range, all positions finite.
    pub mesh: Mesh,
    /// The file asks for a faceted look (only `.serialized` can say so); the mesh then has no normals.
    pub face_normals: bool,
    /// What was repaired or left out, one sentence each.
    pub warnings: Vec<String>,
}

/// Reads a Wavefront OBJ file; all its objects and groups become one mesh. See the module for `flip_v`.
///
/// # Errors
/// The file cannot be read, is no OBJ file, has no faces, or a line of it is wrong.
pub fn read_obj(path: &Path, flip_v: bool) -> Result<LoadedMesh, MeshError> {
    read(path, |bytes| parse_obj(bytes, flip_v))
}

/// Reads a PLY file, ascii or binary. See the module for `flip_v`.
///
/// # Errors
/// The file cannot be read, is no PLY file, has no faces, is truncated or contradicts itself.
pub fn read_ply(path: &Path, flip_v: bool) -> Result<LoadedMesh, MeshError> {
    read(path, |bytes| parse_ply(bytes, flip_v))
}

/// Reads mesh number `shape_index`, from 0, of a Mitsuba `.serialized` file. See the module for `flip_v`.
///
/// # Errors
/// The file cannot be read, is no such file, has no mesh of that number, is truncated or contradicts itself.
pub fn read_serialized(path: &Path, shape_index: usize, flip_v: bool) -> Result<LoadedMesh, MeshError> {
    read(path, |bytes| parse_serialized(bytes, shape_index, flip_v))
}

fn read(
    path: &Path,
    parse: impl FnOnce(&[u8]) -> Result<LoadedMesh, MeshError>,
) -> Result<LoadedMesh, MeshError> {
    let bytes = read_regular_file(path)
        .map_err(|(found, help)| MeshError::new(Place::File, "a readable file", found, help).in_file(path))?;
    parse(&bytes).map_err(|error| error.in_file(path))
}

#[cfg(test)]
pub(crate) mod fuzz;
#[cfg(test)]
mod tests;
