//! The parts of `cargo xtask` that know plain data only, so that examples and tests can use them too.

pub mod report;
