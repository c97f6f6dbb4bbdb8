//! Tests of the ply reader: its features, damaged files, round trips.

use proptest::prelude::*;

use super::parse_ply;
use crate::mesh::fuzz::{feed_damaged, truncations};
use crate::mesh::tests::assert_valid;
use crate::mesh::{LoadedMesh, MeshError, Place};
use lichtweg_ray::math::{Vec2, Vec3};

const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// Writes PLY files of any encoding and types.
struct Writer {
    encoding: &'static str,
    bytes: Vec<u8>,
}

impl Writer {
    /// `header` is what stands between the `format` line and `end_header`.
    fn new(encoding: &'static str, header: &str) -> Self {
        let bytes = format!("ply\nformat {encoding} 1.0\ncomment test\n{header}end_header\n").into_bytes();
        Self { encoding, bytes }
    }

    fn put(&mut self, kind: &str, value: f64) {
        macro_rules! binary {
            ($type:ty) => {{
                let number = value as $type;
                if self.encoding == ENCODINGS[1] {
                    number.to_le_bytes().to_vec()
                } else {
                    number.to_be_bytes().to_vec()
                }
            }};
        }
        let encoded = if self.encoding == ENCODINGS[0] {
            format!("{value} ").into_bytes()
        } else {
            match kind {
                "char" | "int8" => binary!(i8),
                "uchar" | "uint8" => binary!(u8),
                "short" => binary!(i16),
                "ushort" => binary!(u16),
                "int" | "int32" => binary!(i32),
                "uint" | "uint32" => binary!(u32),
                "int64" => binary!(i64),
                "uint64" => binary!(u64),
                "float" | "float32" => binary!(f32),
                "double" => binary!(f64),
                _ => panic!("no type {kind}"),
            }
        };
        self.bytes.extend(encoded);
    }

    fn row(&mut self, kind: &str, values: &[f64]) {
        values.iter().for_each(|&value| self.put(kind, value));
        self.end_row();
    }

    fn list(&mut self, count_kind: &str, kind: &str, values: &[f64]) {
        self.put(count_kind, values.len() as f64);
        self.row(kind, values);
    }

    fn end_row(&mut self) {
        if self.encoding == ENCODINGS[0] {
            self.bytes.push(b'\n');
        }
    }
}

fn load(bytes: &[u8]) -> LoadedMesh {
    let loaded = parse_ply(bytes, false).unwrap();
    assert_valid(&loaded);
    loaded
}

