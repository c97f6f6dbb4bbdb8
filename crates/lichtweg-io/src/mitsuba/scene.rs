//! What is directly in a scene.

use lichtweg::scene::description::{Diagnostic, Span};

use super::translate::Translator;
use super::tree::{Class, ObjectId, Value};

impl Translator<'_> {
    /// Translates everything.
    pub fn scene(&mut self) {
        let scene = self.tree.get(ObjectId::SCENE);
        let (mut integrator, mut sensor) = (None, None);
        let mut seen = std::collections::HashSet::new();
        for property in &scene.properties {
            let Value::Object(id) = property.value else { continue };
            let class = self.tree.get(id).class;
            if matches!(class, Class::Volumetric | Class::Film | Class::Filter | Class::Sampler) {
                continue;
            }
            property.queried.set(true);
            if !seen.insert(id) {
                continue;
            }
            match class {
                Class::Integrator => self.first("integrator", &mut integrator, id, property.value_span),
                Class::Sensor => self.first("sensor", &mut sensor, id, property.value_span),
                Class::Bsdf => drop(self.material(id)),
                Class::Texture => drop(self.texture_input(id)),
                Class::Emitter => self.light(id),
                Class::Shape => self.shape(id),
                _ => {}
            }
        }
        self.refuse_unknown(scene);
        if let Some(id) = integrator {
            self.nested(id, |this, object| this.integrator(object));
        }
        match sensor {
            Some(id) => drop(self.nested(id, |this, object| this.sensor(object))),
            None => {
                let diagnostic = Diagnostic::error("no-sensor", "the scene has no <sensor>");
                self.diagnostics.unsupported(diagnostic, "a camera at the origin, looking along +z, is used");
            }
        }
    }

    fn first(&mut self, what: &str, slot: &mut Option<ObjectId>, id: ObjectId, span: Span) {
        if slot.is_none() {
            *slot = Some(id);
        } else {
            let message = format!("this is not the first {what}; the first one counts");
            self.warning("several-objects", message, span);
        }
    }
}
