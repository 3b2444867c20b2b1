//! A graph whose edges come and go, such as the contacts of a frame.

use crate::build::regather_rows;
use crate::num::{check_items, check_vertices, to_u32};
use crate::{Adjacency, ConstraintGraph, GraphError};

/// Adjacency under insertion and removal, at a cost in proportion to the change.
///
/// A *multigraph*: each constraint holds an edge of its own, so a pair that two contacts share is inserted twice and stays
/// adjacent until both are removed. Rows are in no particular order, but equal edits give equal rows.
///
/// Rows lie in one pool with slack at their ends. A row without slack moves to the end of the pool with twice the room; when
/// the pool has grown to twice what it would be if packed, it is packed, in the order of the vertices. The growth and the removals
/// since the last time pay for that, so an insertion is O(1) amortised and leaves at most 4 places for each edge and each vertex;
/// the one that packs is O(n + m).
#[derive(Debug, Clone, Default)]
pub struct DynamicGraph {
    rows: Vec<Row>,
    pool: Vec<u32>,
    /// Sum of the rows' lengths: twice the number of edges.
    n_items: usize,
}

#[derive(Debug, Clone, Copy, Default)]
struct Row {
    start: usize,
    len: u32,
    capacity: u32,
}

impl Row {
    fn items(self) -> std::ops::Range<usize> {
        self.start..self.start + self.len as usize
    }

    fn end_of_room(self) -> usize {
        self.start + self.capacity as usize
    }
}

/// Places that a packed row has to spare.
const SLACK: u32 = 2;

impl DynamicGraph {
    /// `n_vertices` vertices without edges.
    ///
    /// # Errors
    /// More vertices than 32 bits can number.
    pub fn new(n_vertices: usize) -> Result<Self, GraphError> {
        check_vertices(n_vertices)?;
        Ok(Self { rows: vec![Row::default(); n_vertices], ..Self::default() })
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.rows.len()
    }

    /// Number of edges, a pair inserted twice counted twice.
    pub fn n_edges(&self) -> usize {
        self.n_items / 2
    }

    /// The other end of each edge at `v`, in no particular order.
    ///
    /// # Panics
    /// When `v` is not below `n_vertices()`.
    #[inline]
    pub fn neighbors(&self, v: u32) -> &[u32] {
        &self.pool[self.rows[v as usize].items()]
    }

    /// Number of edges at `v`.
    ///
    /// # Panics
    /// When `v` is not below `n_vertices()`.
    #[inline]
    pub fn degree(&self, v: u32) -> u32 {
        self.rows[v as usize].len
    }

    /// Whether an edge joins `u` and `v`. O(the smaller degree).
    pub fn contains(&self, u: u32, v: u32) -> bool {
        let n = self.n_vertices();
        if u as usize >= n || v as usize >= n {
            return false;
        }
        let (u, v) = if self.degree(u) <= self.degree(v) { (u, v) } else { (v, u) };
        self.neighbors(u).contains(&v)
    }

    /// Adds one edge. O(1) amortised.
    ///
    /// # Errors
    /// A self loop, an end that is not there, more edges than 32 bits can number; the graph is then as before.
    pub fn insert(&mut self, u: u32, v: u32) -> Result<(), GraphError> {
        self.check_edge([u, v])?;
        self.check_room(1)?;
        self.insert_checked([u, v]);
        Ok(())
    }

    /// Takes away one edge between `u` and `v`; `false` when there is none. O(degree).
    pub fn remove(&mut self, u: u32, v: u32) -> bool {
        if !self.contains(u, v) {
            return false;
        }
        self.take(u, v);
        self.take(v, u);
        self.n_items -= 2;
        true
    }

    /// Takes away one edge for each of `removed`, then adds `inserted`; says how many of `removed` were there.
    ///
    /// # Errors
    /// As [`DynamicGraph::insert`], for any of `inserted`; the graph is then as before, nothing removed either.
    pub fn apply(&mut self, removed: &[[u32; 2]], inserted: &[[u32; 2]]) -> Result<usize, GraphError> {
        inserted.iter().try_for_each(|&edge| self.check_edge(edge))?;
        self.check_room(inserted.len())?;
        let n_removed = removed.iter().filter(|&&[u, v]| self.remove(u, v)).count();
        for &edge in inserted {
            self.insert_checked(edge);
        }
        Ok(n_removed)
    }

    /// The simple graph of who is adjacent now. O(n + m log d).
    pub fn to_graph(&self) -> ConstraintGraph {
        ConstraintGraph::from_rows_unchecked(regather_rows(self.n_vertices(), |v, row| {
            row.extend(self.neighbors(v));
        }))
    }

    fn check_edge(&self, edge: [u32; 2]) -> Result<(), GraphError> {
        let n_vertices = self.n_vertices();
        if edge.iter().any(|&v| v as usize >= n_vertices) {
            return Err(GraphError::EdgeOutOfRange { edge, n_vertices });
        }
        if edge[0] == edge[1] { Err(GraphError::SelfLoop { vertex: edge[0] }) } else { Ok(()) }
    }

    fn check_room(&self, n_edges: usize) -> Result<(), GraphError> {
        check_items(
            "stored neighbors (two for each edge)",
            self.n_items.saturating_add(n_edges.saturating_mul(2)),
        )
    }

    fn insert_checked(&mut self, [u, v]: [u32; 2]) {
        self.push(u, v);
        self.push(v, u);
        self.n_items += 2;
        if self.pool.len() > 2 * (self.n_items + SLACK as usize * self.n_vertices()) {
            self.pack();
        }
    }

