//! From statements to the neutral description.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use lichtweg::scene::description::{Description, Diagnostic, MaterialId, TextureId};

use super::files::Files;
use super::material::MaskKey;
use super::report::Report;
use super::state::{MaterialStatement, Statements};
use super::{camera, film, light, material, sampling, shape, texture};
use crate::options::LoadReport;

/// The description under construction, and what its parts are called in the file.
pub(super) struct Builder<'d> {
    pub report: Report<'d>,
    pub scene: Description,
    pub files: Files,
    pub directory: PathBuf,
    /// Textures built so far.
    pub float_textures: HashMap<String, TextureId>,
    pub spectrum_textures: HashMap<String, TextureId>,
    pub materials: Vec<MaterialStatement>,
    pub named_materials: HashMap<String, usize>,
    /// What each of `materials` became; `None` has no surface.
    pub built_materials: Vec<Option<MaterialId>>,
    pub default_material: Option<MaterialId>,
    /// Names of materials that were reported as unknown.
    pub missing_materials: HashSet<Rc<str>>,
    pub masks: HashMap<MaskKey, MaterialId>,
}

impl Builder<'_> {
    /// The path of a file named in the scene.
    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }
}

/// Builds the description.
pub(super) fn build(
    mut statements: Statements,
    name: String,
    directory: PathBuf,
    files: Files,
    report: Report,
) -> Description {
    let mut builder = Builder {
        report,
        scene: Description { name, ..Description::default() },
        files,
        directory,
        float_textures: HashMap::new(),
        spectrum_textures: HashMap::new(),
        materials: std::mem::take(&mut statements.materials),
        named_materials: std::mem::take(&mut statements.named_materials),
        built_materials: Vec::new(),
        default_material: None,
        missing_materials: HashSet::new(),
        masks: HashMap::new(),
    };
    builder.scene.camera.shutter = camera::shutter(&statements, &mut builder.report);
    film::build(&mut builder, &statements);
    camera::build(&mut builder, &statements);
    sampling::build(&mut builder, &statements);
    texture::build_all(&mut builder, std::mem::take(&mut statements.textures));
    material::build_all(&mut builder);
    light::build_all(&mut builder, &statements.lights);
    let attributes = std::mem::take(&mut statements.attributes);
    shape::build_all(&mut builder, statements);
    for (target, param) in attributes.iter().filter(|(_, param)| !param.is_used()) {
        let text = format!("no {target} after this takes the default \"{}\"", param.name);
        builder.report.push(Diagnostic::warning("unused-attribute", text).at(param.span, "never used"));
    }
    builder.report.finish();
    builder.scene
}

/// Loads every file that the statements name, before any is interpreted.
pub(super) fn load_files(statements: &Statements, directory: &Path, report: &mut LoadReport) -> Files {
    let path = |name: &str| directory.join(name);
    let meshes = statements
        .all_shapes()
        .filter(|s| s.entity.kind == "plymesh")
        .filter_map(|s| s.entity.params.peek_string("filename"));
    let textures = statements.textures.iter().filter(|t| t.entity.kind == "imagemap");
    let textures = textures.filter_map(|t| t.entity.params.peek_string("filename"));
    let normal_maps = statements.materials.iter().filter_map(|m| m.entity.params.peek_string("normalmap"));
    let lights = statements.lights.iter().filter(|l| l.entity.kind == "infinite");
    let lights = lights.filter_map(|l| l.entity.params.peek_string("filename"));
    let images = textures.chain(normal_maps).chain(lights);
    Files::load(meshes.map(path).collect(), images.map(path).collect(), report)
}
