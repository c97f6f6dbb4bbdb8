//! Counting what is in a description.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use lichtweg::scene::Scene;
use lichtweg::scene::description::{
    Description, FieldOfView, FovAxis, GeometryDescription, Image, LightKind, MaterialKind, Mesh, Pixels,
    TextureKind,
};
use lichtweg_ray::Placement;
use serde_json::{Value, json};

use crate::options::{describe_filter, describe_integrator, describe_sampler};
use crate::text;

/// How many there are of each kind.
type Counts = BTreeMap<&'static str, u64>;

/// What is in a scene.
#[derive(Debug)]
pub struct Inventory<'a> {
    description: &'a Description,
    scene: Option<&'a Scene>,
    shapes: Counts,
    triangles: u64,
    mesh_bytes: u64,
    lights: Counts,
    materials: Counts,
    textures: Counts,
    images: Vec<Arc<Image>>,
}

impl<'a> Inventory<'a> {
    /// Counts; `scene` where it compiles.
    pub fn new(description: &'a Description, scene: Option<&'a Scene>) -> Self {
        let mut this = Self {
            description,
            scene,
            shapes: tally(description.shapes.iter().map(|s| shape_kind(&s.geometry))),
            triangles: 0,
            mesh_bytes: 0,
            lights: tally(description.lights.iter().map(|l| light_kind(&l.kind))),
            materials: tally(description.materials.iter().map(|m| material_kind(&m.kind))),
            textures: tally(description.textures.iter().map(|t| texture_kind(&t.kind))),
            images: Vec::new(),
        };
        let area_lights = description.shapes.iter().filter(|s| s.emission.is_some()).count() as u64;
        if area_lights > 0 {
            this.lights.insert("area", area_lights);
        }
        this.count_meshes();
        this.collect_images();
        this
    }

    /// Triangles count once for every shape they are in, memory once for every mesh.
    fn count_meshes(&mut self) {
        let mut seen = HashSet::new();
        for shape in &self.description.shapes {
            if let GeometryDescription::Mesh(mesh) = &shape.geometry {
                self.triangles += mesh.triangles.len() as u64;
                if seen.insert(Arc::as_ptr(mesh)) {
                    self.mesh_bytes += mesh_bytes(mesh);
                }
            }
        }
    }

    fn collect_images(&mut self) {
        let of_textures = self.description.textures.iter().filter_map(|t| match &t.kind {
            TextureKind::Bitmap { image, .. } => Some(image),
            _ => None,
        });
        let of_lights = self.description.lights.iter().filter_map(|l| match &l.kind {
            LightKind::Environment { image, .. } => Some(image),
            _ => None,
        });
        let mut seen = HashSet::new();
        self.images = of_textures.chain(of_lights).filter(|i| seen.insert(Arc::as_ptr(i))).cloned().collect();
    }

    fn image_bytes(&self) -> u64 {
        self.images.iter().map(|i| image_bytes(i)).sum()
    }

    /// Keys and values for people.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let d = self.description;
        let film = &d.film;
        let depth = d.integrator.max_depth.map_or("no limit on depth".into(), |n| format!("max_depth {n}"));
        let crop = film.crop.map_or(String::new(), |[x, y, w, h]| format!(", crop {x},{y},{w},{h}"));
        let sampler = &d.sampler;
        let spp = text::plural(sampler.samples_per_pixel.into(), "sample");
        let mut lines = vec![
            ("camera", self.camera()),
            (
                "film",
                format!("{}x{}{crop}, filter {}", film.width, film.height, describe_filter(&film.filter)),
            ),
            (
                "sampler",
                format!("{}, {spp} per pixel, seed {}", describe_sampler(sampler.kind), sampler.seed),
            ),
            ("integrator", format!("{}, {depth}", describe_integrator(&d.integrator))),
            ("shapes", format!("{}; {}", counted(&self.shapes), text::plural(self.triangles, "triangle"))),
            ("instances", self.instances()),
            ("lights", counted(&self.lights)),
            ("materials", counted(&self.materials)),
            ("textures", counted(&self.textures)),
        ];
        lines.extend(self.images.iter().map(|image| ("image", describe_image(image))));
        if let Some(scene) = self.scene {
            let bounds = scene.bounds();
            let corner = |p: [f32; 3]| format!("({}, {}, {})", p[0], p[1], p[2]);
            let bounds = if d.shapes.is_empty() {
                "none".to_owned()
            } else {
                format!("{} to {}", corner(bounds.min.to_array()), corner(bounds.max.to_array()))
            };
            lines.push(("bounds", bounds));
        }
        let hierarchy = self.scene.map(|s| text::bytes(s.build_report().bytes as u64));
        lines.push((
            "memory",
            format!(
                "meshes {}, images {}, ray hierarchy {}",
                text::bytes(self.mesh_bytes),
                text::bytes(self.image_bytes()),
                hierarchy.unwrap_or("not built".into())
            ),
        ));
        lines
    }

    /// `1,000 of 2 groups, 3 moving`.
    fn instances(&self) -> String {
        let instances = &self.description.instances;
        if instances.is_empty() {
            return "none".into();
        }
        let groups: HashSet<_> = instances.iter().map(|i| i.group).collect();
        let moving = instances.iter().filter(|i| matches!(i.to_world, Placement::Moving(_))).count() as u64;
        let moving = if moving > 0 { format!(", {} moving", text::count(moving)) } else { String::new() };
        let groups = text::plural(groups.len() as u64, "group");
        format!("{} of {groups}{moving}", text::count(instances.len() as u64))
    }

    fn camera(&self) -> String {
        let camera = &self.description.camera;
        let view = match camera.field_of_view {
            FieldOfView::Angle { degrees, axis } => format!("{degrees} degrees {}", axis_name(axis)),
            FieldOfView::Window([x0, x1, y0, y1]) => format!("window {x0}..{x1} by {y0}..{y1}"),
        };
        if camera.aperture_radius > 0.0 {
            let (radius, focus) = (camera.aperture_radius, camera.focus_distance);
            format!("thin lens of radius {radius}, in focus at {focus}, {view}")
        } else {
            format!("pinhole, {view}")
        }
    }

    /// For programs. Bounds are `null` where the scene does not compile or has no shape.
    pub fn json(&self) -> Value {
        let d = self.description;
        let bounds = self.scene.filter(|_| !d.shapes.is_empty()).map(Scene::bounds);
        let image = |i: &Arc<Image>| {
            json!({
                "width": i.width, "height": i.height, "channels": i.channels, "type": pixel_type(&i.pixels),
                "bytes": image_bytes(i),
            })
        };
        json!({
            "scene": null,
            "camera": self.camera(),
            "film": {
                "size": [d.film.width, d.film.height],
                "crop": d.film.crop,
                "filter": describe_filter(&d.film.filter),
            },
            "sampler": {
                "kind": describe_sampler(d.sampler.kind),
                "samples_per_pixel": d.sampler.samples_per_pixel,
                "seed": d.sampler.seed,
            },
            "integrator": describe_integrator(&d.integrator),
            "max_depth": d.integrator.max_depth.map_or(-1, i64::from),
            "shapes": self.shapes,
            "triangles": self.triangles,
            "instances": d.instances.len(),
            "lights": self.lights,
            "materials": self.materials,
            "textures": self.textures,
            "images": self.images.iter().map(image).collect::<Vec<_>>(),
            "bounds": bounds.map(|b| [b.min.to_array(), b.max.to_array()]),
            "memory": {
                "mesh_bytes": self.mesh_bytes,
                "image_bytes": self.image_bytes(),
                "ray_hierarchy_bytes": self.scene.map(|s| s.build_report().bytes),
            },
        })
    }
}

