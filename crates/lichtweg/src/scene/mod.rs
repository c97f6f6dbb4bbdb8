//! Scenes: the neutral description and what it compiles to.

pub mod description;
