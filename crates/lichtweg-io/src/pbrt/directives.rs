//! The directives of pbrt-v4, and what each does to the graphics state (pbrt's `parser.cpp` and `scene.cpp`).
//!
//! Blocks: options come before `WorldBegin`, the scene after it. `TransformBegin` saves all of the state, as in
//! pbrt-v4. `WorldEnd` of older versions is accepted.
//!
//! Limits: transforms are affine; lights, and shapes within objects, do not move.

use std::rc::Rc;
use std::sync::Arc;

use lichtweg::scene::description::{Diagnostic, Span};
use lichtweg_ray::Placement;
use lichtweg_ray::math::{Affine, Motion};

use super::blocks::{close, object_begin, object_instance, open, open_object, report_open_block};
use super::params::Params;
use super::parser::{Parser, Reported};
use super::report::suggest;
use super::settings::{color_space, medium_interface, option};
use super::state::{
    ATTRIBUTE_TARGETS, BlockKind, Entity, LightStatement, MaterialChoice, MaterialStatement, ShapeStatement,
    TextureStatement,
};
use super::token::{Kind, Token};
use super::transform;

/// Where a directive may stand.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Options,
    World,
    Anywhere,
}

/// All directives, and where they may stand.
const DIRECTIVES: [(&str, Place); 41] = [
    ("Accelerator", Place::Options),
    ("ActiveTransform", Place::Anywhere),
    ("AreaLightSource", Place::World),
    ("Attribute", Place::Anywhere),
    ("AttributeBegin", Place::World),
    ("AttributeEnd", Place::World),
    ("Camera", Place::Options),
    ("ColorSpace", Place::Anywhere),
    ("ConcatTransform", Place::Anywhere),
    ("CoordSysTransform", Place::Anywhere),
    ("CoordinateSystem", Place::Anywhere),
    ("Film", Place::Options),
    ("Identity", Place::Anywhere),
    ("Import", Place::World),
    ("Include", Place::Anywhere),
    ("Integrator", Place::Options),
    ("LightSource", Place::World),
    ("LookAt", Place::Anywhere),
    ("MakeNamedMaterial", Place::World),
    ("MakeNamedMedium", Place::Anywhere),
    ("Material", Place::World),
    ("MediumInterface", Place::Anywhere),
    ("NamedMaterial", Place::World),
    ("ObjectBegin", Place::World),
    ("ObjectEnd", Place::World),
    ("ObjectInstance", Place::World),
    ("Option", Place::Anywhere),
    ("PixelFilter", Place::Options),
    ("ReverseOrientation", Place::World),
    ("Rotate", Place::Anywhere),
    ("Sampler", Place::Options),
    ("Scale", Place::Anywhere),
    ("Shape", Place::World),
    ("Texture", Place::World),
    ("Transform", Place::Anywhere),
    ("TransformBegin", Place::World),
    ("TransformEnd", Place::World),
    ("TransformTimes", Place::Options),
    ("Translate", Place::Anywhere),
    ("WorldBegin", Place::Options),
    ("WorldEnd", Place::World),
];

/// Whether a word is a directive.
pub(super) fn is_known(word: &str) -> bool {
    place_of(word).is_some()
}

fn place_of(word: &str) -> Option<Place> {
    DIRECTIVES.iter().find(|(name, _)| *name == word).map(|(_, place)| *place)
}

/// Reads and obeys one directive; false at the end of the file.
pub(super) fn next(parser: &mut Parser) -> Result<bool, Reported> {
    let Some(token) = parser.next_token() else {
        return if parser.take_broken() { Err(Reported) } else { Ok(false) };
    };
    let span = parser.span_of(token);
    let word = parser.text(token).to_owned();
    let Some(place) = place_of(&word).filter(|_| token.kind == Kind::Word) else {
        return Err(unknown(parser, token, &word));
    };
    check_place(parser, &word, place, span);
    obey(parser, &word, span)?;
    Ok(true)
}

fn unknown(parser: &mut Parser, token: Token, word: &str) -> Reported {
    let span = parser.span_of(token);
    parser.report.substitute(
        if token.kind == Kind::Word && word.starts_with(|c: char| c.is_alphabetic()) {
            let diagnostic = Diagnostic::error("unknown-directive", format!("{word} is no directive"));
            suggest(diagnostic.at(span, "unknown directive"), word, DIRECTIVES.iter().map(|(name, _)| *name))
        } else {
            Diagnostic::error("syntax", format!("expected a directive, found {word}"))
                .at(span, "belongs to nothing")
        },
        "it is passed over",
    );
    Reported
}

