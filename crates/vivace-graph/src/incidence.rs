//! Which constraints touch a vertex.

use crate::csr::prefix_sum;
use crate::num::{check_items, check_vertices, first_out_of_range, to_u32};
use crate::{Csr, GraphError};

/// One borrowed list of constraints, flattened: `arity` vertices each.
#[derive(Debug, Clone, Copy)]
pub(crate) struct List<'a> {
    pub(crate) vertices: &'a [u32],
    pub(crate) arity: usize,
}

impl<'a> List<'a> {
    pub(crate) fn new<const K: usize>(constraints: &'a [[u32; K]]) -> Self {
        Self { vertices: constraints.as_flattened(), arity: K.max(1) }
    }

    pub(crate) fn len(&self) -> usize {
        self.vertices.len() / self.arity
    }
}

/// Vertex to constraints: row `v` holds, ascending and once each, the constraints that touch `v`.
///
/// Constraints of several lists are numbered through, in the order in which the lists are given: the first of the second list
/// comes after the last of the first.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Incidence {
    rows: Csr,
}

impl Incidence {
    /// From one list; see [`crate::GraphBuilder::incidence`] for mixed ones. O(vertices + constraints).
    ///
    /// # Errors
    /// A constraint that names a vertex `>= n_vertices`; more of either than 32 bits can number.
    pub fn from_constraints<const K: usize>(
        n_vertices: usize,
        constraints: &[[u32; K]],
    ) -> Result<Self, GraphError> {
        Self::from_lists(n_vertices, &[List::new(constraints)])
    }

    pub(crate) fn from_lists(n_vertices: usize, lists: &[List<'_>]) -> Result<Self, GraphError> {
        check_vertices(n_vertices)?;
        check_items("incidences", lists.iter().map(|list| list.vertices.len()).sum())?;
        for (i, list) in lists.iter().enumerate() {
            check_list(n_vertices, i, list)?;
        }

        let mut offsets = vec![0; n_vertices + 1];
        for &v in lists.iter().flat_map(|list| list.vertices) {
            offsets[v as usize + 1] += 1;
        }
        let mut cursors = prefix_sum(&mut offsets);
        let mut items = vec![0; offsets[n_vertices] as usize];
        let mut repeats = false;
        let mut constraint = 0;
        for list in lists {
            for vertices in list.vertices.chunks_exact(list.arity) {
                for &v in vertices {
                    let (start, cursor) = (offsets[v as usize], &mut cursors[v as usize]);
                    repeats |= *cursor > start && items[*cursor as usize - 1] == constraint;
                    items[*cursor as usize] = constraint;
                    *cursor += 1;
                }
                constraint += 1;
            }
        }
        let rows = Csr::from_parts_unchecked(offsets, items);
        Ok(Self { rows: if repeats { without_repeats(&rows) } else { rows } })
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.rows.n_rows()
    }

    /// The constraints that touch `v`, ascending.
    ///
    /// # Panics
    /// When `v` is not below `n_vertices()`.
    #[inline]
    pub fn constraints(&self, v: u32) -> &[u32] {
        self.rows.row(v)
    }

    /// The rows as arrays.
    pub fn csr(&self) -> &Csr {
        &self.rows
    }

    /// Gives the rows away.
    pub fn into_csr(self) -> Csr {
        self.rows
    }
}

fn check_list(n_vertices: usize, list: usize, constraints: &List<'_>) -> Result<(), GraphError> {
    match first_out_of_range(constraints.vertices, n_vertices) {
        None => Ok(()),
        Some(at) => Err(GraphError::ConstraintOutOfRange {
            list,
            constraint: at / constraints.arity,
            vertex: constraints.vertices[at],
            n_vertices,
        }),
    }
}

/// A constraint that names a vertex twice stands twice, side by side, in that vertex's row.
fn without_repeats(rows: &Csr) -> Csr {
    let mut offsets = vec![0];
    let mut items = Vec::with_capacity(rows.len());
    for row in rows.rows() {
        let start = items.len();
        for &item in row {
            if items.len() == start || items.last() != Some(&item) {
                items.push(item);
            }
        }
        offsets.push(to_u32(items.len()));
    }
    Csr::from_parts_unchecked(offsets, items)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GraphBuilder;

    #[test]
    fn lists_are_numbered_through() {
        let incidence = GraphBuilder::new(5)
            .constraints(&[[0, 1], [1, 2]])
            .constraints(&[[2, 1, 0]])
            .incidence()
            .unwrap();
        let rows: Vec<&[u32]> = (0..5).map(|v| incidence.constraints(v)).collect();
        assert_eq!(rows, [&[0, 2][..], &[0, 1, 2], &[1, 2], &[], &[]]);
    }

    #[test]
    fn a_vertex_named_twice_is_touched_once() {
        let incidence = Incidence::from_constraints(3, &[[1, 0, 1], [1, 1, 1]]).unwrap();
        let rows: Vec<&[u32]> = (0..3).map(|v| incidence.constraints(v)).collect();
        assert_eq!(rows, [&[0][..], &[0, 1], &[]]);
    }

    #[test]
    fn out_of_range_is_named() {
        let error = Incidence::from_constraints(3, &[[0, 1], [2, 3]]).unwrap_err();
        assert_eq!(
            error,
            GraphError::ConstraintOutOfRange { list: 0, constraint: 1, vertex: 3, n_vertices: 3 }
        );
    }
}
