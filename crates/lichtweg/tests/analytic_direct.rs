//! Direct light on a small horizontal surface against closed forms, for each kind of light.
//!
//! Irradiance of shapes of even radiance L: pi L times the part of the unit disk that the shape fills when projected
//! onto the hemisphere and down (Nusselt). For a polygon that is Lambert's sum over its edges. Each family of z
//! tests has a probability of a false alarm of 0.01; what has no variance may err by 2e-5.

mod common;

use std::f64::consts::PI;

use common::build::{
    Build, CYLINDER, DISK, SPHERE, chain, facing_down, facing_up, glow, grid, placed, rectangle,
};
use common::judge::{assert_expectation, expectation};
use common::probe::{probe, reflected};
use common::run::{Estimator, camera, render};
use lichtweg::scene::description::{
    Description, EmissionScale, GeometryDescription, LightKind, Mesh, ShapeDescription, SpectrumDescription,
    SpotFalloff,
};
use lichtweg_ray::math::{Affine, Vec3};

const BRIGHT: SpectrumDescription = SpectrumDescription::Constant(3.0);

/// Radiance of the probe under a delta light, exactly.
fn assert_exact(what: &str, light: LightKind, irradiance: f64) {
    for estimator in Estimator::CONNECTING {
        let mut d = probe(1, 1);
        d.light(light.clone());
        estimator.choose(&mut d);
        let (mean, _) = render(&d).mean();
        for (value, expected) in mean.into_iter().zip(reflected(irradiance)) {
            let error = (value - expected).abs();
            assert!(error <= 2e-4 * expected, "{what}, {estimator:?}: {value} instead of {expected}");
        }
    }
}

#[test]
fn point_light() {
    for p in [[0.0, 1.0, 0.0], [0.5, 2.0, -0.25], [3.0, 0.1, 4.0]] {
        let [x, y, z] = p.map(f64::from);
        let d = (x * x + y * y + z * z).sqrt();
        let light = LightKind::Point { position: Vec3::from_array(p), intensity: BRIGHT };
        assert_exact(&format!("point at {p:?}"), light, 3.0 * y / d.powi(3));
    }
    let below = LightKind::Point { position: Vec3::new(0.2, -1.0, 0.0), intensity: BRIGHT };
    assert_exact("point below", below, 0.0);
}

#[test]
fn directional_light() {
    for degrees in [0.0_f64, 30.0, 80.0, 100.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let direction = Vec3::new(2.0 * sin as f32, -2.0 * cos as f32, 0.0);
        let light = LightKind::Directional { direction, irradiance: BRIGHT };
        assert_exact(&format!("parallel light at {degrees} degrees"), light, 3.0 * cos.max(0.0));
    }
}

/// Rays must leave the surface they start on: planes through the origin and off it, small and large, under light that
/// grazes them.
#[test]
fn grazing_light_on_planes() {
    for height in [0.0_f32, 0.5, -30.0] {
        for size in [0.01, 1.0, 100.0] {
            for degrees in [30.0_f32, 60.0, 80.0, 89.0] {
                let y = f64::from(height);
                let mut d = probe(4, 1);
                d.shapes.clear();
                d.camera = camera([0.3, y + 0.4, -0.5], [0.0, y, 0.0], 0.01);
                let white = d.diffuse([1.0; 3]);
                let place = |x: f32, z: f32| Vec3::new(x * size, height, -z * size);
                d.shape(grid(1, place, false), Affine::IDENTITY, white);
                let (sin, cos) = degrees.to_radians().sin_cos();
                let direction = Vec3::new(0.6 * sin, -cos, 0.8 * sin);
                d.light(LightKind::Directional { direction, irradiance: BRIGHT });
                let relative = render(&d).mean().0[0] * PI / f64::from(3.0 * cos);
                let what = format!("height {height}, size {size}, {degrees} degrees");
                assert!((relative - 1.0).abs() < 2e-5, "{what}: {relative} of what it should be");
            }
        }
    }
}

