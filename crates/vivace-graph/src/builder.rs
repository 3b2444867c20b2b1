//! Graphs from constraint lists of different sizes.

use crate::build::gather_rows;
use crate::incidence::List;
use crate::{ConstraintGraph, GraphError, Incidence};

/// Collects constraint lists of different sizes, borrowed, into one graph.
///
/// A list may be empty, a constraint may repeat, and may name a vertex twice.
#[derive(Debug, Clone)]
pub struct GraphBuilder<'a> {
    n_vertices: usize,
    lists: Vec<List<'a>>,
}

impl<'a> GraphBuilder<'a> {
    /// A graph of `n_vertices` vertices and no edges yet.
    pub fn new(n_vertices: usize) -> Self {
        Self { n_vertices, lists: Vec::new() }
    }

    /// Adds constraints on `K` vertices each, every one a clique.
    #[must_use]
    pub fn constraints<const K: usize>(mut self, constraints: &'a [[u32; K]]) -> Self {
        self.lists.push(List::new(constraints));
        self
    }

    /// The graph: a counting sort from vertices to constraints, then each vertex gathers its row, in parallel in the caller's
    /// rayon pool. O(n + sum of K²) and the sorting of the rows.
    ///
    /// # Errors
    /// A constraint that names a vertex `>= n_vertices`; more than 32 bits can number.
    pub fn build(&self) -> Result<ConstraintGraph, GraphError> {
        let incidence = self.incidence()?;
        let ends: Vec<usize> = self
            .lists
            .iter()
            .scan(0, |end, list| {
                *end += list.len();
                Some(*end)
            })
            .collect();
        let rows = gather_rows(self.n_vertices, |v, row| {
            let (mut list, mut start, mut end) = (0, 0, 0);
            for constraint in incidence.constraints(v).iter().map(|&constraint| constraint as usize) {
                if constraint >= end {
                    list = ends.partition_point(|&end| end <= constraint);
                    (start, end) = (ends[list] - self.lists[list].len(), ends[list]);
                }
                let List { vertices, arity } = self.lists[list];
                let at = (constraint - start) * arity;
                row.extend(&vertices[at..at + arity]);
            }
        })?;
        Ok(ConstraintGraph::from_rows_unchecked(rows))
    }

    /// The same lists as an [`Incidence`]: vertex to constraints, numbered through in the order of the lists.
    ///
    /// # Errors
    /// As [`GraphBuilder::build`].
    pub fn incidence(&self) -> Result<Incidence, GraphError> {
        Incidence::from_lists(self.n_vertices, &self.lists)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixed_lists_meet_in_one_graph() {
        let (edges, hinges, none): ([_; 2], [_; 1], [[u32; 3]; 0]) = ([[0, 1], [5, 5]], [[1, 2, 3, 4]], []);
        let graph =
            GraphBuilder::new(6).constraints(&edges).constraints(&none).constraints(&hinges).build().unwrap();
        assert_eq!(
            graph.csr().rows().collect::<Vec<_>>(),
            [&[1][..], &[0, 2, 3, 4], &[1, 3, 4], &[1, 2, 4], &[1, 2, 3], &[]]
        );
    }

    #[test]
    fn a_constraint_out_of_range_is_named() {
        let error = GraphBuilder::new(3).constraints(&[[0, 1]]).constraints(&[[0, 1, 2], [0, 1, 9]]).build();
        let error = error.unwrap_err().to_string();
        assert!(
            error.starts_with("constraint 1 of list 1 names vertex 9, but there are 3 vertices"),
            "{error}"
        );
    }
}
