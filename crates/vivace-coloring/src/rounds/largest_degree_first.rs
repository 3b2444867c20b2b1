//! Largest-Degree-First (Welsh and Powell 1967), as the paper runs it in parallel: as Jones and Plassmann, but the weight is the
//! current degree, the number of uncolored neighbors. Equal degrees are decided by hash.

use vivace_kernels::coloring::{
    DegreeWeight, FirstFit, LeaveNeighbors, LocalMaximum, LocalMaximumUniform, SetValue, SetValueUniform,
    UNCOLORED,
};
use vivace_kernels::{Backend, pcg};

use super::{GraphView, ROUND_LIMIT, RoundColoring, finish, uncolored};

/// Colors a graph: colors at most degree + 1 at every vertex.
pub fn largest_degree_first<B: Backend>(
    backend: &B,
    graph: GraphView<'_, B::Memory>,
    seed: u64,
) -> RoundColoring<B> {
    let key = pcg::key(seed, 0);
    let (mut uncolored, mut color) = uncolored(backend, graph);
    let mut weight = backend.filled(graph.n_vertices, 0);
    let mut lost_to = backend.filled(graph.n_vertices, UNCOLORED);
    backend.map::<DegreeWeight>(&uncolored, &(), (graph.csr().0,), &mut weight);
    let count = backend.rounds(ROUND_LIMIT, &mut uncolored, |_, uncolored| {
        let csr_weight = graph.csr_and(backend.view(&weight));
        let tie = LocalMaximumUniform { key };
        let heaviest = backend.select::<LocalMaximum>(uncolored, &tie, csr_weight, &mut lost_to);
        backend.update::<FirstFit>(&heaviest, &(), graph.csr(), &mut color);
        backend.map::<SetValue>(&heaviest, &SetValueUniform { value: 0 }, (), &mut weight);
        backend.count_down::<LeaveNeighbors>(&heaviest, &(), graph.csr(), &mut weight);
    });
    finish(backend, graph, uncolored, color, count)
}
