//! From XML to objects: parameters, nested objects, references, includes.
//!
//! The language is that of Mitsuba 3 (`src/core/parser.cpp`) with the spellings of Mitsuba 0.4 to 0.6. Recursion is bounded
//! by [`DEEPEST`] and the number of included files by [`MOST_FILES`].

use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::sync::Arc;

use lichtweg::scene::description::{Diagnostic, Diagnostics, SourceMap, Span};
use roxmltree::Node;

use super::definitions::Definitions;
use super::element::Element;
use super::legacy::snake_case;
use super::number::{parse_float, parse_floats, parse_integer, shortened};
use super::suggest::hint;
use super::tree::{Class, Object, ObjectId, Property, Tree, Value};

/// Elements may be nested this deep, over all included files together.
pub(super) const DEEPEST: usize = 100;

/// Files a scene may consist of, every inclusion counting.
pub(super) const MOST_FILES: usize = 1000;

const TAGS: [&str; 39] = [
    "alias",
    "animation",
    "blackbody",
    "boolean",
    "bsdf",
    "camera",
    "color",
    "default",
    "emitter",
    "film",
    "float",
    "include",
    "integer",
    "integrator",
    "luminaire",
    "medium",
    "path",
    "phase",
    "point",
    "ref",
    "rfilter",
    "rgb",
    "sampler",
    "scene",
    "sensor",
    "shape",
    "spectrum",
    "srgb",
    "string",
    "subsurface",
    "texture",
    "transform",
    "translate",
    "rotate",
    "scale",
    "matrix",
    "lookat",
    "vector",
    "volume",
];

/// The state of reading a scene's files.
pub(super) struct Walk<'a> {
    pub sources: &'a mut SourceMap,
    pub diagnostics: &'a mut Diagnostics,
    pub definitions: Definitions,
    pub tree: Tree,
    pub aliases: Vec<Alias>,
    /// A file could not be read or is no XML, so that what is said about the rest would not be to the point.
    pub broken: bool,
    /// The files being read, outermost first, by their canonical paths.
    pub open_files: Vec<PathBuf>,
    /// How many files were read so far.
    pub files_read: usize,
    /// Index of the file being read.
    pub file: u32,
    pub legacy: bool,
    /// Folders in which the current file's references are looked for.
    pub search: Arc<Vec<PathBuf>>,
}

/// `<alias id="old" as="new"/>`.
pub(super) struct Alias {
    pub id: String,
    pub id_span: Span,
    pub new: String,
    pub new_span: Span,
}

