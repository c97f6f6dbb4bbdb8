//! Tests of the obj reader: its features, damaged files, round trips.

use proptest::prelude::*;

use super::parse_obj;
use crate::mesh::fuzz::{feed_damaged, truncations};
use crate::mesh::tests::assert_valid;
use crate::mesh::{LoadedMesh, MeshError, Place};
use lichtweg_ray::math::{Vec2, Vec3};

fn parse(text: &str) -> Result<LoadedMesh, MeshError> {
    parse_obj(text.as_bytes(), false)
}

fn load(text: &str) -> LoadedMesh {
    let loaded = parse(text).unwrap();
    assert_valid(&loaded);
    loaded
}

fn error(text: &str) -> MeshError {
    parse(text).unwrap_err()
}

/// Two triangles of a square with shared positions, all kinds of index, and most of the other syntax.
const SQUARE: &str = "\
# a square
mtllib none.mtl
o square
v 0 0 0
v 1 0 0 0.5 0.5 0.5
v +1.0e0 1 -0
v 0 1. .0e1
vt 0 0
vt 1 0 0
vt 1 1
vt 0 1
vn 0 0 1
usemtl grey
s off
g first
f 1/1/1 2/2/1 3/3/1
g second
f -4/-4/-1 -2/-2/-1 -1/-1/-1
";

#[test]
fn triples_become_vertices_in_order_of_use() {
    let mesh = load(SQUARE).mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    assert_eq!(mesh.positions, corners.map(|(x, y)| Vec3::new(x, y, 0.0)));
    assert_eq!(mesh.uvs, corners.map(|(u, v)| Vec2::new(u, v)));
    assert_eq!(mesh.normals, [Vec3::Z; 4]);
}

#[test]
fn flip_turns_v_over() {
    let mesh = parse_obj(SQUARE.as_bytes(), true).unwrap().mesh;
    assert_eq!(mesh.uvs[0], Vec2::new(0.0, 1.0));
    assert_eq!(mesh.uvs[2], Vec2::new(1.0, 0.0));
}

#[test]
fn line_ends_blanks_and_marks_do_not_matter() {
    let expected = load(SQUARE).mesh;
    let variants = [
        SQUARE.replace('\n', "\r\n"),
        SQUARE.replace('\n', "\r"),
        SQUARE.replace(' ', " \t "),
        SQUARE.replace("\n", " \n\n  "),
        format!("\u{feff}{SQUARE}"),
        SQUARE.trim_end().to_owned(),
        SQUARE.replace("f 1/1/1 2/2/1", "f 1/1/1 \\\n 2/2/1"),
        SQUARE.replace("v 0 0 0\n", "v 0 \\\r\n 0 0 # origin\n"),
        SQUARE.replace("# a square", "# C:\\models\\"),
    ];
    for text in variants {
        let mesh = load(&text).mesh;
        assert_eq!(
            (&mesh.positions, &mesh.triangles),
            (&expected.positions, &expected.triangles),
            "{text:?}"
        );
        assert_eq!((mesh.uvs, mesh.normals), (expected.uvs.clone(), expected.normals.clone()), "{text:?}");
    }
}

#[test]
fn one_position_with_two_normals_is_two_vertices() {
    let mesh =
        load("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 -1\nf 1//1 2//1 3//1\nf 1//2 3//2 2//2\n").mesh;
    assert_eq!(mesh.positions.len(), 6);
    assert!(mesh.uvs.is_empty());
    assert_eq!(mesh.normals[3], -Vec3::Z);
}

#[test]
fn polygons_become_fans() {
    let mesh = load("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n").mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
}

#[test]
fn faces_may_come_before_vertices() {
    assert_eq!(load("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").mesh.positions.len(), 3);
}

#[test]
fn missing_normals_are_those_of_the_faces() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 0\nvn nan 0 1\nf 1//1 2//2 3//3\nf 1//1 2 3\n";
    let loaded = load(text);
    assert_eq!(loaded.mesh.normals, [Vec3::Z; 5]);
    assert_eq!(loaded.warnings.len(), 1);
    assert!(loaded.warnings[0].starts_with("4 of 5 vertex normals"), "{:?}", loaded.warnings);
}

#[test]
fn missing_and_broken_texture_coordinates_are_zero() {
    let loaded = load("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt inf 1\nvt 0.25\nf 1/1 2/2 3\n");
    assert_eq!(loaded.mesh.uvs, [Vec2::ZERO, Vec2::new(0.25, 0.0), Vec2::ZERO]);
    assert_eq!(loaded.warnings.len(), 2, "{:?}", loaded.warnings);
}

#[test]
fn what_is_no_surface_is_left_out_with_a_warning() {
    let loaded = load(&format!("{SQUARE}l 1 2\np 1\ncurv 0 1 1 2\nhullabaloo 7\n"));
    assert_eq!(loaded.mesh.triangles.len(), 2);
    let expected = ["2 point and line", "first in line 21", "\"hullabaloo\" in line 22"];
    assert_eq!(loaded.warnings.len(), expected.len());
    for (warning, part) in loaded.warnings.iter().zip(expected) {
        assert!(warning.contains(part), "{warning}");
    }
}