/// At the height of 2 above the probe, turned away from it by an angle about the z axis: full inside the beam, dark
/// outside the cone, and between them Mitsuba's and pbrt's edge.
#[test]
fn spot_light() {
    let (beam, cutoff) = (20.0_f64, 50.0_f64);
    for angle in [0.0_f64, 19.0, 27.5, 35.0, 49.0, 51.0] {
        let between = (cutoff - angle) / (cutoff - beam);
        let cosine = |degrees: f64| degrees.to_radians().cos();
        let t = (cosine(angle) - cosine(cutoff)) / (cosine(beam) - cosine(cutoff));
        let edges = [
            (SpotFalloff::LinearAngle, between.clamp(0.0, 1.0)),
            (SpotFalloff::SmoothCosine, t.clamp(0.0, 1.0).powi(2) * (3.0 - 2.0 * t.clamp(0.0, 1.0))),
        ];
        for (falloff, expected) in edges {
            let light = LightKind::Spot {
                to_world: chain(&[
                    Affine::translation(0.0, 2.0, 0.0),
                    Affine::rotation([0.0, 0.0, 1.0], angle),
                    facing_down(),
                ]),
                intensity: BRIGHT,
                cutoff: cutoff as f32,
                beam_width: beam as f32,
                falloff,
            };
            assert_exact(&format!("{falloff:?} at {angle}"), light, 3.0 / 4.0 * expected);
        }
    }
}

/// Shapes of radiance 3 over the probe, and the irradiance they give.
fn area_lights() -> Vec<(&'static str, Description, f64)> {
    let mut cases = Vec::new();
    let mut add = |what, geometry, place: Affine, inside_out, irradiance: f64| {
        let mut d = probe(128, cases_seed(what));
        let black = d.diffuse([0.0; 3]);
        let shape: &mut ShapeDescription = d.shape(geometry, place, black);
        shape.emission = glow([3.0; 3]);
        shape.flip_normals = inside_out;
        cases.push((what, d, irradiance));
    };
    let above = |height: f64, radius: f64| {
        chain(&[
            Affine::translation(0.0, height, 0.0),
            facing_down(),
            Affine::scaling(radius, radius, radius),
        ])
    };
    let sine_squared = |radius: f64, height: f64| radius * radius / (radius * radius + height * height);
    add("disk", DISK, above(1.5, 0.8), false, 3.0 * PI * sine_squared(0.8, 1.5));
    add("disk seen from behind", DISK, above(1.5, 0.8), true, 0.0);
    let ring = GeometryDescription::Disk { inner_radius: 0.5, phi_max: 90.0 };
    let expected = 3.0 * PI * 0.25 * (sine_squared(1.0, 0.7) - sine_squared(0.5, 0.7));
    add("quarter of a ring", ring, above(0.7, 1.0), false, expected);

    let (center, radius) = ([0.6, 1.0, -0.3], 0.45);
    let distance: f64 = center.iter().map(|c| c * c).sum::<f64>().sqrt();
    let expected = 3.0 * PI * (radius / distance).powi(2) * center[1] / distance;
    add("sphere", SPHERE, placed(center, [radius; 3]), false, expected);
    let far = center.map(|c| 100.0 * c);
    add("far sphere", SPHERE, placed(far, [radius; 3]), false, expected * 1e-4);
    add("sphere from inside", SPHERE, placed([0.3, 0.2, 0.1], [1.5; 3]), true, 3.0 * PI);
    add("ellipsoid from inside", SPHERE, placed([0.1, 0.3, 0.0], [2.0, 1.0, 0.7]), true, 3.0 * PI);
    let cap = GeometryDescription::Sphere { z_min: 0.3, z_max: 0.9, phi_max: 360.0 };
    let expected = 3.0 * PI * (0.9_f64.powi(2) - 0.3_f64.powi(2));
    let zone = chain(&[Affine::scaling(2.0, 2.0, 2.0), facing_up()]);
    add("zone of a sphere", cap, zone, true, expected);
    let wedge = GeometryDescription::Sphere { z_min: 0.0, z_max: 1.0, phi_max: 60.0 };
    add("wedge of a dome", wedge, zone, true, 3.0 * PI / 6.0);

    // Around the probe, from 0.2 to 1.7 above it.
    let tube = chain(&[Affine::translation(0.0, 0.2, 0.0), facing_up(), Affine::scaling(0.9, 0.9, 1.5)]);
    let expected = 3.0 * PI * (sine_squared(0.9, 0.2) - sine_squared(0.9, 1.7));
    add("cylinder from inside", CYLINDER, tube, true, expected);

    let tilted = chain(&[
        Affine::translation(0.4, 1.2, 0.3),
        Affine::rotation([0.3, 0.1, 1.0], 25.0),
        facing_down(),
        Affine::scaling(0.7, 0.4, 1.0),
    ]);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let corners = corners.map(|[x, y]| tilted.point(Vec3::new(x, y, 0.0)));
    add("rectangle", rectangle(), tilted, false, 3.0 * lambert(&corners));
    let corners = [Vec3::new(-1.0, 0.3, 0.5), Vec3::new(0.5, 0.9, 0.8), Vec3::new(0.2, 1.4, -1.0)];
    let triangle = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let triangle = GeometryDescription::Mesh(triangle.into());
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    add("triangle", triangle, Affine::IDENTITY, normal.dot(corners[0]) > 0.0, 3.0 * lambert(&corners));
    cases
}

