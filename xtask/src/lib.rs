//! The parts of `cargo xtask`: reports from plain data, and one module for each command.

pub mod bench;
pub mod bench_simulation;
pub mod commands;
pub mod figures;
pub mod report;
