//! The certificate, seen to fail: colorings broken on purpose.

use proptest::collection::vec;
use proptest::prelude::*;
use vivace_coloring::{Certificate, Coloring, Violation, color};
use vivace_graph::{Adjacency, ConstraintGraph, DynamicGraph};
use vivace_kernels::coloring::UNCOLORED;
use vivace_tests::generators::{clique, path, tets};
use vivace_tests::oracle;
use vivace_tests::workloads::shared;

use crate::arbitrary::any_graph;

/// What is wrong, found by looking at one vertex after another.
fn first_violation(graph: &impl Adjacency, colors: &[u32]) -> Option<Violation> {
    let n_vertices = graph.n_vertices();
    if colors.len() != n_vertices {
        return Some(Violation::Length { n_colors: colors.len(), n_vertices });
    }
    for (vertex, &color) in (0..).zip(colors) {
        if color as usize >= n_vertices {
            return Some(Violation::Uncolored { vertex, color });
        }
        for &u in graph.neighbors(vertex) {
            if colors[u as usize] == color {
                return Some(Violation::Conflict { edge: [u.min(vertex), u.max(vertex)], color });
            }
        }
    }
    None
}

#[test]
fn a_neighbors_color_is_a_conflict() {
    let graph = shared("tets-10k");
    let colors = color(graph).into_colors();
    for [u, v] in graph.edges().step_by(997) {
        let mut broken = colors.clone();
        broken[v as usize] = colors[u as usize];
        let Err(Violation::Conflict { edge, color }) = Certificate::check(graph, &broken) else {
            panic!("{u} and {v} have one color, and nobody noticed");
        };
        assert!(edge.contains(&v) && color == colors[u as usize] && edge[0] <= u);
        let message = Coloring::new(graph, broken).unwrap_err().to_string();
        assert!(message.contains(&edge[0].to_string()) && message.contains("recolor"), "{message}");
    }
}

#[test]
fn what_is_no_color_is_named() {
    let graph = path(5);
    let colors = [0, 1, 0, 1, 0];
    for wrong in [UNCOLORED, 5, 1 << 31] {
        for vertex in 0..5 {
            let mut broken = colors;
            broken[vertex as usize] = wrong;
            let expected = Violation::Uncolored { vertex, color: wrong };
            assert_eq!(Certificate::check(&graph, &broken), Err(expected));
        }
    }
    for n_colors in [0, 4, 6] {
        let expected = Violation::Length { n_colors, n_vertices: 5 };
        assert_eq!(Certificate::check(&graph, &vec![0; n_colors]), Err(expected));
    }
    // The highest color allowed is n - 1.
    assert!(Certificate::check(&graph, &[0, 1, 4, 1, 0]).is_ok());
    assert_eq!(Certificate::check(&path(0), &[0]), Err(Violation::Length { n_colors: 1, n_vertices: 0 }));
    assert_eq!(Certificate::check(&path(0), &[]).unwrap().n_ids, 0);
}

#[test]
fn the_lowest_vertex_is_reported() {
    let colors = [0, 1, 2, 2, UNCOLORED];
    assert_eq!(Certificate::check(&clique(5), &colors), Err(Violation::Conflict { edge: [2, 3], color: 2 }));
    let colors = [0, UNCOLORED, 2, 2, 4];
    assert_eq!(
        Certificate::check(&clique(5), &colors),
        Err(Violation::Uncolored { vertex: 1, color: UNCOLORED })
    );
}

#[test]
fn what_is_certified_is_counted() {
    // 0-1-2-3-4 with colors 0 and 3: two numbers are left out, and 3 is more than a degree.
    let certificate = Certificate::check(&path(5), &[3, 0, 3, 0, 3]).unwrap();
    assert_eq!((certificate.n_vertices, certificate.n_edges, certificate.max_degree), (5, 4, 2));
    assert_eq!((certificate.n_colors, certificate.n_ids), (2, 4));
    assert_eq!(certificate.class_sizes, [2, 0, 0, 3]);
    assert!(!certificate.within_degree);
    let coloring = Coloring::new(&path(5), vec![3, 0, 3, 0, 3]).unwrap();
    assert_eq!((coloring.colors(), coloring.n_colors()), (&[1, 0, 1, 0, 1][..], 2));
    assert!((coloring.balance() - 1.2).abs() < 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// Some entries of a good coloring are overwritten: the verdict is the naive one, and names the same place.
    #[test]
    fn broken_entries_are_found(
        graph in any_graph(),
        mutations in vec((any::<prop::sample::Index>(), prop_oneof![0..8_u32, 0..200_u32, any::<u32>()]), 0..4),
    ) {
        let mut colors = color(&graph).into_colors();
        for (at, wrong) in mutations {
            if !colors.is_empty() {
                let at = at.index(colors.len());
                colors[at] = wrong;
            }
        }
        let verdict = Certificate::check(&graph, &colors);
        prop_assert_eq!(verdict.clone().err(), first_violation(&graph, &colors));
        prop_assert_eq!(verdict.is_ok(), oracle::is_coloring(&graph, &colors));
        prop_assert_eq!(verdict.is_ok(), Coloring::new(&graph, colors.clone()).is_ok());
        // A graph under change has unordered rows, with repeats: the same verdict.
        let mut dynamic = DynamicGraph::from(&graph);
        for [u, v] in graph.edges().step_by(3) {
            dynamic.insert(v, u).unwrap();
        }
        prop_assert_eq!(Certificate::check(&dynamic, &colors).is_ok(), verdict.is_ok());
    }

    /// Any numbers at all, on a graph small enough for some of them to be colorings.
    #[test]
    fn any_numbers_get_the_naive_verdict(colors in vec(0..4_u32, 0..7), pairs in vec([0..5_u32, 0..5_u32], 0..6)) {
        let graph = ConstraintGraph::from_edges(5, &pairs).unwrap();
        let verdict = Certificate::check(&graph, &colors);
        prop_assert_eq!(verdict.clone().err(), first_violation(&graph, &colors));
        prop_assert_eq!(verdict.is_ok(), oracle::is_coloring(&graph, &colors));
    }
}

/// The checker the tests lean on is wrong in no direction either.
#[test]
fn the_naive_checker_fails_too() {
    let graph = tets(50, 1);
    let colors = color(&graph).into_colors();
    assert!(oracle::is_coloring(&graph, &colors));
    for [u, v] in graph.edges() {
        let mut broken = colors.clone();
        broken[u as usize] = colors[v as usize];
        assert!(!oracle::is_coloring(&graph, &broken));
    }
    assert!(!oracle::is_coloring(&graph, &colors[1..]));
    assert!(!oracle::is_coloring(&graph, &[UNCOLORED; 50]));
    assert!(!oracle::is_first_fit_in_some_order(&path(3), &[0, 1, 2]));
    assert!(oracle::is_first_fit_in_some_order(&path(3), &[0, 1, 0]));
}
