//! The directions that lights propose follow their densities: chi-squared over 10^6 samples, and the density integrates to
//! the fraction of samples that are of use. The same density is told to walks that hit the light, and irradiance
//! estimated from it is that of a brute-force integral.
//!
//! Each function is one family of tests with a probability of a false alarm of 0.01.

mod common;

use common::build::{
    Build, CYLINDER, DISK, SPHERE, chain, cube, facing_down, float_image, glow, grid, placed, rectangle,
};
use common::run::compile_scene;
use lichtweg::light::Light;
use lichtweg::scene::description::{
    Description, Diagnostics, EnvironmentMapping, GeometryDescription, LightKind, LightStrategy,
    SpectrumDescription,
};
use lichtweg::scene::{RayCounts, Scene};
use lichtweg_montecarlo::hypothesis::{DensityTest, sidak, z_test};
use lichtweg_montecarlo::{Moments, Sampler, SamplerKind, warp};
use lichtweg_ray::Ray;
use lichtweg_ray::math::{Affine, Vec3};
use rayon::prelude::*;

/// A light alone, and where it is looked at from.
struct Case {
    what: &'static str,
    scene: Scene,
    from: Vec3,
}

fn area_case(what: &'static str, geometry: GeometryDescription, place: Affine, from: [f32; 3]) -> Case {
    area_case_sided(what, geometry, place, from, false, false)
}

fn area_case_sided(
    what: &'static str,
    geometry: GeometryDescription,
    place: Affine,
    from: [f32; 3],
    inside_out: bool,
    two_sided: bool,
) -> Case {
    let mut d = Description::default();
    let black = d.diffuse([0.0; 3]);
    let shape = d.shape(geometry, place, black);
    shape.flip_normals = inside_out;
    shape.emission = glow([1.0, 2.0, 3.0]);
    shape.emission.as_mut().expect("emits").two_sided = two_sided;
    Case { what, scene: compile_scene(&d), from: Vec3::from_array(from) }
}

fn environment_case(what: &'static str, kind: LightKind) -> Case {
    let mut d = Description::default();
    d.light(kind);
    let black = d.diffuse([0.0; 3]);
    // A shape far away and small, so that the scene has one.
    d.shape(DISK, placed([0.0, -1000.0, 0.0], [1e-3; 3]), black);
    Case { what, scene: compile_scene(&d), from: Vec3::ZERO }
}

/// A map with a bright spot, black texels and texels of all sorts.
fn map(width: u32, height: u32) -> std::sync::Arc<lichtweg::scene::description::Image> {
    let pixels: Vec<[f32; 3]> = (0..width * height)
        .map(|i| {
            let (x, y) = (i % width, i / width);
            let shade = (x * 7 + y * 5) % 11;
            match (x, y) {
                (3, 2) => [8.0, 6.0, 4.0],
                _ if shade < 4 => [0.0; 3],
                _ => [0.1 * shade as f32, 0.3, 0.05 * shade as f32],
            }
        })
        .collect();
    float_image(width, &pixels)
}

