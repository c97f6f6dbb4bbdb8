//! The camera: film and lens are covered evenly, rays meet where they should, blur has the size that optics gives it, and a
//! crop is a part of the whole.
//!
//! Chi-squared tests over 10^6 samples and z tests; each function is one family with a probability of a false alarm of
//! 0.01.

mod common;

use common::build::{Build, DISK, chain, glow, placed, rectangle};
use common::room::room;
use common::run::{film, render};
use lichtweg::camera::Camera;
use lichtweg::scene::description::{CameraDescription, Description, Diagnostics, FieldOfView, FovAxis};
use lichtweg_montecarlo::Sampler;
use lichtweg_montecarlo::hypothesis::{DensityTest, sidak, z_test};
use lichtweg_ray::math::{Affine, Vec3};

fn compile(description: &CameraDescription, width: u32, height: u32) -> Camera {
    let mut diagnostics = Diagnostics::default();
    let camera = Camera::compile(description, width, height, &mut diagnostics);
    assert!(diagnostics.list.is_empty(), "{:#?}", diagnostics.list);
    camera.expect("compiles without findings")
}

fn random_camera(aperture_radius: f32, focus_distance: f32, shift: [f32; 2]) -> CameraDescription {
    CameraDescription {
        to_world: Affine::look_at([1.0, 2.0, 3.0], [-0.5, 0.7, -1.0], [0.2, 1.0, 0.1])
            .expect("spans a frame"),
        field_of_view: FieldOfView::Angle { degrees: 65.0, axis: FovAxis::X },
        principal_point_offset: shift,
        aperture_radius,
        focus_distance,
        ..Default::default()
    }
}

/// Even film points become directions of density 1 / (A cos^3), with A the area of the film at distance 1 (Pharr et al.
/// 2023, section 13.1.1), wherever the principal point is.
#[test]
fn rays_cover_the_film() {
    let cases = [(300, 200, [0.0, 0.0]), (100, 400, [0.0, 0.0]), (200, 200, [0.2, -0.1])];
    for (width, height, shift) in cases {
        let description = random_camera(0.0, 1.0, shift);
        let camera = compile(&description, width, height);
        let to_camera = description.to_world.inverse().expect("regular");
        let tangent = (0.5 * 65.0_f32).to_radians().tan();
        let half = [tangent, tangent * height as f32 / width as f32];
        let area = 4.0 * half[0] * half[1];
        let center = [0, 1].map(|i| {
            let middle = to_camera.vector(camera.ray([0.5, 0.5], [0.5, 0.5], 0.0).direction);
            [middle.x, middle.y][i] / middle.z
        });
        let sample = |s: &mut Sampler| {
            Some(to_camera.vector(camera.ray(s.next_2d(), [0.5, 0.5], 0.0).direction).to_array())
        };
        let pdf = |w: [f32; 3]| {
            let inside = w[2] > 0.0 && (0..2).all(|i| (w[i] / w[2] - center[i]).abs() <= half[i]);
            if inside { 1.0 / (area * w[2].powi(3)) } else { 0.0 }
        };
        let test = DensityTest { grid: [40, 80], ..DensityTest::default() };
        let report = test.sphere(sample, pdf).expect("testable");
        assert!(!report.rejects(sidak(0.01, cases.len())), "{width} x {height}, {shift:?}: {report}");
        let expected = [0, 1].map(|i| 2.0 * half[i] * shift[i].abs());
        let off = [0, 1].map(|i| (center[i].abs() - expected[i]).abs());
        assert!(off.iter().all(|o| *o < 1e-5), "{shift:?}: {center:?}");
    }
}

/// The field of view is the angle between the film's two ends along the axis it is stated for.
#[test]
fn field_of_view_by_axis() {
    let (width, height) = (300_u32, 200_u32);
    let cases = [
        (FovAxis::X, [0.0, 0.5], [1.0, 0.5]),
        (FovAxis::Y, [0.5, 0.0], [0.5, 1.0]),
        (FovAxis::Diagonal, [0.0, 0.0], [1.0, 1.0]),
        (FovAxis::Smaller, [0.5, 0.0], [0.5, 1.0]),
        (FovAxis::Larger, [0.0, 0.5], [1.0, 0.5]),
    ];
    for (axis, from, to) in cases {
        let field_of_view = FieldOfView::Angle { degrees: 40.0, axis };
        let camera = compile(&CameraDescription { field_of_view, ..Default::default() }, width, height);
        let [a, b] = [from, to].map(|film| camera.ray(film, [0.5, 0.5], 0.0).direction);
        let angle = a.cross(b).length().atan2(a.dot(b)).to_degrees();
        assert!((angle - 40.0).abs() < 1e-3, "{axis:?}: {angle}");
    }
}

