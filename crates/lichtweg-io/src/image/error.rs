//! What is wrong with an image file.

use std::fmt;
use std::path::{Path, PathBuf};

use lichtweg::scene::description::Diagnostic;

/// An image that could not be read or written.
///
/// Printed, it reads `path: what is wrong`, without the advice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageError {
    /// The file; empty where the bytes came from elsewhere.
    pub file: PathBuf,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

impl ImageError {
    pub(crate) fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { file: PathBuf::new(), message: message.into(), help: help.into() }
    }

    pub(crate) fn in_file(mut self, path: &Path) -> Self {
        self.file = path.to_owned();
        self
    }

    /// The same as a diagnostic `bad-image`, for the caller to place with [`Diagnostic::at`].
    pub fn diagnostic(&self) -> Diagnostic {
        Diagnostic::error("bad-image", self.to_string()).help(self.help.clone())
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.file.as_os_str().is_empty() {
            write!(f, "{}: ", self.file.display())?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for ImageError {}
