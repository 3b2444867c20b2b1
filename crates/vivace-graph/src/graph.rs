//! The constraint graph: two vertices are neighbors when a constraint holds both.

use rayon::prelude::*;

use crate::build::{gather_rows, regather_rows};
use crate::num::{check_vertices, first_out_of_range, to_u32};
use crate::{Adjacency, Csr, GraphBuilder, GraphError, Incidence};

/// An undirected simple graph: rows strictly ascending, symmetric, without self loops.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ConstraintGraph {
    rows: Csr,
}

impl ConstraintGraph {
    /// From anyone's compressed rows, such as a sparse matrix's pattern: row `v` is `neighbors[offsets[v]..offsets[v + 1]]`.
    ///
    /// Rows are sorted, repeats and self loops dropped, and a pair that stands in one direction only is added in the other.
    /// Arrays that need none of that are taken as they are, without a copy. O(n + m log d) for rows of length d.
    ///
    /// # Errors
    /// Offsets that do not delimit rows; an entry that is no row; more than 32 bits can number.
    pub fn from_csr(offsets: Vec<u32>, neighbors: Vec<u32>) -> Result<Self, GraphError> {
        let rows = Csr::from_parts(offsets, neighbors)?;
        check_entries(&rows)?;
        if is_clean(&rows) {
            return Ok(Self { rows });
        }
        let columns = transposed(&rows);
        let rows = gather_rows(rows.n_rows(), |v, row| {
            row.extend(rows.row(v));
            row.extend(columns.row(v));
        })?;
        Ok(Self { rows })
    }

    /// From pairs in any order; repeats count once and `[v, v]` not at all. O(n + m), and m log d to sort rows of length d.
    ///
    /// # Errors
    /// An edge that names a vertex `>= n_vertices`; more than 32 bits can number.
    pub fn from_edges(n_vertices: usize, edges: &[[u32; 2]]) -> Result<Self, GraphError> {
        Self::from_constraints(n_vertices, edges)
    }

    /// From constraints on `K` vertices each, every one a clique. See [`GraphBuilder`] for lists of different `K`.
    ///
    /// # Errors
    /// A constraint that names a vertex `>= n_vertices`; more than 32 bits can number.
    pub fn from_constraints<const K: usize>(
        n_vertices: usize,
        constraints: &[[u32; K]],
    ) -> Result<Self, GraphError> {
        GraphBuilder::new(n_vertices).constraints(constraints).build()
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.rows.n_rows()
    }

    /// Number of edges, each counted once.
    pub fn n_edges(&self) -> usize {
        self.rows.len() / 2
    }

    /// The vertices adjacent to `v`, strictly ascending.
    ///
    /// # Panics
    /// When `v` is not below `n_vertices()`.
    #[inline]
    pub fn neighbors(&self, v: u32) -> &[u32] {
        self.rows.row(v)
    }

    /// Number of neighbors of `v`.
    ///
    /// # Panics
    /// When `v` is not below `n_vertices()`.
    #[inline]
    pub fn degree(&self, v: u32) -> u32 {
        let offsets = self.rows.offsets();
        offsets[v as usize + 1] - offsets[v as usize]
    }

    /// Largest degree; 0 without vertices. O(n).
    pub fn max_degree(&self) -> u32 {
        self.degrees().max().unwrap_or(0)
    }

    /// Smallest degree; 0 without vertices. O(n).
    pub fn min_degree(&self) -> u32 {
        self.degrees().min().unwrap_or(0)
    }

    /// Mean degree; 0 without vertices.
    pub fn mean_degree(&self) -> f64 {
        if self.n_vertices() == 0 { 0.0 } else { self.rows.len() as f64 / self.n_vertices() as f64 }
    }

    /// Degree of each vertex, in order.
    pub fn degrees(&self) -> impl Iterator<Item = u32> {
        self.rows.offsets().windows(2).map(|ends| ends[1] - ends[0])
    }

