//! Mitsuba's `.serialized`: meshes as zlib streams one after another, with a dictionary of their offsets at the end.
//!
//! Each mesh: `u16` 0x041C, `u16` version (3 or 4), then compressed: `u32` flags, in version 4 a name that ends in 0, `u64`
//! vertices, `u64` triangles, positions, normals, texture coordinates, colours (each of these as the flags say, `f32` or
//! `f64`), `u32` indices. Dictionary: one offset a mesh (`u64` in version 4, `u32` in version 3), then `u32` meshes. All
//! little-endian. Format: the documentation in Mitsuba 3, `src/shapes/serialized.cpp`.
//!
//! Limits: vertex colours are left out.

use std::io::Read;

use flate2::read::ZlibDecoder;
use lichtweg::scene::description::Mesh;
use lichtweg_ray::math::{Vec2, Vec3};

use super::finish::finish;
use super::{LoadedMesh, MeshError, Place};

const MAGIC: u16 = 0x041c;
const MAGIC_BYTES: usize = 4;

const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLORS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const DOUBLE_PRECISION: u32 = 0x2000;

/// Parses mesh number `shape_index`, from 0, of the contents of a `.serialized` file. See the module
/// [`mesh`](crate::mesh) for `flip_v`.
///
/// # Errors
/// The bytes are no such file, there is no mesh of that number, the file is truncated, indices are out of range, or
/// positions are not finite.
pub fn parse_serialized(bytes: &[u8], shape_index: usize, flip_v: bool) -> Result<LoadedMesh, MeshError> {
    let version = check_magic(bytes, 0)?;
    let offset = find_mesh(bytes, version, shape_index)?;
    let version = check_magic(bytes, offset)?;
    let mut stream = Stream::new(bytes, offset + MAGIC_BYTES);
    let flags = stream.u32("flags")?;
    if version == 4 {
        stream.skip_name()?;
    }
    let vertices = stream.u64("the number of vertices")?;
    let triangles = stream.u64("the number of triangles")?;
    if vertices > u64::from(u32::MAX) {
        return Err(stream.error(
            "at most 4294967295 vertices",
            vertices.to_string(),
            "the file is damaged, or the mesh has to be split",
        ));
    }
    let double = flags & DOUBLE_PRECISION != 0;
    let has = |flag: u32| flags & flag != 0;
    let positions = stream.numbers(vertices, 3, double, "positions")?;
    let normals = stream.numbers(if has(HAS_NORMALS) { vertices } else { 0 }, 3, double, "normals")?;
    let uvs = stream.numbers(if has(HAS_UVS) { vertices } else { 0 }, 2, double, "texture coordinates")?;
    stream.numbers(if has(HAS_COLORS) { vertices } else { 0 }, 3, double, "colours")?;
    let indices = stream.array(triangles, 12, "triangles")?;
    let mesh = Mesh {
        positions: vec3s(&positions),
        normals: if has(FACE_NORMALS) { Vec::new() } else { vec3s(&normals) },
        uvs: uvs.chunks_exact(2).map(|uv| Vec2::new(uv[0], uv[1])).collect(),
        triangles: indices.chunks_exact(12).map(triangle).collect(),
    };
    let mut loaded = finish(mesh, flip_v, Vec::new())?;
    loaded.face_normals = has(FACE_NORMALS);
    Ok(loaded)
}

fn vec3s(numbers: &[f32]) -> Vec<Vec3> {
    numbers.chunks_exact(3).map(|xyz| Vec3::new(xyz[0], xyz[1], xyz[2])).collect()
}

fn triangle(bytes: &[u8]) -> [u32; 3] {
    [0, 4, 8].map(|i| u32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]))
}

/// The version of the mesh at an offset.
fn check_magic(bytes: &[u8], offset: usize) -> Result<u16, MeshError> {
    let error = |expected: &str, found: String, help: &str| {
        Err(MeshError::new(Place::Byte(offset as u64), expected, found, help))
    };
    let header = offset.checked_add(MAGIC_BYTES).and_then(|end| bytes.get(offset..end));
    let Some(&[m0, m1, v0, v1]) = header else {
        return error(
            "the header of a mesh",
            "the end of the file".to_owned(),
            "the file is truncated; copy it again",
        );
    };
    let (magic, version) = (u16::from_le_bytes([m0, m1]), u16::from_le_bytes([v0, v1]));
    if magic != MAGIC {
        let help = "check that this is a .serialized file of Mitsuba and has not been damaged";
        return error("the mark 0x041c of a Mitsuba mesh", format!("{magic:#06x}"), help);
    }
    if !matches!(version, 3 | 4) {
        return error("version 3 or 4", version.to_string(), "convert the file with a current Mitsuba");
    }
    Ok(version)
}