fn cases() -> Vec<Case> {
    let tilted = chain(&[
        Affine::translation(0.4, 1.2, 0.3),
        Affine::rotation([0.3, 0.1, 1.0], 25.0),
        facing_down(),
        Affine::scaling(0.7, 0.4, 1.0),
    ]);
    let wavy = grid(3, |x, y| Vec3::new(x, y, 0.3 * (3.0 * x).sin() * y), true);
    let part = GeometryDescription::Sphere { z_min: -0.4, z_max: 0.8, phi_max: 250.0 };
    let ring = GeometryDescription::Disk { inner_radius: 0.4, phi_max: 300.0 };
    let arc = GeometryDescription::Cylinder { z_min: -0.5, z_max: 1.0, phi_max: 210.0 };
    let egg = chain(&[Affine::rotation([1.0, 1.0, 0.0], 40.0), Affine::scaling(1.0, 0.5, 0.3)]);
    let latitude_longitude = |to_world| LightKind::Environment {
        image: map(16, 8),
        mapping: EnvironmentMapping::LatitudeLongitude,
        to_world,
    };
    let octahedral = |to_world| LightKind::Environment {
        image: map(8, 8),
        mapping: EnvironmentMapping::EqualAreaOctahedral,
        to_world,
    };
    let turned = Affine::rotation([1.0, 2.0, 3.0], 77.0);
    vec![
        area_case("rectangle", rectangle(), tilted, [0.0; 3]),
        area_case("rectangle, near", rectangle(), Affine::IDENTITY, [0.3, -0.5, 0.2]),
        area_case("wavy mesh", wavy, Affine::IDENTITY, [0.2, 0.1, 1.0]),
        area_case("cube", cube(), Affine::IDENTITY, [2.0, 1.5, 1.8]),
        area_case("sphere", SPHERE, placed([0.0; 3], [0.5; 3]), [1.0, 0.7, -0.4]),
        area_case("sphere, far", SPHERE, placed([0.0; 3], [0.5; 3]), [30.0, -10.0, 50.0]),
        area_case("sphere, near", SPHERE, Affine::IDENTITY, [0.0, 1.01, 0.0]),
        area_case_sided("sphere from inside", SPHERE, Affine::IDENTITY, [0.3, 0.2, 0.5], true, false),
        area_case_sided(
            "sphere, both sides, from inside",
            SPHERE,
            Affine::IDENTITY,
            [0.1, -0.7, 0.2],
            false,
            true,
        ),
        area_case("mirrored sphere", SPHERE, placed([0.0; 3], [-0.6, 0.6, 0.6]), [1.0, 0.5, 0.2]),
        area_case("ellipsoid", SPHERE, egg, [0.8, 0.9, 0.7]),
        area_case_sided("ellipsoid from inside", SPHERE, egg, [0.1, 0.1, 0.05], true, false),
        area_case("part of a sphere", part.clone(), Affine::IDENTITY, [1.5, 0.7, 0.9]),
        area_case_sided(
            "part of a sphere, both sides",
            part,
            Affine::IDENTITY,
            [0.4, -1.2, 0.9],
            false,
            true,
        ),
        area_case("disk", DISK, tilted, [0.1, 0.0, -0.2]),
        area_case_sided("part of a ring, both sides", ring, Affine::IDENTITY, [0.4, 0.3, -0.6], false, true),
        area_case("cylinder", CYLINDER, Affine::IDENTITY, [1.2, 0.9, 0.3]),
        area_case_sided(
            "cylinder from inside",
            CYLINDER,
            placed([0.0; 3], [1.0, 0.5, 2.0]),
            [0.2, 0.1, 0.7],
            true,
            false,
        ),
        area_case_sided("part of a cylinder, both sides", arc, egg, [0.9, 0.8, 0.7], false, true),
        environment_case(
            "constant environment",
            LightKind::Constant { radiance: SpectrumDescription::Rgb([1.0, 2.0, 3.0]) },
        ),
        environment_case("latitude and longitude", latitude_longitude(Affine::IDENTITY)),
        environment_case("latitude and longitude, turned", latitude_longitude(turned)),
        environment_case("octahedral map", octahedral(Affine::IDENTITY)),
        environment_case("octahedral map, turned", octahedral(turned)),
    ]
}

impl Case {
    fn light(&self) -> &Light {
        &self.scene.lights()[0]
    }

    /// A proposed direction, unless nothing arrives from there: the back of a light is in the way, or does not shine.
    fn sample(&self, sampler: &mut Sampler) -> Option<lichtweg::light::LightSample> {
        let sample = self.light().sample(self.from, sampler.next_2d(), &self.scene)?;
        let ray = match sample.target {
            Some(target) => Ray { tfar: 0.9999, ..Ray::new(self.from, target - self.from) },
            None => Ray::new(self.from, sample.direction),
        };
        let visible = self.scene.transmittance(&ray, &mut RayCounts::default()) > 0.0;
        visible.then_some(sample)
    }

    /// What a walk finds in a direction: its radiance in the first channel, and the density with which a connection would have
    /// taken it.
    fn found(&self, direction: Vec3) -> (f32, f32) {
        let ray = Ray::new(self.from, direction);
        match self.scene.intersect(&ray, &mut RayCounts::default(), || 0.5) {
            None => self
                .scene
                .environments()
                .map(|(_, e)| e.seen(direction))
                .map(|seen| (seen.radiance.0[0], seen.pdf()))
                .next()
                .unwrap_or((0.0, 0.0)),
            Some(point) => {
                let Some((_, light)) = self.scene.area_light(&point) else { return (0.0, 0.0) };
                let radiance = light.radiance(&point, -direction, self.scene.textures()).0[0];
                let pdf = light.pdf(self.from, &point, direction, self.scene.form(point.shape));
                (radiance, if radiance > 0.0 { pdf } else { 0.0 })
            }
        }
    }
}

#[test]
fn directions_follow_the_density() {
    let cases = cases();
    let level = sidak(0.01, cases.len());
    cases.par_iter().for_each(|case| {
        // Cells small enough for the quadrature not to overlook the corners of lights.
        let test = DensityTest { grid: [32, 64], ..DensityTest::default() };
        let sample = |s: &mut Sampler| case.sample(s).map(|sample| sample.direction.to_array());
        let pdf = |w: [f32; 3]| case.found(Vec3::from_array(w)).1;
        let report = test.sphere(sample, pdf).unwrap_or_else(|error| panic!("{}: {error}", case.what));
        assert!(!report.rejects(level), "{}: {report}", case.what);
    });
}

