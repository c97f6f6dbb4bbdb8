//! Files, tokens and parameter lists: the part of the grammar that all directives share.
//!
//! A mistake is reported and the parser goes on at the next directive, so that one run finds them all.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use lichtweg::scene::description::{Diagnostic, SourceMap, Span};

use super::blocks;
use super::color_space::ColorSpace;
use super::directives;
use super::params::{Param, Type, Values};
use super::report::{Report, suggest};
use super::source_file::read_text;
use super::state::{Block, Graphics, Statements};
use super::token::{self, Kind, Token};
use super::values::{ValueReader, number_of};

/// Deepest nesting of files that include each other.
const DEEPEST_INCLUDE: usize = 64;
/// Most files read by `Include` and `Import`, repetitions counted: a few files can include each other without a cycle
/// exponentially often.
const MOST_INCLUDES: usize = 100_000;

/// A mistake that has been reported; the parser goes on at the next directive.
pub(super) struct Reported;

/// The parser and the state that it fills.
pub(super) struct Parser<'a, 'd> {
    pub sources: &'a mut SourceMap,
    pub report: Report<'d>,
    /// Relative names start here: the directory of the scene's first file.
    pub directory: PathBuf,
    pub statements: Statements,
    pub graphics: Graphics,
    pub blocks: Vec<Block>,
    /// Blocks that are open beyond the deepest nesting.
    pub unsaved_blocks: usize,
    pub coordinate_systems: HashMap<String, [lichtweg_ray::math::Affine; 2]>,
    /// The times of the two ends of all motion.
    pub transform_times: [f32; 2],
    pub in_world: bool,
    file: u32,
    position: usize,
    /// A string had no end: what is left of its directive is passed over.
    broken: bool,
    /// A file could not be read, so that what is missing may have been in it.
    lost_file: bool,
    peeked: Option<Token>,
    /// Files being read, outermost first.
    open_files: Vec<PathBuf>,
    known_files: HashMap<PathBuf, u32>,
    include_count: usize,
}

impl<'a, 'd> Parser<'a, 'd> {
    pub fn new(sources: &'a mut SourceMap, report: Report<'d>, directory: PathBuf) -> Self {
        Self {
            sources,
            report,
            directory,
            statements: Statements::default(),
            graphics: Graphics::default(),
            blocks: Vec::new(),
            unsaved_blocks: 0,
            coordinate_systems: HashMap::new(),
            transform_times: [0.0, 1.0],
            in_world: false,
            file: 0,
            position: 0,
            broken: false,
            lost_file: false,
            peeked: None,
            open_files: Vec::new(),
            known_files: HashMap::new(),
            include_count: 0,
        }
    }

    /// What was stated, once blocks left open at the end are reported.
    pub fn finish(mut self) -> (Statements, Report<'d>) {
        while !self.blocks.is_empty() {
            blocks::report_open_block(&mut self);
        }
        if !self.in_world && !self.lost_file && !self.report.is_full() {
            self.report.push(
                Diagnostic::error("missing-directive", "there is no WorldBegin")
                    .help("options come before WorldBegin, the scene after it"),
            );
        }
        (self.statements, self.report)
    }

    /// Parses a file; `stated` is where its name stands in the file that includes it.
    pub fn parse_path(&mut self, path: &Path, stated: Option<Span>) {
        let identity = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        self.include_count += 1;
        let refusal = if self.open_files.contains(&identity) {
            Some(("include-cycle", "includes itself"))
        } else if self.open_files.len() >= DEEPEST_INCLUDE {
            Some(("include-depth", "is included too deep"))
        } else if self.include_count > MOST_INCLUDES {
            Some(("include-count", "is one included file too many"))
        } else {
            None
        };
        if let Some((code, why)) = refusal {
            return self.complain_file(code, format!("{} {why}", path.display()), stated);
        }
        let index = match self.known_files.get(&identity) {
            Some(index) => *index,
            None => match read_text(path) {
                Ok((text, lossless)) => {
                    let index = self.sources.add(path, text);
                    self.known_files.insert(identity.clone(), index);
                    if !lossless {
                        let text = format!("{} is not encoded as UTF-8", path.display());
                        self.report.push(
                            Diagnostic::warning("encoding", text)
                                .at(Span { file: index, start: 0, end: 0 }, "other bytes are replaced"),
                        );
                    }
                    index
                }
                Err(why) => {
                    let text = format!("{}: {why}", path.display());
                    return self.complain_file("unreadable-file", text, stated);
                }
            },
        };
        self.open_files.push(identity);
        self.parse_source(index);
        self.open_files.pop();
    }

    /// Parses a file of the source map.
    pub fn parse_source(&mut self, file: u32) {
        let outer = (self.file, self.position, self.peeked.take());
        self.file = file;
        // A byte order mark is no token.
        self.position = if self.sources.file(file).text.starts_with('\u{feff}') { 3 } else { 0 };
        while !self.report.is_full() {
            match directives::next(self) {
                Ok(true) => {}
                Ok(false) => break,
                Err(Reported) => self.skip_to_directive(),
            }
        }
        (self.file, self.position, self.peeked) = outer;
    }

