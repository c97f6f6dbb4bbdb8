//! Tests of the serialized reader: its features, damaged files, round trips.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use proptest::prelude::*;

use super::{DOUBLE_PRECISION, FACE_NORMALS, HAS_COLORS, HAS_NORMALS, HAS_UVS, parse_serialized};
use crate::mesh::fuzz::{feed_damaged, truncations};
use crate::mesh::tests::assert_valid;
use crate::mesh::{LoadedMesh, Place};
use lichtweg_ray::math::{Vec2, Vec3};

const SINGLE_PRECISION: u32 = 0x1000;

/// The uncompressed contents of one mesh.
fn contents(version: u16, flags: u32, rows: &[[f32; 8]], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut data = flags.to_le_bytes().to_vec();
    if version == 4 {
        data.extend("Würfel\0".as_bytes());
    }
    data.extend((rows.len() as u64).to_le_bytes());
    data.extend((triangles.len() as u64).to_le_bytes());
    let columns = [
        (0..3, true),
        (3..6, flags & HAS_NORMALS != 0),
        (6..8, flags & HAS_UVS != 0),
        (0..3, flags & HAS_COLORS != 0),
    ];
    for (column, _) in columns.into_iter().filter(|(_, present)| *present) {
        for number in rows.iter().flat_map(|row| row[column.clone()].iter()) {
            if flags & DOUBLE_PRECISION != 0 {
                data.extend(f64::from(*number).to_le_bytes());
            } else {
                data.extend(number.to_le_bytes());
            }
        }
    }
    data.extend(triangles.iter().flatten().flat_map(|index| index.to_le_bytes()));
    data
}

/// A file of meshes, given uncompressed.
fn file(version: u16, meshes: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut offsets = Vec::new();
    for mesh in meshes {
        offsets.push(bytes.len() as u64);
        bytes.extend([0x1c, 0x04]);
        bytes.extend(version.to_le_bytes());
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(mesh).unwrap();
        bytes.extend(encoder.finish().unwrap());
    }
    for offset in offsets {
        bytes.extend(&offset.to_le_bytes()[..if version == 4 { 8 } else { 4 }]);
    }
    bytes.extend((meshes.len() as u32).to_le_bytes());
    bytes
}

const ROWS: [[f32; 8]; 3] = [
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.25],
];

/// Three meshes that differ in their last vertex.
fn three_meshes(version: u16, flags: u32) -> Vec<u8> {
    let mesh = |number: u8| {
        let mut rows = ROWS;
        rows[2][1] = f32::from(number) + 1.0;
        contents(version, flags, &rows, &[[0, 1, 2]])
    };
    file(version, &[mesh(0), mesh(1), mesh(2)])
}

fn load(bytes: &[u8], shape_index: usize) -> LoadedMesh {
    let loaded = parse_serialized(bytes, shape_index, false).unwrap();
    assert_valid(&loaded);
    loaded
}

#[test]
fn every_mesh_of_both_versions_and_precisions() {
    for version in [3, 4] {
        for precision in [SINGLE_PRECISION, DOUBLE_PRECISION] {
            let bytes = three_meshes(version, precision | HAS_NORMALS | HAS_UVS | HAS_COLORS);
            for number in 0..3 {
                let loaded = load(&bytes, number);
                assert_eq!(loaded.mesh.positions[2], Vec3::new(0.0, number as f32 + 1.0, 0.0));
                assert_eq!(loaded.mesh.normals, [Vec3::Z; 3]);
                assert_eq!(loaded.mesh.uvs[2], Vec2::new(0.0, 0.25));
                assert_eq!(loaded.mesh.triangles, [[0, 1, 2]]);
                assert!(!loaded.face_normals);
            }
        }
    }
}

#[test]
fn flags_decide_what_there_is() {
    let bare = load(&three_meshes(4, SINGLE_PRECISION), 1);
    assert!(bare.mesh.normals.is_empty() && bare.mesh.uvs.is_empty() && !bare.face_normals);
    let faceted = load(&three_meshes(4, SINGLE_PRECISION | HAS_NORMALS | FACE_NORMALS), 1);
    assert!(faceted.mesh.normals.is_empty() && faceted.face_normals);
}

