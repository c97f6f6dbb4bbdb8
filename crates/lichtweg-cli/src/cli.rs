//! The subcommands.

use std::ffi::OsStr;
use std::path::Path;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use lichtweg_io::builtin::PREFIX;

use crate::completions::CompletionsArgs;
use crate::failure::Failure;
use crate::info::InfoArgs;
use crate::man::ManArgs;
use crate::radiosity::RadiosityArgs;
use crate::render::RenderArgs;
use crate::solve::SolveArgs;
use crate::{completions, info, man, radiosity, render, scenes, solve};

const ABOUT: &str = "Lichtweg, a Monte Carlo light transport system";

const LONG_ABOUT: &str = "\
Lichtweg, a Monte Carlo light transport system.

Reads scenes of Mitsuba (.xml) and pbrt-v4 (.pbrt), and renders them by path tracing. Without a command it renders the \
built-in Cornell box into the current directory.";

const EXAMPLES: &str = "\
Examples:
  lichtweg                              render the built-in Cornell box
  lichtweg render scene.xml --spp 256   render a scene to scene.exr and scene.png
  lichtweg render scene.pbrt --time 60  render for a minute
  lichtweg info scene.xml               what is in a scene, what is not supported
  lichtweg scenes                       the scenes that are built in
  lichtweg solve A.mtx -b b.mtx -u 17   an unknown of a linear system, by random walks

Exit codes:
  0    all went well, or Ctrl-C ended a render early and its image is saved
  1    the scene, a file or the machine stood in the way
  2    the command was not understood
  130  left at once at the second Ctrl-C";

/// The command line.
#[derive(Debug, Parser)]
#[command(name = "lichtweg", version, about = ABOUT, long_about = LONG_ABOUT, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Render(Box<RenderArgs>),
    Info(InfoArgs),
    Solve(Box<SolveArgs>),
    Radiosity(Box<RadiosityArgs>),
    /// List the scenes that are built in
    Scenes,
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// The command line as clap sees it, for man pages and completions.
pub fn definition() -> clap::Command {
    Cli::command()
}

/// Does what the command line asks for.
pub fn run() -> ExitCode {
    let result = match parse().command {
        None => render::run(&RenderArgs::defaults()),
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Info(args)) => info::run(&args),
        Some(Command::Solve(args)) => solve::run(&args),
        Some(Command::Radiosity(args)) => radiosity::run(&args),
        Some(Command::Scenes) => scenes::run(),
        Some(Command::Completions(args)) => completions::run(&args),
        Some(Command::Man(args)) => man::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Parses the command line; ends the process on help, and on errors.
fn parse() -> Cli {
    Cli::try_parse().unwrap_or_else(|error| {
        let scene = std::env::args_os().nth(1).filter(|word| is_scene(word));
        match scene {
            Some(scene) if error.kind() == ErrorKind::InvalidSubcommand => {
                let message =
                    format!("no command is given; to render the scene: lichtweg render {}", scene.display());
                Cli::command().error(ErrorKind::InvalidSubcommand, message).exit()
            }
            _ => error.exit(),
        }
    })
}

/// Whether a word looks like a scene rather than a command.
fn is_scene(word: &OsStr) -> bool {
    word.as_encoded_bytes().starts_with(PREFIX.as_bytes()) || Path::new(word).exists()
}

impl RenderArgs {
    /// Those of `lichtweg render` without any.
    fn defaults() -> Self {
        match Cli::parse_from(["lichtweg", "render"]).command {
            Some(Command::Render(args)) => *args,
            _ => unreachable!("`render` is the subcommand asked for"),
        }
    }
}

impl From<std::io::Error> for Failure {
    /// Output that cannot be written. A reader that has gone, as in `lichtweg scenes | head -1`, is no failure.
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Self::Quiet(0),
            _ => Self::Failed(format!("standard output cannot be written: {error}")),
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn definition_is_consistent() {
        super::definition().debug_assert();
    }
}
