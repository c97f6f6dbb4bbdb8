//! What went wrong, where, and what to do about it.

use std::path::PathBuf;

/// A range of bytes in one file of a [`SourceMap`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Span {
    /// Index of the file.
    pub file: u32,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

/// One file a scene was read from.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// Its path, as far as the user would know it.
    pub path: PathBuf,
    /// Its text; empty for binary files, which diagnostics name without showing a line.
    pub text: String,
}

/// The files a scene was read from; spans point into them.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

impl SourceMap {
    /// Adds a file and returns its index.
    pub fn add(&mut self, path: impl Into<PathBuf>, text: impl Into<String>) -> u32 {
        self.files.push(SourceFile { path: path.into(), text: text.into() });
        self.files.len() as u32 - 1
    }

    /// The file of an index that [`SourceMap::add`] returned.
    pub fn file(&self, index: u32) -> &SourceFile {
        &self.files[index as usize]
    }

    /// All files, in the order they were added.
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// The scene renders, but not quite as written.
    Warning,
    /// The scene does not render.
    Error,
}

/// One finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// A stable kebab-case name of this kind of finding, such as `unknown-plugin`.
    pub code: &'static str,
    /// One sentence: what is wrong.
    pub message: String,
    /// Where, if anywhere, and what is said at that place (may be empty).
    pub label: Option<(Span, String)>,
    /// What was expected, what to do, what is substituted.
    pub help: Vec<String>,
}

impl Diagnostic {
    /// An error without a place.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, code, message: message.into(), label: None, help: Vec::new() }
    }

    /// A warning without a place.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message) }
    }

    /// A note without a place.
    pub fn note(code: &'static str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Note, ..Self::error(code, message) }
    }

    /// The same at a place, with a few words to print under it.
    pub fn at(mut self, span: Span, label: impl Into<String>) -> Self {
        self.label = Some((span, label.into()));
        self
    }

    /// The same with one more line of help.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }
}

/// All findings of one run, and whether unsupported things may be replaced.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    /// Replace what is not supported, with a warning, instead of failing (`--lenient`).
    pub lenient: bool,
    /// The findings, in the order they were made.
    pub list: Vec<Diagnostic>,
}

impl Diagnostics {
    /// An empty list.
    pub fn new(lenient: bool) -> Self {
        Self { lenient, list: Vec::new() }
    }

    /// Adds a finding.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.list.push(diagnostic);
    }

    /// Adds "this is not supported": an error, or when lenient a warning that names the `substitute`, such as
    /// "a grey diffuse material is used instead".
    pub fn unsupported(&mut self, mut diagnostic: Diagnostic, substitute: &str) {
        if self.lenient {
            diagnostic.severity = Severity::Warning;
            diagnostic.help.push(substitute.to_owned());
        } else {
            diagnostic.severity = Severity::Error;
            diagnostic.help.push(format!("with --lenient, {substitute}"));
        }
        self.list.push(diagnostic);
    }

    /// Whether any finding is an error.
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|d| d.severity == Severity::Error)
    }
}
