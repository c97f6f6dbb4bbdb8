//! Scenes from PLY files: binary, little endian, as Mitsuba, pbrt and `lichtweg` write them.

use std::path::{Path, PathBuf};

use lichtweg_ray::math::Vec3;

use super::Scene;

/// All triangles of a file, or of the files of a folder; `None`, with a notice, where there are none.
pub fn read(name: &'static str, path: &str, eye: Vec3, target: Vec3, light: Vec3) -> Option<Scene> {
    let mut scene = Scene::empty(name, eye, target, light);
    for file in files(Path::new(path)) {
        let Some(()) = std::fs::read(&file).ok().and_then(|bytes| add(&mut scene, &bytes)) else {
            eprintln!("{}: not a binary little-endian PLY with float x, y, z first", file.display());
            continue;
        };
    }
    (!scene.indices.is_empty()).then_some(scene)
}

fn files(path: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(path) else { return vec![path.into()] };
    let mut files: Vec<_> = entries.flatten().map(|e| e.path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "ply"));
    files.sort();
    files
}

fn size(kind: &str) -> Option<usize> {
    Some(match kind {
        "char" | "uchar" | "int8" | "uint8" => 1,
        "short" | "ushort" | "int16" | "uint16" => 2,
        "int" | "uint" | "int32" | "uint32" | "float" | "float32" => 4,
        "double" | "float64" => 8,
        _ => return None,
    })
}

/// Adds the faces of a file, as fans.
fn add(scene: &mut Scene, bytes: &[u8]) -> Option<()> {
    let end = bytes.windows(11).position(|w| w == b"end_header\n")? + 11;
    let header = std::str::from_utf8(&bytes[..end]).ok()?;
    let (mut vertices, mut faces, mut stride) = (0, 0, 0);
    let (mut in_faces, mut list) = (false, None);
    for line in header.lines() {
        let words: Vec<_> = line.split_whitespace().collect();
        match words[..] {
            ["format", format, _] if format != "binary_little_endian" => return None,
            ["element", "vertex", n] => vertices = n.parse().ok()?,
            ["element", "face", n] => (faces, in_faces) = (n.parse::<usize>().ok()?, true),
            ["property", "list", count, index, _] => list = Some((size(count)?, size(index)?)),
            ["property", kind, _] if !in_faces => stride += size(kind)?,
            ["property", ..] => return None,
            _ => {}
        }
    }
    let (count_size, index_size) = list?;
    let mut rest = &bytes[end..];
    let base = scene.positions.len() as u32;
    for _ in 0..vertices {
        let (vertex, tail) = rest.split_at_checked(stride)?;
        let at = |i: usize| Some(f32::from_le_bytes(vertex.get(4 * i..4 * i + 4)?.try_into().ok()?));
        scene.positions.push(Vec3::new(at(0)?, at(1)?, at(2)?));
        rest = tail;
    }
    let integer = |rest: &mut &[u8], size: usize| {
        let (head, tail) = rest.split_at_checked(size)?;
        *rest = tail;
        Some(head.iter().rev().fold(0_u32, |n, &b| n << 8 | u32::from(b)))
    };
    for _ in 0..faces {
        let corners = integer(&mut rest, count_size)?;
        let first = integer(&mut rest, index_size)?;
        let mut last = integer(&mut rest, index_size)?;
        for _ in 2..corners {
            let next = integer(&mut rest, index_size)?;
            scene.indices.push([base + first, base + last, base + next]);
            last = next;
        }
    }
    Some(())
}
