//! The passes over a finished coloring: equal classes, fewer colors, no crumbs.

use proptest::collection::vec;
use proptest::prelude::*;
use vivace_coloring::{
    Algorithm, Balanced, Certificate, Coloring, Order, Vivace, balance, blocked_first_fit, color,
    dissolve_small_classes, first_fit, reduce,
};
use vivace_graph::{ConstraintGraph, DynamicGraph};
use vivace_tests::generators::{clique, complete_bipartite, empty, isolated, path, star, wheel};
use vivace_tests::oracle;
use vivace_tests::random::Random;
use vivace_tests::workloads::Workload;

use crate::arbitrary::{any_algorithm, any_graph};

/// Any coloring whatever: first fit in a random order over random starting colors, so that numbers are left out, classes are
/// uneven and colors exceed degrees.
fn any_coloring() -> impl Strategy<Value = (ConstraintGraph, Coloring)> {
    let wishes = vec(0..30_u32, 1..50);
    (any_graph(), wishes).prop_map(|(graph, wishes)| {
        let n = u32::try_from(graph.n_vertices()).expect("small");
        let mut colors = vec![u32::MAX; n as usize];
        for v in 0..n {
            let taken = |c: u32| graph.neighbors(v).iter().any(|&u| colors[u as usize] == c);
            let wish = wishes[v as usize % wishes.len()].min(n - 1);
            let upwards = (wish..n).find(|&c| !taken(c));
            colors[v as usize] =
                upwards.or_else(|| (0..wish).find(|&c| !taken(c))).expect("n colors, n - 1 neighbors");
        }
        let coloring = Coloring::new(&graph, colors).expect("no neighbor's color was taken");
        (graph, coloring)
    })
}

fn is_valid(graph: &ConstraintGraph, coloring: &Coloring) -> bool {
    let is_dense = coloring.class_sizes().iter().all(|&size| size > 0);
    is_dense && oracle::is_coloring(graph, coloring.colors())
}

/// No move more than the bound: each brings the sum of squared sizes down by at least two.
fn most_moves(coloring: &Coloring) -> u64 {
    let sizes = coloring.class_sizes();
    let n: u64 = sizes.iter().map(|&size| u64::from(size)).sum();
    let squares: u64 = sizes.iter().map(|&size| u64::from(size).pow(2)).sum();
    (squares - n * n / u64::from(coloring.n_colors().max(1))) / 2
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn balance_keeps_the_coloring_and_its_colors((graph, coloring) in any_coloring()) {
        let before = coloring.clone();
        let Balanced { coloring, moves } = balance(&graph, coloring);
        prop_assert!(is_valid(&graph, &coloring));
        prop_assert_eq!(coloring.n_colors(), before.n_colors());
        prop_assert!(moves <= most_moves(&before), "{moves} of {} moves", most_moves(&before));
        prop_assert!(coloring.balance() <= before.balance() + 1e-12);
        prop_assert!(moves > 0 || coloring == before);
        if before.balance() == 1.0 {
            prop_assert_eq!((moves, &coloring), (0, &before));
        }
    }

    #[test]
    fn reduce_never_adds_a_color((graph, coloring) in any_coloring()) {
        let before = coloring.n_colors();
        let reduced = reduce(&graph, coloring);
        prop_assert!(is_valid(&graph, &reduced));
        prop_assert!(reduced.n_colors() <= before.min(graph.max_degree() + 1));
        let again = reduce(&graph, reduced.clone());
        prop_assert!(again.n_colors() <= reduced.n_colors());
    }

    #[test]
    fn dissolving_never_adds_a_color_or_a_small_class(
        (graph, coloring) in any_coloring(),
        at_most in 0..20_u32,
    ) {
        let sizes = coloring.class_sizes();
        let (n_before, n_small) = (coloring.n_colors(), sizes.iter().filter(|&&size| size <= at_most).count());
        let dissolved = dissolve_small_classes(&graph, coloring, at_most);
        prop_assert!(is_valid(&graph, &dissolved));
        prop_assert!(dissolved.n_colors() <= n_before);
        let still_small = dissolved.class_sizes().iter().filter(|&&size| size <= at_most).count();
        prop_assert!(still_small <= n_small, "{still_small} of {n_small}");
    }

    #[test]
    fn passes_take_what_any_algorithm_makes(graph in any_graph(), algorithm in any_algorithm()) {
        let coloring = algorithm.color(&graph).coloring;
        let n_colors = coloring.n_colors();
        let coloring = reduce(&graph, dissolve_small_classes(&graph, coloring, 5));
        let balanced = balance(&graph, coloring).coloring;
        prop_assert!(is_valid(&graph, &balanced) && balanced.n_colors() <= n_colors);
        // The rows of a graph under change are in no order; balance reads any.
        let dynamic = DynamicGraph::from(&graph);
        let n_colors = balanced.n_colors();
        let twice = balance(&dynamic, dissolve_small_classes(&dynamic, balanced, 3)).coloring;
        prop_assert!(is_valid(&graph, &twice) && twice.n_colors() <= n_colors);
    }
}

