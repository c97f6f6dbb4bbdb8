//! Parameter lists: `"type name" values`, looked up by name and type, with every unused one reported.
//!
//! Whoever interprets an object asks for each parameter it knows. What was asked for is remembered, so that
//! [`Params::report_unused`] can tell a misspelt name from a wrong type.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use lichtweg::scene::description::{Diagnostic, Span};

use super::color_space::ColorSpace;
use super::report::{Report, suggest};

/// The declared type of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Bool,
    Integer,
    Float,
    Point2,
    Vector2,
    Point3,
    Vector3,
    Normal,
    Rgb,
    Spectrum,
    Blackbody,
    String,
    Texture,
}

impl Type {
    /// All spellings, those of pbrt-v4 first, older ones after.
    const SPELLINGS: [(&'static str, Self); 17] = [
        ("bool", Self::Bool),
        ("integer", Self::Integer),
        ("float", Self::Float),
        ("point2", Self::Point2),
        ("vector2", Self::Vector2),
        ("point3", Self::Point3),
        ("vector3", Self::Vector3),
        ("normal", Self::Normal),
        ("rgb", Self::Rgb),
        ("spectrum", Self::Spectrum),
        ("blackbody", Self::Blackbody),
        ("string", Self::String),
        ("texture", Self::Texture),
        ("point", Self::Point3),
        ("vector", Self::Vector3),
        ("color", Self::Rgb),
        ("normal3", Self::Normal),
    ];

    /// The type of a spelling.
    pub fn parse(text: &str) -> Option<Self> {
        Self::SPELLINGS.iter().find(|(name, _)| *name == text).map(|(_, t)| *t)
    }

    /// All spellings.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Self::SPELLINGS.iter().map(|(name, _)| *name)
    }

    /// Its spelling in pbrt-v4.
    pub fn name(self) -> &'static str {
        Self::SPELLINGS.iter().find(|(_, t)| *t == self).map_or("", |(name, _)| name)
    }

    /// How many numbers make one value.
    fn numbers_per_value(self) -> usize {
        match self {
            Self::Point2 | Self::Vector2 => 2,
            Self::Point3 | Self::Vector3 | Self::Normal | Self::Rgb => 3,
            _ => 1,
        }
    }
}

/// The values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Numbers(Vec<f32>),
    Integers(Vec<i32>),
    Strings(Vec<String>),
    Bools(Vec<bool>),
}

impl Values {
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(v) => v.len(),
            Self::Integers(v) => v.len(),
            Self::Strings(v) => v.len(),
            Self::Bools(v) => v.len(),
        }
    }
}

/// One parameter.
#[derive(Debug)]
pub(super) struct Param {
    pub name: String,
    pub kind: Type,
    pub values: Values,
    /// Its declaration.
    pub span: Span,
    /// Its values.
    pub values_span: Span,
    /// The colour space that was current where it was stated.
    pub color_space: ColorSpace,
    used: Cell<bool>,
}

impl Param {
    pub fn new(name: String, kind: Type, values: Values, spans: [Span; 2], color_space: ColorSpace) -> Self {
        let [span, values_span] = spans;
        Self { name, kind, values, span, values_span, color_space, used: Cell::new(false) }
    }

    /// Its numbers; empty if it has none.
    pub fn numbers(&self) -> &[f32] {
        match &self.values {
            Values::Numbers(v) => v,
            _ => &[],
        }
    }

    /// Its strings; empty if it has none.
    pub fn strings(&self) -> &[String] {
        match &self.values {
            Values::Strings(v) => v,
            _ => &[],
        }
    }

    /// Whether anything has asked for it.
    pub fn is_used(&self) -> bool {
        self.used.get()
    }

    /// An error about its values.
    pub fn bad_value(&self, message: impl Into<String>, label: impl Into<String>) -> Diagnostic {
        Diagnostic::error("bad-value", message).at(self.values_span, label)
    }
}

/// The parameters of one object.
#[derive(Debug, Default)]
pub(super) struct Params {
    own: Vec<Param>,
    /// Defaults from `Attribute` directives, which may go unused.
    inherited: Rc<Vec<Rc<Param>>>,
    asked: RefCell<Vec<(&'static str, Type)>>,
}

impl Params {
    pub fn new(own: Vec<Param>, inherited: Rc<Vec<Rc<Param>>>) -> Self {
        Self { own, inherited, asked: RefCell::default() }
    }

