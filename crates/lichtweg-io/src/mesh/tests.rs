//! What holds for every mesh reader: errors for missing files, normals, primitives, and the scenes that are at hand.

use std::path::PathBuf;

use lichtweg::scene::description::Mesh;
use lichtweg_ray::math::{Vec2, Vec3};

use super::{LoadedMesh, Place, cube, read_obj, read_ply, read_serialized, rectangle, smooth_normals};

/// Panics unless the promises of [`LoadedMesh`] hold.
pub(super) fn assert_valid(loaded: &LoadedMesh) {
    let mesh = &loaded.mesh;
    let vertices = mesh.positions.len();
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < vertices));
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.normals.is_empty() || mesh.normals.len() == vertices);
    assert!(mesh.normals.iter().all(|n| n.try_normalized().is_some()));
    assert!(mesh.uvs.is_empty() || mesh.uvs.len() == vertices);
    assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
}

/// Unnormalised normal of a triangle.
fn face_normal(mesh: &Mesh, triangle: [u32; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
    (b - a).cross(c - a)
}

#[test]
fn missing_file_is_named() {
    let path = PathBuf::from("no/such/Mesh.ply");
    for error in [
        read_ply(&path, false).unwrap_err(),
        read_obj(&path, false).unwrap_err(),
        read_serialized(&path, 0, false).unwrap_err(),
    ] {
        assert!(error.to_string().starts_with("no/such/Mesh.ply: expected a readable file"), "{error}");
        assert!(error.help.contains("letter case"));
        assert_eq!(error.diagnostic().code, "bad-mesh");
    }
}

#[test]
fn directories_and_devices_are_refused() {
    let error = read_obj(&std::env::temp_dir(), false).unwrap_err();
    assert!(error.found.contains("directory"), "{error}");
    #[cfg(target_os = "linux")]
    {
        let error = read_obj("/dev/zero".as_ref(), false).unwrap_err();
        assert!(error.found.contains("device"), "{error}");
        assert_eq!(error.place, Place::File);
    }
}

#[test]
fn rectangle_faces_up_z() {
    let mesh = rectangle();
    for &triangle in &mesh.triangles {
        assert_eq!(face_normal(&mesh, triangle), Vec3::new(0.0, 0.0, 4.0));
    }
    for (p, uv) in mesh.positions.iter().zip(&mesh.uvs) {
        assert_eq!(*uv, Vec2::new((p.x + 1.0) / 2.0, (p.y + 1.0) / 2.0));
    }
}

#[test]
fn cube_is_closed_and_faces_out() {
    let mesh = cube();
    assert_eq!((mesh.positions.len(), mesh.uvs.len(), mesh.triangles.len()), (24, 24, 12));
    let mut sum = Vec3::ZERO;
    for &triangle in &mesh.triangles {
        let normal = face_normal(&mesh, triangle);
        assert_eq!(normal.length(), 4.0);
        assert_eq!(normal.dot(mesh.positions[triangle[0] as usize]), 4.0, "not outward: {triangle:?}");
        sum += normal;
    }
    assert_eq!(sum, Vec3::ZERO);
    // Two vertices out of Mitsuba 3's table.
    assert_eq!((mesh.positions[1], mesh.uvs[1]), (Vec3::new(1.0, -1.0, 1.0), Vec2::new(1.0, 1.0)));
    assert_eq!((mesh.positions[18], mesh.uvs[18]), (Vec3::new(-1.0, 1.0, -1.0), Vec2::new(1.0, 0.0)));
}

/// The corner of a cube whose faces share vertices: all three have angle pi/2, though one is cut in two triangles.
#[test]
fn smooth_normals_do_not_depend_on_the_cut() {
    let mut mesh = Mesh {
        positions: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]]
            .map(|p| Vec3::from_array(p.map(|x| x as f32)))
            .to_vec(),
        triangles: vec![[0, 4, 1], [0, 2, 4], [0, 1, 3], [0, 3, 2]],
        ..Mesh::default()
    };
    smooth_normals(&mut mesh);
    let expected = Vec3::splat(-1.0).normalized();
    assert!((mesh.normals[0] - expected).length() < 1e-6, "{:?}", mesh.normals[0]);
}

#[test]
fn smooth_normals_of_degenerate_faces_are_finite() {
    let mut mesh = Mesh { positions: vec![Vec3::ONE; 3], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    smooth_normals(&mut mesh);
    assert_eq!(mesh.normals, [Vec3::X; 3]);
}

/// The meshes of the test scenes, where those are at hand.
#[test]
fn scene_meshes_load() {
    let scenes = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if !scenes.is_dir() {
        println!("skipped: {} is absent", scenes.display());
        return;
    }
    let (mut ply, mut obj) = (0, 0);
    for scene in ["house", "veach-ajar", "veach-bidir"] {
        for entry in std::fs::read_dir(scenes.join(scene).join("models")).unwrap() {
            let path = entry.unwrap().path();
            let (loaded, triangles) = match path.extension().and_then(|extension| extension.to_str()) {
                Some("ply") => (read_ply(&path, false), &mut ply),
                Some("obj") => (read_obj(&path, true), &mut obj),
                _ => continue,
            };
            let loaded = loaded.unwrap();
            assert_valid(&loaded);
            assert!(loaded.warnings.is_empty(), "{}: {:?}", path.display(), loaded.warnings);
            *triangles += loaded.mesh.triangles.len();
        }
    }
    assert_eq!((ply, obj), (1_569_971, 16_084));
}
