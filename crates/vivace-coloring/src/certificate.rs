//! The proof that a coloring is one, in a form anyone can re-check: one look at every edge.

use rayon::prelude::*;
use vivace_graph::Adjacency;

/// What is true of a proper and complete coloring.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Certificate {
    /// Vertices, each with a color.
    pub n_vertices: usize,
    /// Edges looked at, each once; the ends of each differ.
    pub n_edges: usize,
    /// Largest degree; no algorithm of this crate uses more than this and one colors.
    pub max_degree: u32,
    /// Number of different colors.
    pub n_colors: u32,
    /// Highest color and one: more than `n_colors` where numbers are left out.
    pub n_ids: u32,
    /// Vertices of each color id.
    pub class_sizes: Vec<u32>,
    /// Whether every vertex's color is at most its degree, as first fit leaves it (balancing need not).
    pub within_degree: bool,
}

/// Why colors are no coloring.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// There are more or fewer colors than vertices.
    #[error("{n_colors} colors for {n_vertices} vertices; give one each")]
    Length {
        /// Colors given.
        n_colors: usize,
        /// Vertices of the graph.
        n_vertices: usize,
    },
    /// A vertex has no color.
    #[error("vertex {vertex} has color {color}, but colors are below the number of vertices; color it")]
    Uncolored {
        /// The vertex.
        vertex: u32,
        /// What stands in place of its color.
        color: u32,
    },
    /// Neighbors share a color.
    #[error("vertices {} and {} are neighbors and both have color {color}; recolor one", edge[0], edge[1])]
    Conflict {
        /// The two vertices, ascending.
        edge: [u32; 2],
        /// Their color.
        color: u32,
    },
}

impl Certificate {
    /// Looks at every vertex and edge. O(n + m), in parallel; the violation reported is the one of the lowest vertex.
    ///
    /// # Errors
    /// A vertex without a color or an edge whose ends share one.
    pub fn check(graph: &impl Adjacency, colors: &[u32]) -> Result<Self, Violation> {
        let n = graph.n_vertices();
        if colors.len() != n {
            return Err(Violation::Length { n_colors: colors.len(), n_vertices: n });
        }
        let uncolored = colors.par_iter().position_first(|&c| c as usize >= n);
        let ids = 0..index(uncolored.unwrap_or(n));
        let conflict = ids.into_par_iter().find_map_first(|v| {
            let color = colors[v as usize];
            let other = graph.neighbors(v).iter().find(|&&u| colors[u as usize] == color)?;
            Some(Violation::Conflict { edge: [v.min(*other), v.max(*other)], color })
        });
        if let Some(violation) = conflict {
            return Err(violation);
        }
        if let Some(vertex) = uncolored {
            return Err(Violation::Uncolored { vertex: index(vertex), color: colors[vertex] });
        }
        let n_ids = colors.par_iter().max().map_or(0, |&c| c + 1);
        let class_sizes = crate::coloring::class_sizes(colors, n_ids);
        let degrees = || (0..index(n)).into_par_iter().map(|v| graph.degree(v));
        Ok(Self {
            n_vertices: n,
            n_edges: degrees().map(|d| d as usize).sum::<usize>() / 2,
            max_degree: degrees().max().unwrap_or(0),
            n_colors: index(class_sizes.iter().filter(|&&size| size > 0).count()),
            n_ids,
            class_sizes,
            within_degree: colors.par_iter().zip(0..index(n)).all(|(&c, v)| c <= graph.degree(v)),
        })
    }
}

/// A vertex index; graphs are checked to fit 32 bits when they are made.
#[expect(clippy::cast_possible_truncation, reason = "graphs hold fewer than 2^32 vertices")]
pub(crate) const fn index(i: usize) -> u32 {
    i as u32
}
