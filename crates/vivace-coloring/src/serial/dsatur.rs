//! DSATUR (Brélaz 1979): next comes the vertex whose neighbors show the most different colors; ties go to the larger degree, then to
//! the smaller index.

use std::collections::{BinaryHeap, HashSet};

use vivace_graph::Adjacency;
use vivace_kernels::coloring::UNCOLORED;

use super::Palette;
use crate::Coloring;
use crate::certificate::index;

/// Colors a graph with few colors. O((n + m) log n); serial.
pub fn dsatur(graph: &impl Adjacency) -> Coloring {
    let n = index(graph.n_vertices());
    let entry = |saturation: u32, v: u32| (saturation, graph.degree(v), std::cmp::Reverse(v));
    let mut heap: BinaryHeap<_> = (0..n).map(|v| entry(0, v)).collect();
    let mut seen: Vec<Seen> = (0..n).map(|_| Seen::default()).collect();
    let mut colors = vec![UNCOLORED; graph.n_vertices()];
    let mut palette = Palette::new();
    while let Some((_, _, std::cmp::Reverse(v))) = heap.pop() {
        if colors[v as usize] != UNCOLORED {
            continue; // an entry from when v saw fewer colors
        }
        let color = palette.first_free(graph.neighbors(v), &colors);
        colors[v as usize] = color;
        for &u in graph.neighbors(v) {
            if colors[u as usize] == UNCOLORED && seen[u as usize].insert(color) {
                heap.push(entry(seen[u as usize].len(), u));
            }
        }
    }
    Coloring::dense(colors)
}

/// The different colors that a vertex sees: bits for the first 64, a set for the rest.
#[derive(Debug, Default)]
struct Seen {
    low: u64,
    high: HashSet<u32>,
}

impl Seen {
    /// Whether `color` was not there before.
    fn insert(&mut self, color: u32) -> bool {
        if color >= 64 {
            return self.high.insert(color);
        }
        let before = self.low;
        self.low |= 1 << color;
        self.low != before
    }

    fn len(&self) -> u32 {
        self.low.count_ones() + index(self.high.len())
    }
}
