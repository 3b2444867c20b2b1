//! The parts of `cargo xtask`: reports from plain data, pictures of meshes, and one module for each command.

pub mod bench;
pub mod bench_gpu;
pub mod bench_simulation;
pub mod commands;
pub mod extremes;
pub mod figures;
pub mod picture;
pub mod report;
pub mod strain;
pub mod tradeoff;
