//! What every algorithm promises on every graph.

use std::sync::LazyLock;

use proptest::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use vivace_coloring::{
    Algorithm, Certificate, ConflictRule, Order, Outcome, ROUND_LIMIT, Vivace, color, first_fit,
};
use vivace_cpu::Cpu;
use vivace_graph::ConstraintGraph;
use vivace_tests::generators::{
    clique, complete_bipartite, empty, isolated, random, regular_hinge_cloth, star, wheel, with_hubs,
};
use vivace_tests::naive::in_rounds;
use vivace_tests::oracle;
use vivace_tests::workloads::shared;

use crate::arbitrary::{any_algorithm, any_graph, large_graph};

static POOLS: LazyLock<[ThreadPool; 3]> = LazyLock::new(|| {
    [1, 2, 7]
        .map(|threads| ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had"))
});

/// Colors the graph and checks what holds for every algorithm.
fn promises_hold(graph: &ConstraintGraph, algorithm: Algorithm) -> Outcome {
    let outcome = algorithm.color(graph);
    let coloring = &outcome.coloring;
    let colors = coloring.colors();
    let n = graph.n_vertices();

    let certificate = Certificate::check(graph, colors).unwrap_or_else(|e| panic!("{algorithm}: {e}"));
    assert!(oracle::is_coloring(graph, colors), "{algorithm}: the certificate is wrong");
    assert_eq!((certificate.n_vertices, certificate.n_edges), (n, graph.n_edges()), "{algorithm}");
    assert_eq!(certificate.max_degree, graph.max_degree(), "{algorithm}");

    // Colors are at most the degree, so at most max degree + 1 in number.
    assert!(colors.iter().zip(graph.degrees()).all(|(&c, degree)| c <= degree), "{algorithm}");
    assert!(certificate.within_degree, "{algorithm}");
    assert!(coloring.n_colors() <= graph.max_degree() + 1, "{algorithm}");

    // No number is left out.
    assert_eq!((certificate.n_ids, certificate.n_colors), (coloring.n_colors(), coloring.n_colors()));
    assert!(certificate.class_sizes.iter().all(|&size| size > 0), "{algorithm}");
    assert_eq!(coloring.class_sizes(), certificate.class_sizes, "{algorithm}");

    // The partitions hold every vertex once, each class ascending.
    let partitions = coloring.partitions();
    assert_eq!(partitions.n_colors(), coloring.n_colors() as usize, "{algorithm}");
    let mut times_seen = vec![0; n];
    for class in 0..coloring.n_colors() {
        assert!(partitions.class(class).is_sorted(), "{algorithm}");
        for &v in partitions.class(class) {
            assert_eq!(colors[v as usize], class, "{algorithm}");
            times_seen[v as usize] += 1;
        }
    }
    assert!(times_seen.iter().all(|&times| times == 1), "{algorithm}");

    rounds_are_bounded(&outcome, n, algorithm);
    outcome
}

fn rounds_are_bounded(outcome: &Outcome, n: usize, algorithm: Algorithm) {
    // Luby bounds the rounds for each color, the others all of them.
    let limit = match algorithm {
        Algorithm::Luby { .. } => ROUND_LIMIT * outcome.coloring.n_colors().clamp(1, ROUND_LIMIT),
        _ => ROUND_LIMIT,
    };
    assert!(outcome.rounds <= limit, "{algorithm}: {} rounds", outcome.rounds);
    assert!(outcome.visits <= u64::from(outcome.rounds) * n as u64, "{algorithm}");
    assert!(outcome.visits + u64::from(outcome.stragglers) >= n as u64, "{algorithm}");
    if outcome.stragglers > 0 {
        assert!(outcome.rounds >= ROUND_LIMIT, "{algorithm} gave up early");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn every_setting_holds_its_promises(graph in any_graph(), algorithm in any_algorithm()) {
        promises_hold(&graph, algorithm);
    }

    #[test]
    fn first_fit_and_its_kin_leave_no_smaller_color_free(graph in any_graph(), seed in any::<u64>()) {
        let kin = Algorithm::ALL
            .into_iter()
            .filter(|algorithm| !matches!(algorithm, Algorithm::BlockedFirstFit | Algorithm::Vivace(_)));
        for algorithm in kin {
            let outcome = algorithm.with_seed(seed).color(&graph);
            prop_assert!(
                oracle::is_first_fit_in_some_order(&graph, outcome.coloring.colors()),
                "{}",
                algorithm
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn any_number_of_threads_gives_one_answer(graph in large_graph(), algorithm in any_algorithm()) {
        threads_do_not_show(&graph, algorithm);
    }
}

fn threads_do_not_show(graph: &ConstraintGraph, algorithm: Algorithm) {
    let [one, two, seven] = &*POOLS;
    let expected = one.install(|| algorithm.color(graph));
    assert_eq!(two.install(|| algorithm.color(graph)), expected, "{algorithm}");
    assert_eq!(seven.install(|| algorithm.color(graph)), expected, "{algorithm}");
    assert_eq!(algorithm.color(graph), expected, "{algorithm} outside any pool");
    let on = |cpu: Cpu| in_rounds(&cpu, algorithm, graph);
    assert_eq!(on(Cpu::serial()), seven.install(|| on(Cpu::new())), "{algorithm}");
}

#[test]
fn meshes_and_hubs_hold_them_too() {
    let hub = with_hubs(&random(100_000, 20_000, 5), &[100_000, 0, 3], 6);
    assert_eq!(hub.max_degree(), 100_001);
    let workloads = ["cloth-10k", "hinge-cloth-10k", "irregular-hinge-cloth-10k", "tets-contacts-10k"];
    for graph in workloads.map(shared).into_iter().chain([&hub, &star(100_000), &wheel(100_000)]) {
        for algorithm in Algorithm::ALL {
            promises_hold(graph, algorithm);
            threads_do_not_show(graph, algorithm);
        }
    }
}

#[test]
fn the_extremes() {
    for algorithm in Algorithm::ALL {
        let n_colors = |graph: ConstraintGraph| promises_hold(&graph, algorithm).coloring.n_colors();
        assert_eq!(n_colors(empty()), 0, "{algorithm}");
        assert_eq!(n_colors(isolated(1)), 1, "{algorithm}");
        assert_eq!(n_colors(isolated(5000)), 1, "{algorithm}");
        assert_eq!(n_colors(clique(2)), 2, "{algorithm}");
        assert_eq!(n_colors(clique(70)), 70, "{algorithm}");
        assert_eq!(n_colors(star(100)), 2, "{algorithm}");
        assert!((2..=5).contains(&n_colors(complete_bipartite(2, 300))), "{algorithm}");
    }
    assert_eq!(promises_hold(&complete_bipartite(90, 90), Algorithm::Dsatur).coloring.n_colors(), 2);
}

/// Blocks out of step exchange colors, and a loose thread at the end of a row cannot have what the others may.
#[test]
fn exchanged_colors_stay_within_the_degree() {
    for width in 30..70_u32 {
        // A cloth of hinges, each row with one vertex more: joined to the row's last one, or to none.
        let cloth = regular_hinge_cloth(width as usize, 120);
        let number = |v: u32| v / width * (width + 1) + v % width;
        let mut edges: Vec<[u32; 2]> = cloth.edges().map(|edge| edge.map(number)).collect();
        edges.extend((0..120).step_by(2).map(|row| row * (width + 1) + width).map(|v| [v - 1, v]));
        let fringed = ConstraintGraph::from_edges(120 * (width as usize + 1), &edges).unwrap();
        promises_hold(&fringed, Algorithm::BlockedFirstFit);
    }
}

#[test]
fn color_is_the_default() {
    let graph = shared("tets-10k");
    assert_eq!(color(graph), Algorithm::BlockedFirstFit.color(graph).coloring);
    assert_eq!(first_fit(graph, Order::Natural), Algorithm::FirstFit(Order::Natural).color(graph).coloring);
}

#[test]
fn a_seed_is_a_coloring() {
    let graph = shared("tets-10k");
    for algorithm in Algorithm::ALL {
        let of_seed = |seed| algorithm.with_seed(seed).color(graph);
        assert_eq!(of_seed(1), of_seed(1), "{algorithm}");
        let all = [0, 1, 2, 1 << 32, u64::MAX].map(of_seed);
        for (i, a) in all.iter().enumerate() {
            for b in &all[..i] {
                assert_eq!(a.coloring != b.coloring, algorithm.is_seeded(), "{algorithm}");
            }
        }
    }
}

#[test]
fn names_are_distinct_and_are_read_back() {
    for algorithm in Algorithm::ALL {
        assert_eq!(algorithm.name().parse::<Algorithm>().unwrap(), algorithm);
    }
    let error = "rainbow".parse::<Algorithm>().unwrap_err().to_string();
    assert!(error.contains("rainbow") && error.contains("blocked"), "{error}");
}

/// Where the bound on rounds is met, the rest is colored one by one, and threads still do not show.
#[test]
fn stragglers_have_a_deterministic_end() {
    let no_rule = Algorithm::Vivace(Vivace { conflict: ConflictRule::None, ..Vivace::DEFAULT });
    let cases = [
        (clique(400), Algorithm::JonesPlassmann { seed: 3 }),
        (clique(400), Algorithm::LargestDegreeFirst { seed: 3 }),
        (clique(400), Algorithm::Luby { seed: 3 }),
        (clique(400), no_rule),
        (random(3000, 12_000, 4), no_rule),
    ];
    for (graph, algorithm) in &cases {
        let outcome = promises_hold(graph, *algorithm);
        assert!(outcome.stragglers > 0, "{algorithm}");
        threads_do_not_show(graph, *algorithm);
    }
    let on_clique = |algorithm: Algorithm| algorithm.color(&cases[0].0);
    // One vertex a round, so 256 in rounds and the rest at the end.
    assert_eq!(on_clique(Algorithm::JonesPlassmann { seed: 3 }).stragglers, 400 - ROUND_LIMIT);
    assert_eq!(on_clique(Algorithm::JonesPlassmann { seed: 3 }).rounds, ROUND_LIMIT);
    assert_eq!(on_clique(Algorithm::Luby { seed: 3 }).stragglers, 400 - ROUND_LIMIT);
}