fn error(bytes: &[u8]) -> MeshError {
    parse_ply(bytes, false).unwrap_err()
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const FACE_LIST: &str = "property list uchar int vertex_indices\n";

/// A triangle, a quad and a triangle over a row of vertices at (i, i^2, 0), in the layout with the shortcuts.
fn simple(encoding: &'static str) -> Vec<u8> {
    let mut writer = Writer::new(encoding, &format!("element vertex 5\n{XYZ}element face 3\n{FACE_LIST}"));
    (0..5).for_each(|i| writer.row("float", &[f64::from(i), f64::from(i * i), 0.0]));
    writer.list("uchar", "int", &[0.0, 1.0, 2.0]);
    writer.list("uchar", "int", &[1.0, 2.0, 3.0, 4.0]);
    writer.list("uchar", "int", &[2.0, 3.0, 4.0]);
    writer.bytes
}

/// Every property that is read, in unusual types and order, among things that are not.
fn ornate(encoding: &'static str) -> Vec<u8> {
    let header = "obj_info none\n\
        element camera 2\nproperty uint64 id\nproperty list ushort double view\n\
        element face 2\nproperty uchar red\nproperty list int uint64 vertex_index\nproperty list uint8 float weights\n\
        element nothing 1000000000000\n\
        element vertex 4\nproperty double nz\nproperty double y\nproperty float t\nproperty double x\n\
        property short quality\nproperty list uchar uchar tags\nproperty float nx\nproperty float32 ny\n\
        property float s\nproperty int8 z\n\
        element edge 1\nproperty int vertex1\nproperty int vertex2\n";
    let mut writer = Writer::new(encoding, header);
    for id in 0..2 {
        writer.put("uint64", f64::from(id));
        writer.list("ushort", "double", &[1.5; 3][..id as usize + 1]);
    }
    for indices in [[0.0, 1.0, 2.0], [0.0, 2.0, 3.0]] {
        writer.put("uchar", 255.0);
        writer.list("int", "uint64", &indices);
        writer.list("uint8", "float", &[0.5]);
    }
    for i in 0..4 {
        let x = f64::from(i);
        for (kind, value) in
            [("double", 1.0), ("double", x * x), ("float", 0.25), ("double", x), ("short", -7.0)]
        {
            writer.put(kind, value);
        }
        writer.list("uchar", "uchar", &[9.0; 4][..i as usize]);
        for (kind, value) in [("float", 0.0), ("float32", 0.0), ("float", x), ("int8", -x)] {
            writer.put(kind, value);
        }
        writer.end_row();
    }
    writer.row("int", &[0.0, 1.0]);
    writer.bytes
}

#[test]
fn encodings_agree() {
    for encoding in ENCODINGS {
        let loaded = load(&simple(encoding));
        assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [1, 2, 3], [1, 3, 4], [2, 3, 4]], "{encoding}");
        let expected: Vec<Vec3> = (0..5).map(|i| Vec3::new(i as f32, (i * i) as f32, 0.0)).collect();
        assert_eq!(loaded.mesh.positions, expected, "{encoding}");
        assert!(loaded.mesh.normals.is_empty() && loaded.mesh.uvs.is_empty() && loaded.warnings.is_empty());
    }
}

#[test]
fn properties_of_any_type_and_order() {
    for encoding in ENCODINGS {
        let loaded = load(&ornate(encoding));
        let mesh = loaded.mesh;
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]], "{encoding}");
        assert_eq!(mesh.positions[3], Vec3::new(3.0, 9.0, -3.0), "{encoding}");
        assert_eq!(mesh.normals, [Vec3::Z; 4], "{encoding}");
        assert_eq!(mesh.uvs[2], Vec2::new(2.0, 0.25), "{encoding}");
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    }
}

#[test]
fn texture_coordinates_go_by_several_names() {
    for [u, v] in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]] {
        let header = format!(
            "element vertex 3\n{XYZ}property float {u}\nproperty float {v}\nelement face 1\n{FACE_LIST}"
        );
        let mut writer = Writer::new(ENCODINGS[1], &header);
        (0..3).for_each(|i| {
            writer.row("float", &[f64::from(i), 1.0, f64::from(i * i), 0.5, f64::from(i) / 4.0])
        });
        writer.list("uchar", "int", &[0.0, 1.0, 2.0]);
        assert_eq!(load(&writer.bytes).mesh.uvs[1], Vec2::new(0.5, 0.25), "{u} {v}");
        assert_eq!(parse_ply(&writer.bytes, true).unwrap().mesh.uvs[1], Vec2::new(0.5, 0.75));
    }
}

#[test]
fn windows_headers_before_binary_bodies() {
    let bytes = simple(ENCODINGS[1]);
    let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    for line_end in ["\r\n", "\r"] {
        let mut windows =
            String::from_utf8(bytes[..end].to_vec()).unwrap().replace('\n', line_end).into_bytes();
        windows.extend(&bytes[end..]);
        assert_eq!(load(&windows).mesh.triangles.len(), 4);
    }
    let text = String::from_utf8(simple(ENCODINGS[0])).unwrap().replace('\n', "\r\n");
    assert_eq!(load(text.as_bytes()).mesh.triangles.len(), 4);
}

#[test]
fn faces_without_area_are_left_out_with_a_warning() {
    for encoding in ENCODINGS {
        let header = format!("element vertex 3\n{XYZ}element face 3\n{FACE_LIST}");
        let mut writer = Writer::new(encoding, &header);
        (0..3).for_each(|i| writer.row("float", &[f64::from(i), f64::from(i * i), 0.0]));
        [&[0.0, 1.0][..], &[0.0, 1.0, 2.0], &[]].iter().for_each(|face| writer.list("uchar", "int", face));
        let loaded = load(&writer.bytes);
        assert_eq!(loaded.mesh.triangles, [[0, 1, 2]]);
        assert!(loaded.warnings[0].starts_with("2 faces of fewer"), "{:?}", loaded.warnings);
    }
}

