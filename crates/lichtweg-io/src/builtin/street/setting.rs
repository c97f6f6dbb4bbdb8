//! Everything around the street: camera, film, integrator, sky and sun.

use std::f32::consts::PI;
use std::sync::Arc;

use lichtweg::scene::description::{
    CameraDescription, Description, EnvironmentMapping, FieldOfView, FilmDescription, FovAxis, Image,
    IntegratorDescription, LightDescription, LightKind, Pixels, SamplerDescription, Span,
    SpectrumDescription,
};
use lichtweg_montecarlo::SamplerKind;
use lichtweg_ray::math::{Affine, Vec3};

/// Towards the sun.
const SUN: Vec3 = Vec3::new(0.60, 0.56, 0.34);
/// Of the sun on a plane that faces it, W / m^2.
const SUNLIGHT: [f32; 3] = [4.3, 3.85, 3.1];
/// Radiance of the sky overhead and at the horizon, W / (m^2 sr).
const ZENITH: [f32; 3] = [0.26, 0.40, 0.64];
const HORIZON: [f32; 3] = [0.80, 0.85, 0.88];
/// What the sky gains towards the sun.
const GLOW: [f32; 3] = [0.55, 0.45, 0.30];

/// A description with everything but shapes: the lecture's picture has 1536 x 654 pixels, 16 paths for each, 2 bounces.
pub fn describe() -> Description {
    // A level camera with its film shifted, as photographs of buildings are taken: what is upright stays so.
    let to_world = Affine::look_at([1.5, 5.8, 15.0], [-0.8, 5.8, -30.0], [0.0, 1.0, 0.0]);
    Description {
        name: "street".to_owned(),
        camera: CameraDescription {
            to_world: to_world.expect("the camera looks along the street"),
            field_of_view: FieldOfView::Angle { degrees: 62.0, axis: FovAxis::X },
            principal_point_offset: [0.0, -0.03],
            ..CameraDescription::default()
        },
        film: FilmDescription { width: 1536, height: 654, ..FilmDescription::default() },
        sampler: SamplerDescription {
            samples_per_pixel: 16,
            kind: SamplerKind::Sobol,
            ..SamplerDescription::default()
        },
        integrator: IntegratorDescription { max_depth: Some(3), ..IntegratorDescription::default() },
        lights: vec![light("sun", sun()), light("sky", sky())],
        ..Description::default()
    }
}

fn light(name: &str, kind: LightKind) -> LightDescription {
    LightDescription { name: Some(name.to_owned()), span: Span::default(), kind, scale: 1.0 }
}

fn sun() -> LightKind {
    LightKind::Directional { direction: -SUN, irradiance: SpectrumDescription::Rgb(SUNLIGHT) }
}

/// An image of a clear sky: bright at the horizon and about the sun, dark below.
fn sky() -> LightKind {
    const WIDTH: usize = 128;
    const HEIGHT: usize = 64;
    let texels = (0..WIDTH * HEIGHT).flat_map(|i| {
        // Mitsuba's directions: u = atan2(x, -z) / 2 pi, v = acos(y) / pi.
        let [u, v] = [(i % WIDTH) as f32 + 0.5, (i / WIDTH) as f32 + 0.5];
        let (sin_phi, cos_phi) = (2.0 * PI * u / WIDTH as f32).sin_cos();
        let (sin, cos) = (PI * v / HEIGHT as f32).sin_cos();
        radiance(Vec3::new(sin_phi * sin, cos, -cos_phi * sin))
    });
    let pixels = Pixels::F32(texels.collect());
    let image = Image { width: WIDTH as u32, height: HEIGHT as u32, channels: 3, pixels, srgb: false };
    LightKind::Environment {
        image: Arc::new(image),
        mapping: EnvironmentMapping::LatitudeLongitude,
        to_world: Affine::IDENTITY,
    }
}

/// Of the sky in a direction.
fn radiance(direction: Vec3) -> [f32; 3] {
    if direction.y < -0.1 {
        return [0.02; 3];
    }
    let height = direction.y.max(0.0).powf(0.55);
    let glow = direction.dot(SUN.normalized()).max(0.0).powi(6);
    std::array::from_fn(|c| HORIZON[c] + (ZENITH[c] - HORIZON[c]) * height + GLOW[c] * glow)
}