    /// The rows as arrays: each edge stands in both directions.
    pub fn csr(&self) -> &Csr {
        &self.rows
    }

    /// Gives the rows away.
    pub fn into_csr(self) -> Csr {
        self.rows
    }

    /// Each edge once, `[u, v]` with u < v, ascending.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        (0..to_u32(self.n_vertices())).flat_map(|u| {
            let row = self.neighbors(u);
            row[row.partition_point(|&v| v < u)..].iter().map(move |&v| [u, v])
        })
    }

    /// The same graph with vertex `v` numbered `new_number[v]`. O(n + m log d).
    ///
    /// # Errors
    /// A numbering that does not use each of `0..n_vertices()` once.
    pub fn permuted(&self, new_number: &[u32]) -> Result<Self, GraphError> {
        let old_number = inverse(self.n_vertices(), new_number)?;
        let rows = regather_rows(self.n_vertices(), |new, row| {
            for &neighbor in self.neighbors(old_number[new as usize]) {
                row.push(new_number[neighbor as usize]);
            }
        });
        Ok(Self { rows })
    }

    /// This graph and more edges, as [`ConstraintGraph::from_edges`] takes them; O(n + m). For edges that come and go at each
    /// frame see [`crate::DynamicGraph`].
    ///
    /// # Errors
    /// As [`ConstraintGraph::from_edges`].
    pub fn with_edges(&self, edges: &[[u32; 2]]) -> Result<Self, GraphError> {
        let incidence = Incidence::from_constraints(self.n_vertices(), edges)?;
        let rows = gather_rows(self.n_vertices(), |v, row| {
            row.extend(self.neighbors(v));
            for &edge in incidence.constraints(v) {
                row.extend(&edges[edge as usize]);
            }
        })?;
        Ok(Self { rows })
    }

    /// Connected components: how many, and the component of each vertex, numbered by their lowest vertex. O(n + m).
    pub fn components(&self) -> (usize, Vec<u32>) {
        const NONE: u32 = u32::MAX;
        let mut component = vec![NONE; self.n_vertices()];
        let (mut count, mut stack) = (0, Vec::new());
        for root in 0..to_u32(self.n_vertices()) {
            if component[root as usize] != NONE {
                continue;
            }
            component[root as usize] = count;
            stack.push(root);
            while let Some(v) = stack.pop() {
                for &u in self.neighbors(v) {
                    if component[u as usize] == NONE {
                        component[u as usize] = count;
                        stack.push(u);
                    }
                }
            }
            count += 1;
        }
        (count as usize, component)
    }

    /// For rows that hold the invariant by the way they were made.
    pub(crate) fn from_rows_unchecked(rows: Csr) -> Self {
        debug_assert!(is_clean(&rows));
        Self { rows }
    }
}

impl Adjacency for ConstraintGraph {
    fn n_vertices(&self) -> usize {
        ConstraintGraph::n_vertices(self)
    }

    #[inline]
    fn neighbors(&self, v: u32) -> &[u32] {
        ConstraintGraph::neighbors(self, v)
    }

    #[inline]
    fn degree(&self, v: u32) -> u32 {
        ConstraintGraph::degree(self, v)
    }
}

fn check_entries(rows: &Csr) -> Result<(), GraphError> {
    let n_vertices = rows.n_rows();
    check_vertices(n_vertices)?;
    match first_out_of_range(rows.items(), n_vertices) {
        None => Ok(()),
        Some(at) => {
            let row = rows.offsets().partition_point(|&start| start as usize <= at) - 1;
            let entry = at - rows.offsets()[row] as usize;
            Err(GraphError::NeighborOutOfRange { row, entry, vertex: rows.items()[at], n_vertices })
        }
    }
}

