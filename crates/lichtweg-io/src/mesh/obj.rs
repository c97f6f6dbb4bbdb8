//! Wavefront OBJ: text, with separate indices for position, texture coordinate and normal at every corner.
//!
//! Each distinct triple of indices becomes one vertex, in the order of first use. All objects, groups and materials end up
//! in one mesh, as Mitsuba's `obj` does. Indices count from 1, or back from the last element when negative; positive ones
//! may point ahead. Format: Wavefront, "Advanced Visualizer Manual", appendix B1 (1992).
//!
//! Limits: polygons are cut into fans, which is right for convex ones; weights, colours, curves and free-form surfaces are
//! left out.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use lichtweg::scene::description::Mesh;
use lichtweg_ray::math::{Vec2, Vec3};

use super::finish::finish;
use super::text::{Cursor, quote};
use super::{LoadedMesh, MeshError, Place};

/// Parses the contents of an OBJ file. See the module [`mesh`](crate::mesh) for `flip_v`.
///
/// # Errors
/// A line is wrong, there are no faces, or positions are not finite.
pub fn parse_obj(bytes: &[u8], flip_v: bool) -> Result<LoadedMesh, MeshError> {
    if bytes[..bytes.len().min(4096)].contains(&0) {
        return Err(MeshError::new(
            Place::File,
            "the text of an OBJ file",
            "a binary file",
            "check the file's type; PLY and .serialized files have readers of their own",
        ));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut parser = Parser::default();
    let mut cursor = Cursor::new(bytes, 1);
    while !cursor.at_end() {
        cursor.skip_blanks();
        parser.statement(&mut cursor)?;
        cursor.next_line();
    }
    parser.build(flip_v)
}

/// Marks a corner without texture coordinate or normal.
const NONE: u32 = u32::MAX;

/// The indices of one corner, from 0: position, texture coordinate, normal.
type Corner = [u32; 3];

#[derive(Default)]
struct Parser {
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    vertex_of_corner: HashMap<Corner, u32, BuildHasherDefault<CornerHasher>>,
    corners: Vec<Corner>,
    /// For each corner the line that first used it.
    lines: Vec<u64>,
    triangles: Vec<[u32; 3]>,
    not_surfaces: u64,
    free_form: Option<u64>,
    unknown: Option<(u64, String)>,
}

impl Parser {
    fn statement(&mut self, cursor: &mut Cursor) -> Result<(), MeshError> {
        if cursor.at_line_end() {
            return Ok(());
        }
        let line = cursor.line();
        let keyword = cursor.word();
        cursor.skip_blanks();
        match keyword {
            b"v" => self.positions.push(vec3(cursor)?),
            b"vn" => self.normals.push(vec3(cursor)?),
            b"vt" => self.uvs.push(texture_coordinate(cursor)?),
            b"f" | b"fo" => self.face(cursor)?,
            b"p" | b"l" => self.not_surfaces += 1,
            b"curv" | b"curv2" | b"surf" => {
                self.free_form.get_or_insert(line);
            }
            keyword if is_harmless(keyword) => {}
            keyword => {
                self.unknown.get_or_insert_with(|| (line, quote(keyword)));
            }
        }
        Ok(())
    }

    fn face(&mut self, cursor: &mut Cursor) -> Result<(), MeshError> {
        let line = cursor.line();
        let (mut first, mut previous, mut count) = (0, 0, 0_u64);
        while !cursor.at_line_end() {
            let corner = self.corner(cursor)?;
            let vertex = self.vertex(corner, cursor.line())?;
            match count {
                0 => first = vertex,
                1 => {}
                _ => self.triangles.push([first, previous, vertex]),
            }
            previous = vertex;
            count += 1;
            cursor.skip_blanks();
        }
        if count < 3 {
            return Err(MeshError::new(
                Place::Line(line),
                "a face of three or more vertices",
                format!("{count}"),
                "remove this face, or complete it",
            ));
        }
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, cursor: &mut Cursor) -> Result<Corner, MeshError> {
        let mut corner = [resolve(cursor, self.positions.len(), "vertex")?, NONE, NONE];
        if cursor.take(b'/') {
            if !cursor.take(b'/') {
                // Some exporters write `v/` and `v/vt/`.
                if !cursor.at_word_end() {
                    corner[1] = resolve(cursor, self.uvs.len(), "texture coordinate")?;
                }
                if cursor.take(b'/') && !cursor.at_word_end() {
                    corner[2] = resolve(cursor, self.normals.len(), "normal")?;
                }
            } else if !cursor.at_word_end() {
                corner[2] = resolve(cursor, self.normals.len(), "normal")?;
            }
        }
        if !cursor.at_word_end() {
            return Err(cursor.expected("a corner such as 3, 3/4, 3//5 or 3/4/5"));
        }
        Ok(corner)
    }

    fn vertex(&mut self, corner: Corner, line: u64) -> Result<u32, MeshError> {
        let next = self.corners.len() as u32;
        let vertex = *self.vertex_of_corner.entry(corner).or_insert(next);
        if vertex == next {
            if next == NONE {
                return Err(MeshError::new(
                    Place::Line(line),
                    "at most 4294967295 distinct vertices",
                    "more",
                    "split the mesh",
                ));
            }
            self.corners.push(corner);
            self.lines.push(line);
        }
        Ok(vertex)
    }

    fn build(self, flip_v: bool) -> Result<LoadedMesh, MeshError> {
        if self.positions.is_empty() && self.triangles.is_empty() {
            return Err(self.not_an_obj());
        }
        self.check_corners()?;
        let has_uvs = self.corners.iter().any(|c| c[1] != NONE);
        let has_normals = self.corners.iter().any(|c| c[2] != NONE);
        let mut warnings = self.warnings();
        let missing_uvs = self.corners.iter().filter(|c| c[1] == NONE).count();
        if has_uvs && missing_uvs > 0 {
            let all = self.corners.len();
            warnings
                .push(format!("{missing_uvs} of {all} vertices have no texture coordinate; (0, 0) is used"));
        }
        let attribute = |index: u32| (index != NONE).then_some(index as usize);
        let mesh = Mesh {
            positions: self.corners.iter().map(|c| self.positions[c[0] as usize]).collect(),
            uvs: if has_uvs {
                let uv = |c: &Corner| attribute(c[1]).map_or(Vec2::ZERO, |i| self.uvs[i]);
                self.corners.iter().map(uv).collect()
            } else {
                Vec::new()
            },
            // A missing normal is zero here, and so replaced below.
            normals: if has_normals {
                let normal = |c: &Corner| attribute(c[2]).map_or(Vec3::ZERO, |i| self.normals[i]);
                self.corners.iter().map(normal).collect()
            } else {
                Vec::new()
            },
            triangles: self.triangles,
        };
        finish(mesh, flip_v, warnings)
    }

    /// Positive indices may point ahead, so that they can be checked only now.
    fn check_corners(&self) -> Result<(), MeshError> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let names = ["vertex", "texture coordinate", "normal"];
        for (corner, &line) in self.corners.iter().zip(&self.lines) {
            for kind in 0..3 {
                let index = corner[kind];
                if index as usize >= counts[kind] && (kind == 0 || index != NONE) {
                    return Err(out_of_range(line, i64::from(index) + 1, counts[kind], names[kind]));
                }
            }
        }
        Ok(())
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.not_surfaces > 0 {
            warnings.push(format!("{} point and line elements are left out", self.not_surfaces));
        }
        if let Some(line) = self.free_form {
            warnings.push(format!("curves and free-form surfaces (first in line {line}) are left out"));
        }
        if let Some((line, keyword)) = &self.unknown {
            warnings.push(format!("unknown statements are left out, the first {keyword} in line {line}"));
        }
        warnings
    }

    fn not_an_obj(&self) -> MeshError {
        let (place, found) = match &self.unknown {
            Some((line, keyword)) => (Place::Line(*line), keyword.clone()),
            None => (Place::File, "no vertex and no face".to_owned()),
        };
        MeshError::new(
            place,
            "an OBJ file with `v` and `f` lines",
            found,
            "check that this is the file that was meant",
        )
    }
}