    /// The parameters themselves, to become defaults of others.
    pub fn into_own(self) -> Vec<Param> {
        self.own
    }

    /// The parameter of a name and type; of several, the last. Marks it as used.
    pub fn find(&self, name: &'static str, kind: Type) -> Option<&Param> {
        self.find_any(name, &[kind])
    }

    /// The parameter of a name and one of several types; of several, the last. Marks it as used.
    pub fn find_any(&self, name: &'static str, kinds: &[Type]) -> Option<&Param> {
        let mut asked = self.asked.borrow_mut();
        for kind in kinds {
            if !asked.contains(&(name, *kind)) {
                asked.push((name, *kind));
            }
        }
        drop(asked);
        let own = self.own.iter().rev();
        let mut found = own
            .chain(self.inherited.iter().rev().map(|p| &**p))
            .filter(|p| p.name == name && kinds.contains(&p.kind));
        let first = found.next()?;
        first.used.set(true);
        // An own one that a later one overrides is no unknown parameter.
        found.for_each(|p| p.used.set(true));
        Some(first)
    }

    /// The one string of a name, for looking ahead: no check, no mark.
    pub fn peek_string(&self, name: &str) -> Option<&str> {
        let own = self.own.iter().rev();
        own.chain(self.inherited.iter().rev().map(|p| &**p))
            .find(|p| p.name == name && p.kind == Type::String)
            .and_then(|p| p.strings().first())
            .map(String::as_str)
    }

    /// Whether a parameter of the name is there, of any type; not marked as used.
    pub fn has(&self, name: &str) -> bool {
        self.own.iter().any(|p| p.name == name) || self.inherited.iter().any(|p| p.name == name)
    }

    /// Accepts a parameter that changes nothing here (a matter of speed, or of another program's output).
    pub fn accept(&self, name: &'static str, kind: Type) {
        self.find(name, kind);
    }

    /// Accepts everything: the object as a whole has been reported.
    pub fn accept_all(&self) {
        self.own.iter().for_each(|p| p.used.set(true));
    }

    /// One number.
    pub fn float(&self, name: &'static str, default: f32, report: &mut Report) -> f32 {
        self.float_if(name, report).unwrap_or(default)
    }

    /// One number, where it is stated.
    pub fn float_if(&self, name: &'static str, report: &mut Report) -> Option<f32> {
        let param = self.one(name, Type::Float, report)?;
        param.numbers().first().copied()
    }

    /// One number for which `holds`; otherwise says that it `must` and takes the default.
    pub fn float_where(
        &self,
        name: &'static str,
        default: f32,
        holds: impl Fn(f32) -> bool,
        must: &str,
        report: &mut Report,
    ) -> f32 {
        let Some(value) = self.float_if(name, report) else { return default };
        if holds(value) {
            return value;
        }
        let message = format!("\"{name}\" {must}, but is {value}");
        self.complain(name, Type::Float, message, must, report);
        default
    }

    /// One integer of at least `least`.
    pub fn integer(&self, name: &'static str, default: i32, least: i32, report: &mut Report) -> i32 {
        let must = format!("must be at least {least}");
        self.integer_where(name, default, |value| value >= least, &must, report)
    }

    /// One integer for which `holds`; otherwise says that it `must` and takes the default.
    pub fn integer_where(
        &self,
        name: &'static str,
        default: i32,
        holds: impl Fn(i32) -> bool,
        must: &str,
        report: &mut Report,
    ) -> i32 {
        let Some(param) = self.one(name, Type::Integer, report) else { return default };
        let Values::Integers(values) = &param.values else { return default };
        let value = values.first().copied().unwrap_or(default);
        if holds(value) {
            return value;
        }
        self.complain(name, Type::Integer, format!("\"{name}\" {must}, but is {value}"), must, report);
        default
    }

    /// One truth value.
    pub fn bool(&self, name: &'static str, default: bool, report: &mut Report) -> bool {
        match self.one(name, Type::Bool, report).map(|p| &p.values) {
            Some(Values::Bools(values)) => values.first().copied().unwrap_or(default),
            _ => default,
        }
    }

