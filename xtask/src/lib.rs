//! The parts of `cargo xtask`: reports from plain data, and one module for each command.

pub mod bench;
pub mod commands;
pub mod figures;
pub mod report;
