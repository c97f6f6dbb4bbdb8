//! Lights as the end of walks: where walks from them begin, and the densities of the ways to choose a point on them.

use lichtweg_montecarlo::Sampler;
use lichtweg_ray::Ray;
use lichtweg_ray::math::Vec3;

use super::fault::{Fault, is_seeded};
use super::mis::norm;
use super::vertex::{Departure, Others, Vertex};
use crate::light::{Emission, EmissionDensity, LightChoice, LightSample, Receiver};
use crate::scene::description::Heuristic;
use crate::scene::{Scene, SurfacePoint};

/// The first vertex of a path.
#[derive(Clone, Copy, Debug)]
pub struct LightEnd {
    /// Which light.
    pub light: u32,
    /// Its point; nothing of one that is infinitely far.
    pub position: Option<Vec3>,
    /// The same as a point on a surface, if it is a shape.
    pub point: Option<SurfacePoint>,
    /// Unit direction in which light leaves it.
    pub direction: Vec3,
}

impl LightEnd {
    fn new(scene: &Scene, light: u32, position: Vec3, point: Option<SurfacePoint>, direction: Vec3) -> Self {
        let infinite = scene.lights()[light as usize].is_infinite();
        Self { light, position: (!infinite).then_some(position), point, direction }
    }

    /// A vertex at which a walk from the eye ran into it.
    pub fn hit(light: u32, vertex: &Vertex<'_>) -> Self {
        let point = vertex.point;
        Self { light, position: Some(point.position), point: Some(point), direction: vertex.wo }
    }

    /// A light around the scene that a walk from the eye ran into.
    pub fn escaped(light: u32, direction: Vec3) -> Self {
        Self { light, position: None, point: None, direction: -direction }
    }

    /// |cos| between the normal and the direction; 1 where there is none.
    pub fn cos(&self) -> f32 {
        self.point.map_or(1.0, |p| p.geometric_normal.dot(self.direction).abs())
    }
}

/// The beginning of a walk from a light.
#[derive(Clone, Copy, Debug)]
pub struct LightStart {
    /// How it was sampled.
    pub emission: Emission,
    /// Where.
    pub end: LightEnd,
    /// The probability of the light times [`EmissionDensity::start`].
    pub pdf: f32,
    /// Whether no walk from the eye can run into it.
    delta: bool,
}

impl LightStart {
    /// Chooses a light by power, a point, and a direction.
    pub fn sample(scene: &Scene, sampler: &mut Sampler) -> Option<Self> {
        let (u_light, u_place, u_direction) = (sampler.next_1d_f64(), sampler.next_2d(), sampler.next_2d());
        let (index, probability) = scene.selection().sample_emitter(u_light)?;
        let light = &scene.lights()[index as usize];
        let emission = light.emit(u_place, u_direction, scene)?;
        let position = emission.point.map_or(emission.ray.origin, |p| p.position);
        Some(Self {
            emission: Emission { power: emission.power / probability, ..emission },
            end: LightEnd::new(scene, index, position, emission.point, emission.ray.direction),
            pdf: probability * emission.density.start,
            delta: light.is_delta(),
        })
    }

    /// The walk that begins so; `once` is c of the strategy in which the eye runs into the light.
    pub fn depart(&self, time: f32, once: f32) -> Departure {
        let ray = Ray { time, ..self.emission.ray };
        Departure {
            ray,
            position: self.end.position.unwrap_or(ray.origin),
            throughput: self.emission.power,
            pdf: self.emission.density.leaving,
            cos: self.end.cos(),
            infinite: self.end.position.is_none(),
            link: 1.0,
            chain: if self.delta { 0.0 } else { once / self.pdf },
            normal: Vec3::ZERO,
        }
    }

    /// c of the walk's first surface vertex: the density with which a connection from it chooses this point on the light over
    /// that with which the walk did.
    pub fn first_link(&self, receiver: &Receiver, scene: &Scene) -> f32 {
        if is_seeded(Fault::LightChoice) {
            return 1.0;
        }
        let connection = match self.emission.point {
            Some(on_light) => connection_pdf_area(scene, self.end.light, receiver, &on_light),
            None => {
                let probability = scene.selection().probability(receiver, self.end.light, 0);
                // A point has no density; directions are chosen alike by both.
                probability * self.emission.density.start
            }
        };
        connection / self.pdf
    }
}

