//! The constraint graph: two vertices are neighbors when a constraint holds both.

use rayon::prelude::*;

use crate::build::gather_rows;
use crate::incidence::List;
use crate::num::{check_vertices, to_u32};
use crate::{Adjacency, Csr, GraphError, Incidence};

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
        let rows = gather_rows(self.n_vertices(), |new, row| {
            for &neighbor in self.neighbors(old_number[new as usize]) {
                row.push(new_number[neighbor as usize]);
            }
        })?;
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
    #[expect(dead_code, reason = "for the modules that follow")]
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
        Ok(ConstraintGraph { rows })
    }

    /// The same lists as an [`Incidence`]: vertex to constraints, numbered through in the order of the lists.
    ///
    /// # Errors
    /// As [`GraphBuilder::build`].
    pub fn incidence(&self) -> Result<Incidence, GraphError> {
        Incidence::from_lists(self.n_vertices, &self.lists)
    }
}

fn check_entries(rows: &Csr) -> Result<(), GraphError> {
    let n_vertices = rows.n_rows();
    check_vertices(n_vertices)?;
    let is_out = |v: &u32| *v as usize >= n_vertices;
    match rows.items().par_iter().with_min_len(1 << 14).position_first(is_out) {
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
/// Each upper entry must have its mirror image. Mirror images of different entries differ, so if there are as many upper
/// entries as lower ones, the lower ones have theirs too and need no search.
fn is_clean(rows: &Csr) -> bool {
    let n = to_u32(rows.n_rows());
    let n_upper: Option<usize> = (0..n)
        .into_par_iter()
        .with_min_len(1024)
        .map(|v| {
            let row = rows.row(v);
            let upper = &row[row.partition_point(|&u| u <= v)..];
            let is_fine = row.windows(2).all(|pair| pair[0] < pair[1])
                && row.binary_search(&v).is_err()
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