    /// One string.
    pub fn string(&self, name: &'static str, report: &mut Report) -> Option<&str> {
        self.one(name, Type::String, report)?.strings().first().map(String::as_str)
    }

    /// One of a few words; the first is the default.
    pub fn choice<T: Copy>(&self, name: &'static str, choices: &[(&str, T)], report: &mut Report) -> T {
        let (_, default) = choices[0];
        let Some(word) = self.string(name, report) else { return default };
        if let Some((_, value)) = choices.iter().find(|(w, _)| *w == word) {
            return *value;
        }
        if let Some(param) = self.find(name, Type::String) {
            let known: Vec<&str> = choices.iter().map(|(w, _)| *w).collect();
            let diagnostic =
                param.bad_value(format!("\"{word}\" is not a value of \"{name}\""), "unknown value");
            report.substitute(suggest(diagnostic, word, known), "the default is used");
        }
        default
    }

    /// Three numbers of the type `kind`.
    pub fn triple(&self, name: &'static str, kind: Type, default: [f64; 3], report: &mut Report) -> [f64; 3] {
        match self.one(name, kind, report).map(Param::numbers) {
            Some(&[x, y, z]) => [x, y, z].map(f64::from),
            _ => default,
        }
    }

    /// Any number of values of the type `kind`, complete ones.
    pub fn array(&self, name: &'static str, kind: Type, report: &mut Report) -> Option<&Param> {
        let param = self.find(name, kind)?;
        let per_value = kind.numbers_per_value();
        let count = param.values.len();
        if count == 0 {
            report.substitute(
                param.bad_value(format!("\"{name}\" has no values"), "empty"),
                "the default is used",
            );
            return None;
        }
        if !count.is_multiple_of(per_value) {
            let message = format!("\"{name}\" has {count} numbers, which is no multiple of {per_value}");
            report.substitute(
                param.bad_value(message, format!("a {} is {per_value} numbers", kind.name())),
                "the default is used",
            );
            return None;
        }
        Some(param)
    }

    /// The parameter of a name and type, which must have exactly one value.
    pub fn one(&self, name: &'static str, kind: Type, report: &mut Report) -> Option<&Param> {
        let param = self.find(name, kind)?;
        let (count, want) = (param.values.len(), kind.numbers_per_value());
        if count == want {
            return Some(param);
        }
        let message = format!("\"{name}\" takes {}, but has {count}", values_of(want, kind));
        report.substitute(
            param.bad_value(message, format!("expected {}", values_of(want, kind))),
            "the default is used",
        );
        None
    }

    /// Reports what was never asked for; `object` names the object, such as `Shape "sphere"`.
    pub fn report_unused(&self, object: &str, report: &mut Report) {
        let asked = self.asked.borrow();
        for param in self.own.iter().filter(|p| !p.used.get()) {
            let types: Vec<&str> =
                asked.iter().filter(|(n, _)| *n == param.name).map(|(_, t)| t.name()).collect();
            report.substitute(
                if types.is_empty() {
                    let message = format!("{object} has no parameter \"{}\"", param.name);
                    let diagnostic =
                        Diagnostic::error("unknown-parameter", message).at(param.span, "not known here");
                    suggest(diagnostic, &param.name, asked.iter().map(|(n, _)| *n))
                } else {
                    let message = format!(
                        "parameter \"{}\" of {object} is of type {}, not {}",
                        param.name,
                        list(&types),
                        param.kind.name()
                    );
                    let help = format!("write \"{} {}\"", types[0], param.name);
                    Diagnostic::error("wrong-type", message).at(param.span, "wrong type").help(help)
                },
                "it is left out",
            );
        }
    }

    fn complain(&self, name: &'static str, kind: Type, message: String, label: &str, report: &mut Report) {
        if let Some(param) = self.find(name, kind) {
            report.substitute(param.bad_value(message, label), "the default is used");
        }
    }
}

/// "a, b or c".
fn list(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [most @ .., last] => format!("{} or {last}", most.join(", ")),
    }
}

fn values_of(count: usize, kind: Type) -> String {
    match (kind, count) {
        (Type::String | Type::Texture, _) => "one string".to_owned(),
        (Type::Bool, _) => "one of true and false".to_owned(),
        (_, 1) => "one number".to_owned(),
        _ => format!("{count} numbers"),
    }
}
