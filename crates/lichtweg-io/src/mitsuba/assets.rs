//! The files behind a scene: noted while objects are translated, then read in parallel, each once.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use lichtweg::scene::description::{
    CurvesDescription, Description, Diagnostic, Diagnostics, GeometryDescription, Image, LightKind, Mesh,
    Span, SpectrumDescription, TextureId, TextureKind,
};
use lichtweg_ray::CurveBasis;
use rayon::prelude::*;

use crate::image::read_image;
use crate::mesh::{self, LoadedMesh};
use crate::options::LoadReport;

/// Files to read and where their contents go.
#[derive(Debug, Default)]
pub(super) struct Assets {
    files: Vec<(Asset, Vec<Target>)>,
    index: HashMap<Asset, usize>,
}

/// A file and how to read it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Asset {
    Mesh {
        path: PathBuf,
        format: MeshFormat,
        /// Turn v into 1 - v.
        flip_v: bool,
        /// Leave out normals.
        face_normals: bool,
    },
    Curves {
        path: PathBuf,
        /// Lines rather than B-splines.
        linear: bool,
    },
    Image {
        path: PathBuf,
    },
}

/// A kind of mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum MeshFormat {
    Obj,
    Ply,
    Serialized { shape_index: usize },
}

/// What is waiting for a file, and where it is asked for.
#[derive(Debug)]
pub(super) struct Target {
    pub place: Place,
    pub span: Span,
}

/// A place in a description.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// The geometry of the shape of this index.
    Shape(usize),
    /// The image of a bitmap.
    Texture(TextureId),
    /// The image of the environment light of this index.
    Light(usize),
}

/// A file's contents.
enum Contents {
    Mesh {
        mesh: Arc<Mesh>,
        /// Its normals come from its faces, and so turn with their winding.
        normals_from_faces: bool,
    },
    Curves(Arc<CurvesDescription>),
    Image(Arc<Image>),
}

struct Loaded {
    contents: Result<Contents, Diagnostic>,
    warnings: Vec<String>,
    seconds: f64,
}

impl Assets {
    /// Notes that `target` needs a file.
    pub fn request(&mut self, asset: Asset, target: Target) {
        let next = self.files.len();
        let index = *self.index.entry(asset.clone()).or_insert(next);
        if index == next {
            self.files.push((asset, Vec::new()));
        }
        self.files[index].1.push(target);
    }

    /// Reads all files and puts them where they are needed; what cannot be read is reported and taken out.
    pub fn load(self, description: &mut Description, diagnostics: &mut Diagnostics, report: &mut LoadReport) {
        let loaded: Vec<Loaded> = self.files.par_iter().map(|(asset, _)| asset.load()).collect();
        let mut gone = Gone::default();
        for ((asset, targets), loaded) in self.files.iter().zip(loaded) {
            match asset {
                Asset::Mesh { .. } | Asset::Curves { .. } => report.mesh_seconds += loaded.seconds,
                Asset::Image { .. } => report.image_seconds += loaded.seconds,
            }
            for warning in loaded.warnings {
                let code =
                    if matches!(asset, Asset::Mesh { .. }) { "doubtful-mesh" } else { "doubtful-image" };
                let message = format!("{}: {warning}", asset.path().display());
                let diagnostic = Diagnostic::warning(code, message);
                diagnostics.push(targets.iter().take(1).fold(diagnostic, |d, t| d.at(t.span, "")));
            }
            match loaded.contents {
                Ok(contents) => targets.iter().for_each(|t| contents.place(t.place, description)),
                Err(error) => gone.take_out(&error, targets, description, diagnostics),
            }
        }
        gone.remove(description);
    }
}

impl Asset {
    fn path(&self) -> &Path {
        match self {
            Self::Mesh { path, .. } | Self::Curves { path, .. } | Self::Image { path } => path,
        }
    }

