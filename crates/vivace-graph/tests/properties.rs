//! Each structure against the plainest one that could do its work.

#![expect(clippy::unwrap_used, clippy::cast_possible_truncation, reason = "tests on a few thousand vertices")]

use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;
use vivace_graph::{
    Adjacency, ConstraintGraph, Csr, DynamicGraph, GraphBuilder, GraphError, Incidence, matrix_market,
    smallest_last,
};

/// Rows as sets: every constraint a clique.
fn naive_rows<'a>(n: usize, constraints: impl Iterator<Item = &'a [u32]>) -> Vec<BTreeSet<u32>> {
    let mut rows = vec![BTreeSet::new(); n];
    for constraint in constraints {
        for &u in constraint {
            rows[u as usize].extend(constraint.iter().copied().filter(|&v| v != u));
        }
    }
    rows
}

fn assert_rows(graph: &ConstraintGraph, expected: &[BTreeSet<u32>]) {
    assert_eq!(graph.n_vertices(), expected.len());
    for (row, expected) in graph.csr().rows().zip(expected) {
        assert!(row.iter().eq(expected), "{row:?} is not {expected:?}");
    }
}

#[derive(Debug, Clone)]
struct Lists {
    n: usize,
    edges: Vec<[u32; 2]>,
    triangles: Vec<[u32; 3]>,
    tets: Vec<[u32; 4]>,
}

impl Lists {
    fn builder(&self) -> GraphBuilder<'_> {
        GraphBuilder::new(self.n)
            .constraints(&self.edges)
            .constraints(&self.triangles)
            .constraints(&self.tets)
    }

    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let edges = self.edges.iter().map(<[u32; 2]>::as_slice);
        let triangles = self.triangles.iter().map(<[u32; 3]>::as_slice);
        edges.chain(triangles).chain(self.tets.iter().map(<[u32; 4]>::as_slice))
    }
}

/// Constraints over few vertices and many, so that repeats, hubs and isolated vertices all turn up. Half of the indices are drawn
/// from the first few vertices.
fn lists(max_n: u32, max_len: usize) -> impl Strategy<Value = Lists> {
    (1..=max_n).prop_flat_map(move |n| {
        let vertex = move || prop_oneof![0..n, 0..n.min(3)];
        let edges = prop::collection::vec([vertex(), vertex()], 0..max_len);
        let triangles = prop::collection::vec([vertex(), vertex(), vertex()], 0..max_len);
        let tets = prop::collection::vec([vertex(), vertex(), vertex(), vertex()], 0..max_len);
        let n = n as usize;
        (edges, triangles, tets).prop_map(move |(edges, triangles, tets)| Lists { n, edges, triangles, tets })
    })
}

fn small_graph() -> impl Strategy<Value = ConstraintGraph> {
    lists(40, 25).prop_map(|lists| lists.builder().build().unwrap())
}

fn in_pool<T: Send>(n_threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap().install(run)
}