/// The offset of a mesh, from the dictionary; the first needs none.
fn find_mesh(bytes: &[u8], version: u16, shape_index: usize) -> Result<usize, MeshError> {
    if shape_index == 0 {
        return Ok(0);
    }
    let entry_bytes = if version == 4 { 8 } else { 4 };
    let number = |start: usize, length: usize| {
        let field = &bytes[start..start + length];
        field.iter().rev().fold(0_u64, |sum, &byte| sum << 8 | u64::from(byte))
    };
    // `check_magic` has seen four bytes.
    let end = bytes.len() - 4;
    let count = number(end, 4) as usize;
    let dictionary_bytes = count.saturating_mul(entry_bytes);
    if dictionary_bytes > end - end.min(MAGIC_BYTES) {
        return Err(MeshError::new(
            Place::Byte(end as u64),
            "the number of meshes as the last four bytes",
            format!("{count}, whose offsets the file has no room for"),
            "the file is truncated or damaged; copy it again",
        ));
    }
    if shape_index >= count {
        return Err(MeshError::new(
            Place::Byte(end as u64),
            format!("a mesh number {shape_index} (from 0)"),
            format!("a file of {count} meshes"),
            "correct the shape index",
        ));
    }
    let offset = number(end - dictionary_bytes + shape_index * entry_bytes, entry_bytes);
    // An offset that is nonsense lies behind the end, where there is no header.
    Ok(usize::try_from(offset).unwrap_or(usize::MAX))
}

/// A compressed mesh being read.
struct Stream<'a> {
    decoder: ZlibDecoder<&'a [u8]>,
    start: usize,
    compressed_bytes: usize,
}

impl<'a> Stream<'a> {
    fn new(bytes: &'a [u8], start: usize) -> Self {
        let compressed = &bytes[start..];
        Self { decoder: ZlibDecoder::new(compressed), start, compressed_bytes: compressed.len() }
    }

    fn error(&self, expected: impl Into<String>, found: impl Into<String>, help: &str) -> MeshError {
        let place = Place::Byte(self.start as u64 + self.decoder.total_in());
        MeshError::new(place, expected, found, help)
    }

    /// `count` elements of `size` bytes; memory grows only with what is really there.
    fn array(&mut self, count: u64, size: u64, what: &str) -> Result<Vec<u8>, MeshError> {
        /// Deflate makes at best this many bytes out of one.
        const LARGEST_RATIO: u128 = 1032;
        let bytes = u128::from(count) * u128::from(size);
        if bytes > LARGEST_RATIO * (self.compressed_bytes as u128 + 1) {
            return Err(self.error(
                format!("{count} {what}"),
                format!("{} compressed bytes, which cannot hold them", self.compressed_bytes),
                "the file is truncated or damaged; copy it again",
            ));
        }
        let mut data = Vec::new();
        let result = (&mut self.decoder).take(bytes as u64).read_to_end(&mut data);
        match result {
            Ok(_) if data.len() as u128 == bytes => Ok(data),
            Ok(_) => Err(self.error(
                format!("{count} {what}"),
                format!("the end of the data after {} of {bytes} bytes", data.len()),
                "the file is truncated or damaged; copy it again",
            )),
            Err(error) => Err(self.error(
                format!("{count} {what}"),
                format!("damaged compressed data ({error})"),
                "copy or export the file again",
            )),
        }
    }

    fn u32(&mut self, what: &str) -> Result<u32, MeshError> {
        let bytes = self.array(1, 4, what)?;
        Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }

    fn u64(&mut self, what: &str) -> Result<u64, MeshError> {
        Ok(u64::from(self.u32(what)?) | u64::from(self.u32(what)?) << 32)
    }

    fn skip_name(&mut self) -> Result<(), MeshError> {
        const LONGEST: usize = 1 << 16;
        for _ in 0..LONGEST {
            if self.array(1, 1, "byte of the name")?[0] == 0 {
                return Ok(());
            }
        }
        Err(self.error("a name that ends in 0", "64 KiB without one", "the file is damaged; export it again"))
    }

    /// `count` rows of `width` numbers in either precision.
    fn numbers(&mut self, count: u64, width: u64, double: bool, what: &str) -> Result<Vec<f32>, MeshError> {
        let bytes = self.array(count, width * if double { 8 } else { 4 }, what)?;
        Ok(if double {
            let number =
                |b: &[u8]| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]) as f32;
            bytes.chunks_exact(8).map(number).collect()
        } else {
            bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
        })
    }
}

#[cfg(test)]
mod tests;
