//! A coloring anew in every frame: line 2 of Algorithm 1 where the paper has it.

use vivace_coloring::{ConstraintGraph, GraphBuffers, Vivace, vivace_unseen};
use vivace_kernels::Backend;
use vivace_kernels::MOST_KEYS;
use vivace_kernels::coloring::{ColorInstead, LacksColor, LacksColorUniform, SetValue, SetValueUniform};

use crate::SolverError;
use crate::pd::layout::Layout;
use crate::pd::rows::Rows;

/// Rounds of the coloring. Meshes take 7 to 13; who has no color then keeps that of the system, as all do.
const N_ROUNDS: u32 = 20;
/// Colors beyond those that a coloring on the host has found: another seed may need some more.
const SPARE: u32 = 3;

/// The graph of the free particles, and its coloring of the frame.
pub(super) struct Recolor<B: Backend> {
    options: Vivace,
    n: u32,
    graph: GraphBuffers<B>,
    /// The colors that the system was made with.
    instead: B::Buffer<u32>,
    proposal: B::Buffer<u32>,
    color: B::Buffer<u32>,
    /// Down where the coloring of the frame is none.
    is_whole: B::Buffer<u32>,
    n_colors: u32,
    n_frames: u64,
}

impl<B: Backend> Recolor<B> {
    /// Of a model whose particles are laid out color by color.
    ///
    /// # Errors
    /// More colors than a device sorts by.
    pub(super) fn new(
        backend: &B,
        rows: &Rows,
        layout: &Layout,
        options: Vivace,
    ) -> Result<Self, SolverError> {
        let graph = graph(rows)?;
        let of_class = |(color, class): (u32, &std::ops::Range<usize>)| vec![color; class.len()];
        let instead: Vec<u32> = (0..).zip(&layout.classes).flat_map(of_class).collect();
        let mut n_colors = u32::try_from(layout.classes.len()).unwrap_or(u32::MAX);
        n_colors = n_colors.max(options.n_numbers(&graph) + SPARE);
        if n_colors > MOST_KEYS {
            return Err(SolverError::NoRecoloring {
                why: "its graph takes more colors than a device sorts by",
            });
        }
        Ok(Self {
            options,
            n: u32::try_from(layout.n_free).unwrap_or(u32::MAX),
            graph: GraphBuffers::upload(backend, &graph),
            instead: backend.upload(&instead),
            proposal: backend.filled(layout.n_free, 0),
            color: backend.filled(layout.n_free, 0),
            is_whole: backend.filled(1, 1),
            n_colors,
            n_frames: 0,
        })
    }

    /// The classes of the next frame.
    pub(super) fn next(&mut self, backend: &B) -> Vec<B::List> {
        let options = Vivace { seed: self.options.seed.wrapping_add(self.n_frames), ..self.options };
        self.n_frames += 1;
        let Self { graph, proposal, color, is_whole, instead, n_colors, .. } = self;
        vivace_unseen(backend, graph.view(backend), &options, N_ROUNDS, proposal, color);
        let (one, all) = (backend.range(0..1), backend.range(0..self.n));
        backend.map::<SetValue>(&one, &SetValueUniform { value: 1 }, (), is_whole);
        let uniform = LacksColorUniform { n_colors: *n_colors };
        backend.count_down::<LacksColor>(&all, &uniform, (backend.view(color),), is_whole);
        backend.map::<ColorInstead>(&all, &(), (backend.view(is_whole), backend.view(instead)), color);
        backend.group_by(color, *n_colors)
    }

    /// Classes of a frame, some of which may be empty.
    pub(super) fn n_colors(&self) -> usize {
        self.n_colors as usize
    }
}

/// The rows of the free particles without the pinned ones.
fn graph(rows: &Rows) -> Result<ConstraintGraph, SolverError> {
    let n = rows.len();
    let (mut offsets, mut neighbors) = (vec![0], Vec::with_capacity(rows.columns.len()));
    for i in 0..n {
        let row = &rows.columns[rows.offsets[i] as usize..rows.offsets[i + 1] as usize];
        let first = neighbors.len();
        neighbors.extend(row.iter().filter(|&&j| (j as usize) < n));
        neighbors[first..].sort_unstable();
        offsets.push(crate::error::narrow("neighbors", neighbors.len())?);
    }
    Ok(ConstraintGraph::from_csr(offsets, neighbors)?)
}
