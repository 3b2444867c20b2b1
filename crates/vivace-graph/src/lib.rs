//! Constraint graphs in compressed rows, for coloring and Gauss-Seidel. Part of Vivace.
//!
//! Two unknowns that share a constraint are neighbors: every constraint is a clique of its vertices (a spring 2, a triangle 3,
//! a hinge or a tetrahedron 4), collisions too. A coloring of this graph splits the unknowns into classes that a Gauss-Seidel
//! sweep may relax in parallel. The same holds for the rows of any sparse matrix, so nothing here knows of meshes or physics.
//!
//! ```
//! use vivace_graph::{ConstraintGraph, GraphBuilder};
//!
//! // Two triangles of springs and the hinge between them, over four particles.
//! let springs = [[0, 1], [1, 2], [2, 0], [1, 3], [3, 2]];
//! let hinges = [[1, 2, 0, 3]];
//! let graph = GraphBuilder::new(4).constraints(&springs).constraints(&hinges).build()?;
//! assert_eq!(graph.neighbors(0), [1, 2, 3]);
//!
//! // The rows of a matrix, as they are: unsorted, one-directional, with a diagonal.
//! let same = ConstraintGraph::from_csr(vec![0, 3, 5, 6, 7], vec![3, 0, 1, 2, 3, 0, 2])?;
//! assert_eq!(same, graph);
//! # Ok::<(), vivace_graph::GraphError>(())
//! ```
//!
//! Vertices are numbered from 0 in 32 bits: at most `u32::MAX - 1` vertices and `u32::MAX` stored neighbors, beyond which
//! construction returns an error. Results never depend on the number of threads.

mod adjacency;
mod build;
mod builder;
mod csr;
mod degeneracy;
mod dynamic;
mod error;
mod graph;
mod incidence;
pub mod matrix_market;
mod num;
mod sets;

pub use adjacency::Adjacency;
pub use builder::GraphBuilder;
pub use csr::Csr;
pub use degeneracy::{SmallestLast, smallest_last};
pub use dynamic::DynamicGraph;
pub use error::GraphError;
pub use graph::ConstraintGraph;
pub use incidence::Incidence;
pub use sets::DisjointSets;
