//! Shapes, and objects with their instances (`shapes.cpp`).
//!
//! Radius and height go into the transform. The description keeps the outside of a shape under mirroring transforms, as pbrt
//! does by flipping the normals of those, so that `ReverseOrientation` alone flips.
//!
//! `power` of an area light: pbrt's lights are single triangles, each of which gets the whole power. A mesh here has one
//! radiance, that with which its total is the same.
//!
//! Limits: no curves, no subdivision surfaces, no bilinear patches, no displacement of meshes; `S` is not used.

use std::collections::{HashMap, HashSet};
use std::f32::consts::PI;
use std::sync::Arc;

use lichtweg::scene::description::{
    AreaLightDescription, Diagnostic, EmissionScale, GeometryDescription, InstanceDescription, Mesh,
    ShapeDescription, Span, SpectrumDescription, TextureInput,
};
use lichtweg_ray::Placement;
use lichtweg_ray::math::{Affine, Vec2, Vec3};

use super::build::Builder;
use super::light::AreaEmission;
use super::params::{Params, Type, Values};
use super::report::suggest;
use super::state::{Entity, ShapeStatement, Statements};
use super::winding;

/// Builds all shapes.
pub(super) fn build_all(builder: &mut Builder, statements: Statements) {
    let emissions: Vec<(Option<AreaEmission>, _)> =
        statements.area_lights.iter().map(|light| (builder.area_emission(light), light.span)).collect();
    for statement in statements.shapes {
        let emission =
            statement.area_light.and_then(|i| emissions[i].0.as_ref().map(|e| (e, emissions[i].1)));
        let Some(mut shape) = builder.shape(&statement, emission) else { continue };
        if let Placement::Moving(_) = statement.to_world {
            // A group of one, with an instance that moves.
            let group = builder.scene.add_group();
            shape.group = Some(group);
            let (span, to_world) = (shape.span, statement.to_world);
            builder.scene.instances.push(InstanceDescription { span, group, to_world });
        }
        builder.scene.shapes.push(shape);
    }
    let mut uses: HashMap<String, Vec<(Span, Placement)>> = HashMap::new();
    let defined: HashSet<&str> = statements.objects.iter().map(|o| o.name.as_str()).collect();
    for instance in statements.instances {
        if defined.contains(instance.object.as_str()) {
            uses.entry(instance.object).or_default().push((instance.span, instance.to_world));
            continue;
        }
        let text = format!("there is no object \"{}\"", instance.object);
        let diagnostic = Diagnostic::error("unknown-name", text).at(instance.span, "never defined");
        let diagnostic = suggest(diagnostic, &instance.object, defined.iter().copied());
        builder.report.substitute(diagnostic, "nothing is placed");
    }
    for object in &statements.objects {
        let shapes: Vec<_> = object.shapes.iter().filter_map(|shape| builder.shape(shape, None)).collect();
        builder.place(shapes, uses.remove(&object.name).unwrap_or_default());
    }
}

