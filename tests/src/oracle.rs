//! Colorings and checks written straight from their definitions: slow, and obviously right.

use std::cmp::Reverse;

use vivace_graph::{Adjacency, ConstraintGraph};
use vivace_kernels::pcg;

use crate::generators::to_u32;

const NONE: u32 = u32::MAX;

/// Whether every vertex has a color below the number of vertices, and no edge has one color at both ends.
pub fn is_coloring(graph: &impl Adjacency, colors: &[u32]) -> bool {
    let n = graph.n_vertices();
    if colors.len() != n {
        return false;
    }
    for v in 0..n {
        if colors[v] as usize >= n {
            return false;
        }
        for &u in graph.neighbors(to_u32(v)) {
            if colors[u as usize] == colors[v] {
                return false;
            }
        }
    }
    true
}

/// Whether every vertex has a neighbor in each class below its own, as first fit leaves it whatever the order.
pub fn is_first_fit_in_some_order(graph: &impl Adjacency, colors: &[u32]) -> bool {
    (0..to_u32(graph.n_vertices())).all(|v| {
        let mut seen: Vec<u32> = graph.neighbors(v).iter().map(|&u| colors[u as usize]).collect();
        seen.sort_unstable();
        seen.dedup();
        seen.iter().take_while(|&&c| c < colors[v as usize]).count() == colors[v as usize] as usize
    })
}

/// The smallest color that no neighbor of `v` has.
pub fn first_free(graph: &impl Adjacency, colors: &[u32], v: u32) -> u32 {
    let taken = |c: u32| graph.neighbors(v).iter().any(|&u| colors[u as usize] == c);
    (0..).find(|&c| !taken(c)).expect("there are more colors than neighbors")
}

/// First fit, one vertex after another.
pub fn first_fit(graph: &impl Adjacency, order: impl IntoIterator<Item = u32>) -> Vec<u32> {
    let mut colors = vec![NONE; graph.n_vertices()];
    for v in order {
        colors[v as usize] = first_free(graph, &colors, v);
    }
    colors
}

/// The vertices by descending random weight: the order in which Jones and Plassmann's rounds amount to first fit.
#[must_use]
pub fn descending_hash(graph: &ConstraintGraph, seed: u64) -> Vec<u32> {
    let key = pcg::key(seed, 0);
    let mut order: Vec<u32> = (0..to_u32(graph.n_vertices())).collect();
    order.sort_by_key(|&v| Reverse(pcg::hash(v, key)));
    order
}

/// Largest-degree-first in rounds: all vertices whose (current degree, hash) exceeds that of every uncolored neighbor, at once.
/// Also says in how many rounds.
#[must_use]
pub fn largest_degree_first(graph: &ConstraintGraph, seed: u64) -> (Vec<u32>, u32) {
    let n = to_u32(graph.n_vertices());
    let key = pcg::key(seed, 0);
    let mut colors = vec![NONE; n as usize];
    let mut rounds = 0;
    while colors.contains(&NONE) {
        let uncolored = |v: u32| colors[v as usize] == NONE;
        let current_degree = |v: u32| graph.neighbors(v).iter().filter(|&&u| uncolored(u)).count();
        let priority = |v: u32| (current_degree(v), pcg::hash(v, key));
        let wins = |v: u32| {
            uncolored(v) && graph.neighbors(v).iter().all(|&u| !uncolored(u) || priority(u) < priority(v))
        };
        let chosen: Vec<(u32, u32)> =
            (0..n).filter(|&v| wins(v)).map(|v| (v, first_free(graph, &colors, v))).collect();
        for (v, color) in chosen {
            colors[v as usize] = color;
        }
        rounds += 1;
    }
    (colors, rounds)
}

/// DSATUR: again and again, of the uncolored vertices, the one that sees most different colors, then the one of largest degree,
/// then the lowest.
pub fn dsatur(graph: &impl Adjacency) -> Vec<u32> {
    let n = to_u32(graph.n_vertices());
    let mut colors = vec![NONE; n as usize];
    for _ in 0..n {
        let saturation = |v: u32| {
            let mut seen: Vec<u32> =
                graph.neighbors(v).iter().map(|&u| colors[u as usize]).filter(|&c| c != NONE).collect();
            seen.sort_unstable();
            seen.dedup();
            seen.len()
        };
        let next = (0..n)
            .filter(|&v| colors[v as usize] == NONE)
            .max_by_key(|&v| (saturation(v), graph.degree(v), Reverse(v)))
            .expect("n vertices, fewer colored");
        colors[next as usize] = first_free(graph, &colors, next);
    }
    colors
}

/// The largest smallest degree of any subgraph, by taking away a vertex of smallest degree again and again.
#[must_use]
pub fn degeneracy(graph: &ConstraintGraph) -> u32 {
    let mut left: Vec<u32> = (0..to_u32(graph.n_vertices())).collect();
    let mut degeneracy = 0;
    while !left.is_empty() {
        let degree =
            |v: u32| to_u32(graph.neighbors(v).iter().filter(|u| left.binary_search(u).is_ok()).count());
        let (at, smallest) = (0..left.len())
            .map(|at| (at, degree(left[at])))
            .min_by_key(|&(_, degree)| degree)
            .expect("not empty");
        degeneracy = degeneracy.max(smallest);
        left.remove(at);
    }
    degeneracy
}

/// Smallest and largest class, each over the mean class.
#[must_use]
pub fn class_spread(colors: &[u32]) -> (f64, f64) {
    let n_colors = colors.iter().max().map_or(0, |&c| c as usize + 1);
    let mut sizes = vec![0_u32; n_colors];
    for &c in colors {
        sizes[c as usize] += 1;
    }
    let mean = colors.len() as f64 / n_colors.max(1) as f64;
    let over_mean = |size: Option<u32>| f64::from(size.unwrap_or(0)) / mean.max(f64::MIN_POSITIVE);
    (over_mean(sizes.iter().copied().min()), over_mean(sizes.iter().copied().max()))
}
