//! A diffuse scene in patches, and the matrix of their exchange.
//!
//! The radiosity B_i of patch i (power that leaves per area) obeys B_i = E_i + rho_i sum_j F_ij B_j: the rendering equation with
//! everything constant on patches (Goral, Torrance, Greenberg, Battaile 1984). The form factor F_ij is the fraction of
//! cosine-distributed rays from i that meet j first, so that rows are transition probabilities of the walk that light takes
//! backwards, and 1 - rho_i is its absorption.
//!
//! Limits: triangles only; reflectance and emission are taken at the centre of a patch; what is not diffuse counts by its
//! albedo; patches are black from behind.

use lichtweg::scene::{Form, Scene, SurfacePoint};
use lichtweg_montecarlo::{Sampler, SamplerKind, warp};
use lichtweg_ray::math::Vec3;
use lichtweg_ray::{Accel, BuildOptions, Ray, TriangleMesh};
use lichtweg_walk::{Matrix, System};
use rayon::prelude::*;

/// A part of a triangle.
struct Patch {
    shape: u32,
    triangle: u32,
    /// Corners as weights of the triangle's second and third corner.
    corners: [[f32; 2]; 3],
    normal: Vec3,
    reflectance: [f32; 3],
    /// pi times the emitted radiance.
    emission: [f32; 3],
}

/// A scene in patches.
pub struct Patches {
    patches: Vec<Patch>,
    accel: Accel,
}

/// More patches than this make a matrix that is no longer a demonstration.
const MOST: usize = 200_000;

