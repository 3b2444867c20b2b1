//! Classes of equal size: a parallel sweep waits for what its largest classes hold beyond a full load.

use vivace_graph::Adjacency;

use crate::Coloring;
use crate::certificate::index;
use crate::color_set::ColorSet;
use crate::coloring::class_sizes;

/// What [`balance`] did.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Balanced {
    /// The coloring, as many colors as before.
    pub coloring: Coloring,
    /// Vertices moved; one that moved twice counts twice.
    pub moves: u64,
}

/// No more than this many looks at the whole graph.
const MAX_SWEEPS: u32 = 32;

/// Moves vertices out of classes above the mean size, each to the smallest class that none of its neighbors is in.
///
/// A move goes to a class at least two smaller, so the sum of squared class sizes falls by at least two: there are at most
/// (Σ size² − n² / colors) / 2 moves, whatever the graph. Ends when every class is within half a percent of the mean, or when no
/// vertex can move. The coloring is valid after every move; colors may come to stand above their vertex's degree. O(n + m) for
/// each of a few sweeps; serial.
pub fn balance(graph: &impl Adjacency, coloring: Coloring) -> Balanced {
    let n_colors = coloring.n_colors();
    let mut colors = coloring.into_colors();
    let mut classes = Classes::new(&colors, n_colors);
    let mut moves = 0;
    for _ in 0..MAX_SWEEPS {
        if classes.are_balanced() {
            break;
        }
        let moved = sweep(graph, &mut colors, &mut classes);
        moves += moved;
        if moved == 0 {
            break;
        }
    }
    Balanced { coloring: Coloring::compacted(colors), moves }
}

/// Looks once at each vertex of a class above the mean; returns how many moved.
fn sweep(graph: &impl Adjacency, colors: &mut [u32], classes: &mut Classes) -> u64 {
    let mut used = ColorSet::new(index(classes.sizes.len()));
    let mut moved = 0;
    for v in 0..colors.len() {
        let own = colors[v];
        if classes.sizes[own as usize] > classes.full {
            used.look(graph.neighbors(index(v)), colors);
            if let Some(to) = classes.room(own, &used) {
                colors[v] = to;
                classes.transfer(own, to);
                moved += 1;
            }
        }
    }
    moved
}

/// Class sizes, and the classes in order of size.
struct Classes {
    sizes: Vec<u32>,
    ascending: Vec<u32>,
    /// The mean size, rounded up: a class above it has members to give.
    full: u32,
}

impl Classes {
    fn new(colors: &[u32], n_colors: u32) -> Self {
        let sizes = class_sizes(colors, n_colors);
        let mut ascending: Vec<u32> = (0..n_colors).collect();
        ascending.sort_by_key(|&c| sizes[c as usize]);
        Self { sizes, ascending, full: index(colors.len()).div_ceil(n_colors.max(1)) }
    }

    fn are_balanced(&self) -> bool {
        let slack = self.full / 200;
        self.sizes.iter().all(|&size| size <= self.full + slack && size + slack + 1 >= self.full)
    }

    /// The smallest class not in `used`, if it is at least two smaller than `own`.
    #[inline]
    fn room(&self, own: u32, used: &ColorSet) -> Option<u32> {
        let smaller = |c: u32| self.sizes[c as usize] + 2 <= self.sizes[own as usize];
        self.ascending.iter().copied().take_while(|&c| smaller(c)).find(|&c| !used.contains(c))
    }

    fn transfer(&mut self, from: u32, to: u32) {
        self.sizes[from as usize] -= 1;
        self.sizes[to as usize] += 1;
        self.ascending.sort_by_key(|&c| self.sizes[c as usize]);
    }
}