/// The density that a sample reports, and the one for a walk that goes the same way. Near a silhouette rounding moves the
/// point that is hit, and with it the cosine: one sample in a hundred may differ.
#[test]
fn hits_have_the_density_of_samples() {
    for case in cases() {
        let mut strays = 0;
        for i in 0..20_000 {
            let mut sampler = Sampler::new(SamplerKind::Independent, 7, 0, i);
            let Some(sample) = case.sample(&mut sampler) else { continue };
            let (radiance, pdf) = case.found(sample.direction);
            let close =
                (pdf / sample.pdf - 1.0).abs() < 2e-3 && (radiance / sample.radiance.0[0] - 1.0).abs() < 2e-3;
            strays += u32::from(!close);
        }
        assert!(strays <= 200, "{}: {strays} of 20000 samples differ from hits", case.what);
    }
}

/// The irradiance on a surface that faces the light, by light samples and by even sampling of all directions.
#[test]
fn irradiance_is_that_of_brute_force() {
    const SIDE: u32 = 1000;
    let cases = cases();
    for case in &cases {
        let normal = case.mean_direction();
        let mut by_light = Moments::default();
        for i in 0..200_000 {
            let mut sampler = Sampler::new(SamplerKind::Independent, 8, 1, i);
            by_light.push(
                case.sample(&mut sampler)
                    .map_or(0.0, |s| f64::from(s.radiance.0[0] * s.direction.dot(normal).max(0.0) / s.pdf)),
            );
        }
        // A jittered grid, in pairs of neighbours for an estimate of its error.
        let mut brute = Moments::default();
        let value = |x: u32, y: u32| {
            let [u, v] = Sampler::new(SamplerKind::Independent, 9, u64::from(y), x).next_2d();
            let square = [(x as f32 + u) / SIDE as f32, (y as f32 + v) / SIDE as f32];
            let direction = Vec3::from_array(warp::uniform_sphere(square));
            f64::from(case.found(direction).0 * direction.dot(normal).max(0.0) / warp::UNIFORM_SPHERE_PDF)
        };
        let (mut sum, mut squares) = (0.0, 0.0);
        for y in 0..SIDE {
            for x in (0..SIDE).step_by(2) {
                let (a, b) = (value(x, y), value(x + 1, y));
                sum += a + b;
                squares += (a - b) * (a - b);
            }
        }
        let n = f64::from(SIDE * SIDE);
        brute.push(sum / n);
        let variance = by_light.variance_of_mean() + squares / (n * n);
        let difference = by_light.mean() - brute.mean();
        let outcome = z_test(difference, variance + (1e-4 * by_light.mean()).powi(2));
        assert!(
            !outcome.rejects(sidak(0.01, cases.len())),
            "{}: {} by light samples, {} by brute force: {outcome:?}",
            case.what,
            by_light.mean(),
            brute.mean()
        );
    }
}

impl Case {
    /// The mean of the directions that a light proposes.
    fn mean_direction(&self) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for i in 0..1000 {
            let mut sampler = Sampler::new(SamplerKind::Independent, 6, 0, i);
            sum += self.sample(&mut sampler).map_or(Vec3::ZERO, |s| s.direction);
        }
        sum.try_normalized().unwrap_or(Vec3::Y)
    }
}

/// Lights at a point or in a direction say so, and nothing that is hit has their density.
#[test]
fn delta_lights_say_so() {
    let mut d = Description::default();
    let intensity = SpectrumDescription::Constant(1.0);
    d.light(LightKind::Point { position: Vec3::new(0.0, 2.0, 0.0), intensity: intensity.clone() });
    d.light(LightKind::Directional { direction: Vec3::new(0.0, -3.0, 0.0), irradiance: intensity });
    let black = d.diffuse([0.0; 3]);
    d.shape(DISK, placed([0.0, -1000.0, 0.0], [1e-3; 3]), black);
    let scene = compile_scene(&d);
    for light in scene.lights() {
        let sample = light.sample(Vec3::ZERO, [0.3, 0.6], &scene).expect("shines here");
        assert!(light.is_delta() && sample.delta && sample.pdf == 1.0);
        assert!((sample.direction - Vec3::Y).length() < 1e-6);
    }
}

/// Walks alone never meet a point: who asks for nothing else is told.
#[test]
fn naive_paths_are_warned_of_lights_they_cannot_hit() {
    let warned = |light| {
        let mut d = Description::default();
        d.integrator.light = light;
        d.light(LightKind::Point { position: Vec3::ZERO, intensity: SpectrumDescription::Constant(1.0) });
        let mut diagnostics = Diagnostics::default();
        Scene::compile(&d, &mut diagnostics).expect("only warnings");
        diagnostics.list.iter().any(|diagnostic| diagnostic.code == "unseen-light")
    };
    assert!(warned(LightStrategy::Naive));
    assert!(!warned(LightStrategy::Mis));
}
