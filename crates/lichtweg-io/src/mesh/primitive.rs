//! Meshes of simple shapes, in the forms and parametrisations of Mitsuba 3 (`src/shapes/rectangle.cpp`,
//! `src/shapes/cube.cpp`).

use lichtweg::scene::description::Mesh;
use lichtweg_ray::math::{Vec2, Vec3};

/// The square [-1, 1]^2 in the plane z = 0 with normal +z; (u, v) runs from (0, 0) at (-1, -1) to (1, 1) at (1, 1).
pub fn rectangle() -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    Mesh {
        positions: corners.iter().map(|&(x, y)| Vec3::new(x, y, 0.0)).collect(),
        normals: Vec::new(),
        uvs: corners.iter().map(|&(x, y)| Vec2::new(0.5 * x + 0.5, 0.5 * y + 0.5)).collect(),
        triangles: vec![[0, 1, 2], [2, 3, 0]],
    }
}

/// The cube [-1, 1]^3 with outward winding; every face has its own four vertices and the whole of [0, 1]^2 as its (u, v).
/// Faceted, so it carries no normals.
pub fn cube() -> Mesh {
    // Each face: the corner with (u, v) = (0, 0), and the directions in which u and v grow; the outside is along v x u.
    let faces = [
        (Vec3::new(-1.0, -1.0, -1.0), Vec3::Z, Vec3::X),
        (Vec3::new(1.0, 1.0, 1.0), -Vec3::X, -Vec3::Z),
        (Vec3::new(1.0, -1.0, 1.0), Vec3::Y, -Vec3::Z),
        (Vec3::new(-1.0, -1.0, 1.0), Vec3::Y, Vec3::X),
        (Vec3::new(-1.0, -1.0, -1.0), Vec3::Y, Vec3::Z),
        (Vec3::new(-1.0, 1.0, -1.0), -Vec3::Y, Vec3::X),
    ];
    let uvs = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)];
    let mut mesh = Mesh::default();
    for (origin, along_u, along_v) in faces {
        let base = mesh.positions.len() as u32;
        for (u, v) in uvs {
            mesh.positions.push(origin + along_u * (2.0 * u) + along_v * (2.0 * v));
            mesh.uvs.push(Vec2::new(u, v));
        }
        mesh.triangles.extend([[base, base + 1, base + 2], [base + 3, base, base + 2]]);
    }
    mesh
}
