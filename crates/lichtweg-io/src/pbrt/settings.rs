//! Directives that set one thing by its name: options, colour spaces and media.

use lichtweg::scene::description::Diagnostic;

use super::color_space::ColorSpace;
use super::parser::{Parser, Reported};
use super::report::suggest;
use super::token::Kind;

pub(super) fn option(parser: &mut Parser) -> Result<(), Reported> {
    /// Options, and whether another value than false changes the image.
    const OPTIONS: [(&str, bool); 10] = [
        ("disablepixeljitter", true),
        ("disabletexturefiltering", false),
        ("disablewavelengthjitter", true),
        ("displacementedgescale", false),
        ("forcediffuse", true),
        ("msereferenceimage", false),
        ("msereferenceout", false),
        ("pixelstats", false),
        ("rendercoordsys", false),
        ("wavefront", false),
    ];
    let (name, span) = parser.quoted("the name of an option")?;
    let token = parser.next_token();
    let Some(value) = token.filter(|t| matches!(t.kind, Kind::Word | Kind::Quoted)) else {
        return Err(parser.unexpected(token, "the option's value"));
    };
    let value = parser.text(value).trim_matches('"').to_owned();
    // pbrt takes no notice of letter case and of dashes and underscores.
    let plain = name.to_ascii_lowercase().replace(['-', '_'], "");
    if plain == "seed" {
        match value.parse() {
            Ok(seed) => parser.statements.seed = seed,
            Err(_) => {
                let text = format!("the seed {value} is no integer");
                parser.report.substitute(
                    Diagnostic::error("bad-value", text).at(span, "this option"),
                    "the seed is 0",
                );
            }
        }
        return Ok(());
    }
    match OPTIONS.iter().find(|(known, _)| *known == plain) {
        Some((_, matters)) if !matters || value == "false" => {}
        Some(_) => {
            let text = format!("the option \"{name}\" is not supported");
            let diagnostic = Diagnostic::error("unsupported", text).at(span, "this option");
            parser.report.substitute(diagnostic, "it is left at false");
        }
        None => {
            let text = format!("there is no option \"{name}\"");
            let diagnostic = Diagnostic::error("unknown-name", text).at(span, "unknown option");
            let known = OPTIONS.iter().map(|(known, _)| *known).chain(["seed"]);
            parser.report.substitute(suggest(diagnostic, &plain, known), "it is left out");
        }
    }
    Ok(())
}

pub(super) fn color_space(parser: &mut Parser) -> Result<(), Reported> {
    let (name, span) = parser.quoted("the name of a colour space")?;
    if let Some((_, space)) = ColorSpace::NAMES.iter().find(|(known, _)| *known == name) {
        parser.graphics.color_space = *space;
    } else if name == "aces2065-1" {
        let text = "the colour space ACES 2065-1 is not supported";
        let diagnostic = Diagnostic::error("unsupported", text).at(span, "this colour space");
        parser.report.substitute(diagnostic, "its numbers are taken as linear sRGB");
        parser.graphics.color_space = ColorSpace::Srgb;
    } else {
        let known = ColorSpace::NAMES.map(|(name, _)| name);
        let diagnostic = Diagnostic::error("unknown-name", format!("\"{name}\" is no colour space"))
            .at(span, "unknown colour space");
        parser.report.substitute(suggest(diagnostic, &name, known), "the colour space stays as it is");
    }
    Ok(())
}

pub(super) fn medium_interface(parser: &mut Parser) -> Result<(), Reported> {
    let (inside, span) = parser.quoted("the name of a medium, or \"\"")?;
    let outside = parser.quoted_if().map(|(name, _)| name);
    if !inside.is_empty() || outside.is_some_and(|name| !name.is_empty()) {
        let text = "participating media are not supported";
        let diagnostic = Diagnostic::error("unsupported", text).at(span, "this medium");
        parser.report.substitute(diagnostic, "space is left empty");
    }
    Ok(())
}