#[test]
fn trailing_bytes_are_a_warning() {
    let mut bytes = simple(ENCODINGS[2]);
    bytes.extend([1; 40]);
    assert!(load(&bytes).warnings[0].starts_with("40 bytes follow"));
}

#[test]
fn indices_out_of_range_are_errors() {
    for encoding in ENCODINGS {
        for (index, kind) in [(5.0, "int"), (-1.0, "int"), (4e9, "uint"), (-1.0, "int64"), (1e15, "int64")] {
            let header =
                format!("element vertex 3\n{XYZ}element face 1\nproperty list uchar {kind} vertex_indices\n");
            let mut writer = Writer::new(encoding, &header);
            (0..3).for_each(|i| writer.row("float", &[f64::from(i), f64::from(i * i), 0.0]));
            writer.list("uchar", kind, &[0.0, 1.0, index]);
            let error = error(&writer.bytes);
            assert!(error.to_string().contains("ind"), "{encoding} {index}: {error}");
        }
    }
}

#[test]
fn non_finite_positions_are_counted() {
    let header = format!("element vertex 4\n{XYZ}element face 1\n{FACE_LIST}");
    let mut writer = Writer::new(ENCODINGS[1], &header);
    for x in [0.0, f64::NAN, 1.0, f64::INFINITY] {
        writer.row("float", &[x, x, 0.0]);
    }
    writer.list("uchar", "int", &[0.0, 1.0, 2.0]);
    let error = error(&writer.bytes);
    assert!(error.found.starts_with("2 of 4 that are not; the first is vertex 1"), "{error}");
}

/// Counts far beyond the file's size must be refused before anything is allocated for them.
#[test]
fn absurd_counts_are_refused() {
    for encoding in ENCODINGS {
        for count in ["1000", "4294967295", "18446744073709551615"] {
            for element in ["vertex 5", "face 3"] {
                let name = element.split(' ').next().unwrap();
                let bytes = simple(encoding);
                let end = bytes.windows(10).position(|window| window == b"end_header").unwrap();
                let header = String::from_utf8_lossy(&bytes[..end]);
                let mut absurd = header.replace(element, &format!("{name} {count}")).into_bytes();
                absurd.extend(&bytes[end..]);
                let error = error(&absurd);
                assert!(matches!(error.place, Place::Byte(_) | Place::Line(_)), "{encoding}: {error}");
            }
        }
    }
    let error = error(b"ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nend_header\n");
    assert_eq!((error.place, error.expected.as_str()), (Place::Line(3), "a count of rows"));
}

#[test]
fn list_lengths_beyond_the_file_are_refused() {
    for (kind, length) in
        [("uint", 4e9), ("int", -3.0), ("float", 1.5), ("float", f64::NAN), ("double", 1e300)]
    {
        for encoding in ENCODINGS {
            let header =
                format!("element vertex 3\n{XYZ}element face 1\nproperty list {kind} int vertex_indices\n");
            let mut writer = Writer::new(encoding, &header);
            (0..3).for_each(|i| writer.row("float", &[f64::from(i), f64::from(i * i), 0.0]));
            writer.put(kind, length);
            writer.row("int", &[0.0, 1.0, 2.0]);
            let error = error(&writer.bytes);
            assert!(
                error.expected.starts_with("the length of a list"),
                "{kind} {length} {encoding}: {error}"
            );
        }
    }
}