#[test]
fn extremes() {
    for graph in [empty(), isolated(1), isolated(7), path(9), star(9), wheel(9), clique(9)] {
        let start = color(&graph);
        let n_colors = start.n_colors();
        let reduced = reduce(&graph, dissolve_small_classes(&graph, start, 100));
        let balanced = balance(&graph, reduced).coloring;
        assert!(is_valid(&graph, &balanced));
        assert!(balanced.n_colors() <= n_colors);
    }
    // A color each, and one color for all.
    let each = Coloring::new(&isolated(50), (0..50).collect()).unwrap();
    assert_eq!(reduce(&isolated(50), each.clone()).n_colors(), 1);
    assert_eq!(balance(&isolated(50), each).moves, 0);
    // Two classes, one of them uneven: nobody on the full side can move.
    let sides = color(&complete_bipartite(2, 40));
    let unmoved = balance(&complete_bipartite(2, 40), sides.clone());
    assert_eq!((unmoved.moves, unmoved.coloring), (0, sides));
    // 60 isolated vertices in classes of 50, 9 and 1 end in three classes of 20.
    let uneven = (0..60).map(|v| u32::from(v >= 50) + u32::from(v >= 59)).collect();
    let even = balance(&isolated(60), Coloring::new(&isolated(60), uneven).unwrap());
    assert_eq!(even.coloring.class_sizes(), [20, 20, 20]);
    assert_eq!(even.moves, 30);
}

/// With more than a hundred vertices a color, the largest class is within 1% of the mean and the smallest within 5%.
#[test]
fn workloads_are_balanced() {
    for workload in Workload::up_to(101_000) {
        let graph = workload.shared();
        for algorithm in
            [Algorithm::BlockedFirstFit, Algorithm::Vivace(Vivace::DEFAULT), Algorithm::Luby { seed: 1 }]
        {
            let raw = algorithm.color(graph).coloring;
            let before = raw.clone();
            let Balanced { coloring, moves } = balance(graph, raw);
            assert!(Certificate::check(graph, coloring.colors()).is_ok());
            assert_eq!(coloring.n_colors(), before.n_colors());
            assert!(moves <= most_moves(&before));
            assert!(graph.n_vertices() > 100 * coloring.n_colors() as usize);
            let (smallest, largest) = oracle::class_spread(coloring.colors());
            let row = format!(
                "{:28} {:16} {:2} colors, {:.3} -> {largest:.4}, smallest {smallest:.4}, {moves} moves",
                workload.name,
                algorithm.name(),
                coloring.n_colors(),
                before.balance(),
            );
            println!("{row}");
            assert!((largest - coloring.balance()).abs() < 1e-9);
            assert!(largest <= 1.01 && smallest >= 0.95, "{row}");
        }
    }
}

/// As few colors as the best serial colorings need, from the default coloring; from random palettes at most one more.
#[test]
fn workloads_are_reduced() {
    let mut missed = Vec::new();
    for workload in Workload::up_to(101_000) {
        let graph = workload.shared();
        let random = Algorithm::Vivace(Vivace::DEFAULT).color(graph).coloring;
        let starts = [(blocked_first_fit(graph), workload.few_colors), (random, workload.few_colors + 1)];
        for (start, wanted) in starts {
            let before = start.n_colors();
            let reduced = reduce(graph, start);
            assert!(Certificate::check(graph, reduced.colors()).is_ok());
            let n_colors = reduced.n_colors();
            let row = format!("{:28} {before:2} -> {n_colors:2} colors, wanted {wanted:2}", workload.name);
            println!("{row}");
            if n_colors > wanted {
                missed.push(row);
            }
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// A reduced coloring is no worse than smallest-last, also where the numbering of the vertices says nothing of the mesh.
#[test]
fn reduced_is_no_worse_than_smallest_last() {
    for workload in Workload::up_to(11_000) {
        let n = u32::try_from(workload.shared().n_vertices()).unwrap();
        let shuffled = workload.shared().permuted(&Random::new(7).permutation(n)).unwrap();
        for graph in [workload.shared(), &shuffled] {
            let smallest_last = first_fit(graph, Order::SmallestLast).n_colors();
            let reduced = reduce(graph, color(graph)).n_colors();
            assert!(reduced <= smallest_last, "{}: {reduced} against {smallest_last}", workload.name);
        }
    }
}
