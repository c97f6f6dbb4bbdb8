//! Shapes: what they have in common. Their forms are in `quadric` and `mesh_shape`.

use lichtweg::scene::description::{AreaLightDescription, GeometryDescription, ShapeDescription, Span};
use lichtweg_ray::math::Affine;

use super::assets::{Asset, Place, Target};
use super::translate::Translator;
use super::tree::{Class, Object, ObjectId};

const KNOWN: [&str; 8] = ["obj", "ply", "serialized", "rectangle", "cube", "sphere", "disk", "cylinder"];

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
    /// Translates a shape with its material and its area light.
    pub fn shape(&mut self, id: ObjectId) {
        self.nested(id, |this, object| {
            let to_world = this.invertible(object, "to_world");
            let form = this.form(object);
            let flip = this.boolean(object, "flip_normals", false);
            let emission = this.shape_emission(object);
            let material = this.single(object, Class::Bsdf);
            let material = match material {
                Some(bsdf) => this.material(bsdf),
                None => this.grey(),
            };
            // How silhouettes are sampled concerns derivatives only.
            object.ignore(&["silhouette_sampling_weight"]);
            this.refuse_unknown(object);
            let Some(form) = form else { return };
            let to_world = to_world.after(&form.to_object);
            if to_world.inverse().is_none()
                || to_world.rows.iter().flatten().any(|v| !(*v as f32).is_finite())
            {
                let message =
                    format!("the shape \"{}\" is too small or too large for its transform", object.plugin);
                return this.error("bad-transform", message, object.plugin_span);
            }
            if let Some((asset, span)) = form.file {
                let place = Place::Shape(this.description.shapes.len());
                this.assets.request(asset, Target { place, span });
            }
            let mirrored = form.flipped_by_mirror && to_world.determinant() < 0.0;
            this.description.shapes.push(ShapeDescription {
                name: object.id.clone(),
                span: object.plugin_span,
                geometry: form.geometry,
                to_world,
                flip_normals: flip ^ mirrored,
                material,
                emission,
                group: None,
            });
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
