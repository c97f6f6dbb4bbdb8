//! What the tests of whole images share: scenes built in code, ways to render them, and statistical judgement.

#![allow(dead_code, reason = "each test binary uses its part")]

pub mod build;
pub mod direct;
pub mod gallery;
pub mod judge;
pub mod probe;
pub mod room;
pub mod run;
