//! Meshes: files, rectangles and cubes (Mitsuba 3 `src/shapes/obj.cpp`, `ply.cpp`, `serialized.cpp`, `rectangle.cpp`,
//! `cube.cpp`).
//!
//! Limit: where a file has no normals, Mitsuba makes smooth ones in the world, here they are made in the mesh's own space;
//! under a transform that distorts angles the two differ slightly.

use std::sync::Arc;

use lichtweg::scene::description::{GeometryDescription, Mesh};
use lichtweg_ray::math::Affine;

use super::assets::{Asset, MeshFormat};
use super::include::{find, not_found};
use super::shape::Form;
use super::translate::Translator;
use super::tree::Object;
use crate::mesh;

/// More meshes than any `.serialized` file has.
const MOST_SHAPES: i64 = 1 << 32;

impl<'a> Translator<'a> {
    pub fn rectangle(&mut self, object: &'a Object) -> Form {
        object.ignore(&["face_normals"]);
        of_mesh(mesh::rectangle())
    }

    pub fn cube(&mut self, object: &'a Object) -> Form {
        object.ignore(&["face_normals"]);
        of_mesh(mesh::cube())
    }

    /// A mesh from a file, which must exist.
    pub fn mesh_file(&mut self, object: &'a Object) -> Option<Form> {
        let format = match object.plugin.as_str() {
            "obj" => MeshFormat::Obj,
            "ply" => MeshFormat::Ply,
            _ => {
                let index = self.integer_in(object, "shape_index", 0, 0, MOST_SHAPES);
                MeshFormat::Serialized { shape_index: index as usize }
            }
        };
        let face_normals = self.boolean(object, "face_normals", false);
        let flip_v = self.boolean(object, "flip_tex_coords", format == MeshFormat::Obj);
        // Of Mitsuba 0.x: how several objects in one file are joined, and how vertex colours are encoded.
        object.ignore(&["collapse", "srgb"]);
        let (name, span) = self.required_text(object, "filename")?;
        let Some(path) = find(&object.search, name) else {
            let diagnostic = not_found(name, span, &object.search);
            self.diagnostics.unsupported(diagnostic, "the shape is left out");
            return None;
        };
        let asset = Asset::Mesh { path, format, flip_v, face_normals };
        Some(Form { file: Some((asset, span)), ..of_mesh(Mesh::default()) })
    }
}

fn of_mesh(mesh: Mesh) -> Form {
    Form {
        geometry: GeometryDescription::Mesh(Arc::new(mesh)),
        to_object: Affine::IDENTITY,
        flipped_by_mirror: false,
        file: None,
    }
}