/// Lens points fill a disk of the aperture's radius evenly, and all rays through a film point meet in the plane in focus.
#[test]
fn rays_cover_the_lens() {
    let description = random_camera(0.7, 4.0, [0.0; 2]);
    let camera = compile(&description, 200, 100);
    let to_camera = description.to_world.inverse().expect("regular");
    let films = [[0.5, 0.5], [0.1, 0.8]];
    for film in films {
        let pinhole = compile(&random_camera(0.0, 4.0, [0.0; 2]), 200, 100).ray(film, [0.5; 2], 0.0);
        let axis = description.to_world.vector(Vec3::Z);
        let focus = pinhole.at(4.0 / pinhole.direction.dot(axis));
        let sample = |s: &mut Sampler| {
            let ray = camera.ray(film, s.next_2d(), 0.0);
            let miss = (focus - ray.origin).normalized() - ray.direction;
            assert!(miss.length() < 1e-5, "a ray misses the point in focus by {miss:?}");
            let lens = to_camera.point(ray.origin);
            assert!(lens.z.abs() < 1e-5, "the lens is not flat: {lens:?}");
            Some([lens.x, lens.y])
        };
        let radius_squared = 0.7_f32 * 0.7;
        let pdf = |[x, y]: [f32; 2]| {
            if x * x + y * y <= radius_squared { 1.0 / (std::f32::consts::PI * radius_squared) } else { 0.0 }
        };
        let report =
            DensityTest::default().rectangle([-0.701; 2], [0.701; 2], sample, pdf).expect("testable");
        assert!(!report.rejects(sidak(0.01, films.len())), "{report}");
    }
}

#[test]
fn clipping_planes_and_shutter() {
    let description = CameraDescription {
        near_clip: 2.0,
        far_clip: 5.0,
        shutter: [0.25, 0.75],
        ..random_camera(0.3, 4.0, [0.0; 2])
    };
    let camera = compile(&description, 100, 100);
    let axis = description.to_world.vector(Vec3::Z);
    for film in [[0.0, 0.0], [0.5, 0.5], [0.9, 0.3]] {
        let ray = camera.ray(film, [0.2, 0.9], 0.5);
        let depth = |t: f32| (ray.at(t) - ray.origin).dot(axis);
        assert!((depth(ray.tnear) - 2.0).abs() < 1e-4 && (depth(ray.tfar) - 5.0).abs() < 1e-4);
        assert_eq!(ray.time, 0.5, "the middle of the time that the shutter is open");
    }
    // A wall between the planes is seen, one in front of them or behind is not.
    for (distance, seen) in [(1.9, false), (2.1, true), (4.9, true), (5.1, false)] {
        let mut d = Description { film: film(8, 8), ..Default::default() };
        (d.camera.near_clip, d.camera.far_clip) = (2.0, 5.0);
        d.integrator.max_depth = Some(1);
        let black = d.diffuse([0.0; 3]);
        let turned = Affine::rotation([0.0, 1.0, 0.0], 180.0);
        let place = chain(&[Affine::translation(0.0, 0.0, distance), turned, Affine::scaling(9.0, 9.0, 1.0)]);
        d.shape(rectangle(), place, black).emission = glow([1.0; 3]);
        assert_eq!(render(&d).mean().0[0], f64::from(u8::from(seen)), "at {distance}");
    }
}

