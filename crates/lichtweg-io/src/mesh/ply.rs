//! PLY, the Stanford polygon format: a text header that declares tables, then the tables as text or binary.
//!
//! Read are of `vertex` the properties `x y z`, `nx ny nz` and one of `u v`, `s t`, `texture_u texture_v`,
//! `texture_s texture_t`; of `face` the list `vertex_indices` or `vertex_index`. Whatever else there is is skipped by its
//! declared type. Format: Turk, "The PLY polygon file format" (1994); the names of texture coordinates as in pbrt-v4.
//!
//! Limits: polygons are cut into fans; `tristrips` and texture coordinates per face are left out.

mod header;
mod rows;
mod source;

use self::header::{Element, Encoding, Header, Kind, Scalar};
use self::rows::{Body, NORMAL, SLOTS, UV, Vertices};
use self::source::{Binary, Source};
use super::finish::finish;
use super::text::Cursor;
use super::{LoadedMesh, MeshError, Place};
use lichtweg::scene::description::Mesh;

/// Parses the contents of a PLY file. See the module [`mesh`](crate::mesh) for `flip_v`.
///
/// # Errors
/// The header is wrong, the body is shorter than the header says, there are no faces, indices are out of range, or
/// positions are not finite.
pub fn parse_ply(bytes: &[u8], flip_v: bool) -> Result<LoadedMesh, MeshError> {
    let header = Header::parse(bytes)?;
    let reader = Reader::new(&header)?;
    match header.encoding {
        Encoding::Ascii => reader.read(Cursor::new(&bytes[header.length..], header.lines + 1), flip_v),
        Encoding::LittleEndian => reader.read(Binary::<false>::new(bytes, header.length), flip_v),
        Encoding::BigEndian => reader.read(Binary::<true>::new(bytes, header.length), flip_v),
    }
}

/// Reads the body that a header announces.
struct Reader<'a> {
    header: &'a Header,
    vertex: usize,
    face: usize,
    /// For each property of a vertex the slot it fills.
    slots: Vec<Option<usize>>,
    /// Which property of a face is the list of indices.
    indices: usize,
}

impl<'a> Reader<'a> {
    fn new(header: &'a Header) -> Result<Self, MeshError> {
        let vertex = find_element(header, "vertex")?;
        let face = find_element(header, "face")?;
        let slots = assign_slots(&header.elements[vertex])?;
        let indices = find_indices(&header.elements[face])?;
        Ok(Self { header, vertex, face, slots, indices })
    }

    fn read(&self, mut body: impl Body, flip_v: bool) -> Result<LoadedMesh, MeshError> {
        let mut vertices = self.empty_vertices();
        let mut triangles = Vec::new();
        let mut warnings = self.header_warnings();
        for (index, element) in self.header.elements.iter().enumerate() {
            self.check_size(element, &body)?;
            if index == self.vertex {
                self.read_vertices(&mut body, element, &mut vertices)?;
            } else if index == self.face {
                let dropped = self.read_faces(&mut body, element, &mut triangles)?;
                if dropped > 0 {
                    warnings.push(format!("{dropped} faces of fewer than three vertices are left out"));
                }
            } else {
                skip(&mut body, element)?;
            }
        }
        // Text files may end in blank lines.
        if body.remaining() > 16 {
            warnings.push(format!("{} bytes follow the last element; they are ignored", body.remaining()));
        }
        let mesh = Mesh {
            positions: vertices.positions,
            normals: vertices.normals.unwrap_or_default(),
            uvs: vertices.uvs.unwrap_or_default(),
            triangles,
        };
        finish(mesh, flip_v, warnings)
    }

    fn empty_vertices(&self) -> Vertices {
        let has = |slot: usize| self.slots.contains(&Some(slot));
        Vertices {
            positions: Vec::new(),
            normals: (has(NORMAL) && has(NORMAL + 1) && has(NORMAL + 2)).then(Vec::new),
            uvs: (has(UV) && has(UV + 1)).then(Vec::new),
        }
    }

    /// Refuses a count that the rest of the file cannot hold, before anything is allocated for it.
    fn check_size(&self, element: &Element, body: &impl Source) -> Result<(), MeshError> {
        let least = u128::from(element.least_bytes(self.header.encoding)) * u128::from(element.count);
        // The last number of a text file needs no separator behind it.
        let left = body.remaining() as u128 + u128::from(self.header.encoding == Encoding::Ascii);
        if least <= left {
            return Ok(());
        }
        Err(MeshError::new(
            body.place(),
            format!("{} rows of `{}`, at least {least} bytes", element.count, element.name),
            format!("{} bytes up to the end of the file", body.remaining()),
            "the file is truncated or its header wrong; export or copy it again",
        ))
    }

    fn read_vertices(
        &self,
        body: &mut impl Body,
        element: &Element,
        vertices: &mut Vertices,
    ) -> Result<(), MeshError> {
        if element.count > u64::from(u32::MAX) {
            return Err(MeshError::new(
                Place::Line(element.line),
                "at most 4294967295 vertices",
                element.count.to_string(),
                "split the mesh",
            ));
        }
        vertices.positions.reserve_exact(element.count as usize);
        if body.vertices_at_once(element, &self.slots, vertices)? {
            return Ok(());
        }
        for _ in 0..element.count {
            let mut numbers = [0.0; SLOTS];
            for (property, slot) in element.properties.iter().zip(&self.slots) {
                match (property.kind, *slot) {
                    (Kind::Single(scalar), Some(slot)) => numbers[slot] = body.value(scalar)? as f32,
                    (kind, _) => skip_property(body, kind)?,
                }
            }
            vertices.push(|slot| numbers[slot]);
        }
        Ok(())
    }

