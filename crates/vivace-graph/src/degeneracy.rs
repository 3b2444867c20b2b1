//! Smallest-last order (Matula and Beck 1983): the order in which first fit needs at most degeneracy + 1 colors.
//!
//! A vertex of smallest remaining degree is taken away again and again; the order is that of the removals turned round, so
//! each vertex has at most `degeneracy` neighbors before it.
//!
//! *Reading*: the smallest degree is that of what is left. The array method for core numbers (Batagelj and Zaversnik 2003) lets
//! no degree fall below the core reached so far, which is enough for the cores but loses order among the rest: on a regular cloth
//! of 400 x 250 vertices it costs 4 colors instead of 3, with hinges 7 instead of 4. Among vertices of equal degree the one whose
//! degree changed last goes first (a stack per degree); first in first out, lowest and highest index colored cloths as well.

use crate::Adjacency;
use crate::num::to_u32;

/// What [`smallest_last`] found.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SmallestLast {
    /// The vertices in the order in which to color them: the one removed first stands last. Each has at most `degeneracy`
    /// neighbors before it.
    pub order: Vec<u32>,
    /// Core number of each vertex: the largest k such that it lies in a subgraph of smallest degree k.
    pub core: Vec<u32>,
    /// Largest core number. First fit in this order needs at most one color more.
    pub degeneracy: u32,
}

/// Orders the vertices smallest last. Serial, O(n + m) time, n + m words at most beside the result.
///
/// Where a row holds a neighbor more than once, it counts as often, here as in the degree.
pub fn smallest_last<A: Adjacency + ?Sized>(graph: &A) -> SmallestLast {
    let n = graph.n_vertices();
    let mut degree: Vec<u32> = (0..to_u32(n)).map(|v| graph.degree(v)).collect();
    let max_degree = degree.iter().copied().max().unwrap_or(0);
    // A vertex whose degree falls is pushed anew and its old entry goes stale: cheaper than unlinking it, and at most one entry
    // per edge and vertex is ever made.
    let mut stacks: Vec<Vec<u32>> = vec![Vec::new(); max_degree as usize + 1];
    for (v, &d) in degree.iter().enumerate() {
        stacks[d as usize].push(to_u32(v));
    }

    const REMOVED: u32 = u32::MAX;
    let (mut order, mut core) = (vec![0; n], vec![0; n]);
    let (mut degeneracy, mut smallest) = (0, 0);
    for place in order.iter_mut().rev() {
        let v = loop {
            match stacks[smallest as usize].pop() {
                None => smallest += 1,
                Some(v) if degree[v as usize] == smallest => break v,
                Some(_) => {}
            }
        };
        *place = v;
        degeneracy = degeneracy.max(smallest);
        core[v as usize] = degeneracy;
        degree[v as usize] = REMOVED;
        for &u in graph.neighbors(v) {
            let d = &mut degree[u as usize];
            if *d != REMOVED {
                *d -= 1;
                stacks[*d as usize].push(u);
            }
        }
        smallest = smallest.saturating_sub(1);
    }
    SmallestLast { order, core, degeneracy }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ConstraintGraph, GraphBuilder};

    #[test]
    fn a_triangle_with_a_tail() {
        // 0-1-2 a triangle, 3 hung on 2, 4 hung on 3, 5 alone.
        let graph = ConstraintGraph::from_edges(6, &[[0, 1], [1, 2], [2, 0], [2, 3], [3, 4]]).unwrap();
        let found = smallest_last(&graph);
        assert_eq!(found.core, [2, 2, 2, 1, 1, 0]);
        assert_eq!(found.degeneracy, 2);
        // 5 goes first (degree 0), then the tail 4, 3, then the triangle.
        assert_eq!(found.order[3..], [3, 4, 5]);
        assert_eq!(smallest_last(&ConstraintGraph::default()), SmallestLast::default());
    }

    #[test]
    fn regular_cloth_takes_three_colors_and_its_hinges_four() {
        for [width, height] in [[100, 100], [400, 250]] {
            let (edges, hinges) = cloth(width, height);
            let n = (width * height) as usize;
            let cloth = ConstraintGraph::from_edges(n, &edges).unwrap();
            let hinged = GraphBuilder::new(n).constraints(&edges).constraints(&hinges).build().unwrap();
            for (graph, best) in [(cloth, 3), (hinged, 4)] {
                assert_eq!(first_fit(&graph), best, "{width}");
                for factor in [7_919, 104_729] {
                    assert_eq!(
                        first_fit(&graph.permuted(&scrambled(n, factor)).unwrap()),
                        best,
                        "{width}, {factor}"
                    );
                }
            }
        }
    }

    /// Colors that first fit uses in smallest-last order.
    fn first_fit(graph: &ConstraintGraph) -> u32 {
        const NONE: u32 = 63;
        let mut colors = vec![NONE; graph.n_vertices()];
        for v in smallest_last(graph).order {
            let taken = graph.neighbors(v).iter().fold(0u64, |set, &u| set | 1 << colors[u as usize]);
            colors[v as usize] = (!taken).trailing_zeros();
        }
        colors.iter().max().map_or(0, |&color| color + 1)
    }

    /// Edges right, down and along one diagonal; hinges `[edge, edge, opposite, opposite]`.
    fn cloth(width: u32, height: u32) -> (Vec<[u32; 2]>, Vec<[u32; 4]>) {
        let (mut edges, mut hinges) = (Vec::new(), Vec::new());
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let at = |dx: u32, dy: u32| (y + dy) * width + x + dx;
            let (right, down) = (x + 1 < width, y + 1 < height);
            if right {
                edges.push([at(0, 0), at(1, 0)]);
            }
            if down {
                edges.push([at(0, 0), at(0, 1)]);
            }
            if right && down {
                edges.push([at(0, 0), at(1, 1)]);
                hinges.push([at(0, 0), at(1, 1), at(1, 0), at(0, 1)]);
            }
            if right && y + 2 < height {
                hinges.push([at(0, 1), at(1, 1), at(0, 0), at(1, 1) + width]);
            }
            if down && x + 2 < width {
                hinges.push([at(1, 0), at(1, 1), at(0, 0), at(2, 1)]);
            }
        }
        (edges, hinges)
    }

    /// A numbering of `0..n` that follows no row or column.
    fn scrambled(n: usize, factor: u64) -> Vec<u32> {
        let mut by_hash: Vec<u32> = (0..to_u32(n)).collect();
        by_hash.sort_by_key(|&v| (u64::from(v) * factor + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 20);
        by_hash
    }
}
