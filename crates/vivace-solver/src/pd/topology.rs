//! The graph of a model with the contacts of a frame, and its coloring: line 2 of Algorithm 1 while edges come and go.
//!
//! Vertices keep their places: a class of the model's own coloring is a range of slices. Those that contacts drive out of their class
//! are masked in their slices, and relaxed with their new color one by one.

use vivace_coloring::{Certificate, Coloring, ConstraintGraph, Follower};
use vivace_graph::DynamicGraph;

use super::layout::Layout;
use super::rows::Rows;
use super::slices::Slices;
use crate::contacts::{Change, ContactMemory};
use crate::error::narrow;
use crate::{Recoloring, SolverError};

/// Who is relaxed with whom.
#[derive(Debug)]
pub(super) struct Topology {
    fixed: ConstraintGraph,
    graph: DynamicGraph,
    /// Edges that contacts alone have, ascending, the lower end first.
    edges: Vec<[u32; 2]>,
    follower: Follower,
    /// By color: vertices that are not in their own class.
    moved: Vec<Vec<u32>>,
    /// By slice: a bit for each lane whose vertex has moved.
    masks: Vec<u8>,
}

impl Topology {
    /// Without contacts.
    pub(super) fn new(rows: &Rows, layout: &Layout, slices: &Slices) -> Result<Self, SolverError> {
        let (mut offsets, mut neighbors) = (vec![0], Vec::new());
        for row in rows.offsets.windows(2) {
            let first = neighbors.len();
            let columns = &rows.columns[row[0] as usize..row[1] as usize];
            neighbors.extend(columns.iter().copied().filter(|&column| layout.is_free(column)));
            neighbors[first..].sort_unstable();
            offsets.push(narrow("neighbors", neighbors.len())?);
        }
        let fixed = ConstraintGraph::from_csr(offsets, neighbors)?;
        let mut colors = vec![0; rows.len()];
        for (color, class) in (0..).zip(&layout.classes) {
            colors[class.clone()].fill(color);
        }
        let home = Coloring::new(&fixed, colors).map_err(|violation| SolverError::Coloring { violation })?;
        let (graph, follower) = (DynamicGraph::from(&fixed), Follower::new(&home));
        let masks = vec![0; slices.slices.len()];
        Ok(Self { fixed, graph, edges: Vec::new(), follower, moved: Vec::new(), masks })
    }

    /// How many colors there are.
    pub(super) fn n_colors(&self) -> u32 {
        self.follower.n_colors()
    }

    /// Vertices of `color` that are not in its class.
    pub(super) fn moved(&self, color: usize) -> &[u32] {
        self.moved.get(color).map_or(&[], Vec::as_slice)
    }

    /// A bit for each lane of `slice` whose vertex has moved.
    #[inline]
    pub(super) fn mask(&self, slice: usize) -> u8 {
        self.masks[slice]
    }

    /// Takes the contacts of a frame: the free vertices of each.
    pub(super) fn update<'a>(
        &mut self,
        contacts: impl Iterator<Item = &'a [u32]>,
        recoloring: Recoloring,
        slices: &Slices,
    ) -> Result<Change, SolverError> {
        let mut edges: Vec<[u32; 2]> = contacts.flat_map(pairs).filter(|edge| self.is_new(*edge)).collect();
        edges.sort_unstable();
        edges.dedup();
        let (gone, come) = differences(&self.edges, &edges);
        self.graph.apply(&gone, &come)?;
        self.edges = edges;
        let work = match recoloring {
            Recoloring::Incremental => self.follower.update(&self.graph, &gone, &come),
            Recoloring::Full => self.follower.anew(&self.graph),
        };
        debug_assert!(Certificate::check(&self.graph, self.follower.colors()).is_ok());
        self.place(slices);
        Ok(Change { edges: gone.len() + come.len(), recolored: work.recolored, visited: work.visited })
    }

    fn is_new(&self, [u, v]: [u32; 2]) -> bool {
        self.fixed.neighbors(u).binary_search(&v).is_err()
    }

    /// Lists and masks of who is not in its class.
    fn place(&mut self, slices: &Slices) {
        for &v in self.moved.iter().flatten() {
            self.masks[slices.of_vertex(v as usize)] = 0;
        }
        self.moved.iter_mut().for_each(Vec::clear);
        self.moved.resize(self.moved.len().max(self.follower.n_colors() as usize), Vec::new());
        for v in self.follower.away() {
            let slice = slices.of_vertex(v as usize);
            self.masks[slice] |= 1 << (v as usize - slices.slices[slice].0);
            self.moved[self.follower.colors()[v as usize] as usize].push(v);
        }
    }

    /// What the next update depends on.
    pub(super) fn memory(&self) -> ContactMemory {
        let colors = self.follower.colors();
        ContactMemory {
            edges: self.edges.clone(),
            colors: self.follower.away().map(|v| (v, colors[v as usize])).collect(),
        }
    }

    /// Takes up where another stood.
    pub(super) fn set_memory(&mut self, memory: &ContactMemory, slices: &Slices) -> Result<(), SolverError> {
        let n = self.fixed.n_vertices();
        let is_there = |v: u32| (v as usize) < n;
        let in_order = memory.edges.windows(2).all(|pair| pair[0] < pair[1]);
        let edges = memory.edges.iter().all(|&[u, v]| u < v && is_there(v) && self.is_new([u, v]));
        let colors = memory.colors.iter().all(|&(v, color)| is_there(v) && (color as usize) <= n);
        if !(in_order && edges && colors) {
            return Err(SolverError::Memory);
        }
        let mut graph = DynamicGraph::from(&self.fixed);
        graph.apply(&[], &memory.edges)?;
        self.follower.set_away(&graph, &memory.colors).map_err(|_| SolverError::Memory)?;
        self.graph = graph;
        self.edges.clone_from(&memory.edges);
        self.place(slices);
        Ok(())
    }
}

/// All pairs of a contact's vertices, the lower first.
fn pairs(vertices: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    let of = |(k, &u): (usize, &u32)| vertices[..k].iter().map(move |&v| [u.min(v), u.max(v)]);
    vertices.iter().enumerate().flat_map(of).filter(|[u, v]| u != v)
}

/// What is in `old` alone, and what in `new` alone; both ascend.
fn differences(old: &[[u32; 2]], new: &[[u32; 2]]) -> (Vec<[u32; 2]>, Vec<[u32; 2]>) {
    let without = |these: &[[u32; 2]], those: &[[u32; 2]]| -> Vec<[u32; 2]> {
        these.iter().filter(|edge| those.binary_search(edge).is_err()).copied().collect()
    };
    (without(old, new), without(new, old))
}