fn check_place(parser: &mut Parser, word: &str, place: Place, span: Span) {
    let message = match place {
        Place::Options if parser.in_world && word == "WorldBegin" => {
            "there is a second WorldBegin".to_owned()
        }
        Place::Options if parser.in_world => format!("{word} belongs before WorldBegin"),
        Place::World if !parser.in_world => format!("{word} belongs after WorldBegin"),
        _ => return,
    };
    parser.report.substitute(
        Diagnostic::error("misplaced-directive", message).at(span, "not allowed here"),
        "it is obeyed all the same",
    );
}

fn obey(parser: &mut Parser, word: &str, span: Span) -> Result<(), Reported> {
    match word {
        "Accelerator" => {
            // A matter of speed alone, and of another program's.
            entity(parser, "Accelerator", None)?;
        }
        "ActiveTransform" => active_transform(parser)?,
        "AreaLightSource" => {
            let light = entity(parser, "AreaLightSource", Some("light"))?;
            parser.graphics.area_light = Some(parser.statements.area_lights.len());
            parser.statements.area_lights.push(light);
        }
        "Attribute" => attribute(parser)?,
        "AttributeBegin" => open(parser, BlockKind::Attribute, span),
        "AttributeEnd" => close(parser, &BlockKind::Attribute, span),
        "Camera" => camera(parser)?,
        "ColorSpace" => color_space(parser)?,
        "ConcatTransform" | "Transform" | "Translate" | "Scale" | "Rotate" | "LookAt" => {
            let change = transform::read(parser, word, span)?;
            let replaces = word == "Transform";
            parser.graphics.transform(|t| if replaces { change } else { t.after(&change) });
        }
        "CoordSysTransform" => {
            let (name, span) = parser.quoted("the name of a coordinate system")?;
            match parser.coordinate_systems.get(&name) {
                Some(transforms) => parser.graphics.transforms = *transforms,
                None => {
                    let text = format!("there is no coordinate system \"{name}\"");
                    let diagnostic = Diagnostic::error("unknown-name", text).at(span, "never defined before");
                    let known = parser.coordinate_systems.keys().map(String::as_str);
                    parser
                        .report
                        .substitute(suggest(diagnostic, &name, known), "the transform stays as it is");
                }
            }
        }
        "CoordinateSystem" => {
            let (name, _) = parser.quoted("a name for the coordinate system")?;
            parser.coordinate_systems.insert(name, parser.graphics.transforms);
        }
        "Film" => parser.statements.film = Some(entity(parser, "Film", None)?),
        "Identity" => parser.graphics.transform(|_| Affine::IDENTITY),
        "Include" => include(parser)?,
        "Import" => import(parser)?,
        "Integrator" => parser.statements.integrator = Some(entity(parser, "Integrator", None)?),
        "LightSource" => {
            let entity = entity(parser, "LightSource", Some("light"))?;
            let to_world = static_transform(parser, entity.span, "lights do not move");
            parser.statements.lights.push(LightStatement { entity, to_world });
        }
        "MakeNamedMaterial" => named_material(parser)?,
        "MakeNamedMedium" => {
            let entity = entity(parser, "MakeNamedMedium", Some("medium"))?;
            let text = "participating media are not supported";
            let diagnostic = Diagnostic::error("unsupported", text).at(entity.span, "this medium");
            parser.report.substitute(diagnostic, "space is left empty");
        }
        "Material" => {
            let entity = entity(parser, "Material", Some("material"))?;
            let index = parser.statements.materials.len();
            parser.statements.materials.push(MaterialStatement { name: None, entity });
            parser.graphics.material = MaterialChoice::Index(index);
        }
        "MediumInterface" => medium_interface(parser)?,
        "NamedMaterial" => {
            let (name, span) = parser.quoted("the name of a material")?;
            parser.graphics.material = MaterialChoice::Named(name.into(), span);
        }
        "ObjectBegin" => object_begin(parser, span)?,
        "ObjectEnd" => close(parser, &BlockKind::Object(None), span),
        "ObjectInstance" => object_instance(parser)?,
        "Option" => option(parser)?,
        "PixelFilter" => parser.statements.filter = Some(entity(parser, "PixelFilter", None)?),
        "ReverseOrientation" => {
            parser.graphics.reverse_orientation = !parser.graphics.reverse_orientation;
        }
        "Sampler" => parser.statements.sampler = Some(entity(parser, "Sampler", None)?),
        "Shape" => shape(parser)?,
        "Texture" => texture(parser)?,
        "TransformBegin" => open(parser, BlockKind::Transform, span),
        "TransformEnd" => close(parser, &BlockKind::Transform, span),
        "TransformTimes" => transform_times(parser)?,
        "WorldBegin" => world_begin(parser),
        "WorldEnd" => {}
        _ => {
            let text = format!("{word} is no directive of pbrt-v4");
            parser.report.push(Diagnostic::error("unknown-directive", text).at(span, "unknown directive"));
            return Err(Reported);
        }
    }
    Ok(())
}

