//! Jones and Plassmann (1993): in each round the uncolored vertices heavier than all their uncolored neighbors take the
//! smallest color that no neighbor has. Weights are random and fixed.

use vivace_kernels::coloring::{
    FirstFit, LocalMaximum, LocalMaximumUniform, RandomWeight, RandomWeightUniform, SetValue,
    SetValueUniform, UNCOLORED,
};
use vivace_kernels::{Backend, pcg};

use super::{GraphView, ROUND_LIMIT, RoundColoring, finish, uncolored};

/// Colors a graph: colors at most degree + 1 at every vertex.
pub fn jones_plassmann<B: Backend>(
    backend: &B,
    graph: GraphView<'_, B::Memory>,
    seed: u64,
) -> RoundColoring<B> {
    let key = pcg::key(seed, 0);
    let (mut uncolored, mut color) = uncolored(backend, graph);
    let mut weight = backend.filled(graph.n_vertices, 0);
    let mut lost_to = backend.filled(graph.n_vertices, UNCOLORED);
    backend.map::<RandomWeight>(&uncolored, &RandomWeightUniform { key }, (), &mut weight);
    let count = backend.rounds(ROUND_LIMIT, &mut uncolored, |_, uncolored| {
        let csr_weight = graph.csr_and(backend.view(&weight));
        let tie = LocalMaximumUniform { key };
        let heaviest = backend.select::<LocalMaximum>(uncolored, &tie, csr_weight, &mut lost_to);
        backend.update::<FirstFit>(&heaviest, &(), graph.csr(), &mut color);
        backend.map::<SetValue>(&heaviest, &SetValueUniform { value: 0 }, (), &mut weight);
    });
    finish(backend, graph, uncolored, color, count)
}
