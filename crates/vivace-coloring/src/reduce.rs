//! Fewer colors: iterated greedy (Culberson 1992), and smallest-last where that is cheap.

use vivace_graph::{ConstraintGraph, Csr};
use vivace_kernels::coloring::UNCOLORED;
use vivace_kernels::pcg;

use crate::certificate::index;
use crate::serial::Palette;
use crate::{Coloring, Order, first_fit};

/// Passes at the most.
const MAX_PASSES: u32 = 16;
/// Smallest-last costs several passes and grows with the edges; below this mean degree it is tried, too. Cloth (mean degree 6) and
/// renumbered hinges (12) are why: their three and four colors are out of the reach of iterated greedy. Tetrahedra (13 and more)
/// reach as few colors without it.
const SPARSE: usize = 13;

/// Colors a graph again with as few colors as can be had in a few times the time of first fit; never more than `coloring` has.
///
/// First fit that visits the classes one after another, in any order, needs no more colors than there are classes, and often
/// fewer. Serial, O(n + m) a pass; at most a few dozen passes.
#[must_use]
pub fn reduce(graph: &ConstraintGraph, coloring: Coloring) -> Coloring {
    let bound = clique(graph);
    let reduced = iterate(graph, coloring, bound);
    if reduced.n_colors() <= bound || graph.csr().len() >= SPARSE * graph.n_vertices() {
        return reduced;
    }
    let other = iterate(graph, first_fit(graph, Order::SmallestLast), bound);
    if other.n_colors() < reduced.n_colors() { other } else { reduced }
}

/// Passes of first fit over the classes, as long as they gain a color or the last class is all but gone. The last class comes first,
/// the best of the orders tried; every third pass a random order, since the other falls into cycles.
fn iterate(graph: &ConstraintGraph, mut coloring: Coloring, bound: u32) -> Coloring {
    let n = index(graph.n_vertices());
    for pass in 0..MAX_PASSES {
        let before = coloring.n_colors();
        if before <= bound {
            break;
        }
        let mut order: Vec<u32> = (0..before).rev().collect();
        if pass % 3 == 2 {
            order.sort_by_key(|&c| pcg::hash(c, pcg::key(0, pass)));
        }
        coloring = first_fit_by_class(graph, coloring, &order);
        // A last class this large has not gone in any pass that was tried; one that gained nothing needs to be smaller still.
        let hopeless = if coloring.n_colors() < before { n / 128 } else { n / 500 };
        if coloring.class_sizes().last().is_some_and(|&size| size > hopeless) {
            break;
        }
    }
    coloring
}

/// First fit, class after class.
fn first_fit_by_class(graph: &ConstraintGraph, coloring: Coloring, order: &[u32]) -> Coloring {
    let n_colors = coloring.n_colors();
    let mut colors = coloring.into_colors();
    let classes = Csr::group_by(n_colors as usize, &colors);
    colors.fill(UNCOLORED);
    let mut palette = Palette::new();
    let (offsets, neighbors) = (graph.csr().offsets(), graph.csr().items());
    // The members of a class lie far apart: asking for a row well before it is read hides most of the wait for memory.
    const AHEAD: usize = 12;
    let mut asked = 0_u32;
    for &class in order {
        let class = classes.row(class);
        for (k, &v) in class.iter().enumerate() {
            if let Some(&next) = class.get(k + AHEAD) {
                asked ^= neighbors.get(offsets[next as usize] as usize).copied().unwrap_or(0);
            }
            let row = &neighbors[offsets[v as usize] as usize..offsets[v as usize + 1] as usize];
            let (mut used, mut high) = (0_u64, false);
            for &u in row {
                let c = colors[u as usize];
                used |= u64::from(c < 64).wrapping_shl(c);
                high |= (64..UNCOLORED).contains(&c);
            }
            let in_one_word = !high && used != u64::MAX;
            colors[v as usize] =
                if in_one_word { used.trailing_ones() } else { palette.first_free(row, &colors) };
        }
    }
    std::hint::black_box(asked);
    Coloring::dense(colors)
}

/// The size of a clique, found by growing one from each of a few vertices: no coloring has fewer colors.
fn clique(graph: &ConstraintGraph) -> u32 {
    let n = graph.n_vertices();
    let step = (n / 64).max(1);
    let grow = |v: u32| {
        let mut clique = vec![v];
        for &u in graph.neighbors(v) {
            if clique.iter().all(|w| graph.neighbors(*w).binary_search(&u).is_ok()) {
                clique.push(u);
            }
        }
        clique.len()
    };
    let largest = (0..n).step_by(step).map(|v| grow(index(v))).max();
    index(largest.unwrap_or(0))
}
