//! What a coloring asks of a graph.

/// Who is adjacent to whom, row by row. Vertices are `0..n_vertices()`.
///
/// Implementors keep the relation symmetric and free of self loops; a row may hold a neighbor more than once (see
/// [`crate::DynamicGraph`]) and in any order, so whoever counts distinct neighbors must allow for that.
pub trait Adjacency: Sync {
    /// Number of vertices.
    fn n_vertices(&self) -> usize;

    /// The vertices adjacent to `v`.
    ///
    /// # Panics
    /// When `v` is not below `n_vertices()`.
    fn neighbors(&self, v: u32) -> &[u32];

    /// Length of the row of `v`.
    ///
    /// # Panics
    /// When `v` is not below `n_vertices()`.
    fn degree(&self, v: u32) -> u32 {
        crate::num::to_u32(self.neighbors(v).len())
    }
}

impl<A: Adjacency + ?Sized> Adjacency for &A {
    fn n_vertices(&self) -> usize {
        (**self).n_vertices()
    }

    fn neighbors(&self, v: u32) -> &[u32] {
        (**self).neighbors(v)
    }

    fn degree(&self, v: u32) -> u32 {
        (**self).degree(v)
    }
}
