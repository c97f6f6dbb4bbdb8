//! Light from environments against quadrature of their definitions, written here once more and in f64.
//!
//! z tests, with a probability of a false alarm of 0.01 for each function.

mod common;

use std::f64::consts::PI;

use common::build::{Build, chain, float_image};
use common::judge::{assert_expectation, expectation};
use common::probe::{probe, reflected};
use common::run::{Estimator, render};
use lichtweg::scene::description::{Description, EnvironmentMapping, LightKind, SpectrumDescription};
use lichtweg_ray::math::{Affine, Vec3};

/// A probe under a map that is black but for one texel of radiance 10.
fn one_texel(
    mapping: EnvironmentMapping,
    [width, height]: [u32; 2],
    [column, row]: [u32; 2],
    to_world: Affine,
) -> Description {
    let mut pixels = vec![[0.0; 3]; (width * height) as usize];
    pixels[(row * width + column) as usize] = [10.0; 3];
    let mut d = probe(128, u64::from(100 * width + 10 * row + column));
    d.light(LightKind::Environment { image: float_image(width, &pixels), mapping, to_world });
    d
}

/// The irradiance on a plane facing +y of a texel of radiance 10 in a map with Mitsuba's latitudes and longitudes, read
/// bilinearly: the texel's value falls to zero linearly towards the neighbours, and is kept beyond the pole.
fn latitude_longitude(size: [u32; 2], texel: [u32; 2], to_world: &Affine) -> f64 {
    const STEPS: u32 = 600;
    let [width, height] = size.map(f64::from);
    let [column, row] = texel.map(|t| f64::from(t) + 0.5);
    // From one texel before the texel's centre to one behind.
    let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS) * 2.0 - 1.0;
    let cell = (2.0 / f64::from(STEPS)).powi(2);
    let mut sum = 0.0;
    for i in 0..STEPS * STEPS {
        let (dx, dy) = (offset(i % STEPS), offset(i / STEPS));
        let (phi, theta) = ((column + dx) / width * 2.0 * PI, (row + dy) / height * PI);
        if !(0.0..=PI).contains(&theta) {
            continue;
        }
        // Rows beyond the first and last repeat them.
        let beyond = (texel[1] == 0 && dy < 0.0) || (texel[1] + 1 == size[1] && dy > 0.0);
        let tent = (1.0 - dx.abs()) * if beyond { 1.0 } else { 1.0 - dy.abs() };
        let local = [theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos()];
        let up: f64 = to_world.rows[1].iter().zip(local).map(|(a, b)| a * b).sum();
        sum += 10.0 * tent * up.max(0.0) * theta.sin() * cell;
    }
    sum * (2.0 * PI / width) * (PI / height)
}

#[test]
fn one_bright_texel_of_latitude_and_longitude() {
    let turned = chain(&[Affine::rotation([1.0, 0.2, 0.0], 70.0), Affine::rotation([0.0, 1.0, 0.0], 33.0)]);
    // In the open, across the seam, at the pole, across the horizon, and turned.
    let cases = [
        ([16, 8], [5, 2], Affine::IDENTITY),
        ([16, 8], [0, 1], Affine::IDENTITY),
        ([16, 8], [15, 2], Affine::IDENTITY),
        ([16, 8], [3, 0], Affine::IDENTITY),
        ([16, 8], [9, 4], Affine::IDENTITY),
        ([16, 8], [9, 4], turned),
        ([16, 8], [2, 7], turned),
        ([64, 32], [40, 9], turned),
    ];
    for (size, texel, to_world) in cases {
        let irradiance = latitude_longitude(size, texel, &to_world);
        for estimator in Estimator::CONNECTING {
            let mut d = one_texel(EnvironmentMapping::LatitudeLongitude, size, texel, to_world);
            estimator.choose(&mut d);
            let what = format!("texel {texel:?} of {size:?} by {estimator:?}");
            let image = render(&d);
            assert_expectation(&what, &image, reflected(irradiance), 5e-4, 3 * cases.len());
        }
    }
}

/// The irradiance on a plane facing +y of a texel of radiance 10 in an octahedral map: the square [-1, 1]^2 has the area
/// 4 for 4 pi of directions, its inner diamond |u| + |v| < 1 is the upper half (Clarberg 2008).
fn octahedral(size: u32, texel: [u32; 2], to_world: &Affine) -> f64 {
    const STEPS: u32 = 500;
    let width = 2.0 / f64::from(size);
    let [left, top] = texel.map(|t| f64::from(t) * width - 1.0);
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS) * width;
    let mut sum = 0.0;
    for i in 0..STEPS * STEPS {
        let (u, v) = (left + at(i % STEPS), top + at(i / STEPS));
        let distance = 1.0 - u.abs() - v.abs();
        let r = 1.0 - distance.abs();
        // In the outer corners the two coordinates change places.
        let angle = 0.25 * PI * ((v.abs() - u.abs()) / r + 1.0);
        let sine = r * (2.0 - r * r).sqrt();
        let x = (sine * angle.cos()).copysign(u);
        let y = (sine * angle.sin()).copysign(v);
        let local = [x, y, (1.0 - r * r).copysign(distance)];
        let up: f64 = to_world.rows[1].iter().zip(local).map(|(a, b)| a * b).sum();
        sum += 10.0 * up.max(0.0);
    }
    sum * (width / f64::from(STEPS)).powi(2) * PI
}

