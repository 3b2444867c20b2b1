//! Graph colorings, parallel and serial, each with a certificate that anyone can re-check.
//!
//! A coloring gives neighbors different colors; its classes can then be worked on in parallel: Gauss-Seidel sweeps, sparse
//! Jacobians, any scatter without locks. This crate needs neither a mesh nor a GPU: a symmetric pattern in compressed rows will do.
//!
//! ```
//! use vivace_coloring::{Certificate, ConstraintGraph, color};
//!
//! // A square 0-1-2-3 with one diagonal, as compressed rows.
//! let graph = ConstraintGraph::from_csr(vec![0, 3, 5, 8, 10], vec![1, 2, 3, 0, 2, 0, 1, 3, 0, 2])?;
//! let coloring = color(&graph);
//! assert_eq!(coloring.n_colors(), 3);
//! assert!(Certificate::check(&graph, coloring.colors()).is_ok());
//! # Ok::<(), vivace_graph::GraphError>(())
//! ```
//!
//! # Which one
//!
//! | want | take |
//! |---|---|
//! | speed on a CPU (the default, [`color`]) | [`Algorithm::BlockedFirstFit`] |
//! | fewest colors | [`reduce`] over any coloring |
//! | equal classes | [`balance`] over any coloring |
//! | edges that come and go | [`recolor`]; [`Follower`] where they do so for ever |
//! | the paper's colorings, for a GPU | [`Algorithm::Vivace`], [`Algorithm::JonesPlassmann`], [`Algorithm::Luby`], [`Algorithm::LargestDegreeFirst`] |
//!
//! The default is blocked first fit because on a CPU first fit beats every round-based coloring in speed and mostly in colors
//! (`cargo xtask bench-coloring` shows by how much on your machine); a thread more makes it faster and never changes its answer.
//! Random priorities earn their keep where all vertices act at once, on a GPU: there first fit needs more rounds.
//!
//! Every answer depends on the graph, the algorithm and its seed alone: not on the number of threads, not on the machine.
//! Work runs in the rayon pool it is called in, or on rayon's global pool; see [`vivace_cpu::Cpu`].

mod algorithm;
mod balance;
mod certificate;
mod color_set;
mod coloring;
mod dissolve;
mod follow;
mod recolor;
mod reduce;
mod rounds;
mod serial;

pub use algorithm::{Algorithm, ColorOnError, Outcome, UnknownAlgorithm, color};
pub use balance::{Balanced, balance};
pub use certificate::{Certificate, Violation};
pub use coloring::{Coloring, Partitions};
pub use dissolve::dissolve_small_classes;
pub use follow::{FollowWork, Follower};
pub use recolor::{Recolored, recolor};
pub use reduce::reduce;
pub use rounds::{
    ConflictRule, GraphBuffers, GraphView, ROUND_LIMIT, RoundColoring, Vivace, jones_plassmann,
    largest_degree_first, luby, vivace, vivace_unseen,
};
pub use serial::{Order, blocked_first_fit, dsatur, first_fit};
pub use vivace_graph::{Adjacency, ConstraintGraph, DynamicGraph, GraphError};