    fn complain_file(&mut self, code: &'static str, message: String, stated: Option<Span>) {
        self.lost_file = true;
        let diagnostic = Diagnostic::error(code, message);
        match stated {
            Some(span) => {
                self.report.substitute(diagnostic.at(span, "asked for here"), "the file is left out")
            }
            None => self.report.push(diagnostic),
        }
    }

    /// Passes over what is left of a directive.
    fn skip_to_directive(&mut self) {
        self.skip_to(|parser, token| parser.is_directive(token));
    }

    /// Passes over what is left of a bad list of values.
    fn skip_to_parameter(&mut self) {
        self.skip_to(|parser, token| token.kind == Kind::Quoted || parser.is_directive(token));
    }

    fn skip_to(&mut self, is_end: impl Fn(&Self, Token) -> bool) {
        loop {
            match self.next_token() {
                Some(token) if is_end(self, token) => {
                    self.peeked = Some(token);
                    return;
                }
                None if !self.take_broken() => return,
                _ => {}
            }
        }
    }

    fn is_directive(&self, token: Token) -> bool {
        token.kind == Kind::Word && directives::is_known(self.text(token))
    }

    /// Whether the last `None` was a string without an end rather than the end of the file.
    pub fn take_broken(&mut self) -> bool {
        std::mem::take(&mut self.broken)
    }

    /// The next token; `None` at the end of the file, and at a string without an end, which is reported.
    pub fn next_token(&mut self) -> Option<Token> {
        if let Some(token) = self.peeked.take() {
            return Some(token);
        }
        if self.broken {
            return None;
        }
        match token::next(&self.sources.file(self.file).text, &mut self.position) {
            Ok(token) => token,
            Err(string) => {
                let span = self.span(string.start, string.end);
                let text = "a string has no closing quote on its line";
                let diagnostic = Diagnostic::error("unterminated-string", text).at(span, "opened here");
                self.report.substitute(diagnostic, "its directive is left out");
                self.broken = true;
                None
            }
        }
    }

    /// The next token, left where it is.
    pub fn peek_token(&mut self) -> Option<Token> {
        self.peeked = self.next_token();
        self.peeked
    }

    /// The text of a token, with quotes where it has them.
    pub fn text(&self, token: Token) -> &str {
        token.text(&self.sources.file(self.file).text)
    }

    /// The place of a token.
    pub fn span_of(&self, token: Token) -> Span {
        self.span(token.start, token.end)
    }

    fn span(&self, start: usize, end: usize) -> Span {
        Span { file: self.file, start: start as u32, end: end as u32 }
    }

    /// Reports that `token`, or the end of the file, is not what was expected.
    pub fn unexpected(&mut self, token: Option<Token>, expected: &str) -> Reported {
        let (found, span) = match token {
            None if self.broken => return Reported,
            Some(token) => (shortened(self.text(token)), self.span_of(token)),
            None => {
                let end = self.sources.file(self.file).text.len();
                ("the end of the file".to_owned(), self.span(end, end))
            }
        };
        let message = format!("expected {expected}, found {found}");
        self.report.substitute(
            Diagnostic::error("syntax", message).at(span, format!("expected {expected}")),
            "what it belongs to is left out",
        );
        self.peeked = token.filter(|t| self.is_directive(*t));
        Reported
    }

    /// A quoted string, and its place.
    pub fn quoted(&mut self, expected: &str) -> Result<(String, Span), Reported> {
        match self.next_token() {
            Some(token) if token.kind == Kind::Quoted => Ok((self.unquote(token), self.span_of(token))),
            other => Err(self.unexpected(other, expected)),
        }
    }

    /// A quoted string if one follows.
    pub fn quoted_if(&mut self) -> Option<(String, Span)> {
        let token = self.peek_token().filter(|t| t.kind == Kind::Quoted)?;
        self.peeked = None;
        Some((self.unquote(token), self.span_of(token)))
    }

    /// The contents of a quoted token, its escapes resolved.
    fn unquote(&mut self, token: Token) -> String {
        let inner = token.inner(&self.sources.file(self.file).text);
        match token::unescape(inner) {
            Ok(text) => text.into_owned(),
            Err(escape) => {
                let text = inner.to_owned();
                let message = format!("\\{escape} is no escape sequence");
                let diagnostic = Diagnostic::error("bad-escape", message)
                    .at(self.span_of(token), "in this string")
                    .help("write a backslash as \\\\");
                self.report.substitute(diagnostic, "the backslash stays");
                text
            }
        }
    }

