//! `lichtweg completions`: completion scripts for shells.

use std::io::Write;

use clap::Args;
use clap_complete::Shell;

use crate::cli;
use crate::failure::Failure;

const EXAMPLES: &str = "\
Examples:
  lichtweg completions bash > ~/.local/share/bash-completion/completions/lichtweg
  lichtweg completions fish > ~/.config/fish/completions/lichtweg.fish
  lichtweg completions zsh > \"${fpath[1]}/_lichtweg\"";

/// Print a completion script for a shell
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

/// Prints the script.
pub fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut cli::definition(), "lichtweg", &mut script);
    Ok(std::io::stdout().write_all(&script)?)
}