    /// Returns how many faces had fewer than three vertices.
    fn read_faces(
        &self,
        body: &mut impl Body,
        element: &Element,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Result<u64, MeshError> {
        triangles.reserve_exact(element.count as usize);
        let mut dropped = 0;
        let mut row = 0;
        while row < element.count {
            row += body.triangle_run(element, element.count - row, triangles);
            if row == element.count {
                break;
            }
            for (column, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::List { count, item } if column == self.indices => {
                        dropped += u64::from(polygon(body, count, item, triangles)? < 3);
                    }
                    kind => skip_property(body, kind)?,
                }
            }
            row += 1;
        }
        Ok(dropped)
    }

    fn header_warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let face = &self.header.elements[self.face];
        if face.properties.iter().any(|p| p.name == "texcoord") {
            warnings
                .push("texture coordinates per face are left out; only those per vertex are read".to_owned());
        }
        if self.header.elements.iter().any(|e| e.name == "tristrips" && e.count > 0) {
            warnings.push("triangle strips are left out; only faces are read".to_owned());
        }
        warnings
    }
}

fn find_element(header: &Header, name: &str) -> Result<usize, MeshError> {
    let mut found = header.elements.iter().enumerate().filter(|(_, element)| element.name == name);
    let error = |place, found: String| {
        let names: Vec<&str> = header.elements.iter().map(|e| e.name.as_str()).collect();
        let help = format!("the elements are: {}; export the mesh as polygons", names.join(", "));
        MeshError::new(place, format!("one element `{name}`"), found, help)
    };
    match (found.next(), found.next()) {
        (Some((index, _)), None) => Ok(index),
        (None, _) => Err(error(Place::File, "none".to_owned())),
        (_, Some((_, second))) => Err(error(Place::Line(second.line), "a second one".to_owned())),
    }
}

fn assign_slots(element: &Element) -> Result<Vec<Option<usize>>, MeshError> {
    let has =
        |name: &str| element.properties.iter().any(|p| p.name == name && matches!(p.kind, Kind::Single(_)));
    let uv_names = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];
    let [u, v] = uv_names.into_iter().find(|[u, v]| has(u) && has(v)).unwrap_or(uv_names[0]);
    let names = ["x", "y", "z", "nx", "ny", "nz", u, v];
    for name in &names[..NORMAL] {
        if !has(name) {
            return Err(MeshError::new(
                Place::Line(element.line),
                format!("vertices with a property `{name}`"),
                "none",
                "export the mesh with vertex positions",
            ));
        }
    }
    let slot = |name: &str| names.iter().position(|&known| known == name);
    Ok(element.properties.iter().map(|property| slot(&property.name)).collect())
}

fn find_indices(element: &Element) -> Result<usize, MeshError> {
    let is_indices = |p: &header::Property| {
        matches!(p.name.as_str(), "vertex_indices" | "vertex_index") && matches!(p.kind, Kind::List { .. })
    };
    element.properties.iter().position(is_indices).ok_or_else(|| {
        MeshError::new(
            Place::Line(element.line),
            "faces with a list `vertex_indices`",
            "none",
            "export the mesh with faces",
        )
    })
}

/// Reads one list of indices as a fan; returns its length.
fn polygon(
    body: &mut impl Source,
    count: Scalar,
    item: Scalar,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<u64, MeshError> {
    let count = list_length(body, count)?;
    let (mut first, mut previous) = (0, 0);
    for corner in 0..count {
        let place = body.place();
        let value = body.value(item)?;
        let index = value as u32;
        if f64::from(index) != value {
            return Err(MeshError::new(
                place,
                "the index of a vertex",
                value.to_string(),
                "the file is damaged; export it again",
            ));
        }
        match corner {
            0 => first = index,
            1 => {}
            _ => triangles.push([first, previous, index]),
        }
        previous = index;
    }
    Ok(count)
}

fn list_length(body: &mut impl Source, scalar: Scalar) -> Result<u64, MeshError> {
    let place = body.place();
    let value = body.value(scalar)?;
    let length = value as u64;
    if length as f64 == value && length <= body.remaining() as u64 {
        return Ok(length);
    }
    Err(MeshError::new(
        place,
        format!("the length of a list, at most {}, the bytes left", body.remaining()),
        value.to_string(),
        "the file is damaged or truncated; export or copy it again",
    ))
}

fn skip(body: &mut impl Body, element: &Element) -> Result<(), MeshError> {
    if element.properties.is_empty() || body.skip_at_once(element)? {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            skip_property(body, property.kind)?;
        }
    }
    Ok(())
}

fn skip_property(body: &mut impl Source, kind: Kind) -> Result<(), MeshError> {
    match kind {
        Kind::Single(scalar) => {
            body.value(scalar)?;
        }
        Kind::List { count, item } => {
            for _ in 0..list_length(body, count)? {
                body.value(item)?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
