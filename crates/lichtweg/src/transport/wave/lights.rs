//! Lights chosen for sixteen points, and points on them: triangles and whole spheres in lanes, others one by one.

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{Float, FloatLanes, LANES, Lanes, Mask, Row, Wide};

use super::{lanes_of, lanes_of_vector, load_vector, set_vector, vec3};
use crate::color::{Spectra, SpectrumLanes};
use crate::lanes::warp;
use crate::light::{Cone, LightChoice, Receiver, Sight, pdf_leaving};
use crate::scene::offset::offset;
use crate::scene::{Facets, Scene, Sphere};
use crate::transport::light_end;
use crate::transport::packets::NO_ROW;

/// Sixteen points chosen on lights, as seen from points: [`LightSample`](crate::light::LightSample) in lanes.
pub struct LightLanes<W: Wide> {
    pub valid: W::Mask,
    /// Unit directions to them.
    pub direction: Vector<W::F32>,
    /// The points, where they are not infinitely far.
    pub target: Vector<W::F32>,
    pub near: W::Mask,
    pub radiance: Spectra<W::F32>,
    /// Of the choice of the light, and of the direction.
    pub probability: W::F32,
    pub pdf: W::F32,
    pub delta: W::Mask,
    /// See [`EmissionDensity`](crate::light::EmissionDensity).
    pub start: W::F32,
    pub leaving: W::F32,
    /// See [`NextEvent::spread`](crate::transport::light_end::NextEvent).
    pub spread: W::F32,
    /// Which were chosen.
    pub choices: [Option<LightChoice>; LANES],
}

