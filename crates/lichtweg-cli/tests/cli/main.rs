//! The command as users meet it: the built program, run in directories of its own.

mod bidirectional;
mod common;
mod errors;
#[cfg(unix)]
mod interrupt;
mod others;
mod render;
mod solve;
