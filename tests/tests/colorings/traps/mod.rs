//! Fifteen ways to get Algorithm 2 wrong. Each test says the trap, shows it at work in a literal reading where that can be had,
//! and shows that this implementation does not fall into it.

mod literal;

use std::collections::BTreeSet;

use vivace_coloring::{
    Algorithm, Certificate, ConflictRule, ROUND_LIMIT, Vivace, balance, dissolve_small_classes,
};
use vivace_cpu::{Cpu, List};
use vivace_graph::{ConstraintGraph, GraphError};
use vivace_kernels::coloring::{
    AcceptColor, AcceptColorUniform, CONFLICT_HASH, CONFLICT_INDEX, CONFLICT_NONE, ProposeColor,
    ProposeColorUniform, UNCOLORED,
};
use vivace_kernels::{Backend, pcg};
use vivace_tests::generators::{
    clique, empty, isolated, path, regular_cloth, regular_hinge_cloth, star, tets, with_hubs,
};
use vivace_tests::naive::{Naive, in_rounds};
use vivace_tests::oracle;
use vivace_tests::random::Random;
use vivace_tests::workloads::shared;

use literal::{Feed, Literal, Run, Winner};

/// Rounds after which a literal reading counts as stuck.
const LIMIT: u32 = 200;

fn graphs() -> [&'static ConstraintGraph; 2] {
    ["cloth-10k", "tets-10k"].map(shared)
}

/// The implementation, read as the paper does but for the trap: index priority, and the given s.
fn ours(shrink: f32) -> Algorithm {
    Algorithm::Vivace(Vivace { shrink, seed: 0, conflict: ConflictRule::HighestIndex })
}

fn ends_and_is_proper(graph: &ConstraintGraph, algorithm: Algorithm) {
    let outcome = algorithm.color(graph);
    assert!(Certificate::check(graph, outcome.coloring.colors()).is_ok());
    assert_eq!(outcome.stragglers, 0);
    assert!(outcome.rounds < 40, "{} rounds", outcome.rounds);
}

/// The reading that works does: what goes wrong below goes wrong by its one change.
#[test]
fn trap_00_none() {
    for graph in graphs() {
        let Run { n_stuck, n_bad_edges, rounds, colors } = Literal::SOUND.run(graph, LIMIT);
        assert_eq!((n_stuck, n_bad_edges), (0, 0));
        assert!(rounds < 20 && oracle::is_coloring(graph, &colors));
    }
}

#[test]
fn trap_01_fed_the_same_color_for_ever() {
    // "P := P + {|P| + 1}" of an empty palette offers color 1, again and again.
    for graph in graphs() {
        let run = Literal { feed: Feed::SizePlusOne, ..Literal::SOUND }.run(graph, LIMIT);
        assert!(run.n_stuck > 100, "{}", run.n_stuck);
        ends_and_is_proper(graph, ours(2.0));
    }
}

#[test]
fn trap_02_fed_a_neighbors_color() {
    // The color fed may belong to a colored neighbor; the palette is then not empty, and never fed again.
    for (graph, shrink) in graphs().into_iter().zip([2.0, 5.0]) {
        let run = Literal { feed: Feed::Next, shrink, ..Literal::SOUND }.run(graph, LIMIT);
        assert!(run.n_stuck > 20, "{}", run.n_stuck);
        ends_and_is_proper(graph, ours(shrink));
    }
    // Whatever is colored already, what the others are proposed is free and at most the degree.
    let graph = tets(2000, 1);
    let mut random = Random::new(2);
    let full = Algorithm::ALL[0].color(&graph).coloring.into_colors();
    for shrink in [1.0, 2.5, 1e9] {
        let mut colors = full.clone();
        for color in &mut colors {
            if random.unit() < 0.5 {
                *color = UNCOLORED;
            }
        }
        let proposal = propose(&graph, &colors, shrink);
        for (v, &proposed) in (0..).zip(&proposal).filter(|&(v, _)| colors[v as usize] == UNCOLORED) {
            assert!(proposed <= graph.degree(v));
            assert!(graph.neighbors(v).iter().all(|&u| colors[u as usize] != proposed));
        }
    }
}

