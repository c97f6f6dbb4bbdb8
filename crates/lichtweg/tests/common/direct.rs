//! A second, separate estimator of direct light, which can be told to make a mistake.
//!
//! Without a fault it is one more witness for the path tracer's `max_depth` = 2; with one, it shows that the comparisons
//! notice. It takes one light sample and one BSDF sample at the first hit, weighted by the balance heuristic.

use lichtweg::bsdf::Mode;
use lichtweg::camera::Camera;
use lichtweg::color::Spectrum;
use lichtweg::film::Pixel;
use lichtweg::light::Receiver;
use lichtweg::render::RenderedImage;
use lichtweg::scene::description::{Description, Diagnostics};
use lichtweg::scene::{RayCounts, Scatterer, Scene, SurfacePoint};
use lichtweg_montecarlo::{Sampler, SamplerKind};
use lichtweg_ray::Ray;
use lichtweg_ray::math::Vec3;
use rayon::prelude::*;

/// A mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    None,
    /// Light samples without the cosine at the surface.
    Cosine,
    /// Light samples without the probability of the light's choice.
    Selection,
    /// The weights of hits take a light's density for certain to be asked for: the two no longer sum to one.
    Weights,
    /// Both strategies with weight one.
    DoubleCounting,
    /// Emitters that the camera sees are left out, as in the lecture's second program.
    SeenEmitters,
    /// No shadow rays.
    Shadows,
}

impl Fault {
    pub const ALL: [Self; 6] = [
        Self::Cosine,
        Self::Selection,
        Self::Weights,
        Self::DoubleCounting,
        Self::SeenEmitters,
        Self::Shadows,
    ];
}

/// Renders emitters seen directly and direct light; box filter, no crop.
pub fn render_direct(scene: &Scene, description: &Description, fault: Fault) -> RenderedImage {
    let [width, height] = [description.film.width, description.film.height];
    let camera = Camera::compile(&description.camera, width, height, &mut Diagnostics::default())
        .expect("a sound camera");
    let pixel = |i: u32| {
        let mut pixel = Pixel::default();
        for index in 0..description.sampler.samples_per_pixel {
            let stream = u64::from(i);
            let mut sampler = Sampler::new(SamplerKind::Independent, description.sampler.seed, stream, index);
            let [dx, dy] = sampler.next_2d();
            let film = [((i % width) as f32 + dx) / width as f32, ((i / width) as f32 + dy) / height as f32];
            let ray = camera.ray(film, sampler.next_2d(), 0.0);
            pixel.add(index, radiance(scene, &ray, &mut sampler, fault), 1.0);
        }
        pixel
    };
    RenderedImage {
        size: [width, height],
        window: [0, 0, width, height],
        pixels: (0..width * height).into_par_iter().map(pixel).collect(),
        auxiliary: Vec::new(),
    }
}

fn radiance(scene: &Scene, ray: &Ray, sampler: &mut Sampler, fault: Fault) -> Spectrum {
    let seen = |point: &SurfacePoint, wo: Vec3| {
        let light = scene.area_light(point);
        light.map_or(Spectrum::ZERO, |(_, l)| l.radiance(point, wo, scene.textures()))
    };
    let mut counts = RayCounts::default();
    let Some(point) = scene.intersect(ray, &mut counts, || sampler.next_1d()) else {
        return scene.environment_radiance(ray.direction);
    };
    let wo = -ray.direction;
    let scatterer = scene.scatterer(&point, wo);
    let direct = by_light(scene, &point, &scatterer, wo, sampler, fault)
        + by_bsdf(scene, &point, &scatterer, wo, sampler, fault);
    if fault == Fault::SeenEmitters { direct } else { seen(&point, wo) + direct }
}

fn by_light(
    scene: &Scene,
    point: &SurfacePoint,
    scatterer: &Scatterer<'_>,
    wo: Vec3,
    sampler: &mut Sampler,
    fault: Fault,
) -> Spectrum {
    let (u_light, u) = (sampler.next_1d(), sampler.next_2d());
    let Some(choice) = scene.selection().sample(&receiver(point, scatterer), u_light) else {
        return Spectrum::ZERO;
    };
    let light = &scene.lights()[choice.light as usize];
    let Some((sample, _)) = light.sample_part(point.position, choice.triangle, u, scene) else {
        return Spectrum::ZERO;
    };
    let (mut scattering, pdf_bsdf) = scatterer.eval_pdf(wo, sample.direction, Mode::Radiance);
    let origin = point.leave(sample.direction);
    let ray = match sample.target {
        Some(target) => Ray { tfar: 0.9999, ..Ray::new(origin, target - origin) },
        None => Ray::new(origin, sample.direction),
    };
    let visible = match fault {
        Fault::Shadows => 1.0,
        _ => scene.transmittance(&ray, &mut RayCounts::default()),
    };
    if fault == Fault::Cosine {
        scattering = scattering / point.shading_normal.dot(sample.direction).abs().max(1e-3);
    }
    let density = choice.probability * sample.pdf;
    let weight = match sample.delta || fault == Fault::DoubleCounting {
        true => 1.0,
        false => density / (density + pdf_bsdf),
    };
    let divisor = if fault == Fault::Selection { sample.pdf } else { density };
    scattering * sample.radiance * (visible * weight / divisor)
}

fn receiver(point: &SurfacePoint, scatterer: &Scatterer<'_>) -> Receiver {
    Receiver { position: point.position, normal: scatterer.receiving_normal() }
}

fn by_bsdf(
    scene: &Scene,
    point: &SurfacePoint,
    scatterer: &Scatterer<'_>,
    wo: Vec3,
    sampler: &mut Sampler,
    fault: Fault,
) -> Spectrum {
    let (u_lobe, u) = (sampler.next_1d(), sampler.next_2d());
    let Some(sample) = scatterer.sample(wo, u_lobe, u, Mode::Radiance) else { return Spectrum::ZERO };
    let to = receiver(point, scatterer);
    let weight = |light: u32, triangle: u32, pdf_light: f32| {
        if sample.delta || !scatterer.bsdf.connects() || fault == Fault::DoubleCounting {
            return 1.0;
        }
        let probability =
            if fault == Fault::Weights { 1.0 } else { scene.selection().probability(&to, light, triangle) };
        sample.pdf / (sample.pdf + probability * pdf_light)
    };
    let ray = Ray::new(point.leave(sample.wi), sample.wi);
    let incident = match scene.intersect(&ray, &mut RayCounts::default(), || sampler.next_1d()) {
        Some(hit) => scene.area_light(&hit).map_or(Spectrum::ZERO, |(index, light)| {
            let pdf = light.pdf(point.position, &hit, sample.wi, scene.form(hit.shape));
            light.radiance(&hit, -sample.wi, scene.textures()) * weight(index, hit.primitive, pdf)
        }),
        None => scene.environments().fold(Spectrum::ZERO, |sum, (index, e)| {
            let seen = e.seen(sample.wi);
            sum + seen.radiance * weight(index, 0, seen.pdf())
        }),
    };
    sample.weight * incident
}