/// The type and the parameters that follow a directive; `target` names the defaults that apply.
fn entity(parser: &mut Parser, directive: &'static str, target: Option<&str>) -> Result<Entity, Reported> {
    let (kind, span) = parser.quoted("a type in quotes")?;
    Ok(Entity { directive, kind, span, params: params(parser, target) })
}

fn params(parser: &mut Parser, target: Option<&str>) -> Params {
    let own = parser.parameters(parser.graphics.color_space);
    let index = target.and_then(|t| ATTRIBUTE_TARGETS.iter().position(|name| *name == t));
    Params::new(own, index.map_or_else(Rc::default, |i| parser.graphics.attributes[i].clone()))
}

fn active_transform(parser: &mut Parser) -> Result<(), Reported> {
    let token = parser.next_token();
    let inactive = match token.map(|t| parser.text(t)) {
        Some("All") => [false, false],
        Some("StartTime") => [false, true],
        Some("EndTime") => [true, false],
        _ => return Err(parser.unexpected(token, "All, StartTime or EndTime")),
    };
    parser.graphics.inactive = inactive;
    Ok(())
}

fn attribute(parser: &mut Parser) -> Result<(), Reported> {
    let (target, span) = parser.quoted("what the defaults are for")?;
    let own = params(parser, None).into_own();
    match ATTRIBUTE_TARGETS.iter().position(|name| *name == target) {
        Some(index) => {
            let own: Vec<_> = own.into_iter().map(Rc::new).collect();
            let target = ATTRIBUTE_TARGETS[index];
            parser.statements.attributes.extend(own.iter().map(|param| (target, param.clone())));
            let current = Rc::make_mut(&mut parser.graphics.attributes[index]);
            // A later default of the same name and type prevails.
            current.retain(|old| own.iter().all(|new| new.name != old.name || new.kind != old.kind));
            current.extend(own);
        }
        None => {
            let text = format!("\"{target}\" has no attributes");
            let diagnostic = Diagnostic::error("unknown-name", text).at(span, "unknown target");
            parser
                .report
                .substitute(suggest(diagnostic, &target, ATTRIBUTE_TARGETS), "the defaults are left out");
        }
    }
    Ok(())
}

fn camera(parser: &mut Parser) -> Result<(), Reported> {
    let camera = entity(parser, "Camera", None)?;
    // Transform directives refuse singular maps, so that there is an inverse up to rounding.
    let to_world = parser.graphics.transforms.map(|t| t.inverse().unwrap_or(t));
    parser.coordinate_systems.insert("camera".to_owned(), to_world);
    parser.statements.camera = Some((camera, placement(parser, to_world)));
    Ok(())
}

fn include(parser: &mut Parser) -> Result<(), Reported> {
    let (name, span) = parser.quoted("the name of a file")?;
    let path = parser.directory.join(name);
    parser.parse_path(&path, Some(span));
    Ok(())
}

/// Like [`include`], but the file does not change the state of the one that asks for it.
fn import(parser: &mut Parser) -> Result<(), Reported> {
    let (name, span) = parser.quoted("the name of a file")?;
    let path = parser.directory.join(name);
    let saved = parser.graphics.clone();
    let depth = parser.blocks.len();
    parser.parse_path(&path, Some(span));
    while parser.blocks.len() > depth {
        report_open_block(parser);
    }
    parser.graphics = saved;
    Ok(())
}

fn named_material(parser: &mut Parser) -> Result<(), Reported> {
    let (name, span) = parser.quoted("a name for the material")?;
    let params = params(parser, Some("material"));
    if parser.statements.named_materials.contains_key(&name) {
        let text = format!("there is a material \"{name}\" already");
        parser.report.substitute(
            Diagnostic::error("redefined-name", text).at(span, "defined again"),
            "the first one counts",
        );
        return Ok(());
    }
    let kind = params.string("type", &mut parser.report).unwrap_or("").to_owned();
    if !params.has("type") {
        let text = format!("the material \"{name}\" has no type");
        let help = "add a parameter such as \"string type\" \"diffuse\"";
        parser.report.substitute(
            Diagnostic::error("missing-parameter", text).at(span, "no type").help(help),
            "shapes with it are left out",
        );
        params.accept_all();
    }
    let entity = Entity { directive: "Material", kind, span, params };
    parser.statements.named_materials.insert(name.clone(), parser.statements.materials.len());
    parser.statements.materials.push(MaterialStatement { name: Some(name), entity });
    Ok(())
}

