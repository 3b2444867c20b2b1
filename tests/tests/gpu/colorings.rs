//! Every coloring that runs in rounds: the same bits on the GPU as on the CPU.

use vivace_coloring::{Algorithm, ColorOnError, ConflictRule, GraphBuffers, Vivace, vivace_unseen};
use vivace_cpu::Cpu;
use vivace_graph::ConstraintGraph;
use vivace_kernels::Backend;
use vivace_tests::generators::{
    clique, complete_bipartite, empty, irregular_cloth, irregular_hinge_cloth, isolated, path, random,
    regular_cloth, regular_hinge_cloth, star, tets, wheel, with_contacts,
};
use vivace_tests::naive::in_rounds;
use vivace_tests::workloads::shared;

use crate::gpu;

/// A graph of every family in turn, each larger than the one before.
fn graph(k: u32) -> ConstraintGraph {
    let (n, seed) = (k * 11, u64::from(k));
    let side = 2 + k as usize / 4;
    match k % 13 {
        0 => random(n, 3 * n as usize, seed),
        1 => isolated(n),
        2 => path(n),
        3 => star(n),
        4 => wheel(n + 3),
        5 => clique(k),
        6 => complete_bipartite(k, n),
        7 => regular_cloth(side, side + 1),
        8 => regular_hinge_cloth(side, side + 1),
        9 => irregular_cloth(side, side, seed),
        10 => irregular_hinge_cloth(side, side, seed),
        11 => tets(n as usize + 5, seed),
        _ => with_contacts(&tets(n as usize + 5, seed), 0.3, seed),
    }
}

fn in_rounds_only() -> impl Iterator<Item = Algorithm> {
    Algorithm::ALL.into_iter().filter(Algorithm::is_seeded)
}

#[test]
fn a_hundred_graphs_get_the_colors_of_the_cpu() {
    let gpu = gpu();
    for k in 0..100 {
        let graph = graph(k);
        for algorithm in in_rounds_only().map(|algorithm| algorithm.with_seed(u64::from(k))) {
            let expected = in_rounds(&Cpu::new(), algorithm, &graph);
            assert_eq!(in_rounds(&gpu, algorithm, &graph), expected, "graph {k}, {algorithm}");
        }
    }
}

#[test]
fn meshes_get_the_colors_of_the_cpu() {
    let gpu = gpu();
    for name in ["hinge-cloth-10k", "tets-10k"] {
        for algorithm in in_rounds_only() {
            let outcome = algorithm.color_on(&gpu, shared(name)).unwrap();
            assert_eq!(outcome, algorithm.color(shared(name)), "{name}, {algorithm}");
        }
    }
}

/// Cliques run into the bound on rounds, and with no rule for conflicts nearly everybody does.
#[test]
fn stragglers_get_the_colors_of_the_cpu() {
    let gpu = gpu();
    let no_rule = Algorithm::Vivace(Vivace { shrink: f32::INFINITY, seed: 0, conflict: ConflictRule::None });
    for (graph, algorithm) in
        in_rounds_only().map(|algorithm| (clique(300), algorithm)).chain([(random(500, 3000, 9), no_rule)])
    {
        let expected = in_rounds(&Cpu::new(), algorithm, &graph);
        assert_eq!(in_rounds(&gpu, algorithm, &graph), expected, "{algorithm}");
    }
}

#[test]
fn no_vertex_is_no_work() {
    let gpu = gpu();
    for algorithm in in_rounds_only() {
        assert_eq!(algorithm.color_on(&gpu, &empty()).unwrap(), algorithm.color(&empty()));
    }
    assert_eq!(gpu.n_looks(), 0);
}

/// A mesh is colored without a look between its rounds, and a coloring that takes more of them looks a few times.
#[test]
fn the_host_rarely_looks() {
    let mesh = shared("tets-10k");
    for (algorithm, most) in [
        (Algorithm::Vivace(Vivace::DEFAULT), 1),
        (Algorithm::JonesPlassmann { seed: 0 }, 3),
        (Algorithm::LargestDegreeFirst { seed: 0 }, 3),
    ] {
        let gpu = gpu();
        let outcome = algorithm.color_on(&gpu, mesh).unwrap();
        assert!(gpu.n_looks() <= most, "{algorithm}: {} looks, {} rounds", gpu.n_looks(), outcome.rounds);
    }
}

#[test]
fn what_does_not_run_in_rounds_is_refused() {
    let graph = path(5);
    for algorithm in Algorithm::ALL.into_iter().filter(|algorithm| !algorithm.is_seeded()) {
        let error = algorithm.color_on(&Cpu::new(), &graph).unwrap_err();
        assert_eq!(error, ColorOnError::NotInRounds(algorithm));
        assert!(error.to_string().contains("Algorithm::color"), "{error}");
    }
}

/// So many rounds, in which nobody looks, give the colors of those in which the host does: on every backend, whole where they suffice.
#[test]
fn rounds_that_nobody_sees_give_the_same_colors() {
    fn unseen<B: Backend>(backend: &B, graph: &ConstraintGraph, options: &Vivace, n_rounds: u32) -> Vec<u32> {
        let on_backend = GraphBuffers::upload(backend, graph);
        let [mut proposal, mut color] = [(); 2].map(|()| backend.filled(graph.n_vertices(), 7));
        let view = on_backend.view(backend);
        vivace_unseen(backend, view, options, n_rounds, &mut proposal, &mut color);
        backend.read(color).unwrap_or_else(|error| panic!("{error}"))
    }
    let gpu = gpu();
    for k in 0..40 {
        let graph = graph(k);
        let options = Vivace { seed: u64::from(k), ..Vivace::DEFAULT };
        let seen = in_rounds(&Cpu::new(), Algorithm::Vivace(options), &graph).unwrap();
        let n_rounds = seen.count.rounds;
        for more in [0, 3] {
            assert_eq!(unseen(&gpu, &graph, &options, n_rounds + more), seen.colors, "graph {k}");
            assert_eq!(unseen(&Cpu::new(), &graph, &options, n_rounds + more), seen.colors, "graph {k}");
        }
        if n_rounds > 1 {
            let fewer = unseen(&gpu, &graph, &options, n_rounds - 1);
            assert!(fewer.contains(&u32::MAX), "graph {k}");
            assert!(fewer.iter().zip(&seen.colors).all(|(a, b)| a == b || *a == u32::MAX), "graph {k}");
        }
    }
}
