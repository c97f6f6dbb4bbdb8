//! Typed access to an object's parameters. Wrong types and ranges are reported, and the default is used.

use std::sync::Arc;

use lichtweg::scene::description::{Diagnostic, Span, SpectrumDescription};
use lichtweg_ray::Placement;
use lichtweg_ray::math::Affine;

use super::number::shortened;
use super::suggest::hint;
use super::translate::{Translator, title};
use super::tree::{Class, Object, ObjectId, Property, Value};

impl Object {
    /// A parameter, if it is given; marks it as known.
    pub fn property(&self, name: &'static str) -> Option<&Property> {
        self.asked.borrow_mut().push(name);
        let found = self.properties.iter().find(|p| p.name == name)?;
        found.queried.set(true);
        Some(found)
    }

    /// Accepts parameters that change nothing about the scene.
    pub fn ignore(&self, names: &[&'static str]) {
        for name in names {
            self.property(name);
        }
    }

    /// Where a parameter's value is written, or the object's type.
    pub fn span_of(&self, name: &str) -> Span {
        self.properties.iter().find(|p| p.name == name).map_or(self.plugin_span, |p| p.value_span)
    }
}

impl<'a> Translator<'a> {
    fn wrong_type(&mut self, property: &Property, expected: &str) {
        if property.value != Value::Invalid {
            let message =
                format!("\"{}\": {expected} expected, got {}", property.name, property.value.kind());
            self.error("wrong-type", message, property.value_span);
        }
    }

    fn missing(&mut self, object: &Object, name: &str) {
        let message = format!("{} needs the parameter \"{name}\"", title(object));
        self.error("missing-parameter", message, object.plugin_span);
    }

    /// A number, if it is given and right.
    pub fn optional_float(&mut self, object: &'a Object, name: &'static str) -> Option<f32> {
        let property = object.property(name)?;
        let value = match property.value {
            Value::Float(v) => v,
            Value::Integer(v) => v as f64,
            _ => {
                self.wrong_type(property, "a float");
                return None;
            }
        };
        if !(value as f32).is_finite() {
            self.error(
                "out-of-range",
                format!("{value:e} is beyond the range of numbers"),
                property.value_span,
            );
            return None;
        }
        Some(value as f32)
    }

    /// A number.
    pub fn float(&mut self, object: &'a Object, name: &'static str, default: f32) -> f32 {
        self.optional_float(object, name).unwrap_or(default)
    }

    /// A number for which `allowed` holds; `range` says what that is, such as "greater than 0".
    pub fn float_in(
        &mut self,
        object: &'a Object,
        name: &'static str,
        default: f32,
        range: &str,
        allowed: impl Fn(f32) -> bool,
    ) -> f32 {
        let Some(value) = self.optional_float(object, name) else { return default };
        if allowed(value) {
            return value;
        }
        let message = format!("\"{name}\" must be {range}, and is {value}");
        self.error("out-of-range", message, object.span_of(name));
        default
    }

    /// A whole number from `low` to `high`.
    pub fn integer_in(
        &mut self,
        object: &'a Object,
        name: &'static str,
        default: i64,
        low: i64,
        high: i64,
    ) -> i64 {
        let Some(property) = object.property(name) else { return default };
        match property.value {
            Value::Integer(v) if (low..=high).contains(&v) => v,
            Value::Integer(v) => {
                let range = match (low, high) {
                    (low, i64::MAX) => format!("at least {low}"),
                    (low, high) => format!("between {low} and {high}"),
                };
                let message = format!("\"{name}\" must be {range}, and is {v}");
                self.error("out-of-range", message, property.value_span);
                default
            }
            _ => {
                self.wrong_type(property, "an integer");
                default
            }
        }
    }

    /// True or false.
    pub fn boolean(&mut self, object: &'a Object, name: &'static str, default: bool) -> bool {
        let Some(property) = object.property(name) else { return default };
        match property.value {
            Value::Boolean(v) => v,
            _ => {
                self.wrong_type(property, "a boolean");
                default
            }
        }
    }

    /// A text, if it is given.
    pub fn text(&mut self, object: &'a Object, name: &'static str) -> Option<(&'a str, Span)> {
        let property = object.property(name)?;
        match &property.value {
            Value::Text(text) => Some((text, property.value_span)),
            _ => {
                self.wrong_type(property, "a string");
                None
            }
        }
    }

    /// A text that must be given.
    pub fn required_text(&mut self, object: &'a Object, name: &'static str) -> Option<(&'a str, Span)> {
        if object.property(name).is_none() {
            self.missing(object, name);
        }
        self.text(object, name)
    }

