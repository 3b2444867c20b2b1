//! What the tests, benches and figures of Vivace share: the graphs they run on and slow, obvious versions of what they check.
//!
//! - [`crossings`]: whether a surface intersects itself, by exact signs;
//! - [`generators`]: families of graphs, each a function of its size and seed;
//! - [`workloads`]: the named graphs of the benches and figures;
//! - [`naive`]: a second backend, simple enough to be read as the definition of a kernel run;
//! - [`oracle`]: colorings and checks written straight from their definitions;
//! - [`scenes`]: small cloths, bars and chains, and every way to solve them.

pub mod crossings;
pub mod generators;
pub mod naive;
pub mod oracle;
pub mod random;
pub mod scenes;
pub mod workloads;