impl Builder<'_> {
    /// Places the shapes of an object; what is used once, and does not move, becomes plain shapes.
    fn place(&mut self, shapes: Vec<ShapeDescription>, uses: Vec<(Span, Placement)>) {
        if uses.is_empty() || shapes.is_empty() {
            return;
        }
        if let [(_, Placement::Fixed(map))] = &uses[..] {
            let placed =
                shapes.into_iter().map(|s| ShapeDescription { to_world: map.after(&s.to_world), ..s });
            return self.scene.shapes.extend(placed);
        }
        let group = self.scene.add_group();
        self.scene.shapes.extend(shapes.into_iter().map(|s| ShapeDescription { group: Some(group), ..s }));
        let instances =
            uses.into_iter().map(|(span, to_world)| InstanceDescription { span, group, to_world });
        self.scene.instances.extend(instances);
    }

    fn shape(
        &mut self,
        statement: &ShapeStatement,
        emission: Option<(&AreaEmission, Span)>,
    ) -> Option<ShapeDescription> {
        let entity = &statement.entity;
        let geometry = self.geometry(entity);
        let opacity = self.float_input(&entity.params, "alpha");
        entity.params.report_unused(&entity.title(), &mut self.report);
        let (geometry, placement, own_area) = geometry?;
        // What moves is placed by an instance.
        let to_world = match &statement.to_world {
            Placement::Fixed(map) => map.after(&placement),
            Placement::Moving(_) => placement,
        };
        let mut material = match self.chosen_material(&statement.material) {
            Some(material) => material,
            None if emission.is_some() => {
                let text = "an emitting shape without a surface (material \"interface\") also hides what is behind it";
                self.report.push(Diagnostic::warning("opaque-interface", text).at(entity.span, "this shape"));
                self.black()
            }
            None => return None,
        };
        if let Some(opacity) = opacity {
            material = self.with_opacity(entity, material, opacity, emission.is_some());
        }
        let emission = emission.map(|(emission, span)| {
            let factor = self.emission_factor(emission, &geometry, &to_world, own_area, entity);
            AreaLightDescription {
                span,
                radiance: emission.radiance.clone(),
                two_sided: emission.two_sided,
                scale: EmissionScale::Factor(factor),
            }
        });
        Some(ShapeDescription {
            name: None,
            span: entity.span,
            geometry,
            to_world,
            flip_normals: statement.reverse_orientation,
            material,
            emission,
            group: None,
        })
    }

    fn with_opacity(
        &mut self,
        entity: &Entity,
        material: lichtweg::scene::description::MaterialId,
        opacity: TextureInput,
        emits: bool,
    ) -> lichtweg::scene::description::MaterialId {
        if let TextureInput::Constant(SpectrumDescription::Constant(alpha)) = opacity {
            if alpha >= 1.0 {
                return material;
            }
            if alpha <= 0.0 && emits {
                let text = "invisible area lights (\"alpha\" 0) are not supported";
                let diagnostic = Diagnostic::error("unsupported", text).at(entity.span, "this shape");
                self.report.substitute(diagnostic, "the light can be seen");
                return material;
            }
        }
        self.masked(material, opacity)
    }

    /// The form, its placement in the shape's space, and for quadrics the area that pbrt takes it to have.
    fn geometry(&mut self, entity: &Entity) -> Option<(GeometryDescription, Affine, f32)> {
        const UNSUPPORTED: [&str; 3] = ["bilinearmesh", "curve", "loopsubdiv"];
        const SUPPORTED: [&str; 5] = ["cylinder", "disk", "plymesh", "sphere", "trianglemesh"];
        let params = &entity.params;
        match entity.kind.as_str() {
            "sphere" => self.sphere(entity),
            "disk" => Some(self.disk(params)),
            "cylinder" => self.cylinder(entity),
            "trianglemesh" => {
                let mesh = self.triangle_mesh(entity)?;
                Some((GeometryDescription::Mesh(Arc::new(mesh)), Affine::IDENTITY, 0.0))
            }
            "plymesh" => {
                let mesh = self.ply_mesh(entity)?;
                Some((GeometryDescription::Mesh(mesh), Affine::IDENTITY, 0.0))
            }
            known if UNSUPPORTED.contains(&known) => {
                let diagnostic =
                    Diagnostic::error("unsupported", format!("{known} shapes are not supported"));
                self.report.substitute(diagnostic.at(entity.span, "this shape"), "the shape is left out");
                params.accept_all();
                None
            }
            other => {
                let diagnostic =
                    Diagnostic::error("unknown-type", format!("\"{other}\" is no type of shape"))
                        .at(entity.span, "unknown shape");
                self.report.substitute(
                    suggest(diagnostic, other, SUPPORTED.into_iter().chain(UNSUPPORTED)),
                    "the shape is left out",
                );
                params.accept_all();
                None
            }
        }
    }

    fn radius(&mut self, params: &Params) -> f32 {
        params.float_where("radius", 1.0, |v| v > 0.0, "must be positive", &mut self.report)
    }

    fn phi_max(&mut self, params: &Params) -> f32 {
        let in_range = |v: f32| v > 0.0 && v <= 360.0;
        params.float_where("phimax", 360.0, in_range, "must be in (0, 360] degrees", &mut self.report)
    }

    /// `zmin` and `zmax` in order; `None` where nothing is between them.
    fn z_range(&mut self, entity: &Entity, default: f32) -> Option<[f32; 2]> {
        let z0 = entity.params.float("zmin", -default, &mut self.report);
        let z1 = entity.params.float("zmax", default, &mut self.report);
        if z0 == z1 {
            let text = "nothing is left of the shape between \"zmin\" and \"zmax\"";
            self.report.substitute(
                Diagnostic::error("bad-value", text).at(entity.span, "this shape"),
                "the shape is left out",
            );
            return None;
        }
        Some([z0.min(z1), z0.max(z1)])
    }

    fn sphere(&mut self, entity: &Entity) -> Option<(GeometryDescription, Affine, f32)> {
        let radius = self.radius(&entity.params);
        let phi_max = self.phi_max(&entity.params);
        let [z_min, z_max] = self.z_range(entity, radius)?.map(|z| (z / radius).clamp(-1.0, 1.0));
        if z_min == z_max {
            let text = "\"zmin\" and \"zmax\" are on the same side of the sphere";
            self.report.substitute(
                Diagnostic::error("bad-value", text).at(entity.span, "this shape"),
                "the shape is left out",
            );
            return None;
        }
        let area = phi_max.to_radians() * radius * radius * (z_max - z_min);
        Some((GeometryDescription::Sphere { z_min, z_max, phi_max }, scaling(radius), area))
    }

    fn disk(&mut self, params: &Params) -> (GeometryDescription, Affine, f32) {
        let radius = self.radius(params);
        let phi_max = self.phi_max(params);
        let height = params.float("height", 0.0, &mut self.report);
        let in_range = |v: f32| v >= 0.0 && v < radius;
        let must = "must be at least 0 and below \"radius\"";
        let inner = params.float_where("innerradius", 0.0, in_range, must, &mut self.report);
        let placement = Affine::translation(0.0, 0.0, f64::from(height)).after(&scaling(radius));
        let area = phi_max.to_radians() * 0.5 * (radius * radius - inner * inner);
        (GeometryDescription::Disk { inner_radius: inner / radius, phi_max }, placement, area)
    }

    fn cylinder(&mut self, entity: &Entity) -> Option<(GeometryDescription, Affine, f32)> {
        let radius = self.radius(&entity.params);
        let phi_max = self.phi_max(&entity.params);
        let [z_min, z_max] = self.z_range(entity, 1.0)?.map(|z| z / radius);
        let area = phi_max.to_radians() * radius * radius * (z_max - z_min);
        Some((GeometryDescription::Cylinder { z_min, z_max, phi_max }, scaling(radius), area))
    }

    fn ply_mesh(&mut self, entity: &Entity) -> Option<Arc<Mesh>> {
        let params = &entity.params;
        if let Some(param) = params.find("displacement", Type::Texture) {
            let diagnostic = Diagnostic::error("unsupported", "displacement of meshes is not supported");
            self.report.substitute(diagnostic.at(param.span, "this displacement"), "the mesh stays as it is");
        }
        params.accept("edgelength", Type::Float);
        let Some(file) = params.one("filename", Type::String, &mut self.report) else {
            if !params.has("filename") {
                let diagnostic =
                    Diagnostic::error("missing-parameter", "a plymesh needs a \"string filename\"");
                self.report.substitute(diagnostic.at(entity.span, "no file"), "the shape is left out");
            }
            return None;
        };
        let path = self.path(&file.strings()[0]);
        self.files.mesh(&path, file, "the shape is left out", &mut self.report)
    }

    fn triangle_mesh(&mut self, entity: &Entity) -> Option<Mesh> {
        let params = &entity.params;
        let report = &mut self.report;
        if let Some(param) = params.find("S", Type::Vector3) {
            let text = "the tangents \"S\" are not used: they follow from the texture coordinates";
            report.push(Diagnostic::note("ignored-parameter", text).at(param.span, "not used"));
        }
        // Face numbers serve textures that are reported themselves.
        params.accept("faceIndices", Type::Integer);
        let indices = params.find("indices", Type::Integer);
        let Some(positions) = params.array("P", Type::Point3, report) else {
            if !params.has("P") {
                let diagnostic = Diagnostic::error("missing-parameter", "a trianglemesh needs \"point3 P\"");
                report.substitute(diagnostic.at(entity.span, "no vertices"), "the shape is left out");
            }
            return None;
        };
        let count = positions.numbers().len() / 3;
        let mut per_vertex = |name, kind, width| {
            let param = params.array(name, kind, report)?;
            let found = param.numbers().len() / width;
            if found == count {
                return Some(param.numbers());
            }
            let text = format!("\"{name}\" has {found} values for {count} vertices");
            report.substitute(param.bad_value(text, "one for each vertex is needed"), "they are left out");
            None
        };
        let normals = per_vertex("N", Type::Normal, 3).unwrap_or_default();
        let uvs = per_vertex("uv", Type::Point2, 2).unwrap_or_default();
        let triangles = match indices {
            None if count == 3 => vec![[0, 1, 2]],
            None => {
                let diagnostic =
                    Diagnostic::error("missing-parameter", "a trianglemesh needs \"integer indices\"");
                report.substitute(diagnostic.at(entity.span, "no triangles"), "the shape is left out");
                return None;
            }
            Some(param) => match triangles(&param.values, count) {
                Ok(triangles) => triangles,
                Err(text) => {
                    report.substitute(
                        param.bad_value(text, "expected three vertices a triangle"),
                        "the shape is left out",
                    );
                    return None;
                }
            },
        };
        let vectors =
            |numbers: &[f32]| numbers.chunks_exact(3).map(|v| Vec3::new(v[0], v[1], v[2])).collect();
        let mut mesh = Mesh {
            positions: vectors(positions.numbers()),
            normals: vectors(normals),
            uvs: uvs.chunks_exact(2).map(|v| Vec2::new(v[0], v[1])).collect(),
            triangles,
        };
        winding::agree_with_normals(&mut mesh);
        Some(mesh)
    }

    /// What the radiance of an area light is multiplied with.
    fn emission_factor(
        &mut self,
        emission: &AreaEmission,
        geometry: &GeometryDescription,
        to_world: &Affine,
        own_area: f32,
        entity: &Entity,
    ) -> f32 {
        let Some(power) = emission.power else { return emission.scale };
        let sides = if emission.two_sided { 2.0 } else { 1.0 };
        let (lights, area) = match geometry {
            GeometryDescription::Mesh(mesh) => {
                let areas = TriangleAreas::of(mesh, to_world);
                if areas.largest > 1.001 * areas.smallest {
                    let text = "pbrt gives each triangle of the light its own radiance, for the power of each to be the same";
                    let diagnostic = Diagnostic::note("power-of-triangles", text)
                        .at(entity.span, "this mesh")
                        .help("here they share one radiance, with the same total power");
                    self.report.push(diagnostic);
                }
                (mesh.triangles.len() as f32, areas.total as f32)
            }
            _ => (1.0, own_area),
        };
        let factor = emission.scale * power * lights / (PI * sides * area);
        if factor.is_finite() {
            return factor;
        }
        let text = "a light without area cannot have a power";
        self.report.substitute(
            Diagnostic::error("bad-value", text).at(entity.span, "this shape"),
            "the power is left out",
        );
        emission.scale
    }
}

