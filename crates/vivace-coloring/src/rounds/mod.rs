//! Round-based colorings: in each round all uncolored vertices act at once. Each is a schedule of kernels over a
//! [`Backend`], written once for every machine.

mod jones_plassmann;
mod largest_degree_first;
mod luby;
mod vivace;

use vivace_graph::ConstraintGraph;
use vivace_kernels::coloring::{FirstFit, UNCOLORED};
use vivace_kernels::{Backend, Host, Memory, RoundCount};

pub use jones_plassmann::jones_plassmann;
pub use largest_degree_first::largest_degree_first;
pub use luby::luby;
pub use vivace::{ConflictRule, Vivace, vivace, vivace_unseen};

/// No coloring runs more rounds than this; who is uncolored then is colored one by one, by first fit in ascending order. Meshes
/// take 5 to 60 rounds; cliques, where one vertex is colored a round, are what it is for.
pub const ROUND_LIMIT: u32 = 256;

/// A graph in the memory of a backend.
#[derive(Debug)]
pub struct GraphView<'a, M: Memory> {
    /// Start of each row in `neighbors`, and the end of the last: `n_vertices + 1`.
    pub offsets: M::View<'a, u32>,
    /// The rows: each edge in both directions.
    pub neighbors: M::View<'a, u32>,
    /// Number of vertices.
    pub n_vertices: usize,
    /// Length of `neighbors`.
    pub n_neighbors: usize,
}

impl<M: Memory> Clone for GraphView<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<M: Memory> Copy for GraphView<'_, M> {}

impl<M: Memory> GraphView<'_, M> {
    /// (offsets, neighbors): what most kernels read first.
    fn csr(&self) -> (M::View<'_, u32>, M::View<'_, u32>) {
        (M::shorten(self.offsets), M::shorten(self.neighbors))
    }

    /// (offsets, neighbors, `array`).
    fn csr_and<'s>(
        &'s self,
        array: M::View<'s, u32>,
    ) -> (M::View<'s, u32>, M::View<'s, u32>, M::View<'s, u32>) {
        (M::shorten(self.offsets), M::shorten(self.neighbors), array)
    }
}

impl<'a> GraphView<'a, Host> {
    /// A graph where it lies.
    #[must_use]
    pub fn of(graph: &'a ConstraintGraph) -> Self {
        let csr = graph.csr();
        Self {
            offsets: csr.offsets(),
            neighbors: csr.items(),
            n_vertices: graph.n_vertices(),
            n_neighbors: csr.len(),
        }
    }
}

/// A graph's own arrays on a backend.
pub struct GraphBuffers<B: Backend> {
    offsets: B::Buffer<u32>,
    neighbors: B::Buffer<u32>,
    n_vertices: usize,
    n_neighbors: usize,
}

impl<B: Backend> GraphBuffers<B> {
    /// A copy of `graph`.
    pub fn upload(backend: &B, graph: &ConstraintGraph) -> Self {
        let csr = graph.csr();
        let (offsets, neighbors) = (backend.upload(csr.offsets()), backend.upload(csr.items()));
        Self { offsets, neighbors, n_vertices: graph.n_vertices(), n_neighbors: csr.len() }
    }

    /// Room for a graph of this size.
    pub(crate) fn filled(backend: &B, n_vertices: usize, n_neighbors: usize) -> Self {
        let (offsets, neighbors) = (backend.filled(n_vertices + 1, 0), backend.filled(n_neighbors, 0));
        Self { offsets, neighbors, n_vertices, n_neighbors }
    }

    /// The graph where it lies.
    pub fn view<'a>(&'a self, backend: &'a B) -> GraphView<'a, B::Memory> {
        GraphView {
            offsets: backend.view(&self.offsets),
            neighbors: backend.view(&self.neighbors),
            n_vertices: self.n_vertices,
            n_neighbors: self.n_neighbors,
        }
    }
}

/// Colors on a backend, proper and complete, with unused numbers where the algorithm leaves some.
pub struct RoundColoring<B: Backend> {
    /// Color of each vertex.
    pub colors: B::Buffer<u32>,
    /// Rounds and visits.
    pub count: RoundCount,
    /// Who was colored one by one, after the bound on rounds was met.
    pub stragglers: B::List,
}

/// Colors whoever is left in `uncolored`, one by one: the deterministic end of every coloring.
fn finish<B: Backend>(
    backend: &B,
    graph: GraphView<'_, B::Memory>,
    uncolored: B::List,
    mut colors: B::Buffer<u32>,
    count: RoundCount,
) -> RoundColoring<B> {
    backend.update_in_order::<FirstFit>(&uncolored, &(), graph.csr(), &mut colors);
    RoundColoring { colors, count, stragglers: uncolored }
}

/// All vertices, and no color for any.
fn uncolored<B: Backend>(backend: &B, graph: GraphView<'_, B::Memory>) -> (B::List, B::Buffer<u32>) {
    (backend.all(graph.n_vertices), backend.filled(graph.n_vertices, UNCOLORED))
}