/// Whether a statement carries nothing that a mesh without materials could lose.
fn is_harmless(keyword: &[u8]) -> bool {
    let known = "g o s mg usemtl usemap mtllib maplib vp deg bmat step cstype parm trim hole scrv sp end con \
                 bevel c_interp d_interp lod shadow_obj trace_obj ctech stech call csh res bsp bzp cdc cdp";
    known.split_ascii_whitespace().any(|known| known.as_bytes() == keyword)
}

fn vec3(cursor: &mut Cursor) -> Result<Vec3, MeshError> {
    let mut next = || {
        cursor.skip_blanks();
        cursor.float()
    };
    Ok(Vec3::new(next()?, next()?, next()?))
}

/// One or two numbers (and a third for volumes, left out).
fn texture_coordinate(cursor: &mut Cursor) -> Result<Vec2, MeshError> {
    let u = cursor.float()?;
    cursor.skip_blanks();
    let v = if cursor.at_line_end() { 0.0 } else { cursor.float()? };
    Ok(Vec2::new(u, v))
}

/// An index from 0 out of one that counts from 1, or back from the end.
#[inline]
fn resolve(cursor: &mut Cursor, count: usize, what: &str) -> Result<u32, MeshError> {
    let line = cursor.line();
    let Some(stated) = cursor.integer() else {
        return Err(cursor.expected(&format!("the index of a {what}")));
    };
    let index = if stated < 0 { stated.saturating_add(count as i64) } else { stated - 1 };
    match u32::try_from(index) {
        Ok(index) if index != NONE => Ok(index),
        _ => Err(out_of_range(line, stated, count, what)),
    }
}

fn out_of_range(line: u64, stated: i64, count: usize, what: &str) -> MeshError {
    MeshError::new(
        Place::Line(line),
        format!("the index of one of {count} {what} statements, from 1 up or from -1 down"),
        format!("{stated}"),
        "the file is damaged or truncated; export it again",
    )
}

/// Hashes three indices by multiplication and folding, far faster than the default at this size.
#[derive(Default)]
struct CornerHasher(u64);

impl Hasher for CornerHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(4) {
            let mut word = [0; 4];
            word[..chunk.len()].copy_from_slice(chunk);
            let product = u128::from(self.0 ^ u64::from(u32::from_le_bytes(word)) ^ 0x9e37_79b9_7f4a_7c15)
                * 0xd1b5_4a32_d192_ed03;
            self.0 = (product >> 64) as u64 ^ product as u64;
        }
    }

    fn write_usize(&mut self, _length: usize) {
        // The length of the array is always three.
    }
}

#[cfg(test)]
mod tests;
