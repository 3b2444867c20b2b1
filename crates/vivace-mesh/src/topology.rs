//! What hangs together in a list of triangles: edges, fans, components. Sorting and disjoint sets only, so that a hub of any
//! degree costs n log n.
//!
//! A triangle that names a vertex twice has no edges here and joins nothing: so there are no self edges anywhere.

use crate::mesh::{index32, repeated};

/// One side of one triangle: the edge, and the corner opposite to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side {
    /// Ends of the edge, the lower vertex in the upper half.
    key: u64,
    /// 3 · triangle + which corner is opposite.
    corner: usize,
}

impl Side {
    pub(crate) fn triangle(self) -> usize {
        self.corner / 3
    }

    /// The corners at the start and at the end of this side, in the triangle's own direction.
    fn end_corners(self) -> [usize; 2] {
        let (first, k) = (self.corner - self.corner % 3, self.corner % 3);
        [first + (k + 1) % 3, first + (k + 2) % 3]
    }

    /// Start, end and opposite vertex, in the triangle's own direction.
    pub(crate) fn vertices(self, triangles: &[[u32; 3]]) -> [u32; 3] {
        let [start, end] = self.end_corners();
        [start, end, self.corner].map(|c| triangles[c / 3][c % 3])
    }
}

/// The sides of all triangles, sorted by edge, then by triangle.
pub(crate) struct Sides(Vec<Side>);

impl Sides {
    pub(crate) fn of(triangles: &[[u32; 3]]) -> Self {
        let mut sides = Vec::with_capacity(3 * triangles.len());
        for (t, triangle) in triangles.iter().enumerate() {
            if repeated(triangle).is_none() {
                for k in 0..3 {
                    let key = edge_key(triangle[(k + 1) % 3], triangle[(k + 2) % 3]);
                    sides.push(Side { key, corner: 3 * t + k });
                }
            }
        }
        sides.sort_unstable();
        Self(sides)
    }

    /// The sides of each edge together, edges ascending.
    pub(crate) fn edges(&self) -> impl Iterator<Item = &[Side]> {
        self.0.chunk_by(|a, b| a.key == b.key)
    }
}

/// The ends of an edge as one number, so that edges sort by their lower, then by their higher vertex.
pub(crate) fn edge_key(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

/// The ends of an edge, lower vertex first.
pub(crate) fn edge_ends(key: u64) -> [u32; 2] {
    #[expect(clippy::cast_possible_truncation, reason = "the two halves of the key, taken apart")]
    let ends = [(key >> 32) as u32, key as u32];
    ends
}

/// The distinct edges among keys in any order, ascending.
pub(crate) fn distinct_edges(mut keys: Vec<u64>) -> Vec<[u32; 2]> {
    keys.sort_unstable();
    keys.dedup();
    keys.into_iter().map(edge_ends).collect()
}

/// How many edges end at each vertex.
pub(crate) fn degrees(n_vertices: usize, edges: &[[u32; 2]]) -> Vec<u32> {
    let mut degrees = vec![0; n_vertices];
    for &end in edges.iter().flatten() {
        degrees[end as usize] += 1;
    }
    degrees
}

/// What is counted while the edges of a triangle list are visited once.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct EdgeCounts {
    pub(crate) edges: usize,
    /// In one triangle.
    pub(crate) boundary: usize,
    /// In exactly two triangles that differ in the opposite vertex.
    pub(crate) hinges: usize,
    /// In exactly two triangles of the same three vertices.
    pub(crate) folded: usize,
    /// In more than two triangles.
    pub(crate) nonmanifold: usize,
    /// In exactly two triangles that run along it in the same direction.
    pub(crate) misoriented: usize,
}

impl EdgeCounts {
    pub(crate) fn of(triangles: &[[u32; 3]], sides: &Sides) -> Self {
        let mut counts = Self::default();
        for edge in sides.edges() {
            counts.edges += 1;
            match *edge {
                [_] => counts.boundary += 1,
                [one, other] => {
                    let (one, other) = (one.vertices(triangles), other.vertices(triangles));
                    counts.misoriented += usize::from(one[0] == other[0]);
                    if one[2] == other[2] {
                        counts.folded += 1;
                    } else {
                        counts.hinges += 1;
                    }
                }
                _ => counts.nonmanifold += 1,
            }
        }
        counts
    }
}

