//! The workloads are the graphs they say they are.

use vivace_graph::{ConstraintGraph, smallest_last};
use vivace_tests::generators::{
    clique, complete_bipartite, empty, isolated, path, random, regular_cloth, regular_hinge_cloth, shuffled,
    star, tets, wheel, with_contacts,
};
use vivace_tests::workloads::{HUB_DEGREES, Workload, shared};

fn shape(graph: &ConstraintGraph) -> (usize, usize, u32, u32) {
    (graph.n_vertices(), graph.n_edges(), graph.min_degree(), graph.max_degree())
}

#[test]
fn names_and_sizes() {
    for (i, workload) in Workload::ALL.iter().enumerate() {
        assert!(Workload::ALL[..i].iter().all(|other| other.name != workload.name), "{}", workload.name);
        assert_eq!(Workload::named(workload.name).unwrap().n_vertices, workload.n_vertices);
    }
    assert!(Workload::named("no such thing").is_none());
    for workload in Workload::up_to(101_000) {
        assert_eq!(workload.shared().n_vertices(), workload.n_vertices, "{}", workload.name);
    }
}

#[test]
fn regular_cloths_have_known_shapes() {
    assert_eq!(shape(shared("cloth-10k")), (10_000, 29_601, 2, 6));
    assert_eq!(shape(shared("hinge-cloth-10k")), (10_000, 58_806, 3, 12));
    assert_eq!(shape(shared("cloth-100k")), (100_000, 298_701, 2, 6));
    assert_eq!(shape(shared("hinge-cloth-100k")), (100_000, 596_106, 3, 12));
    // 0 1 2
    // 3 4 5, cut from 0 to 4 and from 1 to 5; 2 is opposite 4 across the edge 1-5.
    assert_eq!(regular_cloth(3, 2).neighbors(1), [0, 2, 4, 5]);
    assert_eq!(regular_hinge_cloth(3, 2).neighbors(1), [0, 2, 3, 4, 5]);
    assert_eq!(regular_hinge_cloth(3, 2).neighbors(2), [1, 4, 5]);
}

#[test]
fn irregular_ones_have_the_statistics_of_their_kind() {
    // A triangulated rectangle has as many edges, however it is cut.
    let (_, edges, min, max) = shape(shared("irregular-cloth-100k"));
    assert_eq!(edges, 298_701);
    assert!(min >= 2 && (10..=12).contains(&max), "{min} {max}");
    let graph = shared("irregular-hinge-cloth-100k");
    assert!((11.7..11.8).contains(&graph.mean_degree()) && (19..=22).contains(&graph.max_degree()));
    assert_eq!(smallest_last(graph).degeneracy + 1, 8);
    // Random points: 15.5 neighbors far from the hull.
    let graph = shared("tets-100k");
    assert!((15.35..15.45).contains(&graph.mean_degree()), "{}", graph.mean_degree());
    assert!((32..=38).contains(&graph.max_degree()) && graph.min_degree() >= 4);
    assert_eq!(smallest_last(graph).degeneracy + 1, 11);
    assert_eq!(graph.components().0, 1);
}

/// Morton order: most neighbors are near in number, too.
#[test]
fn tets_are_numbered_in_space() {
    let near = |graph: &ConstraintGraph| graph.edges().filter(|[u, v]| v - u < 100).count();
    let graph = tets(5000, 3);
    assert!(near(&graph) * 2 > graph.n_edges());
    assert!(near(&shuffled(&graph, 1)) * 10 < graph.n_edges());
    assert_eq!(shuffled(&graph, 1).n_edges(), graph.n_edges());
}

#[test]
fn contacts_and_hubs_are_added() {
    let (plain, with) = (shared("tets-100k"), shared("tets-contacts-100k"));
    let added = (with.n_edges() - plain.n_edges()) as f64 / plain.n_edges() as f64;
    assert!((0.0995..=0.1).contains(&added), "{added}");
    assert!(plain.edges().all(|[u, v]| with.neighbors(u).binary_search(&v).is_ok()));
    assert_eq!(with_contacts(&empty(), 0.1, 1), empty());
    let hubs = shared("hubs-100k");
    let n = 100_000;
    for (k, &degree) in (0..).zip(&HUB_DEGREES) {
        let joined = u32::from(k > 0) + u32::from(k < 7);
        assert_eq!(hubs.degree(n + k), degree + joined);
    }
    assert!(hubs.neighbors(n + 3).contains(&(n + 4)) && !hubs.neighbors(n + 3).contains(&(n + 5)));
}

#[test]
fn small_families() {
    assert_eq!(shape(&empty()), (0, 0, 0, 0));
    assert_eq!(shape(&isolated(3)), (3, 0, 0, 0));
    assert_eq!(shape(&path(4)), (4, 3, 1, 2));
    assert_eq!(shape(&star(5)), (6, 5, 1, 5));
    assert_eq!(shape(&wheel(5)), (6, 10, 3, 5));
    assert_eq!(shape(&clique(6)), (6, 15, 5, 5));
    assert_eq!(shape(&complete_bipartite(2, 3)), (5, 6, 2, 3));
    assert_eq!(path(0), empty());
    assert_eq!(random(0, 5, 1), empty());
    assert_eq!(random(50, 100, 1), random(50, 100, 1));
    assert_ne!(random(50, 100, 1), random(50, 100, 2));
}
