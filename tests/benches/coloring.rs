//! Colorings, passes and recoloring, beside what other crates offer.
//!
//! `cargo bench -p vivace-tests` runs everything in some minutes; `-- 'colors/tets-100k'` narrows it down. Rivals color in one
//! thread whatever the pool, and are left out of a million vertices, where they take minutes. Each row names what it needs in
//! colors once, before it is timed: speed alone says little.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BatchSize, BenchmarkGroup, Criterion, criterion_group, criterion_main};
use petgraph::graph::UnGraph;
use rustworkx_core::coloring::{
    ColoringStrategy, greedy_node_color, greedy_node_color_with_coloring_strategy,
};
use vivace_coloring::{
    Algorithm, Certificate, Vivace, balance, color, dissolve_small_classes, recolor, reduce,
};
use vivace_graph::{ConstraintGraph, DynamicGraph};
use vivace_tests::random::Random;
use vivace_tests::workloads::Workload;

/// Largest graph that the rivals are asked to color.
const RIVALS_UP_TO: usize = 101_000;

/// The families that are timed at each size, and the hard cases.
const TIMED: [&str; 13] = [
    "cloth-10k",
    "hinge-cloth-10k",
    "tets-10k",
    "cloth-100k",
    "hinge-cloth-100k",
    "irregular-hinge-cloth-100k",
    "tets-100k",
    "tets-contacts-100k",
    "hubs-100k",
    "cloth-1m",
    "hinge-cloth-1m",
    "cloth-shuffled-1m",
    "tets-1m",
];

/// Whether benches are to run (`cargo test --all-targets` starts this, too), and those of this workload: a large graph is not
/// made in vain when plain names such as `colors/tets-10k` are asked for.
fn is_asked_for(group: &str, workload: &str) -> bool {
    let is_plain =
        |name: &String| name.contains('/') && name.chars().all(|c| c.is_alphanumeric() || " :-/".contains(c));
    let plain_names: Vec<String> = std::env::args().skip(1).filter(is_plain).collect();
    let id = format!("{group}/{workload}");
    let is_named = |name: &String| id.contains(name.as_str()) || name.contains(&id);
    std::env::args().any(|arg| arg == "--bench")
        && (plain_names.is_empty() || plain_names.iter().any(is_named))
}

fn timed(group: &str) -> Vec<Workload> {
    let workloads = TIMED.iter().filter_map(|name| Workload::named(name));
    workloads.filter(|workload| is_asked_for(group, workload.name)).copied().collect()
}

/// A group with as few and short samples as a graph of this size allows.
fn group<'a>(criterion: &'a mut Criterion, name: &str, workload: &Workload) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(format!("{name}/{}", workload.name));
    let seconds = if workload.n_vertices > RIVALS_UP_TO { 2.0 } else { 1.0 };
    group.sample_size(10).warm_up_time(Duration::from_millis(200));
    group.measurement_time(Duration::from_secs_f64(seconds));
    group
}

fn colors(criterion: &mut Criterion) {
    for workload in timed("colors") {
        let graph = workload.shared();
        let mut group = group(criterion, "colors", &workload);
        for algorithm in Algorithm::ALL {
            let coloring = algorithm.color(graph).coloring;
            tell(workload, algorithm.name(), coloring.n_colors(), coloring.balance());
            group.bench_function(algorithm.name(), |bench| {
                bench.iter(|| algorithm.color(black_box(graph)));
            });
        }
        if workload.n_vertices <= RIVALS_UP_TO {
            rivals(&mut group, workload, graph);
        }
        group.finish();
    }
}

fn tell(workload: Workload, name: &str, n_colors: u32, balance: f64) {
    println!("{:28} {name:24} {n_colors:3} colors, largest over mean class {balance:.2}", workload.name);
}