/// A seed of its own for each case.
fn cases_seed(what: &str) -> u64 {
    what.bytes().fold(7, |seed, b| seed * 31 + u64::from(b))
}

/// Irradiance at the origin with normal +y of a polygon of radiance 1 that lies above the horizon: half the sum over the
/// edges of the angle they subtend times the normal's component along the normal of the plane through edge and
/// origin (Lambert 1760).
fn lambert(corners: &[Vec3]) -> f64 {
    let unit = |v: Vec3| {
        let v = v.to_array().map(f64::from);
        let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        v.map(|c| c / length)
    };
    let sum: f64 = (0..corners.len())
        .map(|i| {
            let (a, b) = (unit(corners[i]), unit(corners[(i + 1) % corners.len()]));
            let cosine: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            let sine = cross.iter().map(|c| c * c).sum::<f64>().sqrt();
            sine.atan2(cosine) * cross[1] / sine
        })
        .sum();
    0.5 * sum.abs()
}

#[test]
fn lambert_of_a_cube_face() {
    // The top face of a cube around a point on the middle of its floor: the form factor of a square of side 2 at distance 1 is,
    // by tables of view factors, 4 times that of a unit square over its corner, 0.138534.
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, z]| Vec3::new(x, 1.0, z));
    assert!((lambert(&corners) / PI - 4.0 * 0.138_534).abs() < 2e-5, "{}", lambert(&corners) / PI);
}

#[test]
fn area_lights_of_all_shapes() {
    let cases = area_lights();
    for (what, description, irradiance) in &cases {
        // A walk hits the far sphere too seldom to say anything.
        let estimators =
            Estimator::ALL.into_iter().filter(|e| *what != "far sphere" || *e != Estimator::Naive);
        for estimator in estimators {
            let mut d = description.clone();
            estimator.choose(&mut d);
            let image = render(&d);
            let what = format!("{what}, {estimator:?}");
            assert_expectation(&what, &image, reflected(*irradiance), 2e-4, 4 * cases.len());
            if *irradiance > 0.0 && estimator == Estimator::MisPower {
                let off = expectation(&image, reflected(irradiance * 1.01), 2e-4);
                assert!(off[0].1.rejects(1e-4), "{what} would pass with an error of one percent: {off:?}");
            }
        }
    }
}

