//! The command `lichtweg`: renders scenes, tells what is in them, and solves linear systems.
//!
//! Exit codes: 0 all went well (a render that Ctrl-C ended early is saved, and counts as well); 1 the scene, a file or
//! the machine stood in the way; 2 the command was not understood; 130 left at once at the second Ctrl-C.

mod bake;
mod cli;
mod completions;
mod console;
mod failure;
mod info;
mod interrupt;
mod load;
mod man;
mod memory;
mod options;
mod output;
mod overrides;
mod path;
mod progress;
mod pyramid;
mod radiosity;
mod record;
mod render;
mod scenes;
mod settings;
mod setup;
mod solve;
mod text;

fn main() -> std::process::ExitCode {
    cli::run()
}