    fn load(&self) -> Loaded {
        let start = Instant::now();
        let (contents, warnings) = match self {
            Self::Mesh { path, format, flip_v, face_normals } => {
                let loaded = match format {
                    MeshFormat::Obj => mesh::read_obj(path, *flip_v),
                    MeshFormat::Ply => mesh::read_ply(path, *flip_v),
                    MeshFormat::Serialized { shape_index } => {
                        mesh::read_serialized(path, *shape_index, *flip_v)
                    }
                };
                match loaded {
                    Ok(mut loaded) => {
                        let warnings = std::mem::take(&mut loaded.warnings);
                        (Ok(with_normals(loaded, *face_normals)), warnings)
                    }
                    Err(error) => (Err(error.diagnostic()), Vec::new()),
                }
            }
            Self::Curves { path, linear } => {
                let basis = if *linear { CurveBasis::Linear } else { CurveBasis::BSpline };
                let curves = mesh::read_curves(path, basis);
                (curves.map(|c| Contents::Curves(Arc::new(c))).map_err(|e| e.diagnostic()), Vec::new())
            }
            Self::Image { path } => match read_image(path) {
                Ok(loaded) => (Ok(Contents::Image(Arc::new(loaded.image))), loaded.warnings),
                Err(error) => (Err(error.diagnostic()), Vec::new()),
            },
        };
        Loaded { contents, warnings, seconds: start.elapsed().as_secs_f64() }
    }
}

/// As Mitsuba: the file's normals, or smooth ones where it has none, or none where a faceted look is asked for.
fn with_normals(loaded: LoadedMesh, face_normals: bool) -> Contents {
    let LoadedMesh { mut mesh, face_normals: faceted, .. } = loaded;
    let normals_from_faces = face_normals || faceted || mesh.normals.is_empty();
    if face_normals || faceted {
        mesh.normals = Vec::new();
    } else if mesh.normals.is_empty() {
        mesh::smooth_normals(&mut mesh);
    }
    Contents::Mesh { mesh: Arc::new(mesh), normals_from_faces }
}

impl Contents {
    fn place(&self, place: Place, description: &mut Description) {
        match (self, place) {
            (Self::Mesh { mesh, normals_from_faces }, Place::Shape(index)) => {
                let shape = &mut description.shapes[index];
                shape.geometry = GeometryDescription::Mesh(Arc::clone(mesh));
                // Mitsuba 3 winds faces after placing them in the world, so a mirror turns those meshes inside out whose
                // normals come from their faces.
                shape.flip_normals ^= *normals_from_faces && shape.to_world.determinant() < 0.0;
            }
            (Self::Curves(curves), Place::Shape(index)) => {
                description.shapes[index].geometry = GeometryDescription::Curves(Arc::clone(curves));
            }
            (Self::Image(image), Place::Texture(id)) => {
                if let TextureKind::Bitmap { image: empty, .. } =
                    &mut description.textures[id.0 as usize].kind
                {
                    *empty = Arc::clone(image);
                }
            }
            (Self::Image(image), Place::Light(index)) => {
                if let LightKind::Environment { image: empty, .. } = &mut description.lights[index].kind {
                    *empty = Arc::clone(image);
                }
            }
            _ => {}
        }
    }
}

/// Shapes and lights whose files cannot be read.
#[derive(Default)]
struct Gone {
    shapes: HashSet<usize>,
    lights: HashSet<usize>,
}

impl Gone {
    fn take_out(
        &mut self,
        error: &Diagnostic,
        targets: &[Target],
        description: &mut Description,
        diagnostics: &mut Diagnostics,
    ) {
        for (i, target) in targets.iter().enumerate() {
            let substitute = match target.place {
                Place::Shape(index) => {
                    self.shapes.insert(index);
                    "the shape is left out"
                }
                Place::Light(index) => {
                    self.lights.insert(index);
                    "the emitter is left out"
                }
                Place::Texture(id) => {
                    let grey = SpectrumDescription::Constant(0.5);
                    description.textures[id.0 as usize].kind = TextureKind::Constant(grey);
                    "mid-grey is used instead"
                }
            };
            // One broken file is one finding, however often it is used.
            if i == 0 {
                diagnostics.unsupported(error.clone().at(target.span, ""), substitute);
            }
        }
    }

    fn remove(&self, description: &mut Description) {
        let mut index = 0..;
        description.shapes.retain(|_| !index.next().is_some_and(|i| self.shapes.contains(&i)));
        let mut index = 0..;
        description.lights.retain(|_| !index.next().is_some_and(|i| self.lights.contains(&i)));
    }
}
