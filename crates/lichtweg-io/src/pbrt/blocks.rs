//! Blocks that nest: attributes, transforms and objects.

use lichtweg::scene::description::{Diagnostic, Span};

use super::directives::placement;
use super::parser::{Parser, Reported};
use super::state::{Block, BlockKind, InstanceStatement, ObjectStatement};

/// Deepest nesting; each block saves the state.
const MOST_BLOCKS: usize = 1000;

/// Opens a block.
pub(super) fn open(parser: &mut Parser, kind: BlockKind, span: Span) {
    if parser.blocks.len() >= MOST_BLOCKS {
        if parser.unsaved_blocks == 0 {
            let text = format!("more than {MOST_BLOCKS} blocks are nested");
            parser.report.substitute(
                Diagnostic::error("nesting", text).at(span, "opened here"),
                "deeper blocks do not save the state",
            );
        }
        parser.unsaved_blocks += 1;
        return;
    }
    let saved = parser.graphics.clone();
    parser.blocks.push(Block { kind, span, saved });
}

/// Closes the innermost block, which should be of a kind.
pub(super) fn close(parser: &mut Parser, kind: &BlockKind, span: Span) {
    if parser.unsaved_blocks > 0 {
        parser.unsaved_blocks -= 1;
        return;
    }
    let same = |a: &BlockKind| std::mem::discriminant(a) == std::mem::discriminant(kind);
    let [begin, end] = kind.directives();
    match parser.blocks.pop() {
        Some(block) if same(&block.kind) => parser.graphics = block.saved,
        Some(block) => {
            let [open, expected] = block.kind.directives();
            let text = format!("{end} does not close the innermost block, which {open} opened");
            let diagnostic = Diagnostic::error("nesting", text).at(span, format!("expected {expected}"));
            parser.report.substitute(
                diagnostic,
                "inner blocks are closed as well, or it is passed over where none matches",
            );
            if parser.blocks.iter().any(|b| same(&b.kind)) {
                // The inner block was left open: close it as well.
                return close(parser, kind, span);
            }
            parser.blocks.push(block);
        }
        None => {
            let text = format!("{end} without {begin}");
            parser.report.substitute(
                Diagnostic::error("nesting", text).at(span, "closes nothing"),
                "it is passed over",
            );
        }
    }
}

/// Reports the innermost open block as never closed, and forgets it.
pub(super) fn report_open_block(parser: &mut Parser) {
    if let Some(block) = parser.blocks.pop() {
        let [begin, end] = block.kind.directives();
        let text = format!("{begin} without {end}");
        parser.report.substitute(
            Diagnostic::error("nesting", text).at(block.span, "opened here, never closed"),
            "it is closed at the end",
        );
    }
}

/// The object whose definition is open, `Some(None)` if its name was refused.
pub(super) fn open_object(parser: &Parser) -> Option<Option<String>> {
    parser.blocks.iter().rev().find_map(|block| match &block.kind {
        BlockKind::Object(name) => Some(name.clone()),
        _ => None,
    })
}

/// `ObjectBegin`.
pub(super) fn object_begin(parser: &mut Parser, span: Span) -> Result<(), Reported> {
    let (name, name_span) = parser.quoted("a name for the object")?;
    let wrong = if open_object(parser).is_some() {
        Some(("nesting", "an object cannot be defined inside of another".to_owned()))
    } else if parser.statements.object_names.contains(&name) {
        Some(("redefined-name", format!("there is an object \"{name}\" already")))
    } else {
        None
    };
    let refused = wrong.is_some();
    if let Some((code, text)) = wrong {
        parser.report.substitute(
            Diagnostic::error(code, text).at(name_span, "this object"),
            "what it holds is left out",
        );
    } else {
        parser.statements.object_names.insert(name.clone());
        parser.statements.objects.push(ObjectStatement { name: name.clone(), shapes: Vec::new() });
    }
    open(parser, BlockKind::Object((!refused).then_some(name)), span);
    Ok(())
}

/// `ObjectInstance`.
pub(super) fn object_instance(parser: &mut Parser) -> Result<(), Reported> {
    let (object, span) = parser.quoted("the name of an object")?;
    if open_object(parser).is_some() {
        let text = "an object cannot be used inside of another";
        parser.report.substitute(Diagnostic::error("nesting", text).at(span, "used here"), "it is left out");
        return Ok(());
    }
    let to_world = placement(parser, parser.graphics.transforms);
    parser.statements.instances.push(InstanceStatement { object, span, to_world });
    Ok(())
}
