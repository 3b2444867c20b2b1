//! The paper's coloring: Algorithm 2, after Grable and Panconesi (2000).
//!
//! Read as `ARCHITECTURE.md` explains, where the printed lines do not end or do not color: the palette is what no colored
//! neighbor owns (lines 12 and 16, see [`ProposeColor`]); of uncolored neighbors that drew the same color, one wins
//! (the "Hungarian heuristic", without which neighbors with one-color palettes clash for ever); priorities are hashed in each
//! round, since indices follow the mesh and make long chains.

use vivace_cpu::Cpu;
use vivace_graph::ConstraintGraph;
use vivace_kernels::coloring::{
    AcceptColor, AcceptColorUniform, CONFLICT_HASH, CONFLICT_INDEX, CONFLICT_NONE, ProposeColor,
    ProposeColorUniform, SetValue, SetValueUniform, UNCOLORED,
};
use vivace_kernels::{Backend, pcg};

use super::{GraphView, ROUND_LIMIT, RoundColoring, finish, uncolored};

/// Settings of the paper's coloring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vivace {
    /// Palette shrinking factor s: a vertex starts with degree / s + 1 colors. Larger means fewer colors and more rounds; below 2
    /// colors explode, above 4 nothing is gained. Taken between 1 and 65536; what is no number counts as the default.
    pub shrink: f32,
    /// Seed: one seed, one coloring.
    pub seed: u64,
    /// Who wins when neighbors draw the same color.
    pub conflict: ConflictRule,
}

/// Who wins when uncolored neighbors draw the same color.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConflictRule {
    /// The largest hash of (vertex, round, seed).
    HighestHash,
    /// The largest index, as in the paper: many more rounds where the numbering follows the mesh.
    HighestIndex,
    /// Nobody: Algorithm 2 as printed. Runs into [`ROUND_LIMIT`] on most graphs; for comparison.
    None,
}

impl Vivace {
    /// s = 2.5 and hashed priorities: the fewest colors before rounds begin to grow, on every graph measured.
    pub const DEFAULT: Self = Self { shrink: 2.5, seed: 0, conflict: ConflictRule::HighestHash };

    /// s = minimum degree and index priority, as the paper recommends; s within [1.5, 8], since a single vertex of degree
    /// 0 or 1 would otherwise undo the shrinking.
    #[must_use]
    pub fn as_printed(min_degree: u32, seed: u64) -> Self {
        let shrink = f32::from(u16::try_from(min_degree).unwrap_or(u16::MAX)).clamp(1.5, 8.0);
        Self { shrink, seed, conflict: ConflictRule::HighestIndex }
    }

    /// The parameters of [`ProposeColor`] on a graph of this mean degree, but for the key.
    fn palettes(&self, n_vertices: usize, n_neighbors: usize) -> ProposeColorUniform {
        let shrink =
            if self.shrink.is_nan() { Self::DEFAULT.shrink } else { self.shrink.clamp(1.0, 65536.0) };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 65536, times 256")]
        let shrink_q8 = (shrink * 256.0).round() as u32;
        let mean_degree = n_neighbors.div_ceil(n_vertices.max(1));
        let palette_cap = u32::try_from((2 * mean_degree * 256).div_ceil(shrink_q8 as usize) + 1);
        ProposeColorUniform { key: 0, shrink_q8, palette_cap: palette_cap.unwrap_or(u32::MAX) }
    }
}

impl Vivace {
    /// How many numbers of colors it takes on a graph, those included that it leaves unused: what [`vivace_unseen`] leaves has as many.
    #[must_use]
    pub fn n_numbers(&self, graph: &ConstraintGraph) -> u32 {
        let cpu = Cpu::new();
        let RoundColoring { colors, .. } = cpu.enter(|| vivace(&cpu, GraphView::of(graph), self));
        colors.iter().max().map_or(0, |&most| most + 1)
    }

    /// The parameters of both kernels in a round, on a graph of this size.
    fn round(
        &self,
        n_vertices: usize,
        n_neighbors: usize,
        round: u32,
    ) -> (ProposeColorUniform, AcceptColorUniform) {
        let rule = match self.conflict {
            ConflictRule::HighestHash => CONFLICT_HASH,
            ConflictRule::HighestIndex => CONFLICT_INDEX,
            ConflictRule::None => CONFLICT_NONE,
        };
        let palettes = self.palettes(n_vertices, n_neighbors);
        let draw = ProposeColorUniform { key: pcg::key(self.seed, 2 * round), ..palettes };
        (draw, AcceptColorUniform { key: pcg::key(self.seed, 2 * round + 1), rule })
    }
}

impl Default for Vivace {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// As [`vivace`], for so many rounds, in which nobody looks: every vertex is visited in each, and whoever has no color then is left without.
/// Two runs a round, over arrays of a number for each vertex: `proposal`, and `color`, which has the colors in the end. Of those that it
/// colors, they are those of [`vivace`].
pub fn vivace_unseen<B: Backend>(
    backend: &B,
    graph: GraphView<'_, B::Memory>,
    options: &Vivace,
    n_rounds: u32,
    proposal: &mut B::Buffer<u32>,
    color: &mut B::Buffer<u32>,
) {
    let all = backend.range(0..u32::try_from(graph.n_vertices).unwrap_or(u32::MAX));
    backend.map::<SetValue>(&all, &SetValueUniform { value: UNCOLORED }, (), color);
    for round in 0..n_rounds {
        let (draw, tie) = options.round(graph.n_vertices, graph.n_neighbors, round);
        backend.map::<ProposeColor>(&all, &draw, graph.csr_and(backend.view(color)), proposal);
        backend.map::<AcceptColor>(&all, &tie, graph.csr_and(backend.view(proposal)), color);
    }
}

/// Colors a graph: expected O(log n) rounds, colors at most degree + 1 at every vertex.
pub fn vivace<B: Backend>(
    backend: &B,
    graph: GraphView<'_, B::Memory>,
    options: &Vivace,
) -> RoundColoring<B> {
    let mut proposal = backend.filled(graph.n_vertices, UNCOLORED);
    let (mut uncolored, mut color) = uncolored(backend, graph); // line 1
    let count = backend.rounds(ROUND_LIMIT, &mut uncolored, |round, uncolored| {
        // line 4
        let (draw, tie) = options.round(graph.n_vertices, graph.n_neighbors, round); // lines 2-3
        let csr_color = graph.csr_and(backend.view(&color));
        backend.map::<ProposeColor>(uncolored, &draw, csr_color, &mut proposal); // lines 14-16 and 5-6
        let csr_proposal = graph.csr_and(backend.view(&proposal));
        backend.select::<AcceptColor>(uncolored, &tie, csr_proposal, &mut color); // lines 7-13
    });
    finish(backend, graph, uncolored, color, count)
}
