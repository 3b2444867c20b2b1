//! Fewer colors: iterated greedy (Culberson 1992), and smallest-last where that is cheap.

use vivace_graph::{ConstraintGraph, Csr};
use vivace_kernels::coloring::UNCOLORED;

use crate::serial::Palette;
use crate::{Coloring, Order, first_fit};

/// Passes without a color less before iterated greedy gives up.
const PATIENCE: u32 = 3;
/// Smallest-last costs several passes and grows with the edges; below this mean degree it is tried, too. Cloth (mean degree 6) is why: its
/// three colors are out of the reach of iterated greedy. Tetrahedra (13 to 15) reach as few colors without it.
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

/// Passes of first fit over the classes until `PATIENCE` of them gained nothing, or the bound is met.
fn iterate(graph: &ConstraintGraph, mut coloring: Coloring, bound: u32) -> Coloring {
    let mut idle = 0;
    let mut pass = 0;
    while idle < PATIENCE && coloring.n_colors() > bound {
        let before = coloring.n_colors();
        coloring = first_fit_by_class(graph, coloring, pass);
        idle = if coloring.n_colors() < before { 0 } else { idle + 1 };
        pass += 1;
    }
    coloring
}

/// First fit, class after class: the last class first, or now and then the largest.
fn first_fit_by_class(graph: &ConstraintGraph, coloring: Coloring, pass: u32) -> Coloring {
    let n_colors = coloring.n_colors();
    let mut order: Vec<u32> = (0..n_colors).rev().collect();
    if pass % 3 == 2 {
        let sizes = coloring.class_sizes();
        order.sort_by_key(|&c| std::cmp::Reverse(sizes[c as usize]));
    }
    let mut colors = coloring.into_colors();
    let classes = Csr::group_by(n_colors as usize, &colors);
    colors.fill(UNCOLORED);
    let mut palette = Palette::new();
    for class in order {
        for &v in classes.row(class) {
            let row = graph.neighbors(v);
            let used = row.iter().fold([0_u64; 2], |[used, high], &u| {
                let c = colors[u as usize];
                [used | u64::from(c < 64).wrapping_shl(c), high | u64::from((64..UNCOLORED).contains(&c))]
            });
            let in_one_word = used[1] == 0 && used[0] != u64::MAX;
            colors[v as usize] =
                if in_one_word { used[0].trailing_ones() } else { palette.first_free(row, &colors) };
        }
    }
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
    let largest = (0..n).step_by(step).map(|v| grow(crate::certificate::index(v))).max();
    crate::certificate::index(largest.unwrap_or(0))
}