/// The knife edge of the lecture's penumbra: half the light is hidden behind a wall whose edge lies between it and the probe.
#[test]
fn half_hidden_disk() {
    for estimator in Estimator::ALL {
        let mut d = probe(128, 11);
        let black = d.diffuse([0.0; 3]);
        let disk = chain(&[Affine::translation(0.0, 2.0, 0.0), facing_down()]);
        d.shape(DISK, disk, black).emission = glow([3.0; 3]);
        let wall = chain(&[Affine::translation(-1.0, 1.0, 0.0), facing_down()]);
        d.shape(rectangle(), wall, black);
        estimator.choose(&mut d);
        let expected = 0.5 * 3.0 * PI / 5.0;
        assert_expectation(&format!("{estimator:?}"), &render(&d), reflected(expected), 2e-4, 4);
    }
}

/// The lecture's penumbra in numbers: a square light of side 1 at height 4, a board at height 1 whose edge is at x = 0. From a
/// point x of the floor one sees the light beyond -3 x, a rectangle again, so that Lambert's sum knows the ramp.
#[test]
fn penumbra_of_a_knife_edge() {
    let places = [-0.2_f64, -0.1, -0.03, 0.0, 0.08, 0.15, 0.2];
    for (i, x) in places.into_iter().enumerate() {
        // The probe stays at the origin, everything else moves.
        let mut d = probe(192, 20 + i as u64);
        let black = d.diffuse([0.0; 3]);
        let light =
            chain(&[Affine::translation(-x, 4.0, 0.0), facing_down(), Affine::scaling(0.5, 0.5, 1.0)]);
        d.shape(rectangle(), light, black).emission = glow([3.0; 3]);
        d.shape(rectangle(), chain(&[Affine::translation(-1.0 - x, 1.0, 0.0), facing_down()]), black);
        let first = (-3.0 * x).clamp(-0.5, 0.5) - x;
        let corners = [[first, -0.5], [0.5 - x, -0.5], [0.5 - x, 0.5], [first, 0.5]];
        let corners = corners.map(|[x, z]| Vec3::new(x as f32, 4.0, z as f32));
        let expected = if x <= -1.0 / 6.0 { 0.0 } else { 3.0 * lambert(&corners) };
        let image = render(&d);
        assert_expectation(&format!("at {x}"), &image, reflected(expected), 2e-4, places.len());
        // Power: two percent more would be noticed.
        let off = expectation(&image, reflected(expected * 1.02), 2e-4);
        assert!(expected == 0.0 || off[0].1.rejects(1e-3), "at {x}: {off:?}");
    }
}

/// A light stated by its power of luminance: a sphere of power P gives P / (4 pi d^2) at a distance far from it, and
/// exactly so at any distance.
#[test]
fn light_stated_by_power() {
    let mut d = probe(128, 12);
    let black = d.diffuse([0.0; 3]);
    let mut emission = glow([0.1; 3]).expect("emits");
    emission.scale = EmissionScale::Power(100.0);
    d.shape(SPHERE, placed([0.0, 2.0, 0.0], [0.5; 3]), black).emission = Some(emission);
    assert_expectation("sphere", &render(&d), reflected(100.0 / (16.0 * PI)), 2e-4, 1);
}

#[test]
fn light_adds_up() {
    for estimator in Estimator::CONNECTING {
        let mut d = probe(128, 13);
        let black = d.diffuse([0.0; 3]);
        d.shape(SPHERE, placed([0.0, 2.0, 0.0], [0.5; 3]), black).emission = glow([1.0; 3]);
        d.light(LightKind::Point { position: Vec3::new(1.0, 1.0, 0.0), intensity: BRIGHT });
        d.light(LightKind::Constant { radiance: SpectrumDescription::Constant(0.25) });
        estimator.choose(&mut d);
        let hidden = 1.0 / 16.0;
        let expected = PI / 16.0 + 3.0 / 8.0_f64.sqrt() + 0.25 * PI * (1.0 - hidden);
        assert_expectation(&format!("{estimator:?}"), &render(&d), reflected(expected), 2e-4, 3);
    }
}
