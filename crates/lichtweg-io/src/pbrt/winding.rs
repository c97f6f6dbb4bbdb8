//! Turning triangles so that their winding agrees with their vertex normals.
//!
//! pbrt turns the geometric normal of a triangle with vertex normals to the side of these (pbrt-v4 `shapes.h`,
//! `Triangle::InteractionFromIntersection`); it decides where a light emits and which side of glass is the inside.
//! The scene description knows the winding alone.
//!
//! Limits: decided by the sum of the three normals, in the mesh's own space. Turning a triangle of a mesh without
//! texture coordinates mirrors the default ones.

use lichtweg::scene::description::Mesh;

/// Reverses the triangles whose geometric normal opposes the sum of their vertex normals.
pub(super) fn agree_with_normals(mesh: &mut Mesh) {
    if mesh.normals.len() != mesh.positions.len() {
        return;
    }
    for triangle in &mut mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        let [na, nb, nc] = triangle.map(|i| mesh.normals[i as usize]);
        if (b - a).cross(c - a).dot(na + nb + nc) < 0.0 {
            triangle.swap(1, 2);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lichtweg_ray::math::Vec3;

    #[test]
    fn turns_only_what_disagrees() {
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, -1.0 * Vec3::X],
            normals: vec![Vec3::Z; 4],
            uvs: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 3, 2]],
        };
        agree_with_normals(&mut mesh);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        mesh.normals.clear();
        mesh.triangles = vec![[0, 3, 2]];
        agree_with_normals(&mut mesh);
        assert_eq!(mesh.triangles, [[0, 3, 2]]);
    }
}