#[test]
fn octahedral_quadrature_by_hand() {
    // With +z up: a quadrant of a 2 x 2 map is a quarter of the sphere; an inner texel of a 4 x 4 map gives
    // pi (1/4 - integral of (u + v)^2 over [0, 1/2]^2) = pi 17/96.
    let up = Affine::rotation([1.0, 0.0, 0.0], -90.0);
    assert!((octahedral(2, [0, 1], &up) - 10.0 * PI / 4.0).abs() < 1e-3);
    assert!((octahedral(4, [2, 1], &up) - 10.0 * PI * 17.0 / 96.0).abs() < 1e-3);
}

#[test]
fn one_bright_texel_of_an_octahedral_map() {
    let up = Affine::rotation([1.0, 0.0, 0.0], -90.0);
    let turned = chain(&[Affine::rotation([1.0, 0.2, 0.0], 70.0), Affine::rotation([0.0, 0.0, 1.0], 33.0)]);
    let cases = [
        (2, [0, 0], up),
        (2, [1, 0], turned),
        (4, [1, 2], up),
        (4, [2, 1], turned),
        (4, [0, 3], turned),
        (16, [9, 4], Affine::IDENTITY),
        (16, [3, 13], turned),
    ];
    for (size, texel, to_world) in cases {
        let irradiance = octahedral(size, texel, &to_world);
        for estimator in Estimator::CONNECTING {
            let mut d = one_texel(EnvironmentMapping::EqualAreaOctahedral, [size, size], texel, to_world);
            estimator.choose(&mut d);
            let what = format!("texel {texel:?} of {size} by {estimator:?}");
            let image = render(&d);
            assert_expectation(&what, &image, reflected(irradiance), 5e-4, 3 * cases.len());
        }
    }
}

/// Over a plane, an even environment and an even map give pi L, and scale.
#[test]
fn even_environments() {
    let map = |mapping| LightKind::Environment {
        image: float_image(4, &[[0.5; 3]; 16]),
        mapping,
        to_world: Affine::rotation([1.0, 2.0, 3.0], 50.0),
    };
    let kinds = [
        LightKind::Constant { radiance: SpectrumDescription::Constant(0.5) },
        map(EnvironmentMapping::LatitudeLongitude),
        map(EnvironmentMapping::EqualAreaOctahedral),
    ];
    for (i, kind) in kinds.into_iter().enumerate() {
        for estimator in Estimator::ALL {
            let mut d = probe(64, i as u64);
            d.light(kind.clone());
            d.lights[0].scale = 3.0;
            estimator.choose(&mut d);
            let image = render(&d);
            let what = format!("environment {i} by {estimator:?}");
            assert_expectation(&what, &image, reflected(1.5 * PI), 2e-4, 12);
            let off = expectation(&image, reflected(1.5 * PI * 1.01), 2e-4);
            let noisy = estimator == Estimator::Nee;
            assert!(
                noisy || off[0].1.rejects(1e-4),
                "{what} would pass with an error of one percent: {off:?}"
            );
        }
    }
}

/// What the camera sees of a map is the map: the direction of each texel's centre, by both conventions.
#[test]
fn maps_are_seen_where_they_are() {
    let size = [8, 4];
    let colors: Vec<[f32; 3]> = (0..32).map(|i| [i as f32, 1.0, 0.0]).collect();
    let look = |mapping, direction: Vec3| {
        let (width, pixels) = match mapping {
            EnvironmentMapping::LatitudeLongitude => (size[0], colors.clone()),
            EnvironmentMapping::EqualAreaOctahedral => (4, colors[..16].to_vec()),
        };
        let mut d = Description {
            camera: common::run::camera([0.0; 3], direction.to_array().map(f64::from), 0.01),
            film: common::run::film(1, 1),
            ..Default::default()
        };
        let image = float_image(width, &pixels);
        d.light(LightKind::Environment { image, mapping, to_world: Affine::IDENTITY });
        let mut diagnostics = lichtweg::scene::description::Diagnostics::default();
        let scene = lichtweg::scene::Scene::compile(&d, &mut diagnostics).expect("compiles");
        common::run::render_scene(&scene, &d).mean().0[0]
    };
    for row in 0..4 {
        for column in 0..8 {
            let phi = (f64::from(column) + 0.5) / 8.0 * 2.0 * PI;
            let theta = (f64::from(row) + 0.5) / 4.0 * PI;
            let direction = [theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos()];
            let direction = Vec3::from_array(direction.map(|c| c as f32));
            let seen = look(EnvironmentMapping::LatitudeLongitude, direction);
            assert!((seen - f64::from(row * 8 + column)).abs() < 0.01, "row {row}, column {column}: {seen}");
        }
    }
    // The middle of the square is +z, its right edge +x, its last row +y, its corners -z.
    let octahedral = [
        ([0.2, 0.1, 1.0], 10.0),
        ([-0.1, -0.2, 1.0], 5.0),
        ([1.0, 0.1, 0.1], 11.0),
        ([0.1, 1.0, 0.1], 14.0),
        ([-1.0, -0.9, -2.0], 0.0),
        ([1.0, 0.9, -2.0], 15.0),
    ];
    for (direction, texel) in octahedral {
        let seen = look(EnvironmentMapping::EqualAreaOctahedral, Vec3::from_array(direction).normalized());
        assert_eq!(seen, texel, "{direction:?}");
    }
}