/// A point at depth z, with the lens of radius a in focus at depth f, is spread evenly over a circle of radius
/// a |1/z - 1/f| on the film at distance 1 (Potmesil and Chakravarty 1981). Its flux stays what a pinhole would get.
#[test]
fn circle_of_confusion() {
    const SIZE: u32 = 64;
    let (aperture, focus, spot) = (0.2_f64, 2.0_f64, 0.02_f64);
    for depth in [1.2_f64, 2.0, 3.5, 8.0] {
        let mut d = Description { film: film(SIZE, SIZE), ..Default::default() };
        d.sampler.samples_per_pixel = 2048;
        d.integrator.max_depth = Some(1);
        d.camera.aperture_radius = aperture as f32;
        d.camera.focus_distance = focus as f32;
        let half = 0.15;
        d.camera.field_of_view = FieldOfView::Window([-half, half, -half, half]);
        let black = d.diffuse([0.0; 3]);
        // As large as to be the same spot on the film at every depth.
        let radius = spot * depth;
        let place =
            chain(&[placed([0.0, 0.0, depth], [radius; 3]), Affine::rotation([1.0, 0.0, 0.0], 180.0)]);
        d.shape(DISK, place, black).emission = glow([1.0; 3]);
        let image = render(&d);

        let blur = aperture * (1.0 / depth - 1.0 / focus).abs();
        let pixel_side = 2.0 * f64::from(half) / f64::from(SIZE);
        let (mut flux, mut flux_variance, mut spread, mut spread_variance) = (0.0, 0.0, 0.0, 0.0);
        // The spot and the circle are independent and even: mean squares of the radii add up, and the pixels' own.
        let expected_spread = 0.5 * (blur * blur + spot * spot) + pixel_side * pixel_side / 6.0;
        for (i, pixel) in image.pixels.iter().enumerate() {
            let at = |p: usize| (p as f64 + 0.5) * pixel_side - f64::from(half);
            let radius_squared = at(i % SIZE as usize).powi(2) + at(i / SIZE as usize).powi(2);
            let (mean, variance) = (pixel.mean()[0], pixel.variance_of_mean()[0]);
            flux += mean;
            flux_variance += variance;
            // Deviations of the ratio, to first order.
            let deviation = radius_squared - expected_spread;
            spread += mean * deviation;
            spread_variance += variance * deviation * deviation;
            let corner = pixel_side / 2.0_f64.sqrt();
            assert!(mean == 0.0 || radius_squared.sqrt() - corner <= blur + spot, "light outside the circle");
            let inside = radius_squared.sqrt() + corner < (blur - spot).abs();
            if inside {
                // The spot covers the lens as seen from here, or lies within it.
                let even = if blur > spot { (spot / blur).powi(2) } else { 1.0 };
                let outcome = z_test(mean - even, variance);
                assert!(
                    !outcome.rejects(sidak(0.01, 4 * 64 * 64)),
                    "pixel {i} of {depth}: {mean}, not {even}"
                );
            }
        }
        let expected_flux = std::f64::consts::PI * (spot / pixel_side).powi(2);
        let outcomes = [z_test(flux - expected_flux, flux_variance), z_test(spread, spread_variance)];
        for outcome in outcomes {
            assert!(!outcome.rejects(sidak(0.01, 8)), "depth {depth}: {outcome:?}, flux {flux}");
        }
        // Power: a circle ten percent larger would be noticed.
        let off = spread - flux * 0.105 * blur * blur;
        assert!(blur == 0.0 || z_test(off, spread_variance).rejects(1e-4), "depth {depth}");
    }
}

/// A crop shows the same pixels as the whole, to the bit.
#[test]
fn crops_are_parts_of_the_whole() {
    let mut d = room(4);
    d.film.width = 50;
    d.film.height = 40;
    let whole = render(&d);
    for crop in [[0, 0, 50, 40], [17, 5, 20, 33], [49, 39, 1, 1], [3, 20, 40, 1]] {
        d.film.crop = Some(crop);
        let part = render(&d);
        assert_eq!(part.window, crop);
        assert_eq!(part.size, [50, 40]);
        let [x0, y0, width, _] = crop.map(|c| c as usize);
        for (i, pixel) in part.pixels.iter().enumerate() {
            let (x, y) = (x0 + i % width, y0 + i / width);
            assert_eq!(*pixel, whole.pixels[y * 50 + x], "crop {crop:?}, pixel {x}, {y}");
        }
    }
}