fn tally(kinds: impl Iterator<Item = &'static str>) -> Counts {
    let mut counts = Counts::new();
    kinds.for_each(|kind| *counts.entry(kind).or_default() += 1);
    counts
}

/// `3: 2 mesh, 1 sphere`.
fn counted(counts: &Counts) -> String {
    if counts.is_empty() {
        return "none".into();
    }
    let kinds: Vec<String> = counts.iter().map(|(kind, n)| format!("{} {kind}", text::count(*n))).collect();
    format!("{}: {}", text::count(counts.values().sum()), kinds.join(", "))
}

fn axis_name(axis: FovAxis) -> &'static str {
    match axis {
        FovAxis::X => "across the width",
        FovAxis::Y => "across the height",
        FovAxis::Diagonal => "across the diagonal",
        FovAxis::Smaller => "across the shorter side",
        FovAxis::Larger => "across the longer side",
    }
}

fn shape_kind(geometry: &GeometryDescription) -> &'static str {
    match geometry {
        GeometryDescription::Mesh(_) => "mesh",
        GeometryDescription::Sphere { .. } => "sphere",
        GeometryDescription::Disk { .. } => "disk",
        GeometryDescription::Cylinder { .. } => "cylinder",
    }
}

fn light_kind(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Point { .. } => "point",
        LightKind::Spot { .. } => "spot",
        LightKind::Directional { .. } => "directional",
        LightKind::Constant { .. } => "constant",
        LightKind::Environment { .. } => "environment",
    }
}

fn material_kind(kind: &MaterialKind) -> &'static str {
    match kind {
        MaterialKind::Diffuse { .. } => "diffuse",
        MaterialKind::Dielectric { roughness: None, .. } => "dielectric",
        MaterialKind::Dielectric { .. } => "rough dielectric",
        MaterialKind::ThinDielectric { .. } => "thin dielectric",
        MaterialKind::Conductor { roughness: None, .. } => "conductor",
        MaterialKind::Conductor { .. } => "rough conductor",
        MaterialKind::Plastic { roughness: None, .. } => "plastic",
        MaterialKind::Plastic { .. } => "rough plastic",
        MaterialKind::TwoSided { .. } => "two-sided",
        MaterialKind::Mask { .. } => "mask",
        MaterialKind::Bump { .. } => "bump",
        MaterialKind::NormalMap { .. } => "normal map",
    }
}

fn texture_kind(kind: &TextureKind) -> &'static str {
    match kind {
        TextureKind::Constant(_) => "constant",
        TextureKind::Bitmap { .. } => "bitmap",
        TextureKind::Checkerboard { .. } => "checkerboard",
        TextureKind::Scale { .. } => "scale",
        TextureKind::Mix { .. } => "mix",
    }
}

fn pixel_type(pixels: &Pixels) -> &'static str {
    match pixels {
        Pixels::U8(_) => "8-bit",
        Pixels::U16(_) => "16-bit",
        Pixels::F32(_) => "float",
    }
}

fn describe_image(image: &Image) -> String {
    let bytes = text::bytes(image_bytes(image));
    format!("{}x{}x{} {}, {bytes}", image.width, image.height, image.channels, pixel_type(&image.pixels))
}

fn image_bytes(image: &Image) -> u64 {
    match &image.pixels {
        Pixels::U8(p) => size_of_val(p.as_slice()) as u64,
        Pixels::U16(p) => size_of_val(p.as_slice()) as u64,
        Pixels::F32(p) => size_of_val(p.as_slice()) as u64,
    }
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let arrays = [
        size_of_val(mesh.positions.as_slice()),
        size_of_val(mesh.normals.as_slice()),
        size_of_val(mesh.uvs.as_slice()),
        size_of_val(mesh.triangles.as_slice()),
    ];
    arrays.iter().sum::<usize>() as u64
}
