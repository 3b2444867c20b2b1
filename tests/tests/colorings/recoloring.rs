//! Coloring again after edges come and go.

use proptest::collection::vec;
use proptest::prelude::*;
use vivace_coloring::{Certificate, Coloring, Recolored, color, recolor};
use vivace_graph::{ConstraintGraph, DynamicGraph};
use vivace_tests::generators::{clique, isolated, path};
use vivace_tests::oracle;
use vivace_tests::random::Random;
use vivace_tests::workloads::shared;

use crate::arbitrary::any_graph;

/// What comes and what goes in one step: any numbers, to be mapped to vertices and to edges that are there.
#[derive(Debug, Clone)]
struct Step {
    come: Vec<[prop::sample::Index; 2]>,
    go: Vec<prop::sample::Index>,
}

fn any_step() -> impl Strategy<Value = Step> {
    let index = any::<prop::sample::Index>;
    (vec([index(), index()], 0..12), vec(index(), 0..6)).prop_map(|(come, go)| Step { come, go })
}

impl Step {
    /// (removed, inserted) edges of a graph as it is now.
    fn edits(&self, graph: &DynamicGraph) -> (Vec<[u32; 2]>, Vec<[u32; 2]>) {
        let n = graph.n_vertices();
        let present: Vec<[u32; 2]> = graph.to_graph().edges().collect();
        let go = if present.is_empty() { &[][..] } else { &self.go };
        let removed = go.iter().map(|at| present[at.index(present.len())]).collect();
        let vertex = |at: &prop::sample::Index| u32::try_from(at.index(n)).expect("small");
        let pairs = self.come.iter().map(|[u, v]| [vertex(u), vertex(v)]);
        (removed, pairs.filter(|[u, v]| u != v).collect())
    }
}

/// Recolors and checks all that is promised of one step.
fn step(graph: &DynamicGraph, coloring: &mut Coloring, inserted: &[[u32; 2]]) -> Recolored {
    let before = coloring.clone();
    let recolored = recolor(graph, coloring, inserted);
    assert!(oracle::is_coloring(graph, coloring.colors()));
    assert!(coloring.colors().iter().all(|&c| c < coloring.n_colors()));

    let mut changed: Vec<u32> = (0..)
        .zip(coloring.colors().iter().zip(before.colors()))
        .filter(|(_, (now, then))| now != then)
        .map(|(v, _)| v)
        .collect();
    let mut told = recolored.vertices.clone();
    told.sort_unstable();
    told.dedup();
    changed.sort_unstable();
    // What is told is what changed, or changed twice and came back.
    assert!(changed.iter().all(|v| told.binary_search(v).is_ok()), "{changed:?}, told {told:?}");

    // Only ends of inserted edges that had become improper.
    let improper: Vec<[u32; 2]> = inserted
        .iter()
        .copied()
        .filter(|[u, v]| before.colors()[*u as usize] == before.colors()[*v as usize])
        .collect();
    assert!(told.iter().all(|v| improper.iter().any(|edge| edge.contains(v))));
    assert!(told.len() <= improper.len());
    if improper.is_empty() {
        assert_eq!((&*coloring, recolored.vertices.len()), (&before, 0));
    }
    // First fit: the new color is at most the degree.
    assert!(told.iter().all(|&v| coloring.colors()[v as usize] <= graph.degree(v)));
    recolored
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn any_sequence_of_edits_leaves_a_coloring(graph in any_graph(), steps in vec(any_step(), 1..8)) {
        prop_assume!(graph.n_vertices() > 1);
        let mut dynamic = DynamicGraph::from(&graph);
        let mut coloring = color(&graph);
        for edit in &steps {
            let (removed, inserted) = edit.edits(&dynamic);
            dynamic.apply(&removed, &inserted).unwrap();
            step(&dynamic, &mut coloring, &inserted);
        }
        prop_assert!(Certificate::check(&dynamic.to_graph(), coloring.colors()).is_ok());
        // The same edits give the same colors.
        let mut again = (DynamicGraph::from(&graph), color(&graph));
        for edit in &steps {
            let (removed, inserted) = edit.edits(&again.0);
            again.0.apply(&removed, &inserted).unwrap();
            recolor(&again.0, &mut again.1, &inserted);
        }
        prop_assert_eq!(again.1, coloring);
    }
}

