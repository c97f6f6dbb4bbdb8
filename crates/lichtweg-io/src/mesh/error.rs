//! What is wrong with a mesh file.

use std::fmt;
use std::path::{Path, PathBuf};

use lichtweg::scene::description::Diagnostic;

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Nowhere in particular.
    File,
    /// A line of a text file, from 1.
    Line(u64),
    /// An offset into a binary file, from 0.
    Byte(u64),
}

/// A mesh file that could not be read.
///
/// Printed, it reads `path: line 7: expected a number, found "abc"`, without the advice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshError {
    /// The file; empty where the bytes came from elsewhere.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What should have been there.
    pub expected: String,
    /// What was there.
    pub found: String,
    /// What to do about it.
    pub help: String,
}

impl MeshError {
    pub(crate) fn new(
        place: Place,
        expected: impl Into<String>,
        found: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self {
            file: PathBuf::new(),
            place,
            expected: expected.into(),
            found: found.into(),
            help: help.into(),
        }
    }

    pub(crate) fn in_file(mut self, path: &Path) -> Self {
        self.file = path.to_owned();
        self
    }

    /// The same as a diagnostic `bad-mesh`, for the caller to place with [`Diagnostic::at`].
    pub fn diagnostic(&self) -> Diagnostic {
        Diagnostic::error("bad-mesh", self.to_string()).help(self.help.clone())
    }
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.file.as_os_str().is_empty() {
            write!(f, "{}: ", self.file.display())?;
        }
        match self.place {
            Place::File => {}
            Place::Line(line) => write!(f, "line {line}: ")?,
            Place::Byte(byte) => write!(f, "byte {byte}: ")?,
        }
        write!(f, "expected {}, found {}", self.expected, self.found)
    }
}

impl std::error::Error for MeshError {}
