//! Sixteen hits as points: on triangles and on whole spheres, with the rows of what is there.

use lichtweg_ray::HitPacket;
use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Mask, Row, Wide};

use super::{lanes_of, load_vector, set_vector};
use crate::bsdf::Frame;
use crate::color::{Spectra, SpectrumLanes};
use crate::scene::{Facets, Form, LobeMaterial, Scene, Sphere};
use crate::transport::packets::NO_ROW;

/// What sixteen walks have hit, as far as they can be dealt with at once.
pub struct Arrivals<'a> {
    scene: &'a Scene,
    hits: &'a HitPacket,
    /// Walks that hit a simple surface.
    pub lanes: u32,
    /// Walks that left the scene.
    pub gone: u32,
    /// Those on lights.
    pub emitting: u32,
    /// The light, where there is one, and its row.
    pub light: Lanes<u32>,
    pub emission: [&'a Row; LANES],
    forms: [&'a Row; LANES],
    spheres: u32,
    /// Shading normals of meshes that have them.
    smooth: u32,
    normals: [Lanes<f32>; 3],
    materials: [Option<&'a LobeMaterial>; LANES],
}

/// Sixteen points on surfaces.
pub struct Points<W: Wide> {
    pub position: Vector<W::F32>,
    pub error: W::F32,
    pub geometric_normal: Vector<W::F32>,
    pub shading_normal: Vector<W::F32>,
}

/// What scatters at sixteen points.
pub struct Materials<W: Wide> {
    /// See [`Scatterer::frame`](crate::scene::Scatterer).
    pub frame: Frame<W::F32>,
    /// The columns of [`LobeMaterial::rows`]; of no model where there is no point.
    pub columns: [W::F32; LANES],
}

impl<'a> Arrivals<'a> {
    /// Looks up what was hit.
    #[inline(always)]
    pub fn new(scene: &'a Scene, active: u32, hits: &'a HitPacket) -> Self {
        let mut out = Self {
            scene,
            hits,
            lanes: 0,
            gone: 0,
            emitting: 0,
            light: Lanes::splat(0),
            emission: [&NO_ROW; LANES],
            forms: [&NO_ROW; LANES],
            spheres: 0,
            smooth: 0,
            normals: [Lanes::splat(0.0); 3],
            materials: [None; LANES],
        };
        for lane in lanes_of(active) {
            let bit = 1 << lane;
            let Some(hit) = hits.get(lane) else {
                out.gone |= bit;
                continue;
            };
            let Some(surface) = scene.simple_surface(&hit) else { continue };
            match surface.form {
                Form::Mesh(mesh) => {
                    out.forms[lane] = mesh.row(hit.primitive);
                    if mesh.is_smooth() {
                        out.smooth |= bit;
                        let normal = mesh.shading_normal(hit.primitive, hit.u, hit.v);
                        set_vector(&mut out.normals, lane, normal);
                    }
                }
                Form::Quadric(quadric) => {
                    let Some(sphere) = &quadric.sphere else { continue };
                    out.forms[lane] = sphere;
                    out.spheres |= bit;
                }
                Form::Curves(_) => continue,
            }
            if let Some((light, row)) = surface.light {
                out.emitting |= bit;
                (out.light.0[lane], out.emission[lane]) = (light, row);
            }
            out.materials[lane] = Some(surface.material);
            out.lanes |= bit;
        }
        out
    }

    /// Numbers of the primitives that were hit.
    #[inline(always)]
    pub fn primitives(&self) -> &Lanes<u32> {
        &self.hits.primitive
    }

    /// Whether a walk is on a sphere.
    #[inline(always)]
    pub fn on_sphere<W: Wide>(&self) -> W::Mask {
        W::Mask::from_bits(self.spheres)
    }

    /// The forms as spheres, of no meaning where they are not.
    #[inline(always)]
    pub fn spheres<W: Wide>(&self) -> Sphere<W::F32> {
        Sphere::from_columns(&W::F32::columns(&self.forms))
    }

    /// The points that rays hit.
    #[inline(always)]
    pub fn points<W: Wide>(&self, origin: Vector<W::F32>, direction: Vector<W::F32>) -> Points<W> {
        let facets = Facets::<W::F32>::new(&self.forms);
        let (u, v) = (W::F32::load(&self.hits.u), W::F32::load(&self.hits.v));
        let normal = facets.normal;
        let on_triangles = Points {
            position: facets.corner + facets.edges[0] * u + facets.edges[1] * v,
            error: facets.error,
            geometric_normal: normal,
            shading_normal: load_vector::<W>(&self.normals).select(W::Mask::from_bits(self.smooth), normal),
        };
        if self.spheres == 0 {
            return on_triangles;
        }
        let sphere = self.spheres::<W>();
        let near = origin + direction * W::F32::load(&self.hits.t);
        let [position, normal] = sphere.nearest(near);
        let on_spheres =
            Points { position, error: sphere.error, geometric_normal: normal, shading_normal: normal };
        on_spheres.select(self.on_sphere::<W>(), on_triangles)
    }

    /// What scatters at the points towards the directions `wo`; see
    /// [`MaterialArena::scatterer`](crate::scene::MaterialArena::scatterer).
    #[inline(always)]
    pub fn materials<W: Wide>(&self, normal: Vector<W::F32>, wo: Vector<W::F32>) -> Materials<W> {
        let zero = W::F32::splat(0.0);
        let front = zero.lt(normal.dot(wo));
        let front_bits = front.bits();
        let mut rows = [&NO_ROW; LANES];
        let mut textured = 0;
        for lane in lanes_of(self.lanes) {
            let Some(material) = self.materials[lane] else { continue };
            // The material of the side that is seen; a one-sided one is seen from the front only.
            rows[lane] = &material.rows[usize::from(front_bits >> lane & 1 == 0)];
            textured |= u32::from(material.is_textured()) << lane;
        }
        let mut columns = W::F32::columns(&rows);
        if textured != 0 {
            let [r, g, b, c, ..] = columns;
            let mut values = SpectrumLanes::new(Spectra([r, g, b, c]));
            for lane in lanes_of(textured) {
                let (Some(material), Some(hit)) = (self.materials[lane], self.hits.get(lane)) else {
                    continue;
                };
                values.set(lane, self.scene.lobe_reflectance(material, &hit, front_bits >> lane & 1 != 0));
            }
            columns[..4].copy_from_slice(&values.load::<W::F32>().0);
        }
        let mirrored = LobeMaterial::is_two_sided(&columns).and_not(front);
        let frame = Frame::from_normal((-normal).select(mirrored, normal));
        let bitangent = (-frame.bitangent).select(mirrored, frame.bitangent);
        Materials { frame: Frame { bitangent, ..frame }, columns }
    }
}

impl<W: Wide> Points<W> {
    #[inline(always)]
    fn select(self, mask: W::Mask, other: Self) -> Self {
        Self {
            position: self.position.select(mask, other.position),
            error: self.error.select(mask, other.error),
            geometric_normal: self.geometric_normal.select(mask, other.geometric_normal),
            shading_normal: self.shading_normal.select(mask, other.shading_normal),
        }
    }
}
