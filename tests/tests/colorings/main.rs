//! Graph colorings: what every algorithm promises, on random graphs, meshes and the extremes of graph theory.

mod arbitrary;
mod certificate;
mod following;
mod golden;
mod passes;
mod promises;
mod recoloring;
mod traps;
mod twins;
mod workloads;
