//! Sixteen walks at diffuse triangles: [`PathTracer::arrive`](super::PathTracer) for the commonest surface.
//!
//! The formulas are those of `bsdf::diffuse`, `bsdf::frame`, `light::area` and `montecarlo::warp`, in the same order of
//! operations; a test holds the two to the same bits.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};

use lichtweg_ray::HitPacket;
use lichtweg_ray::math::Vec3;
use lichtweg_ray::wide::{Float, LANES, Lanes, Mask, Row, Wide, Word};

use super::draws::Draws;
use super::queue::{ConnectionLanes, WalkLanes};
use super::vector::{Spectra, Vector};
use super::{PathObserver, Step, lanes_of};
use crate::light::{LightChoice, Receiver, TrianglePick};
use crate::scene::description::{Heuristic, LightStrategy};
use crate::scene::{Diffuse, Facets, Form};
use crate::transport::path::SHADOW_END;

/// Sixteen points on diffuse triangles, and the shading frames there.
struct Points<W: Wide> {
    position: Vector<W::F32>,
    error: W::F32,
    geometric_normal: Vector<W::F32>,
    tangent: Vector<W::F32>,
    bitangent: Vector<W::F32>,
    normal: Vector<W::F32>,
    reflectance: Spectra<W::F32>,
    /// Whether the walk came from the side that reflects.
    lit_side: W::Mask,
}

/// Sixteen points chosen on lights, as seen from points.
struct LightLanes<W: Wide> {
    valid: W::Mask,
    /// Unit directions to them.
    direction: Vector<W::F32>,
    /// The points, where they are not infinitely far.
    target: Vector<W::F32>,
    near: W::Mask,
    radiance: Spectra<W::F32>,
    /// Of the choice of the light, and of the direction.
    probability: W::F32,
    pdf: W::F32,
    delta: W::Mask,
}

#[inline(always)]
fn vector<W: Wide>([x, y, z]: [W::F32; 3]) -> Vector<W::F32> {
    Vector::new(x, y, z)
}

#[inline(always)]
fn load_vector<W: Wide>(v: &[Lanes<f32>; 3]) -> Vector<W::F32> {
    Vector::new(W::F32::load(&v[0]), W::F32::load(&v[1]), W::F32::load(&v[2]))
}

#[inline(always)]
fn load_spectra<W: Wide>(s: &[Lanes<f32>; 4]) -> Spectra<W::F32> {
    Spectra([W::F32::load(&s[0]), W::F32::load(&s[1]), W::F32::load(&s[2]), W::F32::load(&s[3])])
}

#[inline(always)]
fn lanes_of_vector<W: Wide>(v: Vector<W::F32>) -> [Lanes<f32>; 3] {
    [v.x.to_lanes(), v.y.to_lanes(), v.z.to_lanes()]
}

#[inline(always)]
fn vector_at(v: &[Lanes<f32>; 3], lane: usize) -> Vec3 {
    Vec3::new(v[0].0[lane], v[1].0[lane], v[2].0[lane])
}

#[inline(always)]
fn set_vector(to: &mut [Lanes<f32>; 3], lane: usize, v: Vec3) {
    (to[0].0[lane], to[1].0[lane], to[2].0[lane]) = (v.x, v.y, v.z);
}

/// See `scene::offset`.
#[inline(always)]
fn offset<W: Wide>(
    position: Vector<W::F32>,
    error: W::F32,
    normal: Vector<W::F32>,
    direction: Vector<W::F32>,
) -> Vector<W::F32> {
    position + normal * error.copysign(normal.dot(direction))
}

/// See `warp::cosine_hemisphere_pdf`.
#[inline(always)]
fn cosine_pdf<W: Wide>(cos_theta: W::F32) -> W::F32 {
    cos_theta.max(W::F32::splat(0.0)) * W::F32::splat(FRAC_1_PI)
}

/// See `warp::uniform_disk`.
#[inline(always)]
fn uniform_disk<W: Wide>([u, v]: [W::F32; 2]) -> [W::F32; 2] {
    let splat = W::F32::splat;
    let (a, b) = (splat(2.0) * u - splat(1.0), splat(2.0) * v - splat(1.0));
    let steep = a.abs().le(b.abs());
    let (radius, other) = (b.select(steep, a), a.select(steep, b));
    let zero = splat(0.0);
    let ratio = zero.select(radius.equal(zero), other / radius);
    let x = splat(FRAC_PI_4) * ratio;
    let y = x * x;
    let sin = x
        * (splat(1.0)
            + y * (splat(-1.0 / 6.0)
                + y * (splat(1.0 / 120.0) + y * (splat(-1.0 / 5040.0) + y * splat(1.0 / 362_880.0)))));
    let cos = splat(1.0)
        + y * (splat(-0.5) + y * (splat(1.0 / 24.0) + y * (splat(-1.0 / 720.0) + y * splat(1.0 / 40_320.0))));
    [radius * sin.select(steep, cos), radius * cos.select(steep, sin)]
}