fn scaling(radius: f32) -> Affine {
    let r = f64::from(radius);
    Affine::scaling(r, r, r)
}

/// Triples of vertex numbers below `count`.
fn triangles(indices: &Values, count: usize) -> Result<Vec<[u32; 3]>, String> {
    let Values::Integers(indices) = indices else { return Err("\"indices\" are integers".to_owned()) };
    if indices.is_empty() || !indices.len().is_multiple_of(3) {
        return Err(format!("\"indices\" has {} numbers, which is no multiple of 3", indices.len()));
    }
    if let Some(wrong) = indices.iter().find(|i| !usize::try_from(**i).is_ok_and(|i| i < count)) {
        return Err(format!("\"indices\" names vertex {wrong} of {count}"));
    }
    Ok(indices.chunks_exact(3).map(|t| [t[0] as u32, t[1] as u32, t[2] as u32]).collect())
}

/// Areas of a mesh's triangles in the world.
struct TriangleAreas {
    smallest: f64,
    largest: f64,
    total: f64,
}

impl TriangleAreas {
    fn of(mesh: &Mesh, to_world: &Affine) -> Self {
        let mut out = Self { smallest: f64::INFINITY, largest: 0.0, total: 0.0 };
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            let area = 0.5 * f64::from(to_world.vector(b - a).cross(to_world.vector(c - a)).length());
            out.smallest = out.smallest.min(area);
            out.largest = out.largest.max(area);
            out.total += area;
        }
        out
    }
}
