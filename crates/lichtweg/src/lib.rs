//! Light transport.

pub mod scene;