#[test]
fn damaged_headers_name_their_line() {
    let cases = [
        ("", Place::Byte(0)),
        ("v 0 0 0\n", Place::Byte(0)),
        ("ply\n", Place::Line(2)),
        ("ply\nformat ascii 2.0\n", Place::Line(2)),
        ("ply\nformat utf8 1.0\n", Place::Line(2)),
        ("ply\nproperty float x\n", Place::Line(2)),
        ("ply\nformat ascii 1.0\nelement vertex -1\n", Place::Line(3)),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\n", Place::Line(4)),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar x\n", Place::Line(4)),
        ("ply\nformat ascii 1.0\ncolour red\n", Place::Line(3)),
        ("ply\nelement vertex 0\nend_header\n", Place::Line(3)),
        ("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n", Place::File),
        (
            "ply\nformat ascii 1.0\nelement face 0\nelement vertex 0\nelement face 0\nend_header\n",
            Place::Line(5),
        ),
        ("ply\nformat ascii 1.0\nelement vertex 0\nelement face 0\nend_header\n", Place::Line(3)),
    ];
    for (header, place) in cases {
        let error = error(header.as_bytes());
        assert_eq!(error.place, place, "{header:?}: {error}");
        assert!(!error.help.is_empty());
    }
}

#[test]
fn text_errors_name_their_line() {
    let text = String::from_utf8(simple(ENCODINGS[0])).unwrap().replace("3 9 0", "3 nine 0");
    let error = error(text.as_bytes());
    assert_eq!((error.place, error.found.as_str()), (Place::Line(14), "\"nine\""));
}

#[test]
fn truncated_files_are_errors() {
    for encoding in ENCODINGS {
        for bytes in [simple(encoding), ornate(encoding)] {
            // The last characters of a text file are blank, and a number that lost digits may still be one.
            let end = if encoding == ENCODINGS[0] { bytes.len() - 3 } else { bytes.len() };
            for prefix in truncations(&bytes[..end]) {
                assert!(parse_ply(prefix, false).is_err(), "{encoding}: {} bytes", prefix.len());
            }
        }
    }
}

#[test]
fn damaged_files_never_panic() {
    let valid: Vec<Vec<u8>> =
        ENCODINGS.iter().flat_map(|&encoding| [simple(encoding), ornate(encoding)]).collect();
    feed_damaged(&valid, |bytes| {
        if let Ok(loaded) = parse_ply(bytes, true) {
            assert_valid(&loaded);
        }
    });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Meshes of triangles and quads with normals and texture coordinates come back bit for bit.
    #[test]
    fn written_meshes_come_back(
        rows in prop::collection::vec(prop::array::uniform8(-1e30_f32..1e30), 1..40),
        faces in prop::collection::vec(prop::collection::vec(any::<prop::sample::Index>(), 3..=4), 1..60),
        encoding in 0..3_usize,
        signed in any::<bool>(),
    ) {
        let index_kind = if signed { "int" } else { "uint" };
        let header = format!(
            "element vertex {}\n{XYZ}property float nx\nproperty float ny\nproperty float nz\n\
             property float u\nproperty float v\nelement face {}\nproperty list uchar {index_kind} vertex_indices\n",
            rows.len(), faces.len()
        );
        let mut writer = Writer::new(ENCODINGS[encoding], &header);
        for row in &rows {
            writer.row("float", &row.map(f64::from));
        }
        let mut expected = Vec::new();
        for face in &faces {
            let indices: Vec<u32> = face.iter().map(|index| index.index(rows.len()) as u32).collect();
            expected.extend((2..indices.len()).map(|i| [indices[0], indices[i - 1], indices[i]]));
            writer.list("uchar", index_kind, &indices.iter().map(|&i| f64::from(i)).collect::<Vec<_>>());
        }
        let mesh = load(&writer.bytes).mesh;
        prop_assert_eq!(mesh.triangles, expected);
        for (i, row) in rows.iter().enumerate() {
            prop_assert_eq!(mesh.positions[i].to_array(), [row[0], row[1], row[2]]);
            prop_assert_eq!(mesh.uvs[i], Vec2::new(row[6], row[7]));
            let normal = Vec3::new(row[3], row[4], row[5]);
            prop_assert!(mesh.normals[i] == normal || normal.try_normalized().is_none());
        }
    }
}
