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
    /// Single vertices moved and Kempe chains exchanged.
    pub moves: u64,
}

/// No more than this many looks at the whole graph.
const MAX_SWEEPS: u32 = 32;

/// Moves vertices out of classes above the mean size, each to the smallest class that none of its neighbors is in. Where no vertex
/// can move alone, two classes exchange their members in a connected part of them (a Kempe chain) that holds more of the larger.
///
/// Either way a class at least two larger gives to a smaller, less than the difference, so the sum of squared class sizes falls by at
/// least two: there are at most (Σ size² − n² / colors) / 2 moves, whatever the graph. Ends when no class is over the mean by
/// more than 0.8% or under it by more than 3%, or when nothing can move. The coloring is valid after every move; colors may come to stand above their vertex's
/// degree. O(n + m) for each of a few sweeps; serial.
pub fn balance(graph: &impl Adjacency, coloring: Coloring) -> Balanced {
    let n_colors = coloring.n_colors();
    let mut colors = coloring.into_colors();
    let mut classes = Classes::new(&colors, n_colors);
    let mut moves = 0;
    for _ in 0..MAX_SWEEPS {
        if classes.are_balanced() {
            break;
        }
        let mut moved = sweep(graph, &mut colors, &mut classes);
        if moved == 0 {
            moved = exchange(graph, &mut colors, &mut classes);
        }
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
                classes.transfer(own, to, 1);
                moved += 1;
            }
        }
    }
    moved
}

/// Exchanges Kempe chains between the largest class and the smallest that has some to exchange with; returns how many.
fn exchange(graph: &impl Adjacency, colors: &mut [u32], classes: &mut Classes) -> u64 {
    let ascending = classes.ascending.clone();
    let Some((&large, others)) = ascending.split_last() else { return 0 };
    for &small in others {
        let mut moved = 0;
        let mut seen = vec![false; colors.len()];
        let mut chain = Vec::new();
        for v in 0..colors.len() {
            if classes.sizes[large as usize] < classes.sizes[small as usize] + 2 {
                break;
            }
            if colors[v] != large || seen[v] {
                continue;
            }
            kempe_chain(graph, colors, &mut seen, index(v), [large, small], &mut chain);
            let n_large = index(chain.iter().filter(|&&u| colors[u as usize] == large).count());
            let surplus = (2 * n_large).saturating_sub(index(chain.len()));
            if surplus > 0 && surplus < classes.sizes[large as usize] - classes.sizes[small as usize] {
                for &u in &chain {
                    colors[u as usize] = if colors[u as usize] == large { small } else { large };
                }
                classes.transfer(large, small, surplus);
                moved += 1;
            }
        }
        if moved > 0 {
            return moved;
        }
    }
    0
}

/// Makes `chain` the vertices of two classes that hang together with `v`.
fn kempe_chain(
    graph: &impl Adjacency,
    colors: &[u32],
    seen: &mut [bool],
    v: u32,
    classes: [u32; 2],
    chain: &mut Vec<u32>,
) {
    chain.clear();
    chain.push(v);
    seen[v as usize] = true;
    let mut next = 0;
    while let Some(&u) = chain.get(next) {
        next += 1;
        for &w in graph.neighbors(u) {
            if classes.contains(&colors[w as usize]) && !seen[w as usize] {
                seen[w as usize] = true;
                chain.push(w);
            }
        }
    }
}

/// Class sizes, and the classes in order of size.
struct Classes {
    sizes: Vec<u32>,
    ascending: Vec<u32>,
    /// The mean size, rounded up: a class above it has members to give.
    full: u32,
    /// Members that changed class since `ascending` was sorted.
    unsorted: u32,
}

impl Classes {
    fn new(colors: &[u32], n_colors: u32) -> Self {
        let sizes = class_sizes(colors, n_colors);
        let mut ascending: Vec<u32> = (0..n_colors).collect();
        ascending.sort_by_key(|&c| sizes[c as usize]);
        Self { sizes, ascending, full: index(colors.len()).div_ceil(n_colors.max(1)), unsorted: 0 }
    }

    fn are_balanced(&self) -> bool {
        let mean = self.full.saturating_sub(1);
        let range = mean - mean / 33..=self.full.max(mean + mean / 125);
        self.sizes.iter().all(|size| range.contains(size))
    }

    /// A smallest class not in `used`, if it is at least two smaller than `own`.
    #[inline]
    fn room(&self, own: u32, used: &ColorSet) -> Option<u32> {
        let to = self.ascending.iter().copied().find(|&c| !used.contains(c))?;
        (self.sizes[to as usize] + 2 <= self.sizes[own as usize]).then_some(to)
    }

    fn transfer(&mut self, from: u32, to: u32, members: u32) {
        self.sizes[from as usize] -= members;
        self.sizes[to as usize] += members;
        // The order may lag behind by a part of the tolerance: sorting costs more than a move.
        self.unsorted += members;
        if self.unsorted > self.full / 256 {
            self.unsorted = 0;
            self.ascending.sort_unstable_by_key(|&c| (self.sizes[c as usize], c));
        }
    }
}
