//! Diagnostics as text: the line of the source with a caret under what is meant, advice, and a summary.
//!
//! The layout is that of `codespan-reporting`. Files of a [`SourceMap`] without text (binary ones) are named without a
//! line of source.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use codespan_reporting::diagnostic::{Diagnostic as Report, Label, Severity as Level};
use codespan_reporting::files::{Error, Files, line_starts};
use codespan_reporting::term::termcolor::{Ansi, NoColor, WriteColor};
use codespan_reporting::term::{self, Config};
use lichtweg::scene::description::{Diagnostic, Diagnostics, Severity, SourceMap, Span};

/// Longer lines are not shown, only a piece of them: machines write files of a single line.
const LONGEST_LINE: usize = 400;

/// More findings than this are counted, not shown.
const MOST_SHOWN: usize = 100;

/// All findings in order, then one line that counts them, such as `2 errors, 1 warning`. Empty where there is nothing to
/// say. With `color` the text carries ANSI escape sequences.
pub fn render(diagnostics: &Diagnostics, sources: &SourceMap, color: bool) -> String {
    let files = IndexedSources::new(sources);
    let bytes = if color {
        write_all(diagnostics, &files, Ansi::new(Vec::new())).into_inner()
    } else {
        write_all(diagnostics, &files, NoColor::new(Vec::new())).into_inner()
    };
    let mut text = String::from_utf8_lossy(&bytes).into_owned();
    let hidden = diagnostics.list.len().saturating_sub(MOST_SHOWN);
    if hidden > 0 {
        let _ = writeln!(text, "... and {hidden} more\n");
    }
    let summary = summary(diagnostics);
    if !summary.is_empty() {
        let _ = writeln!(text, "{summary}");
    }
    text
}

/// How many findings there are of each kind, such as `2 errors, 1 warning`; empty where there are none.
pub fn summary(diagnostics: &Diagnostics) -> String {
    let kinds = [(Severity::Error, "error"), (Severity::Warning, "warning"), (Severity::Note, "note")];
    let counts = kinds.iter().filter_map(|(severity, name)| {
        let n = diagnostics.list.iter().filter(|d| d.severity == *severity).count();
        (n > 0).then(|| format!("{n} {name}{}", if n == 1 { "" } else { "s" }))
    });
    counts.collect::<Vec<_>>().join(", ")
}

fn write_all<W: WriteColor>(diagnostics: &Diagnostics, files: &IndexedSources<'_>, mut out: W) -> W {
    let config = Config::default();
    for diagnostic in diagnostics.list.iter().take(MOST_SHOWN) {
        // Writing to memory cannot fail; a span outside its file is the one other cause, and then the message is still
        // worth showing.
        if term::emit_to_write_style(&mut out, &config, files, &report(diagnostic, files)).is_err() {
            let _ = writeln!(out, "{}", diagnostic.message);
        }
    }
    out
}

fn report(diagnostic: &Diagnostic, files: &IndexedSources<'_>) -> Report<u32> {
    let level = match diagnostic.severity {
        Severity::Error => Level::Error,
        Severity::Warning => Level::Warning,
        Severity::Note => Level::Note,
    };
    let mut report = Report::new(level).with_code(diagnostic.code).with_message(&diagnostic.message);
    if let Some((span, label)) = &diagnostic.label {
        match (files.range(*span), files.path(span.file)) {
            (Some(range), _) if files.line_length(span.file, range.start) <= LONGEST_LINE => {
                report.labels.push(Label::primary(span.file, range).with_message(label));
            }
            (Some(range), Some(path)) => report.notes.push(files.excerpt(span.file, path, range)),
            (None, Some(path)) => report.notes.push(format!("in {}", path.display())),
            (_, None) => {}
        }
    }
    report.notes.extend(diagnostic.help.iter().map(|h| format!("help: {h}")));
    report
}

/// A source map and where the lines of its files start.
struct IndexedSources<'a> {
    sources: &'a SourceMap,
    line_starts: Vec<Vec<usize>>,
}

impl<'a> IndexedSources<'a> {
    fn new(sources: &'a SourceMap) -> Self {
        let line_starts = sources.files().iter().map(|f| line_starts(&f.text).collect()).collect();
        Self { sources, line_starts }
    }

    fn path(&self, file: u32) -> Option<&'a Path> {
        self.sources.files().get(file as usize).map(|f| f.path.as_path())
    }

    fn line_length(&self, file: u32, byte_index: usize) -> usize {
        let line = self.line_index(file, byte_index).and_then(|index| self.line_range(file, index));
        line.map_or(0, |range| range.len())
    }

    /// The place of a span and the text there, without the rest of its line.
    fn excerpt(&self, file: u32, path: &Path, range: Range<usize>) -> String {
        const MOST: usize = 60;
        let text = &self.sources.file(file).text[range.start..];
        let piece: String = text.lines().next().unwrap_or("").chars().take(MOST).collect();
        match self.location(file, range.start) {
            Ok(place) => {
                format!("at {}:{}:{}: {piece}", path.display(), place.line_number, place.column_number)
            }
            Err(_) => format!("in {}: {piece}", path.display()),
        }
    }

    /// The bytes of a span, moved to character boundaries; `None` where its file has no text.
    fn range(&self, span: Span) -> Option<Range<usize>> {
        let text = &self.sources.files().get(span.file as usize)?.text;
        if text.is_empty() {
            return None;
        }
        let boundary = |at: u32| {
            let at = (at as usize).min(text.len());
            (0..=at).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
        };
        let (start, end) = (boundary(span.start), boundary(span.end));
        Some(start..end.max(start))
    }
}