impl Walk<'_> {
    /// A span in the current file.
    pub fn span(&self, start: usize, end: usize) -> Span {
        Span { file: self.file, start: start as u32, end: end as u32 }
    }

    pub fn error(&mut self, code: &'static str, message: impl Into<String>, span: Span) {
        self.diagnostics.push(Diagnostic::error(code, message).at(span, ""));
    }

    /// Reads what is inside an object's element.
    pub fn children(&mut self, node: Node<'_, '_>, parent: ObjectId, depth: usize) {
        for child in node.children() {
            if child.is_element() {
                self.child(child, parent, depth + 1);
            } else {
                self.refuse_text(child);
            }
        }
    }

    /// Reads one element inside of `parent`.
    pub fn child(&mut self, node: Node<'_, '_>, parent: ObjectId, depth: usize) {
        let element = self.open(node);
        if depth > DEEPEST {
            let message = format!("elements are nested more than {DEEPEST} deep");
            return self.error("nested-too-deep", message, element.span);
        }
        match element.tag.as_str() {
            "spectrum" if element.has("type") => self.object(node, &element, Class::Texture, parent, depth),
            "default" => self.default(&element),
            "alias" => self.alias(&element),
            "path" => self.path(&element, parent),
            "include" => self.include(&element, parent, depth),
            "ref" => self.reference(&element, parent),
            "transform" => self.transform(node, &element, parent),
            "animation" => self.animation(node, &element, parent),
            "float" | "integer" | "boolean" | "string" | "point" | "vector" => {
                self.parameter(&element, parent)
            }
            "rgb" | "srgb" | "color" | "spectrum" | "blackbody" => self.color(&element, parent),
            "translate" | "rotate" | "scale" | "matrix" | "lookat" | "lookAt" => {
                let message = format!("<{}> belongs into a <transform>", element.tag);
                self.error("misplaced-element", message, element.span);
            }
            tag => match Class::of_tag(tag) {
                Some(Class::Scene) => {
                    self.error("misplaced-element", "<scene> is the outermost element", element.span)
                }
                Some(class) => return self.object(node, &element, class, parent, depth),
                None => return self.unknown_element(&element),
            },
        }
        if !matches!(element.tag.as_str(), "transform" | "animation" | "spectrum") {
            self.refuse_children(node, &element.tag);
        }
    }

    fn object(
        &mut self,
        node: Node<'_, '_>,
        element: &Element,
        class: Class,
        parent: ObjectId,
        depth: usize,
    ) {
        if self.check(element, &["type"], &["id", "name"]) {
            self.nested_object(node, element, class, parent, depth);
        }
    }

    /// Adds an object and what is inside of it.
    pub fn nested_object(
        &mut self,
        node: Node<'_, '_>,
        element: &Element,
        class: Class,
        parent: ObjectId,
        depth: usize,
    ) {
        let (plugin, plugin_span) = element.get("type").unwrap_or(("", element.span));
        let (plugin, id) = (plugin.to_owned(), element.value("id").map(str::to_owned));
        let object = self.add_object(class, plugin, plugin_span, element.span, id.clone());
        if let Some(id) = id {
            self.name_object(&id, element.span_of("id"), object);
        }
        self.add(parent, element, Value::Object(object), element.span);
        self.children(node, object, depth);
    }

    /// Adds an object without parameters.
    pub fn add_object(
        &mut self,
        class: Class,
        plugin: String,
        plugin_span: Span,
        span: Span,
        id: Option<String>,
    ) -> ObjectId {
        self.tree.objects.push(Object {
            class,
            plugin,
            plugin_span,
            span,
            id,
            legacy: self.legacy,
            search: Arc::clone(&self.search),
            properties: Vec::new(),
            asked: RefCell::default(),
        });
        ObjectId(self.tree.objects.len() - 1)
    }

    fn name_object(&mut self, id: &str, span: Span, object: ObjectId) {
        if let Some(&first) = self.tree.ids.get(id) {
            let message = format!("there are two objects with the id \"{id}\"");
            let mut diagnostic = Diagnostic::error("duplicate-id", message).at(span, "");
            if self.few_findings() {
                let line = self.line_of(self.tree.get(first).span);
                diagnostic.help.push(format!("the first one is in {line}"));
            }
            self.diagnostics.push(diagnostic);
        } else {
            self.tree.ids.insert(id.to_owned(), object);
        }
    }

    /// Whether advice that takes a search is still worth its time: nobody reads the thousandth finding.
    pub fn few_findings(&self) -> bool {
        self.diagnostics.list.len() < 200
    }

    fn line_of(&self, span: Span) -> String {
        let file = self.sources.file(span.file);
        let line = 1 + file.text.bytes().take(span.start as usize).filter(|b| *b == b'\n').count();
        format!("{}:{line}", file.path.display())
    }

    /// Adds a parameter to an object under the element's name.
    pub fn add(&mut self, parent: ObjectId, element: &Element, value: Value, value_span: Span) {
        let name = element.value("name").unwrap_or("");
        let name = if self.legacy { snake_case(name).into_owned() } else { name.to_owned() };
        let object = &mut self.tree.objects[parent.0];
        // The scene itself may have very many children, and asks for none by name.
        if !name.is_empty() && parent != ObjectId::SCENE && object.properties.iter().any(|p| p.name == name) {
            let message = format!("the parameter \"{name}\" is given twice");
            return self.error("duplicate-parameter", message, element.span_of("name"));
        }
        object.properties.push(Property {
            name,
            name_span: element.span_of("name"),
            value,
            value_span,
            queried: Cell::new(false),
        });
    }

    fn parameter(&mut self, element: &Element, parent: ObjectId) {
        let vector = matches!(element.tag.as_str(), "point" | "vector");
        let complete = if vector {
            self.check(element, &["name"], &["value", "x", "y", "z"])
        } else {
            self.check(element, &["name", "value"], &[])
        };
        if !complete {
            return self.add_invalid(element, parent);
        }
        let (text, span) = element.get("value").unwrap_or(("", element.span));
        let value = match element.tag.as_str() {
            "float" => parse_float(text).map(Value::Float),
            "integer" => parse_integer(text).map(Value::Integer),
            "boolean" => parse_boolean(text).map(Value::Boolean),
            "string" => Ok(Value::Text(text.to_owned())),
            _ => match self.xyz(element, None) {
                Some(v) => Ok(Value::Vector(v)),
                None => return self.add_invalid(element, parent),
            },
        };
        match value {
            Ok(value) => self.add(parent, element, value, span),
            Err(message) => {
                self.error("bad-value", message, span);
                self.add_invalid(element, parent);
            }
        }
    }

    /// Adds a parameter whose value is wrong, so that it does not count as missing.
    pub fn add_invalid(&mut self, element: &Element, parent: ObjectId) {
        if element.has("name") {
            self.add(parent, element, Value::Invalid, element.span);
        }
    }

    /// The coordinates from `x`, `y`, `z` (those missing are `missing`, or wrong where that is `None`) or from a `value` of
    /// one or three numbers.
    pub fn xyz(&mut self, element: &Element, missing: Option<f64>) -> Option<[f64; 3]> {
        let axes = ["x", "y", "z"];
        if let Some((text, span)) = element.get("value") {
            if axes.iter().any(|a| element.has(a)) {
                self.error(
                    "bad-value",
                    "either \"value\" or \"x\", \"y\" and \"z\" expected, got both",
                    span,
                );
                return None;
            }
            let found = parse_floats(text).and_then(|v| match v[..] {
                [a] => Ok([a; 3]),
                [x, y, z] => Ok([x, y, z]),
                _ => Err(format!("1 or 3 numbers expected, got {}", v.len())),
            });
            return found.map_err(|message| self.error("bad-value", message, span)).ok();
        }
        let mut out = [0.0; 3];
        for (out, axis) in out.iter_mut().zip(axes) {
            *out = match (element.get(axis), missing) {
                (Some((text, span)), _) => {
                    parse_float(text).map_err(|message| self.error("bad-value", message, span)).ok()?
                }
                // Its value holds an undefined parameter, which is reported.
                (None, _) if element.has(axis) => return None,
                (None, Some(missing)) => missing,
                (None, None) => {
                    let message = format!("<{}> needs the attribute \"{axis}\"", element.tag);
                    self.error("missing-attribute", message, element.span);
                    return None;
                }
            };
        }
        Some(out)
    }

    fn default(&mut self, element: &Element) {
        if self.check(element, &["name", "value"], &[]) {
            let (name, span) = element.get("name").unwrap_or(("", element.span));
            if name.is_empty() {
                return self.error("bad-value", "a parameter needs a name", span);
            }
            self.definitions.declare(name, element.value("value").unwrap_or(""), span);
        }
    }

    fn alias(&mut self, element: &Element) {
        if self.check(element, &["id", "as"], &[])
            && let (Some((id, id_span)), Some((new, new_span))) = (element.get("id"), element.get("as"))
        {
            self.aliases.push(Alias { id: id.to_owned(), id_span, new: new.to_owned(), new_span });
        }
    }

    fn reference(&mut self, element: &Element, parent: ObjectId) {
        if self.check(element, &["id"], &["name"]) {
            let (id, span) = element.get("id").unwrap_or(("", element.span));
            self.add(parent, element, Value::Reference(id.to_owned()), span);
        }
    }

    fn unknown_element(&mut self, element: &Element) {
        let message = format!("unknown element <{}>", element.tag);
        let mut diagnostic = Diagnostic::error("unknown-element", message).at(element.span, "");
        diagnostic.help.extend(hint(&element.tag, "known", &TAGS));
        self.diagnostics.unsupported(diagnostic, "it is ignored, with all that is in it");
    }

    /// Reports elements and text inside of an element that holds a plain value.
    pub fn refuse_children(&mut self, node: Node<'_, '_>, tag: &str) {
        for child in node.children() {
            if child.is_element() {
                let inner = self.open(child);
                let message = format!("<{}> cannot be inside of <{tag}>", inner.tag);
                self.error("misplaced-element", message, inner.span);
            } else {
                self.refuse_text(child);
            }
        }
    }

    /// Reports text between elements.
    pub fn refuse_text(&mut self, node: Node<'_, '_>) {
        let text = node.text().filter(|_| node.is_text()).unwrap_or("");
        if !text.trim().is_empty() {
            let start = node.range().start + (text.len() - text.trim_start().len());
            let span = self.span(start, (start + text.trim().len()).min(node.range().end));
            let message = format!("text '{}' between elements", shortened(text.trim()));
            let diagnostic = Diagnostic::error("stray-text", message).at(span, "");
            self.diagnostics.unsupported(diagnostic, "it is ignored");
        }
    }
}

fn parse_boolean(text: &str) -> Result<bool, String> {
    match text.trim() {
        t if t.eq_ignore_ascii_case("true") => Ok(true),
        t if t.eq_ignore_ascii_case("false") => Ok(false),
        t => Err(format!("'true' or 'false' expected, got '{}'", shortened(t))),
    }
}
