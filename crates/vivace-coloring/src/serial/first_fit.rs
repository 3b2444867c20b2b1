//! Greedy first fit: one vertex after another takes the smallest color that no colored neighbor has.

use vivace_graph::{Adjacency, smallest_last};
use vivace_kernels::coloring::UNCOLORED;

use crate::Coloring;
use crate::certificate::index;

/// The order in which first fit visits the vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// As they are numbered.
    Natural,
    /// By descending degree (Welsh and Powell 1967).
    LargestFirst,
    /// The reverse of removing a vertex of least remaining degree again and again (Matula and Beck 1983): at most degeneracy + 1
    /// colors.
    SmallestLast,
}

/// Colors a graph by first fit. O(n + m), n log n for [`Order::LargestFirst`].
pub fn first_fit(graph: &impl Adjacency, order: Order) -> Coloring {
    let n = index(graph.n_vertices());
    match order {
        Order::Natural => in_order(graph, 0..n),
        Order::LargestFirst => {
            let mut order: Vec<u32> = (0..n).collect();
            order.sort_by_key(|&v| std::cmp::Reverse(graph.degree(v)));
            in_order(graph, order)
        }
        Order::SmallestLast => in_order(graph, smallest_last(graph).order),
    }
}

fn in_order(graph: &impl Adjacency, order: impl IntoIterator<Item = u32>) -> Coloring {
    let mut colors = vec![UNCOLORED; graph.n_vertices()];
    let mut palette = Palette::new();
    for v in order {
        colors[v as usize] = palette.first_free(graph.neighbors(v), &colors);
    }
    Coloring::dense(colors)
}

/// The colors around one vertex. Each entry says in which call it was last in use, so that nothing is ever cleared.
#[derive(Debug, Clone)]
pub(crate) struct Palette {
    /// One entry for each color given so far and the next, and a last one for whatever is none of them.
    used_in: Vec<u32>,
    call: u32,
}

impl Palette {
    pub(crate) fn new() -> Self {
        Self { used_in: vec![0; 64], call: 0 }
    }

    /// The smallest color that none of `neighbors` has; [`UNCOLORED`] counts for nothing.
    #[inline]
    pub(crate) fn first_free(&mut self, neighbors: &[u32], colors: &[u32]) -> u32 {
        self.first_free_of(neighbors.iter().map(|&u| colors[u as usize]))
    }

    /// The smallest color that is not among `used`.
    #[inline]
    pub(crate) fn first_free_of(&mut self, used: impl Iterator<Item = u32> + Clone) -> u32 {
        loop {
            self.call = self.call.wrapping_add(1);
            if self.call == 0 {
                self.used_in.fill(0);
                self.call = 1;
            }
            let call = self.call;
            let used_in = self.used_in.as_mut_slice();
            let last = used_in.len() - 1;
            for c in used.clone() {
                used_in[(c as usize).min(last)] = call;
            }
            if let Some(free) = used_in[..last].iter().position(|&used_in| used_in != call) {
                return index(free);
            }
            self.used_in.resize(2 * self.used_in.len(), 0);
        }
    }
}