/// Rows to point at where a lane has none.
static NO_ROW: Row = Lanes([0.0; LANES]);

impl<O: PathObserver> Step<'_, O> {
    /// Deals with the walks that arrived at diffuse triangles that do not emit; which lanes these are.
    #[inline(always)]
    pub(super) fn diffuse_vertices<W: Wide>(
        &mut self,
        walks: WalkLanes<W>,
        active: u32,
        hits: &HitPacket,
    ) -> u32 {
        let mut fast = 0;
        let mut facets = [&NO_ROW; LANES];
        let mut materials: [Option<&Diffuse>; LANES] = [None; LANES];
        let mut smooth = 0;
        let mut normals = [Lanes::splat(0.0); 3];
        for lane in lanes_of(active) {
            let Some(hit) = hits.get(lane) else { continue };
            let Some((Form::Mesh(mesh), diffuse)) = self.scene.diffuse(&hit) else { continue };
            fast |= 1 << lane;
            facets[lane] = mesh.row(hit.primitive);
            materials[lane] = Some(diffuse);
            if mesh.is_smooth() {
                smooth |= 1 << lane;
                set_vector(&mut normals, lane, mesh.shading_normal(hit.primitive, hit.u, hit.v));
            }
        }
        if fast == 0 || self.depth >= self.tracer.max_depth() {
            return fast;
        }
        let shading = (W::Mask::from_bits(smooth), load_vector::<W>(&normals));
        let points = self.points::<W>(&walks, hits, &facets, &materials, shading, fast);
        self.scatter::<W>(walks, &points, W::Mask::from_bits(fast));
        fast
    }

    #[inline(always)]
    fn points<W: Wide>(
        &self,
        walks: &WalkLanes<W>,
        hits: &HitPacket,
        facets: &[&Row; LANES],
        materials: &[Option<&Diffuse>; LANES],
        (smooth, normals): (W::Mask, Vector<W::F32>),
        fast: u32,
    ) -> Points<W> {
        let splat = W::F32::splat;
        let facet = Facets::<W::F32>::new(facets);
        let (u, v) = (W::F32::load(&hits.u), W::F32::load(&hits.v));
        let position =
            vector::<W>(facet.corner) + vector::<W>(facet.edges[0]) * u + vector::<W>(facet.edges[1]) * v;
        let geometric_normal = vector::<W>(facet.normal);
        let normal = normals.select(smooth, geometric_normal);
        let wo = -walks.direction;
        let front = splat(0.0).lt(normal.dot(wo));
        // The material of the side that is seen; a one-sided one is seen from the front only.
        let mut rows = [&NO_ROW; LANES];
        let mut textured = 0;
        for lane in lanes_of(fast) {
            let Some(diffuse) = materials[lane] else { continue };
            rows[lane] = &diffuse.row;
            textured |= u32::from(diffuse.is_textured()) << lane;
        }
        let [r, g, b, c, back_r, back_g, back_b, back_c, two_sided, ..] = W::F32::columns(&rows);
        let mut reflectance = Spectra([r, g, b, c]).select(front, Spectra([back_r, back_g, back_b, back_c]));
        if textured != 0 {
            let [r, g, b, c] = reflectance.0;
            let mut values = [r.to_lanes(), g.to_lanes(), b.to_lanes(), c.to_lanes()];
            let front = front.bits();
            for lane in lanes_of(textured) {
                let (Some(diffuse), Some(hit)) = (materials[lane], hits.get(lane)) else { continue };
                let value = self.scene.diffuse_reflectance(diffuse, &hit, front >> lane & 1 != 0);
                for (to, from) in values.iter_mut().zip(value.0) {
                    to.0[lane] = from;
                }
            }
            reflectance = load_spectra::<W>(&values);
        }
        let flipped = splat(0.0).lt(two_sided).and_not(front);
        let n = (-normal).select(flipped, normal);
        // See `bsdf::Frame::from_normal`.
        let one = splat(1.0);
        let sign = one.copysign(n.z);
        let a = splat(-1.0) / (sign + n.z);
        let b = n.x * n.y * a;
        let tangent = Vector::new(one + sign * n.x * n.x * a, sign * b, -sign * n.x);
        let bitangent = Vector::new(b, sign + n.y * n.y * a, -n.y);
        Points {
            position,
            error: facet.error,
            geometric_normal,
            tangent,
            bitangent: (-bitangent).select(flipped, bitangent),
            normal: n,
            reflectance,
            lit_side: splat(0.0).lt(wo.dot(n)),
        }
    }

    /// Connects sixteen walks to lights, and sends them on.
    #[inline(always)]
    fn scatter<W: Wide>(&mut self, mut walks: WalkLanes<W>, points: &Points<W>, fast: W::Mask) {
        let splat = W::F32::splat;
        let zero = splat(0.0);
        let tracer = self.tracer;
        let mut draws = Draws::<W> {
            kind: self.wave.paths.kind(),
            key: [
                W::U32::gather(&self.wave.paths.key[0], walks.path),
                W::U32::gather(&self.wave.paths.key[1], walks.path),
            ],
            index: W::U32::gather(&self.wave.paths.index, walks.path),
            dimension: walks.dimension,
        };
        let reflected = |pdf: W::F32| points.reflectance * pdf;
        let connects = tracer.light != LightStrategy::Naive;
        if connects {
            let (u_light, u) = (draws.next_1d(), draws.next_2d());
            let light = self.lights::<W>(points, u_light, u, fast.bits());
            let cos = light.direction.dot(points.normal);
            let pdf_bsdf = cosine_pdf::<W>(cos).select(points.lit_side, zero);
            let scattering = reflected(pdf_bsdf);
            let pdf = light.probability * light.pdf;
            let weight = match tracer.light {
                LightStrategy::Mis => {
                    let ratio = pdf_bsdf / pdf;
                    let ratio = match tracer.heuristic {
                        Heuristic::Balance => ratio,
                        Heuristic::Power => ratio * ratio,
                    };
                    splat(1.0).select(light.delta, splat(1.0) / (splat(1.0) + ratio))
                }
                _ => splat(1.0),
            };
            let contribution = walks.throughput * (scattering * light.radiance * (weight / pdf));
            let origin = offset::<W>(points.position, points.error, points.geometric_normal, light.direction);
            let connection = ConnectionLanes::<W> {
                origin,
                direction: (light.target - origin).select(light.near, light.direction),
                tfar: splat(1.0 - SHADOW_END).select(light.near, splat(f32::INFINITY)),
                contribution,
                path: walks.path,
            };
            let mask = fast & light.valid & scattering.is_lit();
            self.wave.connections.append(&connection, mask);
        }
        draws.skip(1);
        let [x, y] = uniform_disk::<W>(draws.next_2d());
        let z = (splat(1.0) - x * x - y * y).max(zero).sqrt();
        let pdf = cosine_pdf::<W>(z).select(points.lit_side, zero);
        let wi = points.tangent * x + points.bitangent * y + points.normal * z;
        let mut throughput = walks.throughput * points.reflectance;
        let mut alive = fast & zero.lt(pdf) & throughput.is_lit();
        if self.depth >= tracer.roulette.start_depth {
            let eta = W::F32::gather(&self.wave.paths.eta, walks.path);
            let survival =
                (throughput.max_element() * eta * eta).max(zero).min(splat(tracer.roulette.max_survival));
            let plays = survival.lt(splat(1.0));
            let before = draws.dimension;
            let u = draws.next_1d();
            draws.dimension = draws.dimension.select(plays, before);
            alive = alive.and_not(plays & survival.le(u));
            throughput = (throughput * (splat(1.0) / survival)).select(plays, throughput);
        }
        walks.origin = offset::<W>(points.position, points.error, points.geometric_normal, wi);
        walks.direction = wi;
        walks.throughput = throughput;
        walks.departure = points.position;
        walks.departure_pdf = if connects { pdf } else { splat(super::queue::NO_PDF) };
        walks.dimension = draws.dimension;
        if self.scene.selection().is_by_place() {
            let (normals, path) = (lanes_of_vector::<W>(points.normal), walks.path.to_lanes());
            for lane in lanes_of(alive.bits()) {
                self.wave.paths.normal[path.0[lane] as usize] = vector_at(&normals, lane);
            }
        }
        self.wave.next.append(&walks, alive);
    }

    /// Chooses lights, and points on them, for sixteen points.
    #[inline(always)]
    fn lights<W: Wide>(
        &self,
        points: &Points<W>,
        u_light: W::F32,
        u: [W::F32; 2],
        fast: u32,
    ) -> LightLanes<W> {
        let scene = self.scene;
        let zeros = Lanes::splat(0.0);
        let u_light = u_light.to_lanes();
        let [u0, u1] = [u[0].to_lanes(), u[1].to_lanes()];
        let mut facets = [&NO_ROW; LANES];
        let mut emissions = [&NO_ROW; LANES];
        let (mut remapped, mut probability) = (zeros, zeros);
        let mut triangles = 0;
        let mut others = 0;
        let (positions, normals) =
            (lanes_of_vector::<W>(points.position), lanes_of_vector::<W>(points.normal));
        let receiver =
            |lane| Receiver { position: vector_at(&positions, lane), normal: vector_at(&normals, lane) };
        let receivers: [Receiver; LANES] = std::array::from_fn(receiver);
        let numbers = std::array::from_fn(|lane| (fast >> lane & 1 != 0).then_some(u_light.0[lane]));
        let choices = scene.selection().sample_many(&receivers, &numbers);
        for lane in lanes_of(fast) {
            let Some(choice) = &choices[lane] else { continue };
            probability.0[lane] = choice.probability;
            match scene.pick_triangle(choice, u0.0[lane]) {
                Some(TrianglePick { facet, emission, remapped: u }) => {
                    triangles |= 1 << lane;
                    facets[lane] = facet;
                    emissions[lane] = emission;
                    remapped.0[lane] = u;
                }
                None => others |= 1 << lane,
            }
        }
        let mut out = self.triangle_lights::<W>(
            points,
            &facets,
            &emissions,
            [W::F32::load(&remapped), u[1]],
            W::Mask::from_bits(triangles),
        );
        out.probability = W::F32::load(&probability);
        if others != 0 {
            self.other_lights(points, &choices, [&u0, &u1], others, &mut out);
        }
        out
    }

    /// See `light::area`.
    #[inline(always)]
    fn triangle_lights<W: Wide>(
        &self,
        points: &Points<W>,
        facets: &[&Row; LANES],
        emissions: &[&Row; LANES],
        [u, v]: [W::F32; 2],
        triangles: W::Mask,
    ) -> LightLanes<W> {
        let splat = W::F32::splat;
        let zero = splat(0.0);
        let facet = Facets::<W::F32>::new(facets);
        let [r, g, b, c, inverse_area, two_sided, ..] = W::F32::columns(emissions);
        // See `warp::uniform_triangle`.
        let half = splat(0.5);
        let upper = u.lt(v);
        let b0 = (half * u).select(upper, u - half * v);
        let b1 = (v - half * u).select(upper, half * v);
        let b2 = (splat(1.0) - b0 - b1).max(zero);
        let position =
            vector::<W>(facet.corner) + vector::<W>(facet.edges[0]) * b1 + vector::<W>(facet.edges[1]) * b2;
        let normal = vector::<W>(facet.normal);
        let to_light = position - points.position;
        let distance_squared = to_light.dot(to_light);
        let direction = to_light * (splat(1.0) / distance_squared.sqrt());
        let cos = normal.dot(-direction);
        let pdf = inverse_area * distance_squared / cos.abs();
        let radiance = Spectra([r, g, b, c]);
        let seen = triangles & !(cos.le(zero).and_not(zero.lt(two_sided)));
        let valid = seen & zero.lt(pdf) & pdf.lt(splat(f32::INFINITY)) & radiance.is_lit();
        LightLanes {
            valid,
            direction,
            target: offset::<W>(position, facet.error, normal, -direction),
            near: triangles,
            radiance,
            probability: zero,
            pdf,
            delta: W::Mask::from_bits(0),
        }
    }

    /// Lights of any other kind, one by one.
    #[inline(always)]
    fn other_lights<W: Wide>(
        &self,
        points: &Points<W>,
        choices: &[Option<LightChoice>; LANES],
        u: [&Lanes<f32>; 2],
        lanes: u32,
        out: &mut LightLanes<W>,
    ) {
        let position = lanes_of_vector::<W>(points.position);
        let mut direction = [Lanes::splat(0.0); 3];
        let mut target = direction;
        let mut radiance = [Lanes::splat(0.0); 4];
        let mut pdf = Lanes::splat(1.0);
        let (mut valid, mut near, mut delta) = (0, 0, 0);
        for lane in lanes_of(lanes) {
            let Some(choice) = &choices[lane] else { continue };
            let light = &self.scene.lights()[choice.light as usize];
            let (from, u) = (vector_at(&position, lane), [u[0].0[lane], u[1].0[lane]]);
            let Some((sample, _)) = light.sample_part(from, choice.triangle, u, self.scene) else { continue };
            valid |= 1 << lane;
            set_vector(&mut direction, lane, sample.direction);
            if let Some(point) = sample.target {
                near |= 1 << lane;
                set_vector(&mut target, lane, point);
            }
            for (to, from) in radiance.iter_mut().zip(sample.radiance.0) {
                to.0[lane] = from;
            }
            pdf.0[lane] = sample.pdf;
            delta |= u32::from(sample.delta) << lane;
        }
        let mask = W::Mask::from_bits;
        let here = mask(lanes);
        out.valid = out.valid | mask(valid);
        out.near = out.near | mask(near);
        out.delta = mask(delta);
        out.direction = load_vector::<W>(&direction).select(here, out.direction);
        out.target = load_vector::<W>(&target).select(here, out.target);
        out.radiance = load_spectra::<W>(&radiance).select(here, out.radiance);
        out.pdf = W::F32::load(&pdf).select(here, out.pdf);
    }
}
