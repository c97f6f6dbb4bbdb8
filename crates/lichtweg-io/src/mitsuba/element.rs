//! An XML element with its attributes, `$parameters` replaced, and where each is written.

use lichtweg::scene::description::{Diagnostic, Span};
use roxmltree::Node;

use super::definitions::ExpandError;
use super::suggest::hint;
use super::walk::Walk;

/// An element's start tag.
pub(super) struct Element {
    pub tag: String,
    /// Of the tag's name.
    pub span: Span,
    attributes: Vec<Attribute>,
}

/// An attribute.
pub(super) struct Attribute {
    name: String,
    name_span: Span,
    /// `None` where a parameter in it could not be replaced, which is already reported.
    value: Option<String>,
    /// Of the value, without quotes.
    pub span: Span,
}

impl Element {
    /// An attribute's value.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.attribute(name)?.value.as_deref()
    }

    /// An attribute that has a value.
    pub fn get(&self, name: &str) -> Option<(&str, Span)> {
        let attribute = self.attribute(name)?;
        Some((attribute.value.as_deref()?, attribute.span))
    }

    /// Whether the attribute is there, be its value right or wrong.
    pub fn has(&self, name: &str) -> bool {
        self.attribute(name).is_some()
    }

    /// Where the attribute's value is, or the element.
    pub fn span_of(&self, name: &str) -> Span {
        self.attribute(name).map_or(self.span, |a| a.span)
    }

    fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }
}

impl Walk<'_> {
    /// Reads a start tag; undefined parameters are reported.
    pub fn open(&mut self, node: Node<'_, '_>) -> Element {
        let tag = node.tag_name().name().to_owned();
        let start = node.range().start + 1;
        let span = self.span(start, start + tag.len());
        let attributes = node
            .attributes()
            .map(|a| {
                let (name, value) = (a.range_qname(), a.range_value());
                let span = self.span(value.start, value.end);
                Attribute {
                    name: a.name().to_owned(),
                    name_span: self.span(name.start, name.end),
                    value: self.expand(a.value(), span),
                    span,
                }
            })
            .collect();
        Element { tag, span, attributes }
    }

    /// Reports attributes that are neither `required` nor `optional`, and required ones that are missing. Whether all
    /// required ones are there with a value.
    pub fn check(&mut self, element: &Element, required: &[&str], optional: &[&str]) -> bool {
        let known = [required, optional].concat();
        for a in element.attributes.iter().filter(|a| !known.contains(&a.name.as_str())) {
            let message = format!("unknown attribute \"{}\" of <{}>", a.name, element.tag);
            let mut diagnostic = Diagnostic::error("unknown-attribute", message).at(a.name_span, "");
            diagnostic.help.extend(hint(&a.name, "known", &known));
            self.diagnostics.unsupported(diagnostic, "it is ignored");
        }
        for name in required.iter().filter(|n| !element.has(n)) {
            let message = format!("<{}> needs the attribute \"{name}\"", element.tag);
            self.diagnostics.push(Diagnostic::error("missing-attribute", message).at(element.span, ""));
        }
        required.iter().all(|name| element.value(name).is_some())
    }

    fn expand(&mut self, text: &str, span: Span) -> Option<String> {
        match self.definitions.expand(text) {
            Ok(value) => Some(value),
            Err(ExpandError::Undefined(name)) => {
                let message = format!("undefined parameter ${name}");
                let mut diagnostic = Diagnostic::error("undefined-parameter", message).at(span, "");
                diagnostic.help.push(
                    hint(&name, "defined", &self.definitions.names())
                        .unwrap_or_else(|| "declare it by <default>, or give it by -D".to_owned()),
                );
                self.diagnostics.push(diagnostic);
                None
            }
            Err(ExpandError::TooLong) => {
                let diagnostic = Diagnostic::error(
                    "parameter-too-long",
                    "the parameters in this value expand to over a megabyte",
                );
                self.diagnostics.push(diagnostic.at(span, ""));
                None
            }
        }
    }
}
