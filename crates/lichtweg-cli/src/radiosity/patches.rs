//! A diffuse scene in patches, and the matrix of their exchange.
//!
//! The radiosity B_i of patch i (power that leaves per area) obeys B_i = E_i + rho_i sum_j F_ij B_j: the rendering equation with
//! everything constant on patches (Goral, Torrance, Greenberg, Battaile 1984). The form factor F_ij is the fraction of
//! cosine-distributed rays from i that meet j first, so that rows are transition probabilities of the walk that light takes
//! backwards, and 1 - rho_i is its absorption.
//!
//! Limits: spheres, disks and cylinders become triangles; there are no curves and no instances, and area lights alone;
//! reflectance and emission are taken at the centre of a patch; what is not diffuse counts by its albedo. The two sides of a
//! surface are patches of their own; one that neither scatters nor shines behind has no patch there, and is black.

use lichtweg::bsdf::Mode;
use lichtweg::light::Light;
use lichtweg::scene::offset::{offset, position_error};
use lichtweg::scene::{Form, MeshForm, Scene, SurfacePoint};
use lichtweg_montecarlo::{Sampler, SamplerKind, warp};
use lichtweg_ray::math::Vec3;
use lichtweg_ray::{Accel, BuildOptions, Ray, TriangleMesh};
use lichtweg_walk::{Matrix, System};
use rayon::prelude::*;

use super::quadric;

/// One side of a triangle, of constant radiosity.
struct Patch {
    corners: [Vec3; 3],
    /// Unit, on this side.
    normal: Vec3,
    reflectance: [f32; 3],
    /// pi times the emitted radiance.
    emission: [f32; 3],
}

/// A scene in patches.
pub struct Patches {
    patches: Vec<Patch>,
    /// Of each triangle: the patches in front and behind.
    sides: Vec<[Option<u32>; 2]>,
    accel: Accel,
}

/// More patches than this make a matrix that is no longer a demonstration.
const MOST: usize = 200_000;