proptest! {
    #[test]
    fn construction_is_that_of_sets(lists in lists(60, 40)) {
        let expected = naive_rows(lists.n, lists.iter());
        let graph = lists.builder().build().unwrap();
        assert_rows(&graph, &expected);

        let mut edges: Vec<[u32; 2]> = graph.edges().collect();
        prop_assert_eq!(edges.len(), graph.n_edges());
        edges.extend_from_within(..edges.len() / 2);
        edges.reverse();
        prop_assert_eq!(&ConstraintGraph::from_edges(lists.n, &edges).unwrap(), &graph);
        let (half, rest) = edges.split_at(edges.len() / 3);
        let grown = ConstraintGraph::from_edges(lists.n, half).unwrap().with_edges(rest).unwrap();
        prop_assert_eq!(&grown, &graph);

        let degrees: Vec<u32> = expected.iter().map(|row| row.len() as u32).collect();
        prop_assert!(graph.degrees().eq(degrees.iter().copied()));
        prop_assert_eq!(graph.max_degree(), *degrees.iter().max().unwrap());
        prop_assert_eq!(graph.min_degree(), *degrees.iter().min().unwrap());
    }

    #[test]
    fn any_rows_become_the_graph_of_their_pairs(rows in prop::collection::vec(prop::collection::vec(0..30u32, 0..12), 30)) {
        let offsets = std::iter::once(0).chain(rows.iter().scan(0, |end, row| {
            *end += row.len() as u32;
            Some(*end)
        }));
        let graph = ConstraintGraph::from_csr(offsets.collect(), rows.concat()).unwrap();
        let pairs: Vec<[u32; 2]> =
            (0..30).zip(&rows).flat_map(|(u, row)| row.iter().map(move |&v| [u, v])).collect();
        assert_rows(&graph, &naive_rows(30, pairs.iter().map(<[u32; 2]>::as_slice)));
    }

    #[test]
    fn bad_arrays_are_refused_not_believed(
        offsets in prop::collection::vec(0..6u32, 0..6), items in prop::collection::vec(0..6u32, 0..6)
    ) {
        let n = offsets.len().saturating_sub(1);
        let delimits = offsets.first() == Some(&0) && offsets.is_sorted() && offsets[n] as usize == items.len();
        let is_good = delimits && items.iter().all(|&v| (v as usize) < n);
        prop_assert_eq!(ConstraintGraph::from_csr(offsets.clone(), items.clone()).is_ok(), is_good);
        prop_assert_eq!(Csr::from_parts(offsets, items).is_ok(), delimits);
    }

    #[test]
    fn incidence_is_that_of_a_search(lists in lists(40, 25)) {
        let incidence = lists.builder().incidence().unwrap();
        for v in 0..lists.n as u32 {
            let expected = (0..).zip(lists.iter()).filter(|(_, constraint)| constraint.contains(&v)).map(|(i, _)| i);
            prop_assert!(incidence.constraints(v).iter().copied().eq(expected));
        }
        let tets = Incidence::from_constraints(lists.n, &lists.tets).unwrap();
        let first_tet = (lists.edges.len() + lists.triangles.len()) as u32;
        for v in 0..lists.n as u32 {
            let expected = incidence.constraints(v).iter().filter_map(|i| i.checked_sub(first_tet));
            prop_assert!(tets.constraints(v).iter().copied().eq(expected));
        }
    }

    #[test]
    fn groups_are_those_of_a_search(n_groups in 0..9usize, keys in prop::collection::vec(0..9u32, 0..60)) {
        let groups = Csr::group_by(n_groups, &keys);
        prop_assert_eq!(groups.n_rows(), n_groups);
        for k in 0..n_groups as u32 {
            let expected = (0..).zip(&keys).filter(|&(_, &key)| key == k).map(|(i, _)| i);
            prop_assert!(groups.row(k).iter().copied().eq(expected));
        }
    }

    #[test]
    fn renumbering_renames(graph in small_graph(), seed in any::<u64>()) {
        let n = graph.n_vertices();
        let mut numbers: Vec<u32> = (0..n as u32).collect();
        numbers.sort_by_key(|&v| (u64::from(v) ^ seed).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let renamed: Vec<[u32; 2]> =
            graph.edges().map(|edge| edge.map(|v| numbers[v as usize])).collect();
        prop_assert_eq!(graph.permuted(&numbers).unwrap(), ConstraintGraph::from_edges(n, &renamed).unwrap());
    }

    #[test]
    fn components_are_closed_and_connected(graph in small_graph()) {
        let (count, component) = graph.components();
        prop_assert!(graph.edges().all(|[u, v]| component[u as usize] == component[v as usize]));
        // A forest has n - edges components: count the edges that join two sets.
        let mut set: Vec<usize> = (0..graph.n_vertices()).collect();
        let mut joined = 0;
        for [u, v] in graph.edges() {
            let (a, b) = (set[u as usize], set[v as usize]);
            if a != b {
                set.iter_mut().filter(|s| **s == a).for_each(|s| *s = b);
                joined += 1;
            }
        }
        prop_assert_eq!(count, graph.n_vertices() - joined);
        let firsts: BTreeSet<u32> = component.iter().copied().collect();
        prop_assert!(firsts.into_iter().eq(0..count as u32));
    }

    #[test]
    fn smallest_last_is_the_naive_peeling(graph in small_graph()) {
        let n = graph.n_vertices();
        let found = smallest_last(&graph);

        // Whichever vertex of smallest degree is taken, the core numbers come out the same.
        let mut left: BTreeSet<u32> = (0..n as u32).collect();
        let (mut core, mut degeneracy) = (vec![0; n], 0);
        let degree_in = |left: &BTreeSet<u32>, v: u32| graph.neighbors(v).iter().filter(|u| left.contains(u)).count() as u32;
        while let Some((degree, v)) = left.iter().map(|&v| (degree_in(&left, v), v)).min() {
            degeneracy = degeneracy.max(degree);
            core[v as usize] = degeneracy;
            left.remove(&v);
        }
        prop_assert_eq!(found.degeneracy, degeneracy);
        prop_assert_eq!(&found.core, &core);

        let mut left: BTreeSet<u32> = (0..n as u32).collect();
        for &v in found.order.iter().rev() {
            let smallest = left.iter().map(|&u| degree_in(&left, u)).min();
            prop_assert_eq!(Some(degree_in(&left, v)), smallest);
            prop_assert!(left.remove(&v));
        }
        prop_assert!(left.is_empty());
    }

    #[test]
    fn dynamic_graph_is_a_multiset(
        start in lists(12, 6),
        edits in prop::collection::vec((any::<bool>(), 0..14u32, 0..14u32), 0..400),
    ) {
        let start = start.builder().build().unwrap();
        let n = start.n_vertices() as u32;
        let mut graph = DynamicGraph::from(&start);
        let mut held: BTreeMap<[u32; 2], usize> = start.edges().map(|edge| (edge, 1)).collect();
        for (is_insertion, u, v) in edits {
            let edge = [u.min(v), u.max(v)];
            if is_insertion {
                let is_legal = u != v && edge[1] < n;
                prop_assert_eq!(graph.insert(u, v).is_ok(), is_legal);
                if is_legal {
                    *held.entry(edge).or_default() += 1;
                }
            } else {
                let count = held.get_mut(&edge).filter(|count| **count > 0);
                prop_assert_eq!(graph.remove(u, v), count.is_some());
                if let Some(count) = count {
                    *count -= 1;
                }
            }
        }
        assert_holds(&graph, &held)?;
    }

    #[test]
    fn apply_is_removals_then_insertions(
        start in prop::collection::vec([0..8u32, 0..8u32], 0..30),
        removed in prop::collection::vec([0..9u32, 0..9u32], 0..30),
        inserted in prop::collection::vec([0..8u32, 0..8u32], 0..30),
    ) {
        let legal = |edges: &[[u32; 2]]| edges.iter().copied().filter(|[u, v]| u != v).collect::<Vec<_>>();
        let mut one = DynamicGraph::new(8).unwrap();
        one.apply(&[], &legal(&start)).unwrap();
        let mut other = one.clone();
        let n_removed = one.apply(&removed, &legal(&inserted)).unwrap();
        prop_assert_eq!(removed.iter().filter(|[u, v]| other.remove(*u, *v)).count(), n_removed);
        for [u, v] in legal(&inserted) {
            other.insert(u, v).unwrap();
        }
        prop_assert!((0..8).all(|v| one.neighbors(v) == other.neighbors(v)));
        prop_assert_eq!(one.to_graph(), other.to_graph());
    }

    #[test]
    fn matrix_market_gives_back_what_was_written(graph in small_graph()) {
        let mut text = Vec::new();
        matrix_market::write(&graph, &mut text).unwrap();
        prop_assert_eq!(matrix_market::parse(&text).unwrap(), graph);
    }

    #[test]
    fn bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = matrix_market::parse(&bytes);
        let with_header = [b"%%MatrixMarket matrix coordinate real general\n".as_slice(), &bytes].concat();
        let _ = matrix_market::parse(&with_header);
    }

    #[test]
    fn a_damaged_file_is_an_error_with_a_line_or_a_graph(
        graph in small_graph(), at in any::<prop::sample::Index>(), byte in prop_oneof![any::<u8>(), Just(b'\n'), b'0'..=b'9'],
        cut in any::<prop::sample::Index>(),
    ) {
        let mut text = Vec::new();
        matrix_market::write(&graph, &mut text).unwrap();
        let at = at.index(text.len());
        text[at] = byte;
        let whole = matrix_market::parse(&text);
        let is_expected = matches!(whole, Ok(_) | Err(GraphError::Parse { .. }));
        prop_assert!(is_expected);
        text.truncate(cut.index(text.len()));
        let _ = matrix_market::parse(&text);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Large enough for several tasks.
    #[test]
    fn threads_do_not_show(lists in lists(30_000, 20_000), seed in any::<u64>()) {
        let make = || {
            let graph = lists.builder().build().unwrap();
            let (offsets, mut items) = graph.clone().into_csr().into_parts();
            items.reverse();
            let dirty = offsets.iter().rev().map(|end| items.len() as u32 - end).collect();
            let turned = ConstraintGraph::from_csr(dirty, items).unwrap();
            let mut numbers: Vec<u32> = (0..lists.n as u32).collect();
            numbers.rotate_left(seed as usize % lists.n);
            (graph.permuted(&numbers).unwrap(), turned, smallest_last(&graph), graph)
        };
        let one = in_pool(1, make);
        assert_rows(&one.3, &naive_rows(lists.n, lists.iter()));
        for n_threads in [2, 7] {
            prop_assert!(in_pool(n_threads, make) == one, "{} threads", n_threads);
        }
    }
}

fn assert_holds(graph: &DynamicGraph, held: &BTreeMap<[u32; 2], usize>) -> Result<(), TestCaseError> {
    let mut rows = vec![Vec::new(); graph.n_vertices()];
    for (&[u, v], &count) in held {
        rows[u as usize].extend(std::iter::repeat_n(v, count));
        rows[v as usize].extend(std::iter::repeat_n(u, count));
    }
    for (v, mut expected) in (0..).zip(rows) {
        let mut row = Adjacency::neighbors(graph, v).to_vec();
        row.sort_unstable();
        expected.sort_unstable();
        prop_assert_eq!(row, expected);
        prop_assert_eq!(Adjacency::degree(graph, v) as usize, graph.neighbors(v).len());
    }
    prop_assert_eq!(graph.n_edges(), held.values().sum::<usize>());
    let edges: Vec<[u32; 2]> = held.iter().filter(|&(_, &count)| count > 0).map(|(&edge, _)| edge).collect();
    prop_assert_eq!(graph.to_graph(), ConstraintGraph::from_edges(graph.n_vertices(), &edges).unwrap());
    Ok(())
}
