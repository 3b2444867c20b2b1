//! A hundredth of a graph's edges changed: what contacts do to it between two frames.

use std::collections::HashSet;

use vivace_graph::ConstraintGraph;
use vivace_tests::random::Random;

/// Where the new edges are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    /// Between vertices with a common neighbor: a body folds.
    Nearby,
    /// Between any two vertices.
    Anywhere,
}

/// Edges that go and edges that come.
pub(super) struct Change {
    pub(super) removed: Vec<[u32; 2]>,
    pub(super) inserted: Vec<[u32; 2]>,
}

impl Change {
    /// A change of `fraction` of the edges, half removed and half inserted.
    pub(super) fn of(graph: &ConstraintGraph, fraction: f64, reach: Reach, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let edges: Vec<[u32; 2]> = graph.edges().collect();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a part of the number of edges"
        )]
        let count = (edges.len() as f64 * fraction / 2.0).round() as usize;
        let n_edges = u32::try_from(edges.len()).unwrap_or(u32::MAX);
        let n_vertices = u32::try_from(graph.n_vertices()).unwrap_or(u32::MAX);
        let mut removed = HashSet::new();
        let mut inserted = HashSet::new();
        // A small or dense graph may not have so many pairs to give.
        for _ in 0..100 * count {
            if removed.len() < count {
                removed.insert(random.below(n_edges));
            }
            if inserted.len() < count {
                let u = random.below(n_vertices);
                let v = match reach {
                    Reach::Anywhere => Some(random.below(n_vertices)),
                    Reach::Nearby => step(graph, u, &mut random).and_then(|v| step(graph, v, &mut random)),
                };
                if let Some(v) = v.filter(|&v| v != u && graph.neighbors(u).binary_search(&v).is_err()) {
                    inserted.insert([u.min(v), u.max(v)]);
                }
            }
            if removed.len() == count && inserted.len() == count {
                break;
            }
        }
        // Sets come in no order; a run must be the same again.
        let mut removed: Vec<[u32; 2]> = removed.into_iter().map(|edge| edges[edge as usize]).collect();
        let mut inserted: Vec<[u32; 2]> = inserted.into_iter().collect();
        removed.sort_unstable();
        inserted.sort_unstable();
        Self { removed, inserted }
    }
}

/// A random neighbor.
fn step(graph: &ConstraintGraph, v: u32, random: &mut Random) -> Option<u32> {
    let degree = graph.degree(v);
    (degree > 0).then(|| graph.neighbors(v)[random.below(degree) as usize])
}

#[cfg(test)]
mod tests {
    use super::*;
    use vivace_graph::DynamicGraph;
    use vivace_tests::generators::regular_cloth;

    #[test]
    fn a_hundredth_of_the_edges_changes() {
        let graph = regular_cloth(40, 40);
        for reach in [Reach::Nearby, Reach::Anywhere] {
            let change = Change::of(&graph, 0.01, reach, 5);
            let half = (graph.n_edges() + 100) / 200;
            assert_eq!((change.removed.len(), change.inserted.len()), (half, half));
            let mut dynamic = DynamicGraph::from(&graph);
            assert_eq!(dynamic.apply(&change.removed, &change.inserted).unwrap(), half);
            assert_eq!(dynamic.to_graph().n_edges(), graph.n_edges());
            let near = |[u, v]: [u32; 2]| graph.neighbors(u).iter().any(|&w| graph.neighbors(w).contains(&v));
            assert_eq!(change.inserted.iter().all(|&edge| near(edge)), reach == Reach::Nearby);
        }
    }
}
