//! A path written out: every factor of its value, and the density of every strategy that could have made it.
//!
//! The value is S G f G ... f G R with S the emission, G the geometric terms with the transmittance between vertices, f the scattering
//! functions, and R the response of the eye; a strategy's estimate is the value over its density. All densities are computed here
//! once more, from the vertices alone and in f64, by their definitions: so weights can be compared with those that walks carry.
//!
//! With shading normals f is f_r |cos_s(light)| / |cos_g(light)| (Veach 1997, section 5.3), so that G has geometric cosines. For a
//! scattering in a single direction f is the lobe's factor over |cos_g|, and the density the lobe's probability.

use lichtweg_ray::math::Vec3;

use super::bidirectional::{Bidirectional, Contribution, Route};
use super::light_end::{LightEnd, connection_pdf_area};
use super::sensor::Sensor;
use super::vertex::Vertex;
use crate::bsdf::Mode;
use crate::color::Spectrum;
use crate::light::{EmissionDensity, Light, Receiver};
use crate::scene::description::Heuristic;
use crate::scene::{Scene, SurfacePoint};

/// A path, from the light (vertex 0) to the lens.
#[derive(Clone, Debug)]
pub struct ExplicitPath {
    /// Vertices of the walk from the light.
    pub s: usize,
    /// Vertices of the walk from the eye.
    pub t: usize,
    /// All vertices.
    pub vertices: Vec<PathVertex>,
    /// G between each vertex and the next.
    pub geometry: Vec<f64>,
    /// S: radiance, intensity or irradiance.
    pub emission: Spectrum,
    /// R: importance We.
    pub response: f64,
    /// Probability that the walks got as far, by roulette.
    pub survival: f64,
    /// The strategies, by their s.
    pub strategies: Vec<PathStrategy>,
}

/// A vertex of a path.
#[derive(Clone, Copy, Debug)]
pub struct PathVertex {
    /// What it is.
    pub kind: VertexKind,
    /// Where; `None` infinitely far.
    pub position: Option<Vec3>,
    /// Geometric normal, if it has one.
    pub normal: Option<Vec3>,
    /// f at surfaces between the ends.
    pub scattering: Spectrum,
    /// Whether it scatters in a single direction here.
    pub delta: bool,
    /// Density per area with which a walk from the light makes it (per solid angle infinitely far).
    pub pdf_from_light: f64,
    /// The same of a walk from the eye.
    pub pdf_from_eye: f64,
}

/// What a vertex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexKind {
    /// On a light, of this index.
    Light(u32),
    /// On a shape, of this index.
    Surface(u32),
    /// On the lens.
    Lens,
}

/// A way to make the path.
#[derive(Clone, Copy, Debug)]
pub struct PathStrategy {
    /// Density of the path, times the number of paths that the strategy makes for a walk from the eye; 0 where it cannot be made so.
    pub pdf: f64,
    /// Weight among all.
    pub weight: f64,
}

/// A surface between the ends, with its densities per solid angle.
struct Middle {
    point: SurfacePoint,
    receiver: Receiver,
    scattering: Spectrum,
    delta: bool,
    to_eye: f64,
    to_light: f64,
    survival: f64,
}

impl Middle {
    /// A vertex of a walk that carries `mode`, between its predecessor and the unit direction `onward`.
    fn new(vertex: &Vertex<'_>, onward: Vec3, sampled: bool, mode: Mode) -> Self {
        let normal = vertex.point.geometric_normal;
        let cos = normal.dot(onward).abs();
        let scattering = vertex.scatter(onward, mode);
        let mut this = Self {
            point: vertex.point,
            receiver: vertex.receiver(),
            scattering: scattering.value / cos,
            delta: false,
            to_eye: f64::from(scattering.pdf),
            to_light: f64::from(scattering.pdf_back),
            survival: 1.0,
        };
        if let Some(sample) = vertex.onward.filter(|_| sampled) {
            this.scattering = sample.weight * (sample.pdf / cos);
            this.delta = sample.delta;
            this.survival = f64::from(sample.survival);
            this.to_eye = f64::from(sample.pdf);
            this.to_light = match sample.delta {
                true => f64::from(sample.pdf),
                false => f64::from(vertex.scatterer.pdf(onward, vertex.wo)),
            };
        }
        if mode == Mode::Radiance {
            std::mem::swap(&mut this.to_eye, &mut this.to_light);
        }
        this
    }
}

fn cos(normal: Option<Vec3>, direction: Vec3) -> f64 {
    normal.map_or(1.0, |n| f64::from(n.dot(direction).abs()))
}

