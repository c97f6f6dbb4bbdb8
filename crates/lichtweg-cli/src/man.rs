//! `lichtweg man`: manual pages in roff.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use clap_mangen::Man;

use crate::cli;
use crate::failure::Failure;

const EXAMPLES: &str = "\
Examples:
  lichtweg man | man -l -
  lichtweg man --dir ~/.local/share/man/man1";

/// Print the manual page, or write one for every command
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ManArgs {
    /// Write lichtweg.1 and one page for every command into this directory
    #[arg(long, value_name = "DIR")]
    dir: Option<PathBuf>,
}

/// Prints or writes the pages.
pub fn run(args: &ManArgs) -> Result<(), Failure> {
    match &args.dir {
        None => {
            let mut page = Vec::new();
            Man::new(cli::definition()).render(&mut page)?;
            Ok(std::io::stdout().write_all(&page)?)
        }
        Some(directory) => fs::create_dir_all(directory)
            .and_then(|()| clap_mangen::generate_to(cli::definition(), directory))
            .map_err(|error| Failure::Failed(format!("{} cannot be written: {error}", directory.display()))),
    }
}
