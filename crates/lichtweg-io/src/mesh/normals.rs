//! Vertex normals from the faces around a vertex.
//!
//! n = sum over corners of (angle of the corner) * (unit normal of the face): Thürmer and Wüthrich, "Computing vertex
//! normals from polygonal facets", Journal of Graphics Tools 3(1), 1998; as Mitsuba does. The angle makes the result
//! independent of how a polygon was cut into triangles.

use lichtweg::scene::description::Mesh;
use lichtweg_ray::math::Vec3;

/// Replaces all normals by those of the faces around each vertex, of unit length. A vertex with no face of any area gets
/// (1, 0, 0).
pub fn smooth_normals(mesh: &mut Mesh) {
    let mut sums = angle_weighted_sums(mesh);
    for n in &mut sums {
        *n = n.try_normalized().unwrap_or(Vec3::X);
    }
    mesh.normals = sums;
}

/// Replaces those normals that are zero or not finite; returns how many.
pub(super) fn repair_normals(mesh: &mut Mesh) -> usize {
    let broken = |n: &Vec3| n.try_normalized().is_none();
    let count = mesh.normals.iter().filter(|n| broken(n)).count();
    if count > 0 {
        let sums = angle_weighted_sums(mesh);
        for (n, sum) in mesh.normals.iter_mut().zip(sums) {
            if broken(n) {
                *n = sum.try_normalized().unwrap_or(Vec3::X);
            }
        }
    }
    count
}

fn angle_weighted_sums(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let p = triangle.map(|i| mesh.positions[i as usize]);
        let Some(normal) = (p[1] - p[0]).cross(p[2] - p[0]).try_normalized() else { continue };
        for corner in 0..3 {
            let a = p[(corner + 1) % 3] - p[corner];
            let b = p[(corner + 2) % 3] - p[corner];
            // atan2 keeps its precision at small angles, where acos of the cosine loses it.
            let angle = a.cross(b).length().atan2(a.dot(b));
            if angle.is_finite() {
                sums[triangle[corner] as usize] += normal * angle;
            }
        }
    }
    sums
}