#[test]
fn errors_name_the_line_and_what_is_there() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let cases = [
        ("v 0 0 zero\n".to_owned(), 1, "a number", "\"zero\""),
        ("v 0 0\nv 1 1 1\n".to_owned(), 1, "a number", "the end of the line"),
        ("\n\nv 0 0".to_owned(), 3, "a number", "the end of the file"),
        ("v 1.0x 0 0\n".to_owned(), 1, "a number", "\"1.0x\""),
        (format!("{vertices}f 1 2 4\n"), 4, "3 vertex statements", "4"),
        (format!("{vertices}f 1 2 -4\n"), 4, "3 vertex statements", "-4"),
        (format!("{vertices}f 1 2 0\n"), 4, "3 vertex statements", "0"),
        (format!("{vertices}f 1 2 99999999999999999999\n"), 4, "3 vertex statements", "9223372036854775807"),
        (format!("{vertices}f 1/1 2/1 3/1\n"), 4, "0 texture coordinate statements", "1"),
        (format!("{vertices}f 1//2 2//1 3//1\n"), 4, "0 normal statements", "2"),
        (format!("{vertices}f 1 2\n"), 4, "three or more vertices", "2"),
        (format!("{vertices}f\n"), 4, "three or more vertices", "0"),
        (format!("{vertices}f 1 2 3/4/5/6\n"), 4, "a corner such as", "\"/6\""),
        (format!("{vertices}f 1 2 c\n"), 4, "the index of a vertex", "\"c\""),
        (format!("{vertices}# \\\nf 1 2 \\\n c\n"), 6, "the index of a vertex", "\"c\""),
    ];
    for (text, line, expected, found) in cases {
        let error = error(&text);
        assert_eq!(error.place, Place::Line(line), "{text:?}: {error}");
        assert!(error.expected.contains(expected), "{text:?}: {error}");
        assert_eq!(error.found, found, "{text:?}: {error}");
        assert!(!error.help.is_empty());
    }
}

#[test]
fn non_finite_positions_are_counted() {
    let error = error("v 0 0 0\nv nan 0 0\nv 0 1e99 0\nf 1 2 3\n");
    assert!(error.found.starts_with("2 of 3"), "{error}");
    assert!(error.found.contains("vertex 1 (from 0) at (NaN, 0, 0)"), "{error}");
}

#[test]
fn other_files_are_refused() {
    assert!(error("").expected.contains("OBJ"));
    assert!(error("v 0 0 0\n").found.contains("no face"));
    let html = error("<!doctype html>\n<html></html>\n");
    assert_eq!((html.place, html.found.as_str()), (Place::Line(1), "\"<!doctype\""));
    assert!(parse_obj(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", false).unwrap_err().found.contains("binary"));
}

#[test]
fn truncated_files_never_panic() {
    for prefix in truncations(SQUARE.as_bytes()) {
        if let Ok(loaded) = parse_obj(prefix, false) {
            assert_valid(&loaded);
        }
    }
}

#[test]
fn damaged_files_never_panic() {
    let valid = [SQUARE.as_bytes().to_vec(), SQUARE.replace('\n', "\r\n").into_bytes()];
    feed_damaged(&valid, |bytes| {
        if let Ok(loaded) = parse_obj(bytes, true) {
            assert_valid(&loaded);
        }
    });
}

fn finite() -> impl Strategy<Value = f32> {
    any::<f32>().prop_filter("finite", |x| x.is_finite())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Every `f32` printed in full comes back bit for bit, and so does every corner.
    #[test]
    fn written_meshes_come_back(
        positions in prop::collection::vec([finite(), finite(), finite()], 1..40),
        uvs in prop::collection::vec([finite(), finite()], 1..40),
        faces in prop::collection::vec([any::<[prop::sample::Index; 2]>(), any::<[prop::sample::Index; 2]>(),
                                        any::<[prop::sample::Index; 2]>()], 1..60),
        relative in any::<bool>(),
    ) {
        let mut text = String::new();
        for p in &positions {
            text += &format!("v {} {:e} {}\n", p[0], p[1], p[2]);
        }
        for uv in &uvs {
            text += &format!("vt {} {}\n", uv[0], uv[1]);
        }
        let mut expected = Vec::new();
        for face in &faces {
            text += "f";
            for corner in face {
                let (v, t) = (corner[0].index(positions.len()), corner[1].index(uvs.len()));
                expected.push((Vec3::from_array(positions[v]), Vec2::new(uvs[t][0], uvs[t][1])));
                text += &if relative {
                    format!(" {}/{}", v as i64 - positions.len() as i64, t as i64 - uvs.len() as i64)
                } else {
                    format!(" {}/{}", v + 1, t + 1)
                };
            }
            text += "\n";
        }
        let loaded = load(&text);
        let corners: Vec<_> = loaded.mesh.triangles.iter().flatten()
            .map(|&i| (loaded.mesh.positions[i as usize], loaded.mesh.uvs[i as usize])).collect();
        prop_assert_eq!(corners, expected);
        prop_assert_eq!(loaded.warnings.len(), 0);
    }
}
