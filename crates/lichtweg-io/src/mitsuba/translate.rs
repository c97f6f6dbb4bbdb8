//! The state of turning objects into a [`Description`], and what all families of objects share.

use std::collections::HashMap;

use lichtweg::scene::description::{
    Description, Diagnostic, Diagnostics, GroupId, MaterialId, Span, TextureId,
};

use super::assets::Assets;
use super::suggest::hint;
use super::tree::{Class, Object, ObjectId, Tree, Value};

/// Objects may refer to objects this deep.
const DEEPEST: usize = 100;

/// A description in the making.
pub(super) struct Translator<'a> {
    pub tree: &'a Tree,
    pub diagnostics: &'a mut Diagnostics,
    pub description: Description,
    pub assets: Assets,
    /// Objects that are made once and used by all that refer to them.
    pub materials: HashMap<ObjectId, MaterialId>,
    pub textures: HashMap<ObjectId, TextureId>,
    pub groups: HashMap<ObjectId, Option<GroupId>>,
    pub default_material: Option<MaterialId>,
    /// The objects being translated, outermost first.
    open: Vec<ObjectId>,
}

impl<'a> Translator<'a> {
    pub fn new(tree: &'a Tree, diagnostics: &'a mut Diagnostics) -> Self {
        Self {
            tree,
            diagnostics,
            description: Description::default(),
            assets: Assets::default(),
            materials: HashMap::new(),
            textures: HashMap::new(),
            groups: HashMap::new(),
            default_material: None,
            open: Vec::new(),
        }
    }

    /// The description, and the files that are still to be read for it.
    pub fn finish(self) -> (Description, Assets) {
        (self.description, self.assets)
    }

    pub fn error(&mut self, code: &'static str, message: impl Into<String>, span: Span) {
        self.diagnostics.push(Diagnostic::error(code, message).at(span, ""));
    }

    pub fn warning(&mut self, code: &'static str, message: impl Into<String>, span: Span) {
        self.diagnostics.push(Diagnostic::warning(code, message).at(span, ""));
    }

    /// Translates an object inside of others by `make`; `None`, with an error, where it is inside of itself.
    pub fn nested<T>(&mut self, id: ObjectId, make: impl FnOnce(&mut Self, &'a Object) -> T) -> Option<T> {
        let object = self.tree.get(id);
        if self.open.contains(&id) {
            let name = object.id.as_deref().unwrap_or("");
            let message = format!("the {} \"{name}\" refers to itself", object.class.name());
            self.error("reference-cycle", message, object.span);
            return None;
        }
        if self.open.len() >= DEEPEST {
            let message = format!("objects refer to each other more than {DEEPEST} deep");
            self.error("nested-too-deep", message, object.span);
            return None;
        }
        self.open.push(id);
        let made = make(self, object);
        self.open.pop();
        Some(made)
    }

    /// Reports the parameters of a translated object that nothing has asked for.
    pub fn refuse_unknown(&mut self, object: &Object) {
        for property in object.properties.iter().filter(|p| !p.queried.replace(true)) {
            if let Value::Object(id) = property.value {
                self.refuse_object(object, property.name.as_str(), id, property.value_span);
                continue;
            }
            // A reference to nothing, which is reported.
            if property.value == Value::Invalid && property.name.is_empty() {
                continue;
            }
            let message = format!("unknown parameter \"{}\" of {}", property.name, title(object));
            let mut diagnostic = Diagnostic::error("unknown-parameter", message).at(property.name_span, "");
            diagnostic.help.extend(hint(&property.name, "known", &object.asked.borrow()));
            self.diagnostics.unsupported(diagnostic, "it is ignored");
        }
    }

    fn refuse_object(&mut self, outer: &Object, name: &str, id: ObjectId, span: Span) {
        let inner = self.tree.get(id);
        let mut diagnostic = if inner.class == Class::Volumetric {
            Diagnostic::error("unsupported-medium", "participating media are not supported")
        } else if name.is_empty() {
            let message = format!("a {} does not belong into {}", inner.class.name(), title(outer));
            Diagnostic::error("misplaced-object", message)
        } else {
            let message = format!("unknown parameter \"{name}\" of {}", title(outer));
            Diagnostic::error("unknown-parameter", message)
        };
        if !name.is_empty() && inner.class != Class::Volumetric {
            diagnostic.help.extend(hint(name, "known", &outer.asked.borrow()));
        }
        self.diagnostics.unsupported(diagnostic.at(span, ""), "it is ignored");
    }

    /// Reports a type that is not among the `known` ones. Its parameters are not looked at.
    pub fn unknown_plugin(&mut self, object: &Object, known: &[&'static str], substitute: &str) {
        object.properties.iter().for_each(|p| p.queried.set(true));
        let message = format!("unsupported {} type \"{}\"", object.class.name(), object.plugin);
        let mut diagnostic = Diagnostic::error("unknown-plugin", message).at(object.plugin_span, "");
        diagnostic.help.extend(hint(&object.plugin, "supported", known));
        self.diagnostics.unsupported(diagnostic, substitute);
    }
}

/// What to call an object in a message, such as `the bsdf "diffuse"`.
pub(super) fn title(object: &Object) -> String {
    match object.class {
        Class::Scene => "the scene".to_owned(),
        class => format!("the {} \"{}\"", class.name(), object.plugin),
    }
}