impl Patches {
    /// Cuts the surfaces of a scene into patches with edges of about `edge`.
    ///
    /// # Errors
    /// Curves, lights other than area lights, too many patches, none at all.
    pub fn new(scene: &Scene, edge: f32) -> Result<Self, String> {
        if scene.lights().iter().any(|light| !matches!(light, Light::Area(_))) {
            return Err("radiosity knows emitting surfaces only: the scene has a point, spot, directional or environment light".into());
        }
        let mut patches: Vec<Patch> = Vec::new();
        let (mut positions, mut sides) = (Vec::new(), Vec::new());
        for shape in 0..scene.shape_count() as u32 {
            let pieces = match scene.form(shape) {
                Form::Mesh(mesh) => pieces_of_mesh(mesh, shape, edge),
                Form::Quadric(form) => quadric::triangles(form, shape, edge),
                Form::Curves(_) => {
                    return Err(
                        "radiosity knows triangles, spheres, disks and cylinders: the scene has curves"
                            .into(),
                    );
                }
            };
            for (corners, centre) in pieces {
                let [front, behind] = Patch::sides(scene, corners, &centre);
                if front.is_some() || behind.is_some() {
                    positions.extend(corners);
                    sides.push([front, behind].map(|patch| {
                        patches.push(patch?);
                        Some(patches.len() as u32 - 1)
                    }));
                }
            }
            if patches.len() > MOST {
                return Err(format!("more than {MOST} patches: take a larger --patch"));
            }
        }
        if patches.is_empty() {
            return Err("the scene has no surface".to_owned());
        }
        let triangles: Vec<[u32; 3]> =
            (0..sides.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriangleMesh::new(positions, triangles);
        let accel =
            Accel::build(vec![mesh.into()], BuildOptions::default()).map_err(|error| error.to_string())?;
        Ok(Self { patches, sides, accel })
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// The matrix of form factors, by `rays` rays from each patch.
    pub fn form_factors(&self, rays: u32, seed: u64) -> Matrix {
        let row = |i: usize| {
            let mut hits: Vec<u32> = (0..rays).filter_map(|ray| self.shoot(i, ray, seed)).collect();
            hits.sort_unstable();
            hits.chunk_by(|a, b| a == b)
                .map(|same| (i as u32, same[0], same.len() as f64 / f64::from(rays)))
                .collect()
        };
        let rows: Vec<Vec<(u32, u32, f64)>> = (0..self.len()).into_par_iter().map(row).collect();
        Matrix::from_triplets(self.len(), self.len(), &rows.concat()).unwrap_or_default()
    }

    /// The patch that a ray from patch `i` meets.
    fn shoot(&self, i: usize, ray: u32, seed: u64) -> Option<u32> {
        let patch = &self.patches[i];
        let mut sampler = Sampler::new(SamplerKind::Sobol, seed, i as u64, ray);
        let weights = warp::uniform_triangle(sampler.next_2d());
        let position =
            weights.iter().zip(patch.corners).fold(Vec3::ZERO, |sum, (&w, corner)| sum + corner * w);
        let local = warp::cosine_hemisphere(sampler.next_2d());
        let direction = lichtweg::bsdf::Frame::from_normal(patch.normal)
            .to_world(Vec3::new(local[0], local[1], local[2]));
        let error = position_error(patch.corners.iter().map(|c| c.abs().max_element()).fold(0.0, f32::max));
        self.seen(&Ray::new(offset(position, error, patch.normal, direction), direction))
    }

    /// The patch along a ray, where there is one on the side that it comes from.
    pub fn seen(&self, ray: &Ray) -> Option<u32> {
        let hit = self.accel.closest(ray)?;
        let faces = |patch: &u32| self.patches[*patch as usize].normal.dot(ray.direction) < 0.0;
        self.sides[hit.primitive as usize].into_iter().flatten().find(faces)
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

impl Patch {
    /// The front and the back of a triangle that looks like the surface at a point: the front always, the back where it is not
    /// black; neither where there is no area.
    fn sides(scene: &Scene, corners: [Vec3; 3], centre: &SurfacePoint) -> [Option<Self>; 2] {
        let [a, b, c] = corners;
        let Some(normal) = (b - a).cross(c - a).try_normalized() else { return [None, None] };
        let outward = if normal.dot(centre.geometric_normal) < 0.0 { -normal } else { normal };
        let side = |normal: Vec3, to: Vec3| Self {
            corners,
            normal,
            reflectance: reflectance(scene, centre, to),
            emission: emission(scene, centre, to),
        };
        let behind = side(-outward, -centre.geometric_normal);
        let black = behind.reflectance.iter().chain(&behind.emission).all(|&value| value == 0.0);
        [Some(side(outward, centre.geometric_normal)), (!black).then_some(behind)]
    }
}

/// The parts of the triangles of a mesh, and the point in the middle of each.
fn pieces_of_mesh(mesh: &MeshForm, shape: u32, edge: f32) -> Vec<([Vec3; 3], SurfacePoint)> {
    let mut found = Vec::new();
    for triangle in (0..mesh.triangles.len() as u32).filter(|&triangle| mesh.area(triangle) > 0.0) {
        let [a, b, c] = mesh.triangles[triangle as usize].map(|i| mesh.positions[i as usize]);
        let lengths = [b - a, c - b, a - c].map(|side| side.length_squared().sqrt());
        let cuts = (lengths.into_iter().fold(0.0, f32::max) / edge).ceil().clamp(1.0, 512.0) as u32;
        for corners in pieces(cuts) {
            let point = |[u, v]: [f32; 2]| mesh.point(shape, triangle, u, v);
            let centre = [0, 1].map(|k| corners.iter().map(|corner| corner[k]).sum::<f32>() / 3.0);
            found.push((corners.map(|corner| point(corner).position), point(centre)));
        }
        if found.len() > MOST {
            break;
        }
    }
    found
}

/// The albedo seen from a direction; zero where nothing is scattered there.
fn reflectance(scene: &Scene, centre: &SurfacePoint, to: Vec3) -> [f32; 3] {
    let scatterer = scene.scatterer(centre, to);
    let scatters = scatterer.sample(to, 0.5, [0.5, 0.5], Mode::Radiance).is_some();
    if scatters { scatterer.bsdf.albedo_hint().to_rgb() } else { [0.0; 3] }
}

/// pi times the radiance in a direction.
fn emission(scene: &Scene, centre: &SurfacePoint, to: Vec3) -> [f32; 3] {
    let Some((_, light)) = scene.area_light(centre) else { return [0.0; 3] };
    light.radiance(centre, to, scene.textures()).to_rgb().map(|l| std::f32::consts::PI * l)
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