#[test]
fn nothing_improper_nothing_done() {
    let mut graph = DynamicGraph::from(&path(4));
    let mut coloring = color(&path(4));
    assert_eq!(coloring.colors(), [0, 1, 0, 1]);
    graph.apply(&[[1, 2]], &[[0, 3]]).unwrap();
    assert!(step(&graph, &mut coloring, &[[0, 3]]).vertices.is_empty());
    assert!(step(&graph, &mut coloring, &[]).vertices.is_empty());
    // 1 and 3 are alike: one of them gives way.
    graph.apply(&[], &[[1, 3]]).unwrap();
    assert_eq!(step(&graph, &mut coloring, &[[1, 3]]).vertices.len(), 1);
}

#[test]
fn a_clique_grown_edge_by_edge() {
    let n = 40;
    let mut graph = DynamicGraph::new(n as usize).unwrap();
    let mut coloring = color(&isolated(n));
    for v in 0..n {
        for u in 0..v {
            graph.insert(u, v).unwrap();
            step(&graph, &mut coloring, &[[u, v]]);
        }
    }
    let mut colors = coloring.into_colors();
    colors.sort_unstable();
    assert_eq!(colors, (0..n).collect::<Vec<_>>());
    // And all at once.
    let all: Vec<[u32; 2]> = clique(n).edges().collect();
    let mut coloring = color(&isolated(n));
    step(&graph, &mut coloring, &all);
}

/// A hundred frames of contacts on a mesh; each in proportion to its contacts, at few colors more.
#[test]
fn frames_of_contacts() {
    let mesh: &ConstraintGraph = shared("irregular-hinge-cloth-10k");
    let n = 10_000;
    let mut random = Random::new(5);
    let mut graph = DynamicGraph::from(mesh);
    let mut coloring = color(mesh);
    let n_colors = coloring.n_colors();
    let mut contacts: Vec<[u32; 2]> = Vec::new();
    for _ in 0..100 {
        let come: Vec<[u32; 2]> =
            (0..1000).map(|_| [random.below(n), random.below(n)]).filter(|[u, v]| u != v).collect();
        assert_eq!(graph.apply(&contacts, &come), Ok(contacts.len()));
        let recolored = recolor(&graph, &mut coloring, &come);
        assert!(recolored.vertices.len() < come.len() / 3, "{}", recolored.vertices.len());
        assert!(oracle::is_coloring(&graph, coloring.colors()));
        contacts = come;
    }
    assert!(coloring.n_colors() <= n_colors + 4, "{n_colors} -> {}", coloring.n_colors());
    println!("{n_colors} -> {} colors", coloring.n_colors());
}

/// Many inserted edges are looked at in parallel: the same answer on any number of threads.
#[test]
fn threads_do_not_show() {
    let mesh = shared("tets-10k");
    let mut random = Random::new(6);
    let come: Vec<[u32; 2]> =
        (0..20_000).map(|_| [random.below(10_000), random.below(10_000)]).filter(|[u, v]| u != v).collect();
    let mut graph = DynamicGraph::from(mesh);
    graph.apply(&[], &come).unwrap();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut coloring = color(mesh);
        let recolored = pool.install(|| recolor(&graph, &mut coloring, &come));
        (coloring, recolored)
    };
    let expected = on(1);
    assert!(oracle::is_coloring(&graph, expected.0.colors()));
    assert_eq!(on(2), expected);
    assert_eq!(on(7), expected);
}
