//! What the choice of lights needs to know of each: its power, where it is, and where it shines.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use lichtweg_ray::math::{Bounds3, Vec3};

use super::Shape;
use super::surface::{Form, MeshForm};
use crate::light::{AreaLight, Candidate, Light, LightBounds, Spot};
use crate::texture::{Input, TextureArena};

/// A light, for the choice among all; the scene has this radius.
pub(super) fn candidate(
    light: &Light,
    shapes: &[Shape],
    textures: &TextureArena,
    scene_radius: f32,
) -> Candidate {
    let power = power(light, shapes, textures, scene_radius);
    let one = |bounds| Candidate { power, parts: vec![(bounds, 1.0)], in_triangles: false };
    match light {
        Light::Point(l) => {
            let intensity = l.intensity.max_element();
            one(LightBounds { intensity, ..everywhere(Bounds3::of([l.position])) })
        }
        Light::Spot(l) => one(spot(l)),
        Light::Directional(_) | Light::Environment(_) => {
            Candidate { power, parts: Vec::new(), in_triangles: false }
        }
        Light::Area(l) => match &shapes[l.shape as usize].form {
            Form::Mesh(mesh) => {
                let parts = triangles(l, mesh, textures, power);
                Candidate { power, parts, in_triangles: true }
            }
            form => {
                let (axis, spread) = form.normal_cone(l.shape);
                let two_sided = l.two_sided;
                let intensity = power * if spread < PI { 1.0 / PI } else { 0.25 / PI };
                one(LightBounds { bounds: form.bounds(), axis, spread, two_sided, intensity })
            }
        },
    }
}

fn everywhere(bounds: Bounds3) -> LightBounds {
    LightBounds { bounds, axis: Vec3::Z, spread: PI, two_sided: false, intensity: 0.0 }
}

fn spot(light: &Spot) -> LightBounds {
    // All within a right angle of the axis, if the cone is not wider.
    let spread = if light.cutoff < FRAC_PI_2 { 0.0 } else { PI };
    let bounds = Bounds3::of([light.position]);
    LightBounds { axis: light.axis, spread, intensity: light.intensity.max_element(), ..everywhere(bounds) }
}

/// The triangles of a mesh, with their shares of its area.
fn triangles(
    light: &AreaLight,
    mesh: &MeshForm,
    textures: &TextureArena,
    power: f32,
) -> Vec<(LightBounds, f32)> {
    let count = mesh.triangles.len() as u32;
    let area: f64 = (0..count).map(|i| f64::from(mesh.area(i))).sum();
    let sides = if light.two_sided { 2.0 } else { 1.0 };
    (0..count)
        .map(|i| {
            let share = (f64::from(mesh.area(i)) / area) as f32;
            let point = mesh.point(light.shape, i, 0.0, 0.0);
            let bounds = LightBounds {
                bounds: Bounds3::of(mesh.triangles[i as usize].map(|v| mesh.positions[v as usize])),
                axis: point.geometric_normal,
                spread: 0.0,
                two_sided: light.two_sided,
                intensity: power * share * brightness(light, mesh, i, textures) / (PI * sides),
            };
            (bounds, share)
        })
        .collect()
}

/// About how bright a triangle is beside the mean of its light, and at least half as bright: a few looks at a texture may miss
/// what shines.
fn brightness(light: &AreaLight, mesh: &MeshForm, triangle: u32, textures: &TextureArena) -> f32 {
    const LOOKS: [[f32; 2]; 4] = [[0.33, 0.33], [0.67, 0.17], [0.17, 0.67], [0.17, 0.17]];
    let mean = textures.mean(light.radiance).max_element();
    if matches!(light.radiance, Input::Constant(_)) || mean <= 0.0 {
        return 1.0;
    }
    let look = |[u, v]: [f32; 2]| {
        let point = mesh.point(light.shape, triangle, u, v);
        textures.eval(light.radiance, point.uv).max_element()
    };
    let seen = LOOKS.map(look).iter().sum::<f32>() / (mean * LOOKS.len() as f32);
    // Textures may hold anything.
    if seen.is_finite() { 0.5 + 0.5 * seen.clamp(0.0, 1e3) } else { 1.0 }
}

/// Emitted power, about: for the choice of lights.
fn power(light: &Light, shapes: &[Shape], textures: &TextureArena, scene_radius: f32) -> f32 {
    let disk = PI * scene_radius * scene_radius;
    let emitted = match light {
        Light::Area(l) => {
            let sides = if l.two_sided { 2.0 } else { 1.0 };
            textures.mean(l.radiance) * (l.factor * PI * sides * l.area(&shapes[l.shape as usize].form))
        }
        Light::Point(l) => l.intensity * (4.0 * PI),
        Light::Spot(l) => l.intensity * (TAU * (1.0 - 0.5 * (l.cutoff.cos() + l.beam_width.cos()))),
        Light::Directional(l) => l.irradiance * disk,
        Light::Environment(e) => e.mean() * (4.0 * PI * disk),
    };
    emitted.max_element()
}