/// What each vertex would draw beside these colors.
fn propose(graph: &ConstraintGraph, colors: &[u32], shrink: f32) -> Vec<u32> {
    let mut proposal = vec![UNCOLORED; colors.len()];
    let (offsets, neighbors) = (graph.csr().offsets(), graph.csr().items());
    let inputs = (offsets, neighbors, colors);
    Cpu::new().map::<ProposeColor>(
        &List::all(colors.len()),
        &palettes(shrink, u32::MAX),
        inputs,
        &mut proposal,
    );
    proposal
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive, and saturates")]
fn palettes(shrink: f32, palette_cap: u32) -> ProposeColorUniform {
    ProposeColorUniform { key: 5, shrink_q8: (shrink * 256.0) as u32, palette_cap }
}

#[test]
fn trap_03_empty_palettes() {
    // "A list of D / s colors" is empty where D < s; `{0..D/s}` is not.
    for shrink in [1.0, 1.05, 1.5, 2.5, 8.0, 65_536.0] {
        for degree in [0, 1, 2, 3, 7, 100, 1 << 20, (1 << 24) + 5, u32::MAX - 1] {
            for cap in [1, 8, u32::MAX] {
                let size = palettes(shrink, cap).palette_size(degree);
                assert!((1..=degree + 1).contains(&size) && size <= cap, "{degree} {shrink}: {size}");
            }
            let uniform = palettes(shrink, u32::MAX);
            let printed = 256 * u64::from(degree.min((1 << 24) - 1)) / u64::from(uniform.shrink_q8) + 1;
            assert_eq!(u64::from(uniform.palette_size(degree)), printed, "{degree} {shrink}");
        }
    }
    assert_eq!(palettes(2.5, u32::MAX).palette_size(1), 1);
    ends_and_is_proper(&isolated(100), ours(2.0));
    ends_and_is_proper(&path(100), ours(2.0));
}

#[test]
fn trap_04_shrinking_by_the_smallest_degree() {
    // s = min degree divides by zero, or by 1, where a single vertex has degree 0 or 1.
    for (min_degree, shrink) in [(0, 1.5), (1, 1.5), (2, 2.0), (5, 5.0), (9, 8.0), (u32::MAX, 8.0)] {
        assert!((Vivace::as_printed(min_degree, 0).shrink - shrink).abs() < f32::EPSILON);
    }
    let mesh = tets(5000, 3);
    let dangling = with_hubs(&mesh, &[1, 0], 1);
    assert_eq!(dangling.min_degree(), 1);
    let n_colors = |shrink: f32| {
        let algorithm = ours(shrink);
        ends_and_is_proper(&dangling, algorithm);
        algorithm.color(&dangling).coloring.n_colors()
    };
    assert!(2 * n_colors(1.0) > 3 * n_colors(2.5));
    assert!(n_colors(Vivace::as_printed(1, 0).shrink) > n_colors(2.5));
    // No number is refused, and none hangs.
    for shrink in [0.0, -3.0, f32::NAN, f32::INFINITY, f32::MIN_POSITIVE] {
        let outcome = Algorithm::Vivace(Vivace { shrink, ..Vivace::DEFAULT }).color(&dangling);
        assert!(oracle::is_coloring(&dangling, outcome.coloring.colors()));
        assert_eq!(outcome.stragglers, 0);
    }
}

#[test]
fn trap_05_nobody_wins() {
    // Without the "Hungarian heuristic", neighbors whose palettes are both {k} clash for ever: they are never hungry.
    for graph in graphs() {
        let run = Literal { winner: Winner::Nobody, ..Literal::SOUND }.run(graph, LIMIT);
        assert!(run.n_stuck > 100, "{}", run.n_stuck);
        ends_and_is_proper(graph, Algorithm::Vivace(Vivace { shrink: 2.0, ..Vivace::DEFAULT }));
    }
    let pair = clique(2);
    let run = Literal { winner: Winner::Nobody, ..Literal::SOUND }.run(&pair, LIMIT);
    assert_eq!(run.n_stuck, 2);
    // The same rule is on offer, for comparison; the bound on rounds ends it.
    let none = Algorithm::Vivace(Vivace { conflict: ConflictRule::None, ..Vivace::DEFAULT }).color(&pair);
    assert_eq!((none.rounds, none.stragglers, none.coloring.n_colors()), (ROUND_LIMIT, 2, 2));
    let default = Algorithm::Vivace(Vivace::DEFAULT).color(&pair);
    assert_eq!((default.rounds, default.stragglers, default.coloring.n_colors()), (2, 0, 2));
}

#[test]
fn trap_06_highest_among_the_wrong_neighbors() {
    // "The higher index among its neighbors": of all of them, hardly anybody is; of the uncolored ones, chains are long.
    for graph in graphs() {
        let all = Literal { winner: Winner::HighestOfAll, ..Literal::SOUND }.run(graph, LIMIT);
        assert!(all.n_stuck > 100, "{}", all.n_stuck);
        let uncolored = Literal { winner: Winner::HighestOfUncolored, ..Literal::SOUND }.run(graph, LIMIT);
        let same = Literal::SOUND.run(graph, LIMIT);
        assert_eq!((uncolored.n_stuck, same.n_stuck), (0, 0));
        assert!(uncolored.rounds > same.rounds, "{} {}", uncolored.rounds, same.rounds);
        ends_and_is_proper(graph, ours(2.0));
    }
}

/// Of a pair that drew the same color, the higher index wins, or the higher hash.
#[test]
fn trap_06_who_wins() {
    let winners = |graph: &ConstraintGraph, rule: u32, key: u32| {
        let n = graph.n_vertices();
        let same = vec![3; n];
        let inputs = (graph.csr().offsets(), graph.csr().items(), &same[..]);
        let uniform = AcceptColorUniform { key, rule };
        let mut colors = vec![UNCOLORED; n];
        let won = Cpu::new().select::<AcceptColor>(&mut List::all(n), &uniform, inputs, &mut colors);
        won.indices().to_vec()
    };
    for key in 0..20 {
        assert_eq!(winners(&path(2), CONFLICT_INDEX, key), [1]);
        assert_eq!(winners(&star(3), CONFLICT_INDEX, key), [1, 2, 3]);
        let by_hash = u32::from(pcg::hash(1, key) > pcg::hash(0, key));
        assert_eq!(winners(&path(2), CONFLICT_HASH, key), [by_hash]);
        assert!(winners(&path(2), CONFLICT_NONE, key).is_empty());
    }
}

#[test]
fn trap_07_winning_against_a_colored_neighbor() {
    // "Then the coloring is considered legitimate": not if the neighbor with that color has it already.
    let wrong = Literal { feed: Feed::Next, winner: Winner::HighestAgainstColored, ..Literal::SOUND };
    for (graph, shrink) in graphs().into_iter().zip([2.0, 5.0]) {
        let run = Literal { shrink, ..wrong }.run(graph, LIMIT);
        assert!(run.n_bad_edges > 20, "{}", run.n_bad_edges);
        ends_and_is_proper(graph, ours(shrink));
    }
}

#[test]
fn trap_08_deciding_while_committing() {
    // Written in the kernel that reads them, flags show a vertex that the winner is done, and it takes the same color.
    for graph in graphs() {
        let run = Literal { commits_at_once: true, ..Literal::SOUND }.run(graph, 1);
        assert!(run.n_bad_edges > 1000, "{}", run.n_bad_edges);
    }
    // Here no order shows: the naive backend runs in descending order, the other in pieces of ascending order.
    for graph in graphs() {
        let n = graph.n_vertices();
        let proposal = propose(graph, &vec![UNCOLORED; n], 2.0);
        let inputs = (graph.csr().offsets(), graph.csr().items(), &proposal[..]);
        for rule in [CONFLICT_HASH, CONFLICT_INDEX] {
            let uniform = AcceptColorUniform { key: 9, rule };
            let (mut colors, mut list) = (vec![UNCOLORED; n], List::all(n));
            let accepted = Cpu::new().select::<AcceptColor>(&mut list, &uniform, inputs, &mut colors);
            let (mut colors_down, mut list_down) = (vec![UNCOLORED; n], Naive::default().all(n));
            let accepted_down =
                Naive::default().select::<AcceptColor>(&mut list_down, &uniform, inputs, &mut colors_down);
            assert_eq!(colors, colors_down);
            assert!(accepted.indices().iter().eq(&accepted_down) && list.indices().iter().eq(&list_down));
            let is_bad = |[u, v]: [u32; 2]| {
                colors[u as usize] != UNCOLORED && colors[u as usize] == colors[v as usize]
            };
            assert!(!graph.edges().any(is_bad) && accepted.len() > n / 3);
        }
    }
}

#[test]
fn trap_09_index_priority_follows_the_numbering() {
    // Indices that follow the mesh make long chains where palettes are small; a hash of (vertex, round) makes none.
    for (graph, times) in graphs().into_iter().zip([8, 3]) {
        let rounds = |conflict| {
            let options = Vivace { shrink: f32::INFINITY, seed: 0, conflict };
            Algorithm::Vivace(options).color(graph).rounds
        };
        let (index, hash) = (rounds(ConflictRule::HighestIndex), rounds(ConflictRule::HighestHash));
        assert!(index > times * hash && hash <= 15, "index {index}, hash {hash}");
    }
    // Equal hashes would both win: under one key there are none.
    for key in [0, pcg::key(3, 14), u32::MAX] {
        let hashes: BTreeSet<u32> = (0..100_000).map(|v| pcg::hash(v, key)).collect();
        assert_eq!(hashes.len(), 100_000);
    }
}

#[test]
fn trap_10_a_hubs_palette() {
    // A hub of degree 50,001 at s = 2 draws from 25,001 colors, and every sweep over the colors pays for the number it drew.
    let graph = shared("hubs-100k");
    let literal = Literal::SOUND.run(graph, LIMIT);
    assert!(literal.colors.iter().max().is_some_and(|&highest| highest > 1000));
    for seed in 0..5 {
        let algorithm = Algorithm::Vivace(Vivace { seed, ..Vivace::DEFAULT });
        let outcome = algorithm.color(graph);
        let certificate = Certificate::check(graph, outcome.coloring.colors()).unwrap();
        assert!(certificate.n_ids <= 10, "{} colors", certificate.n_ids);
        assert_eq!(certificate.n_ids, certificate.n_colors);
        assert!(outcome.rounds <= 10, "{} rounds", outcome.rounds);
        // Nor are there large numbers before unused ones are closed up.
        let raw = in_rounds(&Cpu::new(), algorithm, graph).unwrap();
        assert!(raw.colors.iter().all(|&c| c < 16));
    }
}

#[test]
fn trap_11_holes_and_crumbs() {
    // Random draws leave numbers that nobody has and classes of a few vertices: a launch each.
    let graph = with_hubs(shared("tets-10k"), &[5000, 1000], 1);
    let literal = Literal { shrink: 2.5, ..Literal::SOUND }.run(&graph, LIMIT);
    let n_ids = literal.colors.iter().max().unwrap() + 1;
    let n_used = literal.colors.iter().collect::<BTreeSet<_>>().len();
    assert!(n_used < n_ids as usize, "{n_used} of {n_ids}");
    let n_crumbs = |sizes: Vec<u32>| sizes.into_iter().filter(|&size| size <= 30).count();
    let (mut before, mut after) = (0, 0);
    for seed in 0..5 {
        let algorithm = Algorithm::Vivace(Vivace { seed, ..Vivace::DEFAULT });
        let coloring = algorithm.color(&graph).coloring;
        assert!(coloring.class_sizes().iter().all(|&size| size > 0));
        for mesh in [shared("tets-100k"), shared("irregular-hinge-cloth-100k")] {
            let coloring = algorithm.color(mesh).coloring;
            let sizes = coloring.class_sizes();
            let dissolved = dissolve_small_classes(mesh, coloring, 30);
            assert!(oracle::is_coloring(mesh, dissolved.colors()));
            before += n_crumbs(sizes);
            after += n_crumbs(dissolved.class_sizes());
        }
    }
    assert!(before > 5 && after == 0, "{before} -> {after} small classes");
}

#[test]
fn trap_12_classes_are_not_of_similar_size() {
    // "Partitions of similar size": the largest is half as large again as the mean; a pass makes them equal.
    for graph in graphs() {
        let raw = Algorithm::Vivace(Vivace::DEFAULT).color(graph).coloring;
        assert!(raw.balance() > 1.3, "{}", raw.balance());
        assert!(balance(graph, raw).coloring.balance() < 1.01);
    }
}

#[test]
fn trap_13_the_wrong_graph() {
    // A coloring of the mesh's edges lets the ends of a hinge collide: every constraint is a clique of its vertices.
    let (mesh, hinges) = (regular_cloth(30, 30), regular_hinge_cloth(30, 30));
    for algorithm in Algorithm::ALL {
        let coloring = algorithm.color(&mesh).coloring;
        assert!(Certificate::check(&hinges, coloring.colors()).is_err(), "{algorithm}");
    }
    // Repeats would inflate degrees, a self loop would clash with itself, one-directional rows would not see each other.
    let messy = ConstraintGraph::from_csr(vec![0, 4, 4, 7], vec![2, 1, 0, 1, 2, 1, 1]).unwrap();
    assert_eq!(messy, clique(3));
    let repeated: Vec<[u32; 2]> = mesh.edges().flat_map(|[u, v]| [[u, v], [v, u], [v, v]]).collect();
    assert_eq!(ConstraintGraph::from_edges(900, &repeated).unwrap(), mesh);
    let error = ConstraintGraph::from_constraints(4, &[[0, 1, 2, 3], [1, 2, 3, 4]]).unwrap_err();
    assert!(matches!(error, GraphError::ConstraintOutOfRange { constraint: 1, vertex: 4, .. }));
    let error = ConstraintGraph::from_csr(vec![0, 1, 1], vec![2]).unwrap_err();
    assert!(matches!(error, GraphError::NeighborOutOfRange { row: 0, vertex: 2, .. }));
}

#[test]
fn trap_14_threads_show() {
    // A generator carried from vertex to vertex, one for each thread: another number of threads, another coloring.
    let graph = shared("tets-10k");
    let by_streams = |n_threads: usize| {
        let n = graph.n_vertices();
        let streams = (0..n_threads as u64).flat_map(|thread| {
            let mut random = Random::new(thread);
            (0..n.div_ceil(n_threads)).map(move |_| random.below(u32::MAX)).collect::<Vec<_>>()
        });
        let weights: Vec<u32> = streams.take(n).collect();
        let mut order: Vec<u32> = (0..10_000).collect();
        order.sort_by_key(|&v| (weights[v as usize], v));
        oracle::first_fit(graph, order)
    };
    assert_ne!(by_streams(1), by_streams(2));
    for algorithm in Algorithm::ALL {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| algorithm.color(graph))
        };
        let expected = on(1);
        assert_eq!(on(2), expected, "{algorithm}");
        assert_eq!(on(5), expected, "{algorithm}");
    }
}

#[test]
fn trap_15_nothing_to_color_and_no_end() {
    // The smallest degree of no vertices; loops that must not start; rounds without a bound.
    for algorithm in Algorithm::ALL {
        let nothing = algorithm.color(&empty());
        assert_eq!((nothing.rounds, nothing.visits, nothing.coloring.n_colors()), (0, 0, 0), "{algorithm}");
        assert_eq!(nothing.coloring.partitions().n_colors(), 0);
        for graph in [isolated(1), isolated(3000)] {
            let alone = algorithm.color(&graph);
            assert_eq!((alone.rounds, alone.coloring.n_colors()), (1, 1), "{algorithm}");
        }
        let long = algorithm.color(&clique(300));
        assert!(long.rounds <= ROUND_LIMIT && long.coloring.n_colors() == 300, "{algorithm}");
        assert_eq!(algorithm.color(&star(70_000)).coloring.n_colors(), 2, "{algorithm}");
    }
}