/// Density per area with which a connection from a receiver chooses a point on an area light.
pub fn connection_pdf_area(scene: &Scene, light: u32, receiver: &Receiver, on_light: &SurfacePoint) -> f32 {
    let Some((_, area_light)) = scene.area_light(on_light) else { return 0.0 };
    let pdf = area_light.connection_pdf_area(receiver.position, on_light, scene.form(on_light.shape));
    scene.selection().probability(receiver, light, on_light.primitive) * pdf
}

/// Stands for all other strategies for a path that ran into an area light at `vertex`, coming from `receiver`; `lit` is c of the
/// strategy that connects the two.
pub fn others_of_hit(
    scene: &Scene,
    light: u32,
    vertex: &Vertex<'_>,
    receiver: &Receiver,
    heuristic: Heuristic,
    lit: f32,
) -> f32 {
    let Some((_, area_light)) = scene.area_light(&vertex.point) else { return 0.0 };
    let connection = connection_pdf_area(scene, light, receiver, &vertex.point);
    let emission = area_light.emission_density(&vertex.point, vertex.wo, scene);
    let start = scene.selection().emitter_probability(light) * emission.start;
    let Others { connected, shorter } = vertex.others;
    norm(heuristic, lit * connection * connected, start * emission.leaving * shorter)
}

/// The same for a path that left the scene towards a light around it.
pub fn others_of_escape(
    scene: &Scene,
    light: u32,
    departure: &Departure,
    pdf_direction: f32,
    heuristic: Heuristic,
    lit: f32,
) -> f32 {
    let Others { connected, shorter } = departure.arrive(1.0, departure.cos);
    let selection = scene.selection();
    let connection = selection.probability(&departure.receiver(), light, 0) * pdf_direction;
    let start = selection.emitter_probability(light) * pdf_direction;
    let leaving = scene.surroundings().disk_pdf();
    norm(heuristic, lit * connection * connected, start * leaving * shorter)
}

/// A point on a light that a vertex of a walk from the eye was connected to.
#[derive(Clone, Copy, Debug)]
pub struct NextEvent {
    /// As seen from the vertex.
    pub sample: LightSample,
    /// Probability of the light.
    pub probability: f32,
    /// The densities of a walk that begins so; `start` includes the probability of the light.
    pub emission: EmissionDensity,
    /// Where.
    pub end: LightEnd,
    /// See [`spread`].
    spread: f32,
}

/// What makes a density per solid angle at a receiver one of the walk from the light: |cos| at a point of a shape, else the square of the
/// distance; 1 for a light infinitely far.
#[inline]
pub fn spread(sample: &LightSample, point: Option<&SurfacePoint>, receiver: Vec3) -> f32 {
    match (point, sample.target) {
        (Some(point), _) => point.geometric_normal.dot(sample.direction).abs(),
        (None, Some(target)) => (target - receiver).length_squared(),
        (None, None) => 1.0,
    }
}

impl NextEvent {
    /// Chooses a light for a receiver by a uniform number, and a point on it by two.
    pub fn sample(scene: &Scene, receiver: &Receiver, u_light: f32, u: [f32; 2]) -> Option<Self> {
        let choice = scene.selection().sample(receiver, u_light)?;
        let LightChoice { light: index, triangle, probability } = choice;
        let from = receiver.position;
        let light = &scene.lights()[index as usize];
        let (sample, point) = light.sample_part(from, triangle, u, scene)?;
        let emission = light.emission_density(&sample, point.as_ref(), scene);
        let position = point.map(|p| p.position).or(sample.target).unwrap_or(from);
        let end = LightEnd::new(scene, index, position, point, -sample.direction);
        Some(Self {
            sample,
            probability,
            emission: EmissionDensity {
                start: scene.selection().emitter_probability(index) * emission.start,
                ..emission
            },
            end,
            spread: spread(&sample, point.as_ref(), from),
        })
    }

    /// Density per solid angle, the probability of the light included.
    pub fn pdf(&self) -> f32 {
        self.probability * self.sample.pdf
    }

    /// How many times more densely walks from the light make both its point and a receiver at an angle to them whose cosine is
    /// given, than connections choose the point: per area at the receiver.
    pub fn emission_over_connection(&self, cos_receiver: f32) -> f32 {
        self.emission.start * self.emission.leaving * cos_receiver / (self.pdf() * self.spread)
    }
}