impl ExplicitPath {
    /// Writes out what a strategy made. `None` where a look at it fails by rounding.
    pub fn new(
        contribution: &Contribution<'_, '_>,
        scene: &Scene,
        sensor: &Sensor<'_>,
        settings: &Bidirectional,
    ) -> Option<Self> {
        let route = contribution.route?;
        let (light_walk, eye_walk) = (route.light.to_vec(), route.eye.to_vec());
        let middles = middles(contribution, &route, &light_walk, &eye_walk);
        let end = route.end;
        let light = &scene.lights()[end.light as usize];
        let density = density(light, end, scene);
        let probability = f64::from(scene.selection().emitter_probability(end.light));

        let mut vertices = vec![PathVertex {
            kind: VertexKind::Light(end.light),
            position: end.position,
            normal: end.point.map(|p| p.geometric_normal),
            scattering: Spectrum::ONE,
            delta: false,
            pdf_from_light: probability * f64::from(density.start),
            pdf_from_eye: 0.0,
        }];
        vertices.extend(middles.iter().map(|m| PathVertex {
            kind: VertexKind::Surface(m.point.shape),
            position: Some(m.point.position),
            normal: Some(m.point.geometric_normal),
            scattering: m.scattering,
            delta: m.delta,
            pdf_from_light: 0.0,
            pdf_from_eye: 0.0,
        }));
        let forward = sensor.camera.forward();
        let lens_pdf = sensor.camera.lens_pdf();
        vertices.push(PathVertex {
            kind: VertexKind::Lens,
            position: Some(route.lens),
            normal: Some(forward),
            scattering: Spectrum::ONE,
            delta: false,
            pdf_from_light: 0.0,
            // The only point of a pinhole has no density.
            pdf_from_eye: f64::from(lens_pdf.unwrap_or(1.0)),
        });

        let last = vertices.len() - 1;
        // Unit direction from vertex i to the next.
        let direction = |i: usize| match (vertices[i].position, vertices[i + 1].position) {
            (Some(a), Some(b)) => (b - a).normalized(),
            _ => end.direction,
        };
        let look = sensor.look(route.lens, -direction(last - 1))?;
        let directions: Vec<Vec3> = (0..last).map(direction).collect();
        let mut geometry = Vec::with_capacity(last);
        for i in 0..last {
            let per_area = match (vertices[i].position, vertices[i + 1].position) {
                (Some(a), Some(b)) => 1.0 / f64::from((b - a).length_squared()),
                _ => 1.0,
            };
            let infinite = vertices[i].position.is_none();
            let here = if infinite { 1.0 } else { cos(vertices[i].normal, directions[i]) };
            let there = cos(vertices[i + 1].normal, directions[i]);
            geometry.push(here * there * per_area);
            let leaving = if i == 0 { f64::from(density.leaving) } else { middles[i - 1].to_eye };
            vertices[i + 1].pdf_from_light = leaving * there * per_area;
            let coming = if i + 1 == last { f64::from(look.pdf) } else { middles[i].to_light };
            vertices[i].pdf_from_eye = coming * here * per_area;
        }
        let first = middles.first().map(|m| &m.receiver);
        let first_link = connection(light, end, scene, &density, first);
        let (s, t) = (contribution.s as usize, contribution.t as usize);
        let mut path = Self {
            s,
            t,
            emission: emission(light, contribution.s, end, scene),
            response: f64::from(look.pdf) * f64::from(lens_pdf.unwrap_or(1.0)) / f64::from(look.cos),
            survival: middles.iter().map(|m| m.survival).product(),
            strategies: Vec::new(),
            vertices,
            geometry,
        };
        path.strategies = path.strategies(first_link, light.is_delta(), lens_pdf.is_none(), settings);
        Some(path)
    }

    /// The density of every strategy, and their weights.
    fn strategies(
        &self,
        connection_pdf: f64,
        light_is_delta: bool,
        is_pinhole: bool,
        settings: &Bidirectional,
    ) -> Vec<PathStrategy> {
        let n = self.vertices.len();
        let pdf = |s: usize| {
            let possible = if s == 0 {
                !light_is_delta
            } else if s == n {
                !is_pinhole
            } else {
                !self.vertices[s - 1].delta && !self.vertices[s].delta
            };
            if !possible || (n == 2 && s != 0) {
                return 0.0;
            }
            let light: f64 = match s {
                1 => connection_pdf,
                _ => self.vertices[..s].iter().map(|v| v.pdf_from_light).product(),
            };
            let paths = match (s, n - s) {
                (0, _) | (_, 0 | 1) => 1,
                (1, _) => settings.lights,
                _ => settings.partners,
            };
            f64::from(paths) * light * self.vertices[s..].iter().map(|v| v.pdf_from_eye).product::<f64>()
        };
        let pdfs: Vec<f64> = (0..=n).map(pdf).collect();
        let largest = pdfs.iter().copied().fold(0.0, f64::max);
        let exponent = match settings.heuristic {
            Heuristic::Balance => 1,
            Heuristic::Power => 2,
        };
        let total: f64 = pdfs.iter().map(|p| (p / largest).powi(exponent)).sum();
        pdfs.into_iter()
            .map(|pdf| PathStrategy { pdf, weight: (pdf / largest).powi(exponent) / total })
            .collect()
    }