impl<'a> Files<'a> for IndexedSources<'a> {
    type FileId = u32;
    type Name = String;
    type Source = &'a str;

    fn name(&'a self, id: u32) -> Result<String, Error> {
        self.path(id).map(|p| p.display().to_string()).ok_or(Error::FileMissing)
    }

    fn source(&'a self, id: u32) -> Result<&'a str, Error> {
        self.sources.files().get(id as usize).map(|f| f.text.as_str()).ok_or(Error::FileMissing)
    }

    fn line_index(&'a self, id: u32, byte_index: usize) -> Result<usize, Error> {
        let starts = self.line_starts.get(id as usize).ok_or(Error::FileMissing)?;
        Ok(starts.partition_point(|&start| start <= byte_index).saturating_sub(1))
    }

    fn line_range(&'a self, id: u32, line_index: usize) -> Result<Range<usize>, Error> {
        let starts = self.line_starts.get(id as usize).ok_or(Error::FileMissing)?;
        let start = *starts
            .get(line_index)
            .ok_or(Error::LineTooLarge { given: line_index, max: starts.len().saturating_sub(1) })?;
        Ok(start..starts.get(line_index + 1).copied().unwrap_or(self.source(id)?.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> (Diagnostics, SourceMap) {
        let mut sources = SourceMap::default();
        let file = sources.add("scene.xml", "<scene>\n    <ünknown/>\n</scene>\n");
        let binary = sources.add("mesh.ply", "");
        let mut diagnostics = Diagnostics::new(false);
        let span = Span { file, start: 13, end: 21 };
        diagnostics
            .push(Diagnostic::error("unknown-element", "no such element").at(span, "here").help("remove it"));
        let span = Span { file: binary, start: 0, end: 0 };
        diagnostics.push(Diagnostic::warning("bad-mesh", "no faces").at(span, ""));
        diagnostics.push(Diagnostic::warning("unplaced", "somewhere"));
        (diagnostics, sources)
    }

    #[test]
    fn places_carets_and_counts() {
        let (diagnostics, sources) = example();
        let text = render(&diagnostics, &sources, false);
        assert!(text.contains("error[unknown-element]: no such element"), "{text}");
        assert!(text.contains("scene.xml:2:6"), "{text}");
        assert!(text.contains("^^^^^^^ here"), "{text}");
        assert!(text.contains("help: remove it"), "{text}");
        assert!(text.contains("in mesh.ply"), "{text}");
        assert!(text.ends_with("1 error, 2 warnings\n"), "{text}");
        assert!(!text.contains('\x1b'));
        assert!(render(&diagnostics, &sources, true).contains('\x1b'));
    }

    #[test]
    fn survives_spans_out_of_range() {
        let (mut diagnostics, sources) = example();
        for span in [
            Span { file: 0, start: 14, end: 15 },
            Span { file: 0, start: 900, end: 1000 },
            Span { file: 0, start: 20, end: 3 },
            Span { file: 77, start: 0, end: 1 },
        ] {
            diagnostics.push(Diagnostic::note("odd", "odd place").at(span, ""));
        }
        assert_eq!(render(&diagnostics, &sources, false).matches("odd place").count(), 4);
    }

    #[test]
    fn cuts_long_lines() {
        let mut sources = SourceMap::default();
        let file =
            sources.add("long.xml", format!("<scene>\n{}<wibble/>{}", "x".repeat(1000), "y".repeat(1000)));
        let mut diagnostics = Diagnostics::new(false);
        diagnostics.push(Diagnostic::error("e", "wrong").at(Span { file, start: 1008, end: 1016 }, ""));
        let text = render(&diagnostics, &sources, false);
        assert!(text.contains("at long.xml:2:1001: <wibble/>yyy") && text.len() < 300, "{text}");
    }

    #[test]
    fn shows_a_limited_number() {
        let mut diagnostics = Diagnostics::new(false);
        for _ in 0..MOST_SHOWN + 5 {
            diagnostics.push(Diagnostic::error("e", "again"));
        }
        let text = render(&diagnostics, &SourceMap::default(), false);
        assert!(text.contains("... and 5 more") && text.ends_with("105 errors\n"), "{text}");
        assert_eq!(render(&Diagnostics::new(false), &SourceMap::default(), false), "");
    }
}