/// Whether rows with entries in range are strictly ascending, without self loops and symmetric.
///
/// Each upper entry must have its mirror image. Mirror images of different entries differ and lie below, so if the upper entries
/// are half of all, the lower ones have theirs too and none is left for a self loop.
fn is_clean(rows: &Csr) -> bool {
    let n = to_u32(rows.n_rows());
    let n_upper: Option<usize> = (0..n)
        .into_par_iter()
        .with_min_len(1024)
        .map(|v| {
            let row = rows.row(v);
            let upper = &row[row.partition_point(|&u| u <= v)..];
            let is_fine = row.windows(2).all(|pair| pair[0] < pair[1])
                && upper.iter().all(|&u| rows.row(u).binary_search(&v).is_ok());
            is_fine.then_some(upper.len())
        })
        .sum();
    n_upper.is_some_and(|n_upper| 2 * n_upper == rows.len())
}

/// Row `v` holds, ascending, the rows in which `v` stands.
fn transposed(rows: &Csr) -> Csr {
    let (offsets, mut items) = Csr::group_by(rows.n_rows(), rows.items()).into_parts();
    let mut row_of = vec![0; rows.len()];
    for (row, ends) in rows.offsets().windows(2).enumerate() {
        row_of[ends[0] as usize..ends[1] as usize].fill(to_u32(row));
    }
    for item in &mut items {
        *item = row_of[*item as usize];
    }
    Csr::from_parts_unchecked(offsets, items)
}

