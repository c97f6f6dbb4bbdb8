//! References: every `<ref id="..."/>` becomes the object it names, wherever that is defined.

use lichtweg::scene::description::Diagnostic;

use super::suggest::hint;
use super::tree::Value;
use super::walk::Walk;

impl Walk<'_> {
    /// Resolves aliases and references once all files are read.
    pub fn resolve(&mut self) {
        self.resolve_aliases();
        for index in 0..self.tree.objects.len() {
            for property in 0..self.tree.objects[index].properties.len() {
                self.resolve_property(index, property);
            }
        }
    }

    /// As in Mitsuba, an alias may name objects anywhere, and aliases above it.
    fn resolve_aliases(&mut self) {
        for alias in std::mem::take(&mut self.aliases) {
            match self.tree.ids.get(&alias.id).copied() {
                None => {
                    let diagnostic = self.unknown_id(&alias.id).at(alias.id_span, "");
                    self.diagnostics.push(diagnostic);
                }
                Some(_) if self.tree.ids.contains_key(&alias.new) => {
                    let message = format!("there is an object with the id \"{}\" already", alias.new);
                    self.error("duplicate-id", message, alias.new_span);
                }
                Some(object) => {
                    self.tree.ids.insert(alias.new, object);
                }
            }
        }
    }

    fn resolve_property(&mut self, object: usize, property: usize) {
        let place = &self.tree.objects[object].properties[property];
        let Value::Reference(id) = &place.value else { return };
        let value = match self.tree.ids.get(id) {
            Some(target) => Value::Object(*target),
            None => {
                let diagnostic = self.unknown_id(id).at(place.value_span, "");
                self.diagnostics.push(diagnostic);
                Value::Invalid
            }
        };
        self.tree.objects[object].properties[property].value = value;
    }

    fn unknown_id(&self, id: &str) -> Diagnostic {
        let mut diagnostic =
            Diagnostic::error("unknown-id", format!("there is no object with the id \"{id}\""));
        if self.few_findings() {
            let ids: Vec<&str> = self.tree.ids.keys().map(String::as_str).collect();
            diagnostic.help.extend(hint(id, "defined", &ids));
        }
        diagnostic
    }
}
