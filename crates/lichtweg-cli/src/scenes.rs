//! `lichtweg scenes`: what is built in.

use std::io::Write;

use lichtweg_io::builtin;

use crate::failure::Failure;

/// Lists the built-in scenes.
pub fn run() -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    for scene in builtin::SCENES {
        writeln!(out, "{:28}{}", format!("{}{}", builtin::PREFIX, scene.name), scene.about)?;
    }
    Ok(())
}
