//! The CPU backend against the naive one, bit for bit, and the algorithms against their definitions.

use proptest::prelude::*;
use vivace_coloring::{
    Algorithm, Certificate, ConflictRule, GraphView, Order, Vivace, blocked_first_fit, dsatur, first_fit,
    jones_plassmann,
};
use vivace_cpu::Cpu;
use vivace_graph::{ConstraintGraph, smallest_last};
use vivace_tests::generators::{clique, random, regular_cloth, star, tets, wheel};
use vivace_tests::naive::{Fault, Naive, Rounds, in_rounds};
use vivace_tests::oracle;
use vivace_tests::workloads::{Workload, shared};

use crate::arbitrary::{any_graph, any_round_based, large_graph, random_graph};

fn on_cpu(algorithm: Algorithm, graph: &ConstraintGraph) -> Option<Rounds> {
    in_rounds(&Cpu::new(), algorithm, graph)
}

fn on_naive(fault: Option<Fault>, algorithm: Algorithm, graph: &ConstraintGraph) -> Option<Rounds> {
    in_rounds(&Naive { fault }, algorithm, graph)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    #[test]
    fn both_backends_agree_bit_for_bit(graph in any_graph(), algorithm in any_round_based()) {
        let expected = on_naive(None, algorithm, &graph);
        prop_assert!(expected.is_some());
        prop_assert_eq!(on_cpu(algorithm, &graph), expected);
    }

    #[test]
    fn jones_plassmann_is_first_fit_by_descending_weight(graph in any_graph(), seed in any::<u64>()) {
        let rounds = jones_plassmann(&Cpu::new(), GraphView::of(&graph), seed);
        let expected = oracle::first_fit(&graph, oracle::descending_hash(&graph, seed));
        prop_assert_eq!(rounds.colors, expected);
    }

    #[test]
    fn luby_takes_maximal_independent_sets(graph in any_graph(), seed in any::<u64>()) {
        let colors = on_cpu(Algorithm::Luby { seed }, &graph).unwrap().colors;
        for class in 0..colors.iter().max().map_or(0, |&c| c + 1) {
            // Whoever is left for later has a neighbor in the set: it could not have joined.
            for (v, _) in (0..).zip(&colors).filter(|&(_, &c)| c > class) {
                let row = graph.neighbors(v);
                prop_assert!(row.iter().any(|&u| colors[u as usize] == class), "{v} could be in {class}");
            }
        }
    }

    #[test]
    fn largest_degree_first_follows_its_definition(graph in random_graph(60), seed in any::<u64>()) {
        let rounds = on_cpu(Algorithm::LargestDegreeFirst { seed }, &graph).unwrap();
        prop_assert_eq!((rounds.colors, rounds.count.rounds), oracle::largest_degree_first(&graph, seed));
    }

    #[test]
    fn serial_colorings_follow_their_definitions(graph in any_graph()) {
        let n = u32::try_from(graph.n_vertices()).unwrap();
        let natural = first_fit(&graph, Order::Natural);
        prop_assert_eq!(natural.colors(), oracle::first_fit(&graph, 0..n));
        let mut by_degree: Vec<u32> = (0..n).collect();
        by_degree.sort_by_key(|&v| std::cmp::Reverse(graph.degree(v)));
        let largest_first = first_fit(&graph, Order::LargestFirst);
        prop_assert_eq!(largest_first.colors(), oracle::first_fit(&graph, by_degree));
        let by_removal = first_fit(&graph, Order::SmallestLast);
        prop_assert_eq!(by_removal.colors(), oracle::first_fit(&graph, smallest_last(&graph).order));
        let by_saturation = dsatur(&graph);
        prop_assert_eq!(by_saturation.colors(), oracle::dsatur(&graph));
    }

    #[test]
    fn smallest_last_stays_below_the_degeneracy(graph in any_graph()) {
        let bound = if graph.n_vertices() == 0 { 0 } else { oracle::degeneracy(&graph) + 1 };
        let n_colors = first_fit(&graph, Order::SmallestLast).n_colors();
        prop_assert!(n_colors <= bound, "{n_colors} colors, degeneracy + 1 is {bound}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    #[test]
    fn both_backends_agree_on_large_graphs(graph in large_graph(), algorithm in any_round_based()) {
        prop_assert_eq!(on_cpu(algorithm, &graph), on_naive(None, algorithm, &graph));
    }
}

#[test]
fn both_backends_agree_on_meshes() {
    for name in ["hinge-cloth-10k", "tets-10k"] {
        for algorithm in Algorithm::ALL {
            let graph = shared(name);
            assert_eq!(on_cpu(algorithm, graph), on_naive(None, algorithm, graph), "{name}, {algorithm}");
        }
    }
    // Past the bound on rounds, too.
    for algorithm in Algorithm::ALL {
        assert_eq!(on_cpu(algorithm, &clique(300)), on_naive(None, algorithm, &clique(300)), "{algorithm}");
    }
}

/// A comparison counts once it has been seen to fail: every mistake a backend might make shows in some algorithm.
#[test]
fn a_wrong_backend_is_noticed() {
    let graphs = [tets(500, 3), regular_cloth(20, 20), star(50)];
    for fault in Fault::ALL {
        let notices = |algorithm: Algorithm| {
            graphs.iter().any(|graph| {
                let wrong = std::panic::catch_unwind(|| on_naive(Some(fault), algorithm, graph));
                wrong.is_err() || wrong.is_ok_and(|wrong| wrong != on_cpu(algorithm, graph))
            })
        };
        let noticed_by: Vec<&str> =
            Algorithm::ALL.into_iter().filter(|&a| a.is_seeded() && notices(a)).map(|a| a.name()).collect();
        let expected = match fault {
            Fault::CountDownCollides => vec!["ldf"],
            Fault::SelectionLosesOne => vec!["luby", "jones-plassmann", "ldf"], // the paper's goes on with the list alone
            Fault::RoundsFromOne => vec!["luby", "vivace", "vivace-index"],
            _ => vec!["luby", "jones-plassmann", "ldf", "vivace", "vivace-index"],
        };
        assert_eq!(noticed_by, expected, "{fault:?}");
    }
}

/// With palettes of one color and no rule for conflicts, neighbors clash until the bound on rounds; first fit then ends it.
#[test]
fn without_a_rule_the_end_is_first_fit() {
    let options = Vivace { shrink: f32::INFINITY, seed: 0, conflict: ConflictRule::None };
    let graph = random(500, 3000, 9);
    let rounds = on_cpu(Algorithm::Vivace(options), &graph).unwrap();
    let connected = (0..500).filter(|&v| graph.degree(v) > 0).collect::<Vec<_>>();
    assert_eq!(rounds.stragglers, connected);
    assert_eq!(rounds.colors, oracle::first_fit(&graph, 0..500));
}

/// Blocks cost at most one color against plain first fit.
#[test]
fn blocks_cost_at_most_one_color() {
    for workload in Workload::up_to(101_000) {
        let graph = workload.shared();
        let (blocked, plain) = (blocked_first_fit(graph), first_fit(graph, Order::Natural));
        assert!(Certificate::check(graph, blocked.colors()).is_ok());
        let (blocked, plain) = (blocked.n_colors(), plain.n_colors());
        assert!(blocked <= plain + 1, "{}: {blocked} colors in blocks, {plain} without", workload.name);
        println!("{:28} blocked {blocked:2}, first fit {plain:2}", workload.name);
    }
}

#[test]
fn wheels_and_stars_agree_past_the_thread_threshold() {
    for graph in [wheel(5000), star(5000)] {
        for algorithm in Algorithm::ALL {
            assert_eq!(on_cpu(algorithm, &graph), on_naive(None, algorithm, &graph), "{algorithm}");
        }
    }
}