/// Checks that `new_number` is a numbering of `n_vertices` vertices and turns it round.
fn inverse(n_vertices: usize, new_number: &[u32]) -> Result<Vec<u32>, GraphError> {
    if new_number.len() != n_vertices {
        return Err(GraphError::NumberingLength { found: new_number.len(), n_vertices });
    }
    let mut old_number = vec![u32::MAX; n_vertices];
    for (vertex, &number) in new_number.iter().enumerate() {
        let wrong = |why| Err(GraphError::Numbering { vertex, number, why, n_vertices });
        match old_number.get_mut(number as usize) {
            None => return wrong("out of range"),
            Some(old) if *old != u32::MAX => return wrong("taken already"),
            Some(old) => *old = to_u32(vertex),
        }
    }
    Ok(old_number)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles over the edge 1-2, and vertex 4 alone.
    fn bowtie() -> ConstraintGraph {
        ConstraintGraph::from_constraints(5, &[[0, 1, 2], [1, 3, 2]]).unwrap()
    }

    fn rows(graph: &ConstraintGraph) -> Vec<&[u32]> {
        graph.csr().rows().collect()
    }

    #[test]
    fn triangles_are_cliques() {
        let graph = bowtie();
        assert_eq!(rows(&graph), [&[1, 2][..], &[0, 2, 3], &[0, 1, 3], &[1, 2], &[]]);
        assert_eq!((graph.n_vertices(), graph.n_edges()), (5, 5));
        assert_eq!((graph.min_degree(), graph.max_degree(), graph.mean_degree()), (0, 3, 2.0));
        assert_eq!(graph.edges().collect::<Vec<_>>(), [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
        assert_eq!(graph.components(), (2, vec![0, 0, 0, 0, 1]));
    }

    #[test]
    fn nothing_is_a_graph() {
        let empty = GraphBuilder::new(0).build().unwrap();
        assert_eq!(empty, ConstraintGraph::default());
        assert_eq!(empty, ConstraintGraph::from_csr(vec![0], vec![]).unwrap());
        assert_eq!((empty.min_degree(), empty.max_degree(), empty.mean_degree()), (0, 0, 0.0));
        assert_eq!(empty.components(), (0, vec![]));
        assert_eq!(empty.edges().count(), 0);
        let no_edges = ConstraintGraph::from_constraints::<0>(3, &[[], []]).unwrap();
        assert_eq!((no_edges.n_vertices(), no_edges.n_edges()), (3, 0));
    }

    #[test]
    fn clean_arrays_are_taken_without_a_copy() {
        let (offsets, items) = bowtie().into_csr().into_parts();
        let places = (offsets.as_ptr(), items.as_ptr());
        let graph = ConstraintGraph::from_csr(offsets, items).unwrap();
        assert_eq!(graph, bowtie());
        let (offsets, items) = graph.into_csr().into_parts();
        assert_eq!((offsets.as_ptr(), items.as_ptr()), places);
    }

    #[test]
    fn each_kind_of_dirt_is_cleaned() {
        for (what, offsets, items) in [
            ("unsorted", [0, 2, 3, 4], vec![2, 1, 0, 0]),
            ("repeated", [0, 3, 4, 5], vec![1, 1, 2, 0, 0]),
            ("repeated on both sides", [0, 4, 6, 8], vec![1, 1, 2, 2, 0, 0, 0, 0]),
            ("self loop", [0, 3, 4, 5], vec![0, 1, 2, 0, 0]),
            ("upper only", [0, 2, 2, 2], vec![1, 2]),
            ("lower only", [0, 0, 1, 2], vec![0, 0]),
            ("as many up as down", [0, 1, 1, 2], vec![1, 0]),
        ] {
            let graph = ConstraintGraph::from_csr(offsets.to_vec(), items).unwrap();
            assert_eq!(rows(&graph), [&[1, 2][..], &[0], &[0]], "{what}");
        }
    }

    #[test]
    fn bad_rows_are_named() {
        let error = ConstraintGraph::from_csr(vec![0, 1, 1, 3], vec![1, 0, 3]).unwrap_err();
        assert_eq!(error, GraphError::NeighborOutOfRange { row: 2, entry: 1, vertex: 3, n_vertices: 3 });
        let error = GraphBuilder::new(3).constraints(&[[0, 1]]).constraints(&[[0, 1, 2], [0, 1, 9]]).build();
        let error = error.unwrap_err().to_string();
        assert!(
            error.starts_with("constraint 1 of list 1 names vertex 9, but there are 3 vertices"),
            "{error}"
        );
        assert!(matches!(
            ConstraintGraph::from_edges(usize::MAX, &[]),
            Err(GraphError::TooLarge { count: usize::MAX, .. })
        ));
    }

    #[test]
    fn renumbering() {
        let path = ConstraintGraph::from_edges(3, &[[0, 1], [1, 2]]).unwrap();
        assert_eq!(rows(&path.permuted(&[2, 0, 1]).unwrap()), [&[1, 2][..], &[0], &[0]]);
        let why = |numbers: &[u32]| path.permuted(numbers).unwrap_err().to_string();
        assert!(why(&[0, 1]).starts_with("the numbering has 2 entries for 3 vertices"));
        assert!(why(&[0, 1, 1]).contains("vertex 2 is given the number 1, which is taken already"));
        assert!(why(&[0, 3, 1]).contains("vertex 1 is given the number 3, which is out of range"));
    }

    #[test]
    fn more_edges() {
        let graph = bowtie().with_edges(&[[4, 0], [2, 1], [3, 3]]).unwrap();
        assert_eq!(rows(&graph), [&[1, 2, 4][..], &[0, 2, 3], &[0, 1, 3], &[1, 2], &[0]]);
        assert!(bowtie().with_edges(&[[0, 5]]).is_err());
    }

    #[test]
    fn hubs_and_cliques() {
        let spokes: Vec<[u32; 2]> = (1..=100_000).rev().map(|v| [v, 0]).collect();
        let star = ConstraintGraph::from_edges(100_001, &spokes).unwrap();
        assert_eq!((star.degree(0), star.n_edges()), (100_000, 100_000));
        let clique = ConstraintGraph::from_constraints(400, &[std::array::from_fn::<u32, 400, _>(to_u32)]);
        assert_eq!(clique.unwrap().n_edges(), 400 * 399 / 2);
    }
}
