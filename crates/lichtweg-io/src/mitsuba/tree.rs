//! The scene as its XML states it: objects with typed parameters, before anything is made of them.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use lichtweg::scene::description::{Span, SpectrumDescription};
use lichtweg_ray::math::{Affine, Motion};

/// Index of an object in a [`Tree`]; the scene itself is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct ObjectId(pub usize);

impl ObjectId {
    /// The root.
    pub const SCENE: Self = Self(0);
}

/// All objects of a scene and the names given to them.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub objects: Vec<Object>,
    pub ids: HashMap<String, ObjectId>,
}

impl Tree {
    pub fn get(&self, id: ObjectId) -> &Object {
        &self.objects[id.0]
    }
}

/// What kind of thing an object is, from its tag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Class {
    Scene,
    Integrator,
    Sensor,
    Film,
    Filter,
    Sampler,
    Bsdf,
    Texture,
    Emitter,
    Shape,
    /// Media, volumes, phase functions and subsurface models: known, and not rendered.
    Volumetric,
}

impl Class {
    /// The class of a tag, in any of Mitsuba's versions.
    pub fn of_tag(tag: &str) -> Option<Self> {
        Some(match tag {
            "scene" => Self::Scene,
            "integrator" => Self::Integrator,
            "sensor" | "camera" => Self::Sensor,
            "film" => Self::Film,
            "rfilter" => Self::Filter,
            "sampler" => Self::Sampler,
            "bsdf" => Self::Bsdf,
            "texture" => Self::Texture,
            "emitter" | "luminaire" => Self::Emitter,
            "shape" => Self::Shape,
            "medium" | "volume" | "phase" | "subsurface" => Self::Volumetric,
            _ => return None,
        })
    }

    /// What to call it in a message.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Integrator => "integrator",
            Self::Sensor => "sensor",
            Self::Film => "film",
            Self::Filter => "reconstruction filter",
            Self::Sampler => "sampler",
            Self::Bsdf => "bsdf",
            Self::Texture => "texture",
            Self::Emitter => "emitter",
            Self::Shape => "shape",
            Self::Volumetric => "participating medium",
        }
    }
}

/// An object: `<bsdf type="diffuse" id="grey"> ... </bsdf>`.
#[derive(Debug)]
pub(super) struct Object {
    pub class: Class,
    /// Its `type`.
    pub plugin: String,
    /// Where the type is written.
    pub plugin_span: Span,
    /// Where the object starts.
    pub span: Span,
    pub id: Option<String>,
    /// It comes from a file for Mitsuba 0.x.
    pub legacy: bool,
    /// Folders in which its files are looked for, in this order.
    pub search: Arc<Vec<PathBuf>>,
    pub properties: Vec<Property>,
    /// The parameter names that its translation has asked for, to suggest in place of unknown ones.
    pub asked: RefCell<Vec<&'static str>>,
}

/// A parameter or a nested object.
#[derive(Debug)]
pub(super) struct Property {
    /// Empty where it has none, as nested objects often do.
    pub name: String,
    pub name_span: Span,
    pub value: Value,
    pub value_span: Span,
    /// Somebody has asked for it.
    pub queried: Cell<bool>,
}

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    Vector([f64; 3]),
    Color(SpectrumDescription),
    Transform(Affine),
    /// Transforms at ascending times.
    Animation(Motion),
    Object(ObjectId),
    /// To the object of this id; resolved into `Object` once all files are read.
    Reference(String),
    /// Wrong, and already reported.
    Invalid,
}

impl Value {
    /// What to call it in a message.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Float(_) => "a float",
            Self::Integer(_) => "an integer",
            Self::Boolean(_) => "a boolean",
            Self::Text(_) => "a string",
            Self::Vector(_) => "a vector",
            Self::Color(_) => "a colour",
            Self::Transform(_) => "a transform",
            Self::Animation(_) => "an animated transform",
            Self::Object(_) | Self::Reference(_) => "an object",
            Self::Invalid => "an invalid value",
        }
    }
}