fn texture(parser: &mut Parser) -> Result<(), Reported> {
    let (name, name_span) = parser.quoted("a name for the texture")?;
    let (value, value_span) = parser.quoted("\"float\" or \"spectrum\"")?;
    let entity = entity(parser, "Texture", Some("texture"))?;
    let is_float = match value.as_str() {
        "float" => true,
        // The older spelling.
        "spectrum" | "color" => false,
        _ => {
            let text = format!("\"{value}\" is no type of texture");
            let diagnostic =
                Diagnostic::error("unknown-type", text).at(value_span, "expected \"float\" or \"spectrum\"");
            parser
                .report
                .substitute(suggest(diagnostic, &value, ["float", "spectrum"]), "the texture is left out");
            return Ok(());
        }
    };
    if parser.statements.texture_names.insert((is_float, name.clone())) {
        parser.statements.textures.push(TextureStatement { name, is_float, entity });
    } else {
        let text = format!("there is a {value} texture \"{name}\" already");
        parser.report.substitute(
            Diagnostic::error("redefined-name", text).at(name_span, "defined again"),
            "the first one counts",
        );
    }
    Ok(())
}

fn shape(parser: &mut Parser) -> Result<(), Reported> {
    let entity = entity(parser, "Shape", Some("shape"))?;
    let in_object = open_object(parser);
    let to_world = if in_object.is_some() {
        let why = "shapes do not move within an object";
        Placement::Fixed(static_transform(parser, entity.span, why))
    } else if parser.graphics.area_light.is_some() {
        let why = "a shape that moves cannot emit light";
        Placement::Fixed(static_transform(parser, entity.span, why))
    } else {
        placement(parser, parser.graphics.transforms)
    };
    let shape = ShapeStatement {
        to_world,
        reverse_orientation: parser.graphics.reverse_orientation,
        material: parser.graphics.material.clone(),
        area_light: parser.graphics.area_light,
        entity,
    };
    match in_object {
        None => parser.statements.shapes.push(shape),
        Some(None) => {}
        Some(Some(_)) => {
            if shape.area_light.is_some() {
                let text = "shapes in an object emit no light";
                let diagnostic = Diagnostic::warning("dark-object", text)
                    .at(shape.entity.span, "has an area light")
                    .help("the shape is dark, as it is in pbrt; state it outside of ObjectBegin");
                parser.report.push(diagnostic);
            }
            let shape = ShapeStatement { area_light: None, ..shape };
            if let Some(object) = parser.statements.objects.last_mut() {
                object.shapes.push(shape);
            }
        }
    }
    Ok(())
}

fn world_begin(parser: &mut Parser) {
    parser.in_world = true;
    parser.graphics.transforms = [Affine::IDENTITY; 2];
    parser.graphics.inactive = [false; 2];
    parser.coordinate_systems.insert("world".to_owned(), [Affine::IDENTITY; 2]);
}

/// What two transforms at the ends of a motion make of it.
pub(super) fn placement(parser: &Parser, [start, end]: [Affine; 2]) -> Placement {
    let [from, to] = parser.transform_times;
    match Motion::new([(from, start), (to, end)]) {
        Some(motion) if start != end => Placement::Moving(Arc::new(motion)),
        _ => Placement::Fixed(start),
    }
}

/// The current transform, of something that cannot move.
fn static_transform(parser: &mut Parser, span: Span, why: &str) -> Affine {
    let [start, end] = parser.graphics.transforms;
    if start != end {
        let diagnostic = Diagnostic::error("unsupported", why).at(span, "moves while the shutter is open");
        parser.report.substitute(diagnostic, "it stays where it is at the start");
    }
    start
}

fn transform_times(parser: &mut Parser) -> Result<(), Reported> {
    let (times, span) = parser.numbers::<2>(false)?;
    let times = times.map(|t| t as f32);
    if times[0] < times[1] && times.iter().all(|t| t.is_finite()) {
        parser.transform_times = times;
        return Ok(());
    }
    let diagnostic =
        Diagnostic::error("bad-value", "motion has to start before it ends").at(span, "expected two times");
    parser.report.substitute(diagnostic, "the times are 0 and 1");
    Ok(())
}
