//! What is promised of the street: its size, that it is a function of its parameters, sound triangles, and that it renders.

use lichtweg::render::{Job, LayerSelection, Progress};
use lichtweg::scene::Scene;
use lichtweg::scene::description::{Diagnostics, Mesh};
use lichtweg_ray::math::Bounds3;

use super::palette::Material;
use super::solids::{Rectangle, ball, cuboid, frustum, prism, tube, v, wall};
use super::*;

fn with_detail(detail: f32) -> Parameters {
    Parameters { detail, ..Parameters::default() }
}

fn meshes(description: &Description) -> impl Iterator<Item = &Mesh> {
    description.shapes.iter().map(|shape| match &shape.geometry {
        GeometryDescription::Mesh(mesh) => mesh.as_ref(),
        other => panic!("the street has meshes only, not {other:?}"),
    })
}

#[test]
fn has_as_many_faces_as_the_lectures_and_more_with_detail() {
    let count = |detail| triangles(with_detail(detail)).1.len();
    let faces = count(1.0);
    assert!((250_000..600_000).contains(&faces), "{faces}");
    assert!(count(0.1) < faces / 2);
    assert!(count(4.0) > 2 * faces);
}

#[test]
fn is_a_function_of_its_parameters() {
    let small = with_detail(0.1);
    let (positions, indices) = triangles(small);
    assert_eq!((&positions, &indices), (&triangles(small).0, &triangles(small).1));
    assert_ne!(positions, triangles(Parameters { seed: 2, ..small }).0);
    let description = describe(small);
    assert_eq!(meshes(&description).map(|mesh| mesh.triangles.len()).sum::<usize>(), indices.len());
}

#[test]
fn parameters_are_set_by_name() {
    let mut parameters = Parameters::default();
    parameters.set("detail", "0.5").unwrap();
    parameters.set("seed", "7").unwrap();
    assert_eq!(parameters, Parameters { detail: 0.5, seed: 7 });
    assert_eq!(parameters.set("detail", "1e9").unwrap_err().code, "bad-value");
    assert_eq!(parameters.set("spp", "1").unwrap_err().code, "unused-define");
    assert_eq!(parameters, Parameters { detail: 0.5, seed: 7 });
}

#[test]
fn triangles_have_area_and_normals_have_length() {
    for detail in [0.05, 1.0, 3.0] {
        let description = describe(with_detail(detail));
        let mut bounds = Bounds3::EMPTY;
        for (mesh, shape) in meshes(&description).zip(&description.shapes) {
            assert!(mesh.positions.iter().all(|p| p.is_finite()), "{:?}", shape.name);
            bounds = bounds.union(Bounds3::of(mesh.positions.iter().copied()));
            assert!(mesh.normals.is_empty() || mesh.normals.len() == mesh.positions.len());
            assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4), "{:?}", shape.name);
            for t in &mesh.triangles {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                assert!((b - a).cross(c - a).length() > 0.0, "{:?} {a:?} {b:?} {c:?}", shape.name);
            }
        }
        assert!(bounds.min.y > -1.0 && bounds.max.y < 40.0, "{bounds:?}");
        assert!(bounds.extent().max_element() < 320.0, "{bounds:?}");
    }
}

/// Six times the volume that the faces of a form enclose: positive where they look outwards.
fn volume(build: impl FnOnce(&mut Builder)) -> f32 {
    let mut builder = Builder::new(1.0);
    build(&mut builder);
    let volumes = builder.finish().flat_map(|(_, _, mesh)| {
        let corners = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize]);
        mesh.triangles.iter().map(corners).map(|[a, b, c]| a.dot(b.cross(c))).collect::<Vec<_>>()
    });
    volumes.sum()
}

#[test]
fn forms_are_closed_and_face_outwards() {
    let close =
        |found: f32, expected: f32| assert!((found - 6.0 * expected).abs() < 1e-3, "{found} {expected}");
    let m = Material::Stone;
    close(volume(|b| cuboid(b, m, [1.0, 0.0, 2.0], [3.0, 1.0, 4.0])), 4.0);
    close(volume(|b| b.turned(30.0, |b| b.tilted(20.0, |b| cuboid(b, m, [1.0; 3], [2.0; 3])))), 1.0);
    close(volume(|b| frustum(b, m, [-1.0, 0.0, -1.0], [1.0, 3.0, 1.0], 0.5)), 7.0);
    close(volume(|b| prism(b, m, &[[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]], 5.0, 7.0)), 2.0);
    let round = volume(|b| ball(b, m, 1.0, 64)) / 6.0;
    assert!((4.15..4.19).contains(&round), "{round}");
    assert!(volume(|b| tube(b, m, &[v(0.0, 0.0, 0.0), v(0.3, 1.0, 0.2)], |_| 0.1, 8)) > 0.0);
    // A body is open below, at a height of a quarter of a metre.
    let body = volume(|b| b.at(0.0, -0.25, 0.0, |b| car::car(b, &mut Random::new(3)))) / 6.0;
    assert!((3.0..12.0).contains(&body), "{body}");
}

#[test]
fn walls_have_their_openings() {
    let area = |openings: &[Rectangle]| -> f32 {
        let mut builder = Builder::new(1.0);
        let whole = Rectangle { x0: 0.0, x1: 4.0, y0: 0.0, y1: 3.0 };
        wall(&mut builder, Material::Stone, whole, openings, 0.5);
        let (_, _, mesh) = builder.finish().next().expect("one mesh");
        let corners = mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize]));
        corners.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
    };
    let opening = |x0| Rectangle { x0, x1: x0 + 1.0, y0: 1.0, y1: 2.0 };
    assert!((area(&[]) - 12.0).abs() < 1e-4);
    // Each takes one square metre, and adds four reveals of half a one.
    assert!((area(&[opening(0.5), opening(2.5)]) - 14.0).abs() < 1e-4);
}

#[test]
fn renders_in_daylight_without_invalid_samples() {
    let mut description = describe(with_detail(0.2));
    let film = [description.film.width, description.film.height];
    assert_eq!((film, description.integrator.max_depth), ([1536, 654], Some(3)));
    assert_eq!(description.sampler.samples_per_pixel, 16);
    (description.film.width, description.film.height) = (96, 41);
    let mut diagnostics = Diagnostics::default();
    let scene = Scene::compile(&description, &mut diagnostics).expect("the street compiles");
    let job = Job::compile(&description, LayerSelection::default(), None, &mut diagnostics).expect("a job");
    assert!(diagnostics.list.is_empty(), "{:?}", diagnostics.list);
    let rendering = job.render(&scene, &Progress::default()).expect("a picture");
    assert_eq!(rendering.statistics.dropped, 0);
    let (mean, error) = rendering.image.mean();
    for (mean, error) in mean.into_iter().zip(error) {
        assert!((0.15..0.6).contains(&mean) && error < 0.01 * mean, "{mean} {error}");
    }
}