    fn push(&mut self, v: u32, neighbor: u32) {
        let mut row = self.rows[v as usize];
        if row.len == row.capacity {
            let capacity = row.capacity.saturating_mul(2).max(4);
            if row.end_of_room() != self.pool.len() {
                let start = self.pool.len();
                self.pool.extend_from_within(row.items());
                row.start = start;
            }
            row.capacity = capacity;
            self.pool.resize(row.end_of_room(), 0);
        }
        self.pool[row.start + row.len as usize] = neighbor;
        row.len += 1;
        self.rows[v as usize] = row;
    }

    /// Removes one occurrence of `neighbor`, which is there, from row `v`. From the back: what came last tends to go first.
    fn take(&mut self, v: u32, neighbor: u32) {
        let row = &mut self.rows[v as usize];
        let items = &mut self.pool[row.items()];
        if let (Some(at), Some(last)) =
            (items.iter().rposition(|&u| u == neighbor), items.len().checked_sub(1))
        {
            items.swap(at, last);
            row.len -= 1;
        }
    }

    fn pack(&mut self) {
        let old = std::mem::take(self);
        self.pack_rows(old.rows.iter().map(|row| &old.pool[row.items()]));
    }

    /// Fills an empty graph with these rows, each with some slack.
    fn pack_rows<'a>(&mut self, rows: impl ExactSizeIterator<Item = &'a [u32]>) {
        self.rows.reserve_exact(rows.len());
        for items in rows {
            let (start, len) = (self.pool.len(), to_u32(items.len()));
            let row = Row { start, len, capacity: len.saturating_add(SLACK) };
            self.pool.extend_from_slice(items);
            self.pool.resize(row.end_of_room(), 0);
            self.rows.push(row);
            self.n_items += items.len();
        }
    }
}

impl From<&ConstraintGraph> for DynamicGraph {
    /// Each edge once. O(n + m).
    fn from(graph: &ConstraintGraph) -> Self {
        let mut dynamic = Self::default();
        dynamic.pack_rows(graph.csr().rows());
        dynamic
    }
}

impl Adjacency for DynamicGraph {
    fn n_vertices(&self) -> usize {
        DynamicGraph::n_vertices(self)
    }

    #[inline]
    fn neighbors(&self, v: u32) -> &[u32] {
        DynamicGraph::neighbors(self, v)
    }

    #[inline]
    fn degree(&self, v: u32) -> u32 {
        DynamicGraph::degree(self, v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(graph: &DynamicGraph, v: u32) -> Vec<u32> {
        let mut row = graph.neighbors(v).to_vec();
        row.sort_unstable();
        row
    }

    #[test]
    fn a_pair_held_twice_stays_until_both_are_gone() {
        let path = ConstraintGraph::from_edges(3, &[[0, 1], [1, 2]]).unwrap();
        let mut graph = DynamicGraph::from(&path);
        graph.insert(2, 1).unwrap();
        assert_eq!((graph.n_edges(), graph.degree(1)), (3, 3));
        assert_eq!(sorted(&graph, 1), [0, 2, 2]);
        assert!(graph.remove(1, 2));
        assert_eq!(graph.to_graph(), path);
        assert!(graph.remove(1, 2));
        assert!(!graph.remove(1, 2) && !graph.contains(1, 2));
        assert_eq!(graph.to_graph(), ConstraintGraph::from_edges(3, &[[0, 1]]).unwrap());
    }

    #[test]
    fn bad_edges_change_nothing() {
        let mut graph = DynamicGraph::new(3).unwrap();
        graph.insert(0, 1).unwrap();
        assert_eq!(graph.insert(1, 1), Err(GraphError::SelfLoop { vertex: 1 }));
        assert_eq!(graph.insert(0, 3), Err(GraphError::EdgeOutOfRange { edge: [0, 3], n_vertices: 3 }));
        assert!(!graph.remove(0, 3) && !graph.remove(7, 0) && !graph.remove(2, 2));
        assert!(graph.apply(&[[0, 1]], &[[1, 2], [2, 2]]).is_err());
        assert_eq!((sorted(&graph, 0), graph.n_edges()), (vec![1], 1));
        assert_eq!(graph.apply(&[[1, 0], [1, 0]], &[[1, 2]]), Ok(1));
        assert_eq!((sorted(&graph, 0), sorted(&graph, 1)), (vec![], vec![2]));
    }

    #[test]
    fn the_pool_stays_in_proportion_and_packing_keeps_the_rows() {
        // A heap of contacts among 30 vertices that wanders through 300, over a ring that stays.
        let n = 300;
        let ring: Vec<[u32; 2]> = (0..n).map(|v| [v, (v + 1) % n]).collect();
        let mut graph = DynamicGraph::from(&ConstraintGraph::from_edges(300, &ring).unwrap());
        let heap = |at: u32| (0..30).flat_map(move |i| (0..i).map(move |j| [(at + i) % n, (at + j) % n]));
        for at in (0..n).step_by(7) {
            let contacts: Vec<[u32; 2]> = heap(at).collect();
            graph.apply(&[], &contacts).unwrap();
            assert!(graph.pool.len() <= 2 * (graph.n_items + 2 * 300), "{} places at {at}", graph.pool.len());
            let expected = ConstraintGraph::from_edges(300, &[&ring[..], &contacts].concat()).unwrap();
            assert_eq!(graph.to_graph(), expected);
            assert_eq!(graph.apply(&contacts, &[]), Ok(contacts.len()));
        }
        assert_eq!(graph.n_edges(), 300);
    }

    #[test]
    fn a_hub_takes_room_in_proportion() {
        let mut graph = DynamicGraph::from(&ConstraintGraph::from_edges(100_001, &[]).unwrap());
        for v in 1..=100_000 {
            graph.insert(0, v).unwrap();
        }
        assert_eq!(graph.degree(0), 100_000);
        assert!(graph.pool.len() < 900_000, "{}", graph.pool.len());
    }
}