/// The vertices where the triangles form more than one fan (two cones that touch in their tips), ascending.
///
/// Triangles are of one fan when they share an edge at the vertex, however many share it: where only edges are at fault,
/// vertices are not blamed.
pub(crate) fn nonmanifold_vertices(n_vertices: usize, triangles: &[[u32; 3]], sides: &Sides) -> Vec<u32> {
    let mut fans = DisjointSets::new(3 * triangles.len());
    for edge in sides.edges() {
        let ends = |side: Side| {
            let [start, end] = side.end_corners();
            if side.vertices(triangles)[0] == edge_ends(side.key)[0] { [start, end] } else { [end, start] }
        };
        for pair in edge.windows(2) {
            let (one, other) = (ends(pair[0]), ends(pair[1]));
            fans.join(one[0], other[0]);
            fans.join(one[1], other[1]);
        }
    }
    let mut n_fans = vec![0_u32; n_vertices];
    for (corner, &vertex) in triangles.as_flattened().iter().enumerate() {
        if fans.root(corner) == corner && repeated(&triangles[corner / 3]).is_none() {
            n_fans[vertex as usize] += 1;
        }
    }
    (0..n_vertices).filter(|&v| n_fans[v] > 1).map(index32).collect()
}

/// The component of each vertex, numbered from 0 in the order of their lowest vertices.
pub(crate) fn components(n_vertices: usize, edges: impl IntoIterator<Item = [u32; 2]>) -> Vec<u32> {
    let mut sets = DisjointSets::new(n_vertices);
    for [a, b] in edges {
        sets.join(a as usize, b as usize);
    }
    let mut labels = vec![u32::MAX; n_vertices];
    let mut n_components = 0;
    for vertex in 0..n_vertices {
        let root = sets.root(vertex);
        if labels[root] == u32::MAX {
            labels[root] = n_components;
            n_components += 1;
        }
        labels[vertex] = labels[root];
    }
    labels
}

/// Union-find by size, with path halving.
struct DisjointSets {
    parent: Vec<usize>,
    size: Vec<usize>,
}

impl DisjointSets {
    fn new(n: usize) -> Self {
        Self { parent: (0..n).collect(), size: vec![1; n] }
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            let (small, large) = if self.size[a] < self.size[b] { (a, b) } else { (b, a) };
            self.parent[small] = large;
            self.size[large] += self.size[small];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(triangles: &[[u32; 3]]) -> EdgeCounts {
        EdgeCounts::of(triangles, &Sides::of(triangles))
    }

    fn bad_vertices(n: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
        nonmanifold_vertices(n, triangles, &Sides::of(triangles))
    }

    #[test]
    fn two_triangles_share_one_edge() {
        let expected = EdgeCounts { edges: 5, boundary: 4, hinges: 1, ..EdgeCounts::default() };
        assert_eq!(counts(&[[0, 1, 2], [0, 2, 3]]), expected);
        assert_eq!(counts(&[[0, 1, 2], [0, 3, 2]]), EdgeCounts { misoriented: 1, ..expected });
    }

    #[test]
    fn the_same_triangle_twice_is_folded_and_three_times_not_manifold() {
        let twice = counts(&[[0, 1, 2], [2, 1, 0]]);
        assert_eq!((twice.folded, twice.hinges, twice.misoriented), (3, 0, 0));
        assert_eq!(counts(&[[0, 1, 2]; 3]).nonmanifold, 3);
    }

    #[test]
    fn a_repeated_corner_gives_no_edge() {
        assert_eq!(counts(&[[1, 1, 3]]), EdgeCounts::default());
        assert!(bad_vertices(4, &[[1, 1, 3], [1, 2, 3]]).is_empty());
    }

    #[test]
    fn a_bow_tie_is_bad_at_its_knot() {
        assert_eq!(bad_vertices(5, &[[0, 1, 2], [0, 3, 4]]), [0]);
        assert!(bad_vertices(4, &[[0, 1, 2], [0, 2, 3]]).is_empty());
        assert!(bad_vertices(4, &[[0, 1, 2], [0, 3, 2]]).is_empty());
        assert!(bad_vertices(5, &[[0, 1, 2], [0, 1, 3], [1, 0, 4]]).is_empty());
    }

    #[test]
    fn components_are_numbered_by_their_lowest_vertex() {
        assert_eq!(components(6, [[4, 1], [5, 0]]), [0, 1, 2, 3, 1, 0]);
        assert!(components(0, []).is_empty());
    }

    #[test]
    fn edge_keys_come_apart_again() {
        for [a, b] in [[0, 1], [u32::MAX - 2, 7], [3, u32::MAX - 1]] {
            assert_eq!(edge_ends(edge_key(a, b)), [a.min(b), a.max(b)]);
        }
    }
}