    /// `N` numbers; `bracketed` ones stand in brackets.
    pub fn numbers<const N: usize>(&mut self, bracketed: bool) -> Result<([f64; N], Span), Reported> {
        let mut span: Option<Span> = None;
        let mut out = [0.0; N];
        if bracketed {
            self.bracket(Kind::Open)?;
        }
        for (i, number) in out.iter_mut().enumerate() {
            let token = self.next_token();
            let value = token.filter(|t| t.kind == Kind::Word).and_then(|t| number_of::<f64>(self.text(t)));
            let (Some(token), Some(value)) = (token, value) else {
                return Err(self.unexpected(token, &format!("number {} of {N}", i + 1)));
            };
            *number = value;
            let here = self.span_of(token);
            span = Some(Span { end: here.end, ..span.unwrap_or(here) });
        }
        if bracketed {
            self.bracket(Kind::Close)?;
        }
        Ok((out, span.unwrap_or_default()))
    }

    fn bracket(&mut self, kind: Kind) -> Result<(), Reported> {
        let expected = if kind == Kind::Open { "[" } else { "]" };
        match self.next_token() {
            Some(token) if token.kind == kind => Ok(()),
            other => Err(self.unexpected(other, expected)),
        }
    }

    /// The parameter list that follows a directive and its type. Bad parameters are reported and left out.
    pub fn parameters(&mut self, color_space: ColorSpace) -> Vec<Param> {
        let mut list: Vec<Param> = Vec::new();
        while let Some((declaration, span)) = self.quoted_if() {
            let mut words = declaration.split_ascii_whitespace();
            let (type_name, name) = (words.next().unwrap_or(""), words.next().unwrap_or(""));
            let kind = Type::parse(type_name);
            if words.next().is_some() || name.is_empty() {
                let text = format!("\"{}\" is not a type and a name", shortened(&declaration));
                let help = "a parameter is declared as in \"float radius\"";
                self.report.substitute(
                    Diagnostic::error("syntax", text).at(span, "no parameter").help(help),
                    "the parameter is left out",
                );
            } else if kind.is_none() {
                let text = format!("\"{}\" is no parameter type", shortened(type_name));
                let diagnostic = Diagnostic::error("unknown-type", text).at(span, "unknown type");
                self.report
                    .substitute(suggest(diagnostic, type_name, Type::names()), "the parameter is left out");
            }
            let values = self.values(kind.unwrap_or(Type::String), kind.is_some() && !name.is_empty());
            if values.is_err() {
                self.skip_to_parameter();
            }
            if let (Ok((values, values_span)), Some(kind), false) = (values, kind, name.is_empty()) {
                if list.iter().any(|p| p.name == name && p.kind == kind) {
                    let text = format!("parameter \"{name}\" is stated twice");
                    let diagnostic = Diagnostic::warning("repeated-parameter", text);
                    self.report.push(diagnostic.at(span, "this one counts"));
                }
                list.push(Param::new(name.to_owned(), kind, values, [span, values_span], color_space));
            }
        }
        list
    }

    /// The values of a parameter, in brackets or a single one; of a wrong one, one finding if `loud`.
    fn values(&mut self, kind: Type, loud: bool) -> Result<(Values, Span), Reported> {
        let first = self.next_token();
        let bracketed = first.is_some_and(|t| t.kind == Kind::Open);
        let Some(first) = first.filter(|t| t.kind != Kind::Close && (bracketed || self.is_value(*t))) else {
            return Err(self.unexpected(first, "a value"));
        };
        let mut read = ValueReader::new(kind);
        let mut wrong: Option<Token> = None;
        let mut end = first.end;
        let mut token = if bracketed { self.next_token() } else { Some(first) };
        loop {
            let Some(here) = token.filter(|t| t.kind == Kind::Close || self.is_value(*t)) else {
                return Err(self.unexpected(token, "] after the values"));
            };
            end = end.max(here.end);
            if here.kind == Kind::Close {
                break;
            }
            let text = here.text(&self.sources.file(self.file).text);
            if wrong.is_none() && !read.push(here.kind, text) {
                wrong = Some(here);
            }
            if !bracketed {
                break;
            }
            token = self.next_token();
        }
        if let Some(token) = wrong.filter(|_| loud) {
            let text = shortened(self.text(token));
            let message = format!("{text} is not {}", read.expected());
            let span = self.span_of(token);
            self.report.substitute(
                Diagnostic::error("bad-value", message).at(span, format!("expected {}", read.expected())),
                "the parameter is left out",
            );
            return Err(Reported);
        }
        Ok((read.values, self.span(first.start, end)))
    }

    /// Whether a token can be a value: anything but a bracket or a directive.
    fn is_value(&self, token: Token) -> bool {
        match token.kind {
            Kind::Quoted => true,
            Kind::Word => {
                !self.text(token).starts_with(|c: char| c.is_ascii_uppercase())
                    || !directives::is_known(self.text(token))
            }
            Kind::Open | Kind::Close => false,
        }
    }
}

/// A piece of source for a message, cut to a readable length.
fn shortened(text: &str) -> String {
    const MOST: usize = 40;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
