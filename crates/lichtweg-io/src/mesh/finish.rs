//! The checks that every mesh passes, whatever file it came from.

use lichtweg::scene::description::Mesh;
use lichtweg_ray::math::Vec2;

use super::normals::repair_normals;
use super::{LoadedMesh, MeshError, Place};

/// Checks that there is a triangle, that indices are in range and positions finite; repairs normals and texture
/// coordinates that are not.
pub(super) fn finish(
    mut mesh: Mesh,
    flip_v: bool,
    mut warnings: Vec<String>,
) -> Result<LoadedMesh, MeshError> {
    if mesh.triangles.is_empty() {
        return Err(MeshError::new(
            Place::File,
            "at least one face",
            format!("{} vertices and no face", mesh.positions.len()),
            "export the mesh with its faces, or remove the shape from the scene",
        ));
    }
    check_positions(&mesh)?;
    check_indices(&mesh)?;
    let repaired = repair_normals(&mut mesh);
    if repaired > 0 {
        let all = mesh.normals.len();
        warnings.push(format!(
            "{repaired} of {all} vertex normals are zero or not finite; those of the faces around are used"
        ));
    }
    let broken_uvs = mesh.uvs.iter().filter(|uv| !uv.is_finite()).count();
    if broken_uvs > 0 {
        let all = mesh.uvs.len();
        warnings.push(format!("{broken_uvs} of {all} texture coordinates are not finite; (0, 0) is used"));
        mesh.uvs.iter_mut().filter(|uv| !uv.is_finite()).for_each(|uv| *uv = Vec2::ZERO);
    }
    if flip_v {
        mesh.uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
    }
    Ok(LoadedMesh { mesh, face_normals: false, warnings })
}

fn check_positions(mesh: &Mesh) -> Result<(), MeshError> {
    let Some(first) = mesh.positions.iter().position(|p| !p.is_finite()) else { return Ok(()) };
    let count = mesh.positions.iter().filter(|p| !p.is_finite()).count();
    let p = mesh.positions[first];
    Err(MeshError::new(
        Place::File,
        "finite vertex positions",
        format!(
            "{count} of {} that are not; the first is vertex {first} (from 0) at ({}, {}, {})",
            mesh.positions.len(),
            p.x,
            p.y,
            p.z
        ),
        "repair the mesh in the program that wrote it",
    ))
}

fn check_indices(mesh: &Mesh) -> Result<(), MeshError> {
    let largest = mesh.triangles.iter().flatten().copied().max().unwrap_or(0);
    if (largest as usize) < mesh.positions.len() {
        return Ok(());
    }
    let out_of_range = |t: &[u32; 3]| t.iter().any(|&i| i as usize >= mesh.positions.len());
    let first = mesh.triangles.iter().position(out_of_range).unwrap_or(0);
    let count = mesh.triangles.iter().filter(|t| out_of_range(t)).count();
    Err(MeshError::new(
        Place::File,
        format!("vertex indices below {}, the number of vertices", mesh.positions.len()),
        format!(
            "{count} triangles with others; the first is triangle {first} (from 0) {:?}",
            mesh.triangles[first]
        ),
        "the file is damaged; export it again",
    ))
}
