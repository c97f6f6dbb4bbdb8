//! What a pbrt file has said so far: the graphics state, and the objects it was attached to.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use lichtweg::scene::description::Span;
use lichtweg_ray::Placement;
use lichtweg_ray::math::Affine;

use super::color_space::ColorSpace;
use super::params::{Param, Params};

/// An object as stated: its type, and its parameters.
#[derive(Debug, Default)]
pub(super) struct Entity {
    /// What introduced it, such as `Shape`.
    pub directive: &'static str,
    /// Its type, such as `sphere`.
    pub kind: String,
    /// Where its type stands.
    pub span: Span,
    pub params: Params,
}

impl Entity {
    /// Its name in messages, such as `Shape "sphere"`.
    pub fn title(&self) -> String {
        format!("{} \"{}\"", self.directive, self.kind)
    }
}

/// Which material a shape has.
#[derive(Clone, Debug, Default)]
pub(super) enum MaterialChoice {
    /// None was stated: grey diffuse.
    #[default]
    Default,
    /// An index into [`Statements::materials`].
    Index(usize),
    /// A name, and where it was used.
    Named(Rc<str>, Span),
}

/// A shape with the state it was stated in.
#[derive(Debug)]
pub(super) struct ShapeStatement {
    pub entity: Entity,
    pub to_world: Placement,
    pub reverse_orientation: bool,
    pub material: MaterialChoice,
    /// An index into [`Statements::area_lights`].
    pub area_light: Option<usize>,
}

/// A texture with its name.
#[derive(Debug)]
pub(super) struct TextureStatement {
    pub name: String,
    pub is_float: bool,
    pub entity: Entity,
}

/// A material with its name, if it has one.
#[derive(Debug)]
pub(super) struct MaterialStatement {
    pub name: Option<String>,
    pub entity: Entity,
}

/// A light with the transform it was stated under.
#[derive(Debug)]
pub(super) struct LightStatement {
    pub entity: Entity,
    pub to_world: Affine,
}

/// What stands between `ObjectBegin` and `ObjectEnd`.
#[derive(Debug)]
pub(super) struct ObjectStatement {
    pub name: String,
    pub shapes: Vec<ShapeStatement>,
}

/// A use of an object.
#[derive(Debug)]
pub(super) struct InstanceStatement {
    pub object: String,
    pub span: Span,
    pub to_world: Placement,
}

/// Everything a file states, in its order.
#[derive(Debug, Default)]
pub(super) struct Statements {
    /// The camera, and the transform from its space, which has x to the right, to the world.
    pub camera: Option<(Entity, Placement)>,
    pub film: Option<Entity>,
    pub sampler: Option<Entity>,
    pub filter: Option<Entity>,
    pub integrator: Option<Entity>,
    /// From `Option "seed"`.
    pub seed: i64,
    /// All defaults from `Attribute`, with their target.
    pub attributes: Vec<(&'static str, Rc<Param>)>,
    pub textures: Vec<TextureStatement>,
    /// Whether it is a float texture, and its name.
    pub texture_names: HashSet<(bool, String)>,
    pub materials: Vec<MaterialStatement>,
    pub named_materials: HashMap<String, usize>,
    pub lights: Vec<LightStatement>,
    pub shapes: Vec<ShapeStatement>,
    pub area_lights: Vec<Entity>,
    pub object_names: HashSet<String>,
    pub objects: Vec<ObjectStatement>,
    pub instances: Vec<InstanceStatement>,
}

impl Statements {
    /// All shapes, those of objects once.
    pub fn all_shapes(&self) -> impl Iterator<Item = &ShapeStatement> {
        self.shapes.iter().chain(self.objects.iter().flat_map(|o| &o.shapes))
    }
}

/// What `Attribute` can give defaults to.
pub(super) const ATTRIBUTE_TARGETS: [&str; 5] = ["shape", "light", "material", "medium", "texture"];

/// The state that `AttributeBegin` saves and `AttributeEnd` restores.
#[derive(Clone, Debug, Default)]
pub(super) struct Graphics {
    /// From the current space to the world (before `WorldBegin`: from the world to the camera), when the shutter opens and when it
    /// closes.
    pub transforms: [Affine; 2],
    /// Which of the two the transform directives change.
    pub inactive: [bool; 2],
    pub reverse_orientation: bool,
    pub material: MaterialChoice,
    pub area_light: Option<usize>,
    pub color_space: ColorSpace,
    /// Defaults by target, see [`ATTRIBUTE_TARGETS`].
    pub attributes: [Rc<Vec<Rc<Param>>>; 5],
}

impl Graphics {
    /// Applies `change` to the active transforms.
    pub fn transform(&mut self, change: impl Fn(&Affine) -> Affine) {
        for (transform, inactive) in self.transforms.iter_mut().zip(self.inactive) {
            if !inactive {
                *transform = change(transform);
            }
        }
    }
}

/// What the innermost open block is, and where it was opened.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub kind: BlockKind,
    pub span: Span,
    pub saved: Graphics,
}

/// Kinds of blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum BlockKind {
    Attribute,
    /// The older form, which saves as much.
    Transform,
    /// With the object's name; `None` where the name was refused.
    Object(Option<String>),
}

impl BlockKind {
    /// The directive that opens and the one that closes it.
    pub fn directives(&self) -> [&'static str; 2] {
        match self {
            Self::Attribute => ["AttributeBegin", "AttributeEnd"],
            Self::Transform => ["TransformBegin", "TransformEnd"],
            Self::Object(_) => ["ObjectBegin", "ObjectEnd"],
        }
    }
}