/// The rows of sixteen chosen lights.
struct Chosen<'a> {
    forms: [&'a Row; LANES],
    emissions: [&'a Row; LANES],
    triangles: u32,
    spheres: u32,
}

/// Sixteen points on lights.
struct LightPoints<W: Wide> {
    position: Vector<W::F32>,
    normal: Vector<W::F32>,
    error: W::F32,
}

/// Chooses lights, and points on them, for sixteen points that receive on the side of their normals.
#[inline(always)]
pub fn lights<W: Wide>(
    scene: &Scene,
    position: Vector<W::F32>,
    normal: Vector<W::F32>,
    u_light: W::F32,
    [u0, u1]: [W::F32; 2],
    lanes: u32,
) -> LightLanes<W> {
    let u = u0.to_lanes();
    let mut chosen =
        Chosen { forms: [&NO_ROW; LANES], emissions: [&NO_ROW; LANES], triangles: 0, spheres: 0 };
    let (mut remapped, mut probability) = (u, Lanes::splat(0.0));
    let mut others = 0;
    let receiver = Receiver { position, normal };
    let choices = scene.selection().sample_lanes::<W>(&receiver, u_light, lanes);
    for lane in lanes_of(lanes) {
        let Some(choice) = &choices[lane] else { continue };
        probability.0[lane] = choice.probability;
        let Some(rows) = scene.light_rows(choice, u.0[lane]) else {
            others |= 1 << lane;
            continue;
        };
        (chosen.forms[lane], chosen.emissions[lane]) = (rows.form, rows.emission);
        remapped.0[lane] = rows.remapped;
        let kind = if rows.is_sphere { &mut chosen.spheres } else { &mut chosen.triangles };
        *kind |= 1 << lane;
    }
    let (mut out, near) = area_lights::<W>(position, &chosen, [W::F32::load(&remapped), u1]);
    others |= near;
    out.probability = W::F32::load(&probability);
    out.choices = choices;
    if others != 0 {
        let positions = lanes_of_vector(position);
        other_lights(scene, &positions, &choices, [&u, &u1.to_lanes()], others, &mut out);
    }
    out
}

/// Lights of any other kind, one by one.
#[inline(always)]
fn other_lights<W: Wide>(
    scene: &Scene,
    position: &[Lanes<f32>; 3],
    choices: &[Option<LightChoice>; LANES],
    u: [&Lanes<f32>; 2],
    lanes: u32,
    out: &mut LightLanes<W>,
) {
    let mut direction = [Lanes::splat(0.0); 3];
    let mut target = direction;
    let mut radiance = SpectrumLanes::new(Spectra([W::F32::splat(0.0); 4]));
    let (mut pdf, mut start, mut leaving) = (Lanes::splat(1.0), Lanes::splat(1.0), Lanes::splat(1.0));
    let mut spread = Lanes::splat(1.0);
    let (mut valid, mut near, mut delta) = (0, 0, 0);
    for lane in lanes_of(lanes) {
        let Some(choice) = &choices[lane] else { continue };
        let light = &scene.lights()[choice.light as usize];
        let (from, u) = (vec3(position, lane), [u[0].0[lane], u[1].0[lane]]);
        let Some((sample, point)) = light.sample_part(from, choice.triangle, u, scene) else { continue };
        valid |= 1 << lane;
        set_vector(&mut direction, lane, sample.direction);
        if let Some(point) = sample.target {
            near |= 1 << lane;
            set_vector(&mut target, lane, point);
        }
        radiance.set(lane, sample.radiance);
        pdf.0[lane] = sample.pdf;
        let density = light.emission_density(&sample, point.as_ref(), scene);
        (start.0[lane], leaving.0[lane]) = (density.start, density.leaving);
        spread.0[lane] = light_end::spread(&sample, point.as_ref(), from);
        delta |= u32::from(sample.delta) << lane;
    }
    let mask = W::Mask::from_bits;
    let here = mask(lanes);
    out.valid = out.valid.and_not(here) | mask(valid);
    out.near = out.near.and_not(here) | mask(near);
    out.delta = mask(delta);
    out.direction = load_vector::<W>(&direction).select(here, out.direction);
    out.target = load_vector::<W>(&target).select(here, out.target);
    out.radiance = radiance.load::<W::F32>().select(here, out.radiance);
    out.pdf = W::F32::load(&pdf).select(here, out.pdf);
    out.start = W::F32::load(&start).select(here, out.start);
    out.leaving = W::F32::load(&leaving).select(here, out.leaving);
    out.spread = W::F32::load(&spread).select(here, out.spread);
}

/// See [`AreaLight::sample`](crate::light::AreaLight::sample). With the lanes that are in, or all but in, their spheres: these are
/// left to others.
#[inline(always)]
fn area_lights<W: Wide>(from: Vector<W::F32>, chosen: &Chosen, u: [W::F32; 2]) -> (LightLanes<W>, u32) {
    let zero = W::F32::splat(0.0);
    let [r, g, b, c, inverse_area, two_sided, ..] = W::F32::columns(&chosen.emissions);
    let radiance = Spectra([r, g, b, c]);
    let mut point = triangle_points::<W>(&chosen.forms, u);
    let on_sphere = W::Mask::from_bits(chosen.spheres);
    let (mut cone_pdf, mut inside) = (zero, 0);
    if chosen.spheres != 0 {
        let sphere = Sphere::from_columns(&W::F32::columns(&chosen.forms));
        let cone = Cone::new(&sphere, from);
        let [position, normal] = cone.point(&sphere, u);
        point.position = position.select(on_sphere, point.position);
        point.normal = normal.select(on_sphere, point.normal);
        point.error = sphere.error.select(on_sphere, point.error);
        cone_pdf = cone.pdf();
        inside = on_sphere.and_not(cone.valid).bits();
    }
    let sight = Sight::new(from, point.position, point.normal);
    let pdf = cone_pdf.select(on_sphere, sight.per_solid_angle(inverse_area));
    let here = W::Mask::from_bits(chosen.triangles | chosen.spheres);
    let seen = here & !(sight.cos.le(zero).and_not(zero.lt(two_sided)));
    let valid = seen & zero.lt(pdf) & pdf.lt(W::F32::splat(f32::INFINITY)) & radiance.is_lit();
    let out = LightLanes {
        valid,
        direction: sight.direction,
        target: offset(point.position, point.error, point.normal, -sight.direction),
        near: here,
        radiance,
        probability: zero,
        pdf,
        delta: W::Mask::from_bits(0),
        start: inverse_area,
        leaving: pdf_leaving(zero.lt(two_sided), sight.cos),
        spread: sight.cos.abs(),
        choices: [None; LANES],
    };
    (out, inside)
}

#[inline(always)]
fn triangle_points<W: Wide>(forms: &[&Row; LANES], u: [W::F32; 2]) -> LightPoints<W> {
    let facets = Facets::<W::F32>::new(forms);
    let [_, b, c] = warp::uniform_triangle(u);
    let position = facets.corner + facets.edges[0] * b + facets.edges[1] * c;
    LightPoints { position, normal: facets.normal, error: facets.error }
}
