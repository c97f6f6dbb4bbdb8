//! From a [`Description`] to a [`Scene`].

use std::f32::consts::{PI, TAU};
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use lichtweg_ray::QuadricShape;
use lichtweg_ray::math::{Bounds3, Vec3};
use rayon::prelude::*;

use super::candidate::candidate;
use super::curve::CurveForm;
use super::description::{
    Description, Diagnostic, Diagnostics, EmissionScale, EstimatorKind, GeometryDescription,
    LightDescription, LightKind, LightStrategy, Mesh, ShapeDescription, SpectrumDescription,
};
use super::instances::Structures;
use super::surface::{Form, MeshForm, QuadricForm};
use super::{MaterialArena, Scene, Shape};
use crate::color::{Role, Spectrum, luminance, rgb_spectrum};
use crate::light::{
    AreaLight, ConstantEnvironment, Directional, EmissionSampling, Environment, Light, LightSelection,
    MapEnvironment, Point, Spot, Surroundings,
};
use crate::texture::{Input, TextureArena};

/// What compiling a scene took and found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompileReport {
    /// Seconds for everything but the ray hierarchy.
    pub seconds: f64,
    /// Triangles in all meshes, before the ray engine drops degenerate ones.
    pub triangles: u64,
}

impl Scene {
    /// Compiles a description. What is wrong with it goes to `diagnostics`; a scene comes out unless an error was among it.
    pub fn compile(description: &Description, diagnostics: &mut Diagnostics) -> Option<Self> {
        let start = Instant::now();
        let textures = TextureArena::compile(&description.textures, diagnostics);
        let materials = MaterialArena::compile(&description.materials, &textures, diagnostics);
        let forms: Vec<Result<Form, Diagnostic>> = description.shapes.par_iter().map(form).collect();
        let mut shapes = Vec::with_capacity(forms.len());
        let mut lights = Vec::new();
        // Those in the world first, then group by group.
        let mut sources: Vec<_> = forms.into_iter().zip(&description.shapes).collect();
        sources.sort_by_key(|(_, source)| source.group.map(|g| g.0));
        for (form, source) in sources {
            match form.and_then(|form| check_group(source, description.groups).map(|()| form)) {
                Ok(form) => {
                    add_shape(form, source, &materials, &textures, &mut shapes, &mut lights, diagnostics)
                }
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        if !description.keep_coordinates {
            forget_coordinates(&mut shapes, &lights, &materials);
        }
        for light in &description.lights {
            lights.extend(compile_light(light, diagnostics));
        }
        if diagnostics.has_errors() {
            return None;
        }
        let triangles = shapes.iter().map(|s| s.form.triangles()).sum();
        let seconds = start.elapsed().as_secs_f64();
        let structures = Structures::build(description, &shapes, &group_ranges(description));
        let Structures { accel, emitters, instances, report: hierarchies } =
            structures.map_err(|fault| diagnostics.push(fault)).ok()?;
        let surroundings = surroundings(accel.bounds());
        let candidates: Vec<_> =
            lights.par_iter().map(|l| candidate(l, &shapes, &textures, surroundings.radius)).collect();
        let environments = (0..lights.len() as u32)
            .filter(|&i| matches!(lights[i as usize], Light::Environment(_)))
            .collect();
        let scene = Self {
            has_holes: shapes.iter().any(|s| s.has_holes),
            selection: LightSelection::new(&candidates, description.integrator.light_choice),
            accel,
            emitters,
            instances,
            hierarchies,
            shapes,
            textures,
            materials,
            lights,
            environments,
            surroundings,
            report: CompileReport { seconds, triangles },
        };
        scene.warn(description, diagnostics);
        Some(scene)
    }

    /// What renders, but perhaps not as meant.
    fn warn(&self, description: &Description, diagnostics: &mut Diagnostics) {
        if self.lights.is_empty() {
            diagnostics.push(
                Diagnostic::warning("no-light", "the scene has no light: its image will be black")
                    .help("add an emitter, for instance a constant environment"),
            );
        }
        let integrator = &description.integrator;
        let runs_into_lights =
            integrator.estimator == EstimatorKind::Path && integrator.light == LightStrategy::Naive;
        if runs_into_lights && self.lights.iter().any(Light::is_delta) {
            diagnostics.push(
                Diagnostic::warning(
                    "unseen-light",
                    "lights at a point or in a single direction give nothing: walks alone never hit them",
                )
                .help("use path:light=mis or path:light=nee, which connect to them"),
            );
        }
        let report = self.build_report();
        let dropped = report.dropped_degenerate + report.dropped_non_finite;
        let kept = report.triangles + report.curve_segments;
        if dropped > 0 && dropped * 100 > kept {
            diagnostics.push(Diagnostic::warning(
                "degenerate-triangles",
                format!(
                    "{dropped} of {} triangles{} have no area and are left out",
                    kept + dropped,
                    if report.curve_segments > 0 { " and segments of curves" } else { "" },
                ),
            ));
        }
        if description.shapes.is_empty() {
            diagnostics.push(Diagnostic::warning("no-shape", "the scene has no shape"));
        }
    }
}

/// The ranges that the groups have among compiled shapes.
fn group_ranges(description: &Description) -> Vec<Range<usize>> {
    let mut counts = vec![0; description.groups as usize];
    let mut end = 0;
    for shape in &description.shapes {
        match shape.group {
            Some(group) => counts[group.0 as usize] += 1,
            None => end += 1,
        }
    }
    let following = |count| {
        let start = end;
        end += count;
        start..end
    };
    counts.into_iter().map(following).collect()
}

fn fault(code: &'static str, shape: &ShapeDescription, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(code, message).at(shape.span, "this shape")
}

/// Places a shape in the world.
fn form(shape: &ShapeDescription) -> Result<Form, Diagnostic> {
    let singular = || {
        fault("singular-transform", shape, "a shape's transform is singular or not finite")
            .help("no scale factor may be zero, and no entry NaN or infinite")
    };
    let quadric = |form: QuadricShape| {
        if !shape.to_world.is_finite() {
            return Err(singular());
        }
        QuadricForm::new(form, shape.to_world, shape.flip_normals)
            .map(|form| Form::Quadric(Box::new(form)))
            .ok_or_else(singular)
    };
    match &shape.geometry {
        GeometryDescription::Mesh(mesh) => {
            if shape.to_world.inverse().is_none() {
                return Err(singular());
            }
            place_mesh(mesh, shape).map(Form::Mesh)
        }
        GeometryDescription::Sphere { z_min, z_max, phi_max } => {
            quadric(QuadricShape::Sphere { z_min: *z_min, z_max: *z_max, phi_max: radians(*phi_max) })
        }
        GeometryDescription::Disk { inner_radius, phi_max } => {
            quadric(QuadricShape::Disk { inner_radius: *inner_radius, phi_max: radians(*phi_max) })
        }
        GeometryDescription::Cylinder { z_min, z_max, phi_max } => {
            quadric(QuadricShape::Cylinder { z_min: *z_min, z_max: *z_max, phi_max: radians(*phi_max) })
        }
        GeometryDescription::Curves(curves) => {
            if shape.to_world.inverse().is_none() {
                return Err(singular());
            }
            CurveForm::new(curves, &shape.to_world, shape.flip_normals)
                .map(Form::Curves)
                .map_err(|error| fault("bad-curves", shape, error.to_string()))
        }
    }
}

/// Degrees to radians, a full turn exactly.
fn radians(degrees: f32) -> f32 {
    (degrees / 360.0) * TAU
}

fn place_mesh(mesh: &Mesh, shape: &ShapeDescription) -> Result<MeshForm, Diagnostic> {
    let vertices = mesh.positions.len();
    let sound = |list: usize| list == 0 || list == vertices;
    if !sound(mesh.normals.len()) || !sound(mesh.uvs.len()) {
        return Err(fault(
            "bad-mesh",
            shape,
            "a mesh has not as many normals or texture coordinates as vertices",
        ));
    }
    let m = &shape.to_world;
    let positions: Arc<[Vec3]> = mesh.positions.iter().map(|p| m.point(*p)).collect();
    if let Some(i) = positions.iter().position(|p| !p.is_finite()) {
        return Err(fault(
            "not-finite",
            shape,
            format!("vertex {i} of a mesh is not finite: {:?}", mesh.positions[i]),
        ));
    }
    let flip = if shape.flip_normals { -1.0 } else { 1.0 };
    let mirror = m.determinant().signum() as f32;
    if let Some(t) = mesh.triangles.iter().flatten().find(|&&i| i as usize >= vertices) {
        return Err(fault(
            "bad-mesh",
            shape,
            format!("a mesh refers to vertex {t}, but has {vertices} vertices"),
        ));
    }
    Ok(MeshForm::new(
        positions,
        mesh.triangles.as_slice().into(),
        mesh.normals.iter().map(|n| (m.normal(*n) * flip).normalized()).collect(),
        mesh.uvs.clone(),
        flip * mirror,
    ))
}

/// What a shape in one of `groups` must be.
fn check_group(shape: &ShapeDescription, groups: u32) -> Result<(), Diagnostic> {
    match shape.group {
        Some(group) if group.0 >= groups => {
            Err(fault("unknown-group", shape, "a shape is in a group that does not exist"))
        }
        Some(_) if shape.emission.is_some() => {
            let text = "a shape that instances place, or that moves, cannot emit light";
            Err(fault("emitting-instance", shape, text))
        }
        _ => Ok(()),
    }
}

fn add_shape(
    form: Form,
    source: &ShapeDescription,
    materials: &MaterialArena,
    textures: &TextureArena,
    shapes: &mut Vec<Shape>,
    lights: &mut Vec<Light>,
    diagnostics: &mut Diagnostics,
) {
    let material = source.material.0;
    if material as usize >= materials.len() {
        diagnostics.push(fault("unknown-material", source, "a shape has a material that does not exist"));
        return;
    }
    let has_holes = materials.has_holes(material);
    let light = area_light(&form, source, shapes.len() as u32, textures, diagnostics).map(|mut light| {
        light.row = light.emission_row(&form, has_holes);
        lights.push(Light::Area(light));
        lights.len() as u32 - 1
    });
    let emits_simply = light.is_none_or(|light| lights[light as usize].row().is_some());
    let is_simple = !has_holes && emits_simply && form.has_rows();
    let lobe = if is_simple { materials.lobe(material) } else { None };
    shapes.push(Shape { form, material, light, has_holes, lobe });
}

/// Forgets texture coordinates that neither materials nor lights look at.
fn forget_coordinates(shapes: &mut [Shape], lights: &[Light], materials: &MaterialArena) {
    for shape in shapes {
        let light = shape.light.map(|light| &lights[light as usize]);
        let textured = matches!(light, Some(Light::Area(a)) if matches!(a.radiance, Input::Texture(_)));
        if let Form::Mesh(mesh) = &mut shape.form
            && !textured
            && !materials.uses_coordinates(shape.material)
        {
            mesh.forget_coordinates();
        }
    }
}

fn area_light(
    form: &Form,
    source: &ShapeDescription,
    shape: u32,
    textures: &TextureArena,
    diagnostics: &mut Diagnostics,
) -> Option<AreaLight> {
    let emission = source.emission.as_ref()?;
    let radiance = textures.input(&emission.radiance, Role::Emission, emission.span, diagnostics)?;
    let negative = |s: Spectrum| s.0.iter().any(|v| *v < 0.0);
    if let Input::Constant(c) = radiance
        && negative(c)
    {
        diagnostics.push(
            Diagnostic::error("negative-emission", "a light emits negative radiance")
                .at(emission.span, "here"),
        );
        return None;
    }
    if radiance.is_zero() {
        return None;
    }
    if let Form::Curves(_) = form {
        let diagnostic = Diagnostic::error("emitting-curves", "curves cannot emit light");
        diagnostics.unsupported(diagnostic.at(emission.span, "emission stated here"), "they stay dark");
        return None;
    }
    let Some(sampling) = EmissionSampling::new(form) else {
        diagnostics.push(
            Diagnostic::warning("no-area", "an emitting shape has no area, and so gives no light")
                .at(emission.span, "emission stated here"),
        );
        return None;
    };
    let mut light =
        AreaLight { shape, radiance, factor: 1.0, two_sided: emission.two_sided, sampling, row: None };
    light.factor = match emission.scale {
        EmissionScale::Factor(factor) => factor,
        EmissionScale::Power(power) => {
            let sides = if light.two_sided { 2.0 } else { 1.0 };
            power / (luminance(textures.mean(radiance).to_rgb()) * PI * sides * light.area(form))
        }
    };
    if !(light.factor >= 0.0 && light.factor.is_finite()) {
        diagnostics.push(
            Diagnostic::error(
                "bad-emission",
                "the scale or power of a light must be finite and not negative",
            )
            .at(emission.span, "here"),
        );
        return None;
    }
    (light.factor > 0.0).then_some(light)
}

fn compile_light(light: &LightDescription, diagnostics: &mut Diagnostics) -> Option<Light> {
    let mut fault = |message: &str| {
        diagnostics.push(Diagnostic::error("bad-light", message).at(light.span, "this light"));
        None
    };
    if !(light.scale >= 0.0 && light.scale.is_finite()) {
        return fault("the scale of a light must be finite and not negative");
    }
    let emitted = |s: &SpectrumDescription| {
        rgb_spectrum(s, Role::Emission).map(|s| s * light.scale).filter(|s| s.is_valid_radiance())
    };
    const NO_RADIANCE: &str = "what a light emits must be finite and not negative";
    match &light.kind {
        LightKind::Point { position, intensity } => {
            let Some(intensity) = emitted(intensity) else { return fault(NO_RADIANCE) };
            Some(Light::Point(Point { position: *position, intensity }))
        }
        LightKind::Spot { to_world, intensity, cutoff, beam_width, falloff } => {
            let Some(intensity) = emitted(intensity) else { return fault(NO_RADIANCE) };
            let Some(axis) = to_world.vector(Vec3::Z).try_normalized() else {
                return fault("a spot light has a singular transform");
            };
            Some(Light::Spot(Spot {
                position: to_world.point(Vec3::ZERO),
                axis,
                intensity,
                cutoff: cutoff.to_radians(),
                beam_width: beam_width.to_radians(),
                falloff: *falloff,
            }))
        }
        LightKind::Directional { direction, irradiance } => {
            let Some(irradiance) = emitted(irradiance) else { return fault(NO_RADIANCE) };
            let Some(direction) = direction.try_normalized() else {
                return fault("a directional light has no direction");
            };
            Some(Light::Directional(Directional { direction, irradiance }))
        }
        LightKind::Constant { radiance } => {
            let Some(radiance) = emitted(radiance) else { return fault(NO_RADIANCE) };
            Some(Light::Environment(Environment::Constant(ConstantEnvironment { radiance })))
        }
        LightKind::Environment { image, mapping, to_world } => {
            match MapEnvironment::new(image, *mapping, to_world, light.scale) {
                Some(map) => Some(Light::Environment(Environment::Map(map))),
                None => fault(
                    "an environment map is black, has negative or infinite values, or a singular transform",
                ),
            }
        }
    }
}

/// A sphere around everything, a little larger than rounding asks for.
fn surroundings(bounds: Bounds3) -> Surroundings {
    if bounds.is_empty() {
        return Surroundings { center: Vec3::ZERO, radius: 1.0 };
    }
    let radius = (bounds.extent().length() * 0.5 * (1.0 + 1e-4)).max(f32::MIN_POSITIVE);
    Surroundings { center: bounds.center(), radius }
}
