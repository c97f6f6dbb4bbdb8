//! Meshes and images of a scene, loaded in parallel, each file once.

use std::collections::{HashMap, HashSet};
use std::hash::Hash;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use lichtweg::scene::description::{Diagnostic, Image, Mesh};
use rayon::prelude::*;

use super::params::Param;
use super::report::Report;
use super::source_file::{has_extension, read_bytes};
use super::winding;
use crate::image::read_image;
use crate::mesh;
use crate::options::LoadReport;

/// Packed files may not unpack to more.
const MOST_UNPACKED: u64 = 16 << 30;

/// A file's contents with what is doubtful about them, or what is wrong with it.
type Loaded<T> = Result<(Arc<T>, Vec<String>), Diagnostic>;

/// The files of a scene by path.
#[derive(Default)]
pub(super) struct Files {
    meshes: Table<Mesh>,
    images: Table<Image>,
}

struct Table<T> {
    loaded: HashMap<PathBuf, Loaded<T>>,
    /// Files whose warnings or errors have been told.
    told: HashSet<PathBuf>,
}

impl<T> Default for Table<T> {
    fn default() -> Self {
        Self { loaded: HashMap::new(), told: HashSet::new() }
    }
}

impl Files {
    /// Loads all files of two lists, which may repeat themselves, and adds up the time that takes.
    pub fn load(meshes: Vec<PathBuf>, images: Vec<PathBuf>, report: &mut LoadReport) -> Self {
        let ((meshes, mesh_seconds), (images, image_seconds)) =
            rayon::join(|| load_all(meshes, load_mesh), || load_all(images, load_image));
        report.mesh_seconds += mesh_seconds;
        report.image_seconds += image_seconds;
        Self {
            meshes: Table { loaded: meshes, told: HashSet::new() },
            images: Table { loaded: images, told: HashSet::new() },
        }
    }

    /// A mesh, its triangles turned to agree with its normals. `substitute` says what happens without it.
    pub fn mesh(
        &mut self,
        path: &Path,
        stated: &Param,
        substitute: &str,
        report: &mut Report,
    ) -> Option<Arc<Mesh>> {
        self.meshes.get(path, stated, substitute, report)
    }

    /// An image. `substitute` says what happens without it.
    pub fn image(
        &mut self,
        path: &Path,
        stated: &Param,
        substitute: &str,
        report: &mut Report,
    ) -> Option<Arc<Image>> {
        self.images.get(path, stated, substitute, report)
    }
}

impl<T> Table<T> {
    fn get(&mut self, path: &Path, stated: &Param, substitute: &str, report: &mut Report) -> Option<Arc<T>> {
        let is_new = self.told.insert(path.to_owned());
        match self.loaded.get(path)? {
            Ok((contents, warnings)) => {
                for warning in warnings.iter().filter(|_| is_new) {
                    let diagnostic = Diagnostic::warning("doubtful-file", warning.clone());
                    report.push(diagnostic.at(stated.values_span, "in this file"));
                }
                Some(contents.clone())
            }
            Err(error) => {
                if is_new {
                    report.substitute(error.clone().at(stated.values_span, "this file"), substitute);
                }
                None
            }
        }
    }
}

fn load_all<T: Send + Sync>(
    mut paths: Vec<PathBuf>,
    load: impl Fn(&Path) -> Loaded<T> + Sync,
) -> (HashMap<PathBuf, Loaded<T>>, f64) {
    unique(&mut paths);
    let timed = |path: PathBuf| {
        let start = Instant::now();
        let loaded = load(&path);
        ((path, loaded), start.elapsed().as_secs_f64())
    };
    // Files differ in size by orders of magnitude: let idle threads take them one by one.
    let (files, seconds): (Vec<_>, Vec<f64>) = paths.into_par_iter().with_max_len(1).map(timed).unzip();
    (files.into_iter().collect(), seconds.iter().sum())
}

fn unique<T: Hash + Eq + Clone>(list: &mut Vec<T>) {
    let mut seen = HashSet::new();
    list.retain(|item| seen.insert(item.clone()));
}

fn load_mesh(path: &Path) -> Loaded<Mesh> {
    let loaded = if has_extension(path, "gz") {
        let bytes = read_bytes(path, MOST_UNPACKED).map_err(|why| unreadable("bad-mesh", path, &why))?;
        mesh::parse_ply(&bytes, false)
    } else {
        mesh::read_ply(path, false)
    };
    let mut loaded = loaded.map_err(|error| error.diagnostic())?;
    winding::agree_with_normals(&mut loaded.mesh);
    Ok((Arc::new(loaded.mesh), loaded.warnings))
}

fn load_image(path: &Path) -> Loaded<Image> {
    let loaded = read_image(path).map_err(|error| error.diagnostic())?;
    Ok((Arc::new(loaded.image), loaded.warnings))
}

fn unreadable(code: &'static str, path: &Path, why: &str) -> Diagnostic {
    Diagnostic::error(code, format!("{}: {why}", path.display()))
}
