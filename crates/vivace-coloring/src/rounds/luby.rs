//! Luby (1985): color after color, a maximal independent set of the uncolored vertices, grown in rounds. In a round the
//! contenders heavier than all contending neighbors win, and their neighbors leave the contest for this color.

use vivace_kernels::coloring::{
    IsColored, LocalMaximum, LocalMaximumUniform, NeighborHasColor, NeighborHasColorUniform, RandomWeight,
    RandomWeightUniform, SetValue, SetValueUniform, TakeColor, TakeColorUniform, UNCOLORED,
};
use vivace_kernels::{Backend, RoundCount, pcg};

use super::{GraphView, ROUND_LIMIT, RoundColoring, finish, uncolored};

/// Colors a graph: colors at most degree + 1 at every vertex, since each set is maximal. Rounds count over all colors.
pub fn luby<B: Backend>(backend: &B, graph: GraphView<'_, B::Memory>, seed: u64) -> RoundColoring<B> {
    let mut count = RoundCount::default();
    let (mut uncolored, mut color) = uncolored(backend, graph);
    let mut weight = backend.filled(graph.n_vertices, 0);
    let mut lost_to = backend.filled(graph.n_vertices, UNCOLORED);
    backend.rounds(ROUND_LIMIT, &mut uncolored, |c, uncolored| {
        let key = pcg::key(seed, c);
        backend.map::<RandomWeight>(uncolored, &RandomWeightUniform { key }, (), &mut weight);
        let mut contenders = uncolored.clone();
        let set = backend.rounds(ROUND_LIMIT, &mut contenders, |_, contenders| {
            let csr_weight = graph.csr_and(backend.view(&weight));
            let tie = LocalMaximumUniform { key };
            let winners = backend.select::<LocalMaximum>(contenders, &tie, csr_weight, &mut lost_to);
            backend.map::<SetValue>(&winners, &SetValueUniform { value: c }, (), &mut color);
            backend.map::<SetValue>(&winners, &SetValueUniform { value: 0 }, (), &mut weight);
            let csr_color = graph.csr_and(backend.view(&color));
            let taken = NeighborHasColorUniform { color: c };
            backend.select::<NeighborHasColor>(contenders, &taken, csr_color, &mut weight);
        });
        backend.update_in_order::<TakeColor>(
            &contenders,
            &TakeColorUniform { color: c },
            graph.csr(),
            &mut color,
        );
        backend.select::<IsColored>(uncolored, &(), (), &mut color);
        count.rounds += set.rounds;
        count.visits += set.visits;
    });
    finish(backend, graph, uncolored, color, count)
}
