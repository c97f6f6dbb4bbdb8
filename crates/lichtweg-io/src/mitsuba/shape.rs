//! Shapes: what they have in common, groups of them and instances. Their forms are in `quadric` and `mesh_shape`.
//!
//! A shape that moves is a group of one with an instance that moves.

use lichtweg::scene::description::{
    AreaLightDescription, Diagnostic, GeometryDescription, GroupId, InstanceDescription, ShapeDescription,
    Span,
};
use lichtweg_ray::Placement;
use lichtweg_ray::math::Affine;

use super::assets::{Asset, Place, Target};
use super::translate::Translator;
use super::tree::{Class, Object, ObjectId};

const KNOWN: [&str; 10] =
    ["obj", "ply", "serialized", "rectangle", "cube", "sphere", "disk", "cylinder", "shapegroup", "instance"];

/// A shape's form, before its place in the world.
pub(super) struct Form {
    pub geometry: GeometryDescription,
    /// Applied before the shape's own `to_world`.
    pub to_object: Affine,
    /// Mitsuba turns this kind of shape inside out under a mirroring transform.
    pub flipped_by_mirror: bool,
    /// The file that the geometry is still to be read from, and where it is asked for.
    pub file: Option<(Asset, Span)>,
}

impl<'a> Translator<'a> {
    /// Translates what is a shape to Mitsuba: also groups of shapes, and instances of them.
    pub fn shape(&mut self, id: ObjectId) {
        match self.tree.get(id).plugin.as_str() {
            "shapegroup" => drop(self.shape_group(id)),
            "instance" => drop(self.nested(id, |this, object| this.instance(object))),
            _ => drop(self.nested(id, |this, object| this.surface(object, None))),
        }
    }

    /// The group that a `shapegroup` is, translated once (Mitsuba 3 `src/shapes/shapegroup.cpp`).
    fn shape_group(&mut self, id: ObjectId) -> Option<GroupId> {
        if let Some(&known) = self.groups.get(&id) {
            return known;
        }
        let group = self.nested(id, |this, object| {
            let group = this.description.add_group();
            for (shape, span) in this.nested_of(object, Class::Shape) {
                if matches!(this.tree.get(shape).plugin.as_str(), "shapegroup" | "instance") {
                    let text = "a shape group cannot hold groups or instances";
                    let diagnostic = Diagnostic::error("nested-instance", text).at(span, "");
                    this.diagnostics.unsupported(diagnostic, "it is left out");
                    continue;
                }
                this.nested(shape, |this, object| this.surface(object, Some(group)));
            }
            this.refuse_unknown(object);
            group
        });
        self.groups.insert(id, group);
        group
    }

    /// An `instance` of a group (Mitsuba 3 `src/shapes/instance.cpp`).
    fn instance(&mut self, object: &'a Object) {
        let to_world = self.placement(object, "to_world");
        let group = self.single(object, Class::Shape);
        self.refuse_unknown(object);
        let Some(group) = group.filter(|id| self.tree.get(*id).plugin == "shapegroup") else {
            let text = "an instance needs a reference to a shape of type \"shapegroup\"";
            return self.error("missing-group", text, object.plugin_span);
        };
        if let Some(group) = self.shape_group(group) {
            let span = object.plugin_span;
            self.description.instances.push(InstanceDescription { span, group, to_world });
        }
    }

    /// Translates a surface with its material and its area light.
    fn surface(&mut self, object: &'a Object, group: Option<GroupId>) {
        // Inside of a group, nothing moves by itself.
        let placement = match group {
            Some(_) => Placement::Fixed(self.invertible(object, "to_world")),
            None => self.placement(object, "to_world"),
        };
        let form = self.form(object);
        let flip = self.boolean(object, "flip_normals", false);
        let mut emission = self.shape_emission(object);
        let material = self.single(object, Class::Bsdf);
        let material = match material {
            Some(bsdf) => self.material(bsdf),
            None => self.grey(),
        };
        // How silhouettes are sampled concerns derivatives only.
        object.ignore(&["silhouette_sampling_weight"]);
        self.refuse_unknown(object);
        let Some(form) = form else { return };
        let (to_world, motion) = match placement {
            Placement::Fixed(map) => (map.after(&form.to_object), None),
            Placement::Moving(motion) => (form.to_object, Some(motion)),
        };
        if to_world.inverse().is_none() || to_world.rows.iter().flatten().any(|v| !(*v as f32).is_finite()) {
            let message =
                format!("the shape \"{}\" is too small or too large for its transform", object.plugin);
            return self.error("bad-transform", message, object.plugin_span);
        }
        if (group.is_some() || motion.is_some())
            && let Some(light) = emission.take()
        {
            let text = if group.is_some() {
                "a shape in a group cannot emit light"
            } else {
                "a shape that moves cannot emit light"
            };
            let diagnostic = Diagnostic::error("emitting-instance", text).at(light.span, "");
            self.diagnostics.unsupported(diagnostic, "the shape is dark");
        }
        if let Some((asset, span)) = form.file {
            let place = Place::Shape(self.description.shapes.len());
            self.assets.request(asset, Target { place, span });
        }
        let mirrored = form.flipped_by_mirror && to_world.determinant() < 0.0;
        let span = object.plugin_span;
        let group = motion.map_or(group, |motion| {
            let group = self.description.add_group();
            let to_world = Placement::Moving(motion);
            self.description.instances.push(InstanceDescription { span, group, to_world });
            Some(group)
        });
        self.description.shapes.push(ShapeDescription {
            name: object.id.clone(),
            span,
            geometry: form.geometry,
            to_world,
            flip_normals: flip ^ mirrored,
            material,
            emission,
            group,
        });
    }

    fn form(&mut self, object: &'a Object) -> Option<Form> {
        match object.plugin.as_str() {
            "sphere" => Some(self.sphere(object)),
            "disk" => Some(self.disk(object)),
            "cylinder" => self.cylinder(object),
            "rectangle" => Some(self.rectangle(object)),
            "cube" => Some(self.cube(object)),
            "obj" | "ply" | "serialized" => self.mesh_file(object),
            _ => {
                self.unknown_plugin(object, &KNOWN, "the shape is left out");
                None
            }
        }
    }

    fn shape_emission(&mut self, object: &'a Object) -> Option<AreaLightDescription> {
        let id = self.single(object, Class::Emitter)?;
        self.nested(id, |this, emitter| this.area_light(emitter)).flatten()
    }
}