    /// The value over the density of the strategy that made it, with all that is between the vertices transparent.
    pub fn estimate(&self) -> [f64; 3] {
        let geometry: f64 = self.geometry.iter().product();
        let scale = geometry * self.response / (self.strategies[self.s].pdf * self.survival);
        let mut value = self.emission.to_rgb().map(|v| f64::from(v) * scale);
        for vertex in &self.vertices {
            value.iter_mut().zip(vertex.scattering.to_rgb()).for_each(|(v, f)| *v *= f64::from(f));
        }
        value
    }
}

/// The surfaces between the ends, from the light on.
fn middles(
    contribution: &Contribution<'_, '_>,
    route: &Route<'_, '_>,
    light: &[Vertex<'_>],
    eye: &[Vertex<'_>],
) -> Vec<Middle> {
    let (Contribution { s, t, .. }, Route { end, lens, .. }) = (contribution, route);
    let toward = |from: &Vertex<'_>, to: Vec3| (to - from.point.position).normalized();
    // A walk from the eye that ran into a shape has the point on the light as its last vertex.
    let eye = if *s == 0 && end.position.is_some() { &eye[..eye.len() - 1] } else { eye };
    let mut middles: Vec<Middle> = Vec::with_capacity(light.len() + eye.len());
    for (i, vertex) in light.iter().enumerate() {
        let last = i + 1 == light.len();
        let next = match light.get(i + 1) {
            Some(next) => next.point.position,
            None => eye.last().map_or(*lens, |v| v.point.position),
        };
        // The walk itself went on into the lens where t is 0.
        let sampled = !last || *t == 0;
        middles.push(Middle::new(vertex, toward(vertex, next), sampled, Mode::Importance));
    }
    for (i, vertex) in eye.iter().enumerate().rev() {
        let last = i + 1 == eye.len();
        let next = match eye.get(i + 1) {
            Some(next) => toward(vertex, next.point.position),
            None => match (light.last(), end.position) {
                (Some(light), _) => toward(vertex, light.point.position),
                (None, Some(position)) => toward(vertex, position),
                (None, None) => -end.direction,
            },
        };
        let sampled = !last || *s == 0;
        middles.push(Middle::new(vertex, next, sampled, Mode::Radiance));
    }
    middles
}

/// With which densities walks begin at the light.
fn density(light: &Light, end: &LightEnd, scene: &Scene) -> EmissionDensity {
    match (light, &end.point) {
        (Light::Area(light), Some(point)) => light.emission_density(point, end.direction, scene),
        (Light::Environment(environment), _) => EmissionDensity {
            start: environment.seen(-end.direction).pdf(),
            leaving: scene.surroundings().disk_pdf(),
        },
        (light, _) => light.delta_emission_density(scene),
    }
}

/// Density with which the first surface is connected to this point on the light.
fn connection(
    light: &Light,
    end: &LightEnd,
    scene: &Scene,
    density: &EmissionDensity,
    first: Option<&Receiver>,
) -> f64 {
    let Some(receiver) = first else { return 0.0 };
    match (light, &end.point) {
        (Light::Area(_), Some(point)) => f64::from(connection_pdf_area(scene, end.light, receiver, point)),
        _ => f64::from(scene.selection().probability(receiver, end.light, 0)) * f64::from(density.start),
    }
}

/// S, in the direction of the path.
fn emission(light: &Light, s: u32, end: &LightEnd, scene: &Scene) -> Spectrum {
    match (light, &end.point) {
        (Light::Area(light), Some(point)) => {
            // Whether a surface with holes is there is left to chance where a walk from the eye runs into it.
            let opacity = if s == 0 { 1.0 } else { scene.opacity_at(point, end.direction) };
            light.radiance(point, end.direction, scene.textures()) * opacity
        }
        (Light::Area(_), None) => Spectrum::ZERO,
        (Light::Point(light), _) => light.intensity,
        (Light::Spot(light), _) => light.intensity * light.falloff(end.direction.dot(light.axis)),
        (Light::Directional(light), _) => light.irradiance,
        (Light::Environment(environment), _) => environment.seen(-end.direction).radiance,
    }
}