    /// One of a few words, in any case.
    pub fn choice<T: Copy>(
        &mut self,
        object: &'a Object,
        name: &'static str,
        default: T,
        choices: &[(&'static str, T)],
    ) -> T {
        let Some((text, span)) = self.text(object, name) else { return default };
        if let Some((_, value)) = choices.iter().find(|(word, _)| word.eq_ignore_ascii_case(text)) {
            return *value;
        }
        let words: Vec<&str> = choices.iter().map(|c| c.0).collect();
        let message = format!("\"{name}\" cannot be '{}'", shortened(text));
        let mut diagnostic = Diagnostic::error("unknown-value", message).at(span, "");
        diagnostic.help.extend(hint(text, "possible", &words));
        self.diagnostics.push(diagnostic);
        default
    }

    /// Three coordinates, if they are given.
    pub fn vector(&mut self, object: &'a Object, name: &'static str) -> Option<[f64; 3]> {
        let property = object.property(name)?;
        match property.value {
            Value::Vector(v) if v.iter().all(|c| (*c as f32).is_finite()) => Some(v),
            Value::Vector(_) => {
                let message = format!("\"{name}\" is beyond the range of numbers");
                self.error("out-of-range", message, property.value_span);
                None
            }
            _ => {
                self.wrong_type(property, "a point or vector");
                None
            }
        }
    }

    /// A transform, if it is given.
    pub fn transform(&mut self, object: &'a Object, name: &'static str) -> Option<Affine> {
        let property = object.property(name)?;
        match &property.value {
            Value::Transform(t) => Some(*t),
            Value::Animation(motion) => {
                let message = format!("{} cannot move", title(object));
                let diagnostic =
                    Diagnostic::error("unsupported-animation", message).at(property.value_span, "");
                self.diagnostics.unsupported(diagnostic, "it stays at the first place of the animation");
                motion.keys().next().map(|(_, map)| *map)
            }
            _ => {
                self.wrong_type(property, "a transform");
                None
            }
        }
    }

    /// A transform that may be animated and can be undone; the identity where none is given.
    pub fn placement(&mut self, object: &'a Object, name: &'static str) -> Placement {
        if let Some(Property { value: Value::Animation(motion), .. }) = object.property(name) {
            return Placement::Moving(Arc::new(motion.clone()));
        }
        Placement::Fixed(self.invertible(object, name))
    }

    /// A transform that can be undone; the identity where none is given.
    pub fn invertible(&mut self, object: &'a Object, name: &'static str) -> Affine {
        let Some(found) = self.transform(object, name) else { return Affine::IDENTITY };
        if found.inverse().is_some() {
            return found;
        }
        let message = format!("\"{name}\" is singular: it flattens space");
        self.error("bad-transform", message, object.span_of(name));
        Affine::IDENTITY
    }

    /// A colour that does not vary over a surface.
    pub fn spectrum(
        &mut self,
        object: &'a Object,
        name: &'static str,
        default: SpectrumDescription,
    ) -> SpectrumDescription {
        let Some(property) = object.property(name) else { return default };
        match &property.value {
            Value::Color(c) => c.clone(),
            Value::Float(v) => SpectrumDescription::Constant(*v as f32),
            Value::Integer(v) => SpectrumDescription::Constant(*v as f32),
            Value::Object(id) if self.tree.get(*id).class == Class::Texture => {
                match self.nested(*id, |this, texture| this.spectrum_object(texture)).flatten() {
                    Some(found) => found,
                    None => default,
                }
            }
            _ => {
                self.wrong_type(property, "a colour");
                default
            }
        }
    }

    /// The light a source emits: a colour without negative parts.
    pub fn emission(&mut self, object: &'a Object, name: &'static str) -> SpectrumDescription {
        let found = self.spectrum(object, name, SpectrumDescription::Constant(1.0));
        self.refuse_negative(object, name, &found);
        found
    }

    /// Reports a colour with negative or unrepresentable parts.
    pub fn refuse_negative(&mut self, object: &Object, name: &str, spectrum: &SpectrumDescription) {
        if let Some(v) = values(spectrum).iter().find(|v| !(**v >= 0.0 && v.is_finite())) {
            let message = format!("\"{name}\" must not be negative, and has {v}");
            self.error("out-of-range", message, object.span_of(name));
        }
    }

    /// The nested objects of a class, named or not.
    pub fn nested_of(&mut self, object: &'a Object, class: Class) -> Vec<(ObjectId, Span)> {
        let of_class =
            |p: &&Property| matches!(p.value, Value::Object(id) if self.tree.get(id).class == class);
        let found = object.properties.iter().filter(of_class).filter(|p| !p.queried.replace(true));
        found
            .filter_map(|p| if let Value::Object(id) = p.value { Some((id, p.value_span)) } else { None })
            .collect()
    }

    /// The one nested object of a class, if any; further ones are reported.
    pub fn single(&mut self, object: &'a Object, class: Class) -> Option<ObjectId> {
        let found = self.nested_of(object, class);
        for (_, span) in found.iter().skip(1) {
            let message = format!("{} takes one {}, and has more", title(object), class.name());
            self.error("too-many-objects", message, *span);
        }
        found.first().map(|(id, _)| *id)
    }
}

/// The numbers in a colour, for range checks.
pub(super) fn values(spectrum: &SpectrumDescription) -> &[f32] {
    match spectrum {
        SpectrumDescription::Constant(v) => std::slice::from_ref(v),
        SpectrumDescription::Rgb(rgb) => rgb,
        SpectrumDescription::Sampled { values, .. } => values,
        SpectrumDescription::Blackbody { scale, .. } => std::slice::from_ref(scale),
        SpectrumDescription::Conductor { .. } => &[],
    }
}