#[test]
fn indices_of_missing_meshes_are_errors() {
    let error = parse_serialized(&three_meshes(4, SINGLE_PRECISION), 3, false).unwrap_err();
    assert_eq!(error.found, "a file of 3 meshes");
    assert!(parse_serialized(&three_meshes(3, SINGLE_PRECISION), usize::MAX, false).is_err());
}

#[test]
fn foreign_files_are_refused() {
    for (bytes, found) in
        [(&b""[..], "the end of the file"), (b"ply\nformat", "0x6c70"), (b"\x1c\x04\x07\0rest", "7")]
    {
        let error = parse_serialized(bytes, 0, false).unwrap_err();
        assert_eq!((error.place, error.found.as_str()), (Place::Byte(0), found));
    }
}

/// Counts that the compressed data cannot hold must be refused before anything is allocated for them.
#[test]
fn absurd_counts_are_refused() {
    for count in [1_u64 << 20, 1 << 31, u64::MAX] {
        for at in [0, 8] {
            let mut mesh = contents(3, SINGLE_PRECISION, &ROWS, &[[0, 1, 2]]);
            mesh[4 + at..12 + at].copy_from_slice(&count.to_le_bytes());
            assert!(parse_serialized(&file(3, &[mesh]), 0, false).is_err(), "{count} at {at}");
        }
    }
}

#[test]
fn indices_out_of_range_are_errors() {
    let mesh = contents(4, SINGLE_PRECISION, &ROWS, &[[0, 1, 2], [0, 1, 3]]);
    let error = parse_serialized(&file(4, &[mesh]), 0, false).unwrap_err();
    assert!(error.found.contains("triangle 1 (from 0) [0, 1, 3]"), "{error}");
}

#[test]
fn truncated_files_are_errors() {
    for version in [3, 4] {
        let bytes = three_meshes(version, SINGLE_PRECISION | HAS_NORMALS);
        for prefix in truncations(&bytes) {
            assert!(parse_serialized(prefix, 2, false).is_err(), "version {version}, {} bytes", prefix.len());
        }
    }
}

#[test]
fn damaged_files_never_panic() {
    let valid =
        [three_meshes(3, SINGLE_PRECISION | HAS_UVS), three_meshes(4, DOUBLE_PRECISION | HAS_NORMALS)];
    feed_damaged(&valid, |bytes| {
        for number in [0, 2] {
            if let Ok(loaded) = parse_serialized(bytes, number, false) {
                assert_valid(&loaded);
            }
        }
    });
}

/// Damage before compression, so that it gets past the checksum.
#[test]
fn damaged_contents_never_panic() {
    let valid = [contents(4, SINGLE_PRECISION | HAS_NORMALS | HAS_UVS, &ROWS, &[[0, 1, 2]])];
    feed_damaged(&valid, |data| {
        if let Ok(loaded) = parse_serialized(&file(4, &[data.to_vec()]), 0, false) {
            assert_valid(&loaded);
        }
    });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn written_meshes_come_back(
        rows in prop::collection::vec(prop::array::uniform8(-1e30_f32..1e30), 1..40),
        corners in prop::collection::vec(any::<[prop::sample::Index; 3]>(), 1..60),
        version in 3..=4_u16,
        double in any::<bool>(),
    ) {
        let triangles: Vec<[u32; 3]> =
            corners.iter().map(|triangle| triangle.map(|index| index.index(rows.len()) as u32)).collect();
        let precision = if double { DOUBLE_PRECISION } else { SINGLE_PRECISION };
        let mesh = contents(version, precision | HAS_UVS, &rows, &triangles);
        let loaded = load(&file(version, &[mesh]), 0);
        prop_assert_eq!(loaded.mesh.triangles, triangles);
        for (i, row) in rows.iter().enumerate() {
            prop_assert_eq!(loaded.mesh.positions[i].to_array(), [row[0], row[1], row[2]]);
            prop_assert_eq!(loaded.mesh.uvs[i], Vec2::new(row[6], row[7]));
        }
    }
}