impl Patches {
    /// Cuts the triangles of a scene into patches with edges of about `edge`.
    ///
    /// # Errors
    /// A shape that is not made of triangles, too many patches, none at all.
    pub fn new(scene: &Scene, edge: f32) -> Result<Self, String> {
        let mut patches = Vec::new();
        let mut positions = Vec::new();
        for shape in 0..scene.shape_count() as u32 {
            let Form::Mesh(mesh) = scene.form(shape) else {
                return Err(
                    "radiosity knows triangles only: the scene has a sphere, disk or cylinder".to_owned()
                );
            };
            for triangle in 0..mesh.triangles.len() as u32 {
                if mesh.area(triangle) <= 0.0 {
                    continue;
                }
                let [a, b, c] = mesh.triangles[triangle as usize].map(|i| mesh.positions[i as usize]);
                let longest = [b - a, c - b, a - c]
                    .map(|side| side.length_squared().sqrt())
                    .into_iter()
                    .fold(0.0, f32::max);
                let cuts = (longest / edge).ceil().clamp(1.0, 512.0) as u32;
                for corners in pieces(cuts) {
                    let point = |[u, v]: [f32; 2]| mesh.point(shape, triangle, u, v);
                    let centre =
                        point([0, 1].map(|k| corners.iter().map(|corner| corner[k]).sum::<f32>() / 3.0));
                    positions.extend(corners.map(|corner| point(corner).position));
                    patches.push(Patch {
                        shape,
                        triangle,
                        corners,
                        normal: centre.geometric_normal,
                        reflectance: scene
                            .scatterer(&centre, centre.shading_normal)
                            .bsdf
                            .albedo_hint()
                            .to_rgb(),
                        emission: emission(scene, &centre),
                    });
                }
                if patches.len() > MOST {
                    return Err(format!("more than {MOST} patches: take a larger --patch"));
                }
            }
        }
        if patches.is_empty() {
            return Err("the scene has no surface".to_owned());
        }
        let triangles: Vec<[u32; 3]> =
            (0..patches.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriangleMesh::new(positions, triangles);
        let accel =
            Accel::build(vec![mesh.into()], BuildOptions::default()).map_err(|error| error.to_string())?;
        Ok(Self { patches, accel })
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// The matrix of form factors, by `rays` rays from each patch.
    pub fn form_factors(&self, scene: &Scene, rays: u32, seed: u64) -> Matrix {
        let row = |i: usize| {
            let mut hits: Vec<u32> = (0..rays).filter_map(|ray| self.shoot(scene, i, ray, seed)).collect();
            hits.sort_unstable();
            hits.chunk_by(|a, b| a == b)
                .map(|same| (i as u32, same[0], same.len() as f64 / f64::from(rays)))
                .collect()
        };
        let rows: Vec<Vec<(u32, u32, f64)>> = (0..self.len()).into_par_iter().map(row).collect();
        Matrix::from_triplets(self.len(), self.len(), &rows.concat()).unwrap_or_default()
    }

    /// The patch that a ray from patch `i` meets from the front.
    fn shoot(&self, scene: &Scene, i: usize, ray: u32, seed: u64) -> Option<u32> {
        let patch = &self.patches[i];
        let Form::Mesh(mesh) = scene.form(patch.shape) else { return None };
        let mut sampler = Sampler::new(SamplerKind::Sobol, seed, i as u64, ray);
        let weights = warp::uniform_triangle(sampler.next_2d());
        let [u, v] =
            [0, 1].map(|k| weights.iter().zip(&patch.corners).map(|(w, corner)| w * corner[k]).sum::<f32>());
        let local = warp::cosine_hemisphere(sampler.next_2d());
        let direction = lichtweg::bsdf::Frame::from_normal(patch.normal)
            .to_world(Vec3::new(local[0], local[1], local[2]));
        let origin = mesh.point(patch.shape, patch.triangle, u, v).leave(direction);
        self.seen(&Ray::new(origin, direction))
    }

    /// The patch along a ray, if it shows its front.
    pub fn seen(&self, ray: &Ray) -> Option<u32> {
        let hit = self.accel.closest(ray)?;
        let faces = self.patches[hit.primitive as usize].normal.dot(ray.direction) < 0.0;
        faces.then_some(hit.primitive)
    }

    /// B = diag(rho) F B + E of one colour channel.
    ///
    /// # Errors
    /// Emission that is not finite.
    pub fn system(&self, form_factors: &Matrix, channel: usize) -> Result<System, String> {
        let entries = form_factors.triplets().map(|(i, j, factor)| {
            (i as u32, j as u32, factor * f64::from(self.patches[i].reflectance[channel]))
        });
        let matrix = Matrix::from_triplets(self.len(), self.len(), &entries.collect::<Vec<_>>());
        let emission = self.patches.iter().map(|patch| f64::from(patch.emission[channel])).collect();
        let matrix = matrix.map_err(|error| error.to_string())?;
        System::fixed_point(matrix, emission).map_err(|error| error.to_string())
    }
}

fn emission(scene: &Scene, centre: &SurfacePoint) -> [f32; 3] {
    let Some((_, light)) = scene.area_light(centre) else { return [0.0; 3] };
    light
        .radiance(centre, centre.geometric_normal, scene.textures())
        .to_rgb()
        .map(|l| std::f32::consts::PI * l)
}

/// The n^2 congruent parts of a triangle whose sides are cut into n.
fn pieces(n: u32) -> Vec<[[f32; 2]; 3]> {
    let at = |i: u32, j: u32| [i as f32 / n as f32, j as f32 / n as f32];
    let mut pieces = Vec::new();
    for i in 0..n {
        for j in 0..n - i {
            pieces.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 2 <= n {
                pieces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::pieces;

    #[test]
    fn pieces_tile_the_triangle() {
        for n in 1..6 {
            let pieces = pieces(n);
            assert_eq!(pieces.len() as u32, n * n);
            let area = |[a, b, c]: &[[f32; 2]; 3]| {
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            };
            assert!(pieces.iter().all(|piece| area(piece) > 0.0));
            assert!((pieces.iter().map(area).sum::<f32>() - 0.5).abs() < 1e-5);
        }
    }
}