/// Degree-greedy and saturation of `rustworkx-core`, DSATUR of `petgraph`, on `petgraph`'s own graph.
fn rivals(group: &mut BenchmarkGroup<'_, WallTime>, workload: Workload, graph: &ConstraintGraph) {
    let mut rival: UnGraph<(), ()> = UnGraph::with_capacity(graph.n_vertices(), graph.n_edges());
    for _ in 0..graph.n_vertices() {
        rival.add_node(());
    }
    rival.extend_with_edges(graph.edges().map(|[u, v]| (u, v)));
    let saturation = |graph: &UnGraph<(), ()>| {
        let none = |_| Ok::<_, std::convert::Infallible>(None);
        greedy_node_color_with_coloring_strategy(graph, none, ColoringStrategy::Saturation)
    };
    let count = |colors: Vec<usize>| {
        let mut sizes = vec![0_u32; colors.iter().max().map_or(0, |&c| c + 1)];
        colors.iter().for_each(|&c| sizes[c] += 1);
        let n_colors = u32::try_from(sizes.len()).expect("few");
        let largest = sizes.iter().max().copied().unwrap_or(0);
        (n_colors, f64::from(largest) * f64::from(n_colors) / colors.len() as f64)
    };
    let greedy_colors = count(greedy_node_color(&rival).into_values().collect());
    tell(workload, "rustworkx-core greedy", greedy_colors.0, greedy_colors.1);
    group.bench_function("rival: rustworkx-core greedy", |bench| {
        bench.iter(|| greedy_node_color(black_box(&rival)));
    });
    let saturated =
        count(saturation(&rival).map_or_else(|never| match never {}, |c| c.into_values().collect()));
    tell(workload, "rustworkx-core dsatur", saturated.0, saturated.1);
    group.bench_function("rival: rustworkx-core dsatur", |bench| {
        bench.iter(|| saturation(black_box(&rival)));
    });
    let dsatur = |graph| petgraph::algo::coloring::dsatur_coloring(graph);
    let dsatur_colors = count(dsatur(&rival).0.into_values().collect());
    tell(workload, "petgraph dsatur", dsatur_colors.0, dsatur_colors.1);
    group.bench_function("rival: petgraph dsatur", |bench| {
        bench.iter(|| dsatur(black_box(&rival)));
    });
}

fn passes(criterion: &mut Criterion) {
    for workload in timed("passes") {
        let graph = workload.shared();
        let mut group = group(criterion, "passes", &workload);
        let first = color(graph);
        group.bench_function("balance", |bench| {
            bench.iter_batched(|| first.clone(), |start| balance(graph, start), BatchSize::LargeInput);
        });
        group.bench_function("reduce", |bench| {
            bench.iter_batched(|| first.clone(), |start| reduce(graph, start), BatchSize::LargeInput);
        });
        group.bench_function("color, reduce and balance", |bench| {
            bench.iter(|| balance(graph, reduce(graph, color(graph))));
        });
        let drawn = Algorithm::Vivace(Vivace::DEFAULT).color(graph).coloring;
        group.bench_function("dissolve small classes", |bench| {
            let dissolve = |start| dissolve_small_classes(graph, start, 100);
            bench.iter_batched(|| drawn.clone(), dissolve, BatchSize::LargeInput);
        });
        group.bench_function("certificate", |bench| {
            bench.iter(|| Certificate::check(graph, black_box(first.colors())));
        });
        let reduced = reduce(graph, first.clone());
        tell(workload, "reduced", reduced.n_colors(), reduced.balance());
        let balanced = balance(graph, reduced).coloring;
        tell(workload, "reduced and balanced", balanced.n_colors(), balanced.balance());
        group.finish();
    }
}

/// A frame of contacts, one for a hundred vertices: the edits, then coloring again only what they made improper.
fn recoloring(criterion: &mut Criterion) {
    for workload in timed("recoloring") {
        let graph = workload.shared();
        let n = u32::try_from(graph.n_vertices()).expect("32 bits");
        let mut random = Random::new(1);
        let mut contacts = || -> Vec<[u32; 2]> {
            let pairs = (0..n / 100).map(|_| [random.below(n), random.below(n)]);
            pairs.filter(|[u, v]| u != v).collect()
        };
        let frames = [contacts(), contacts()];
        let mut group = group(criterion, "recoloring", &workload);
        let (mut dynamic, mut coloring) = (DynamicGraph::from(graph), color(graph));
        dynamic.apply(&[], &frames[1]).expect("below n");
        recolor(&dynamic, &mut coloring, &frames[1]);
        let mut frame = 0;
        group.bench_function("a frame of contacts", |bench| {
            bench.iter(|| {
                dynamic.apply(&frames[1 - frame], &frames[frame]).expect("below n");
                let recolored = recolor(&dynamic, &mut coloring, &frames[frame]);
                frame = 1 - frame;
                recolored
            });
        });
        group.bench_function("all from scratch", |bench| {
            bench.iter(|| color(&graph.with_edges(&frames[0]).expect("below n")));
        });
        group.finish();
    }
}

criterion_group!(benches, colors, passes, recoloring);
criterion_main!(benches);
