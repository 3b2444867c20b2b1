//! Graphs for property tests.

use proptest::collection::vec;
use proptest::prelude::*;
use vivace_coloring::{Algorithm, ConflictRule, Vivace};
use vivace_graph::ConstraintGraph;
use vivace_tests::generators::{
    clique, complete_bipartite, empty, irregular_cloth, irregular_hinge_cloth, isolated, path, random,
    regular_cloth, regular_hinge_cloth, star, tets, wheel, with_contacts,
};

/// Random pairs over up to `n_max` vertices, sparse to dense. Shrinks to few vertices and pairs.
pub(crate) fn random_graph(n_max: u32) -> impl Strategy<Value = ConstraintGraph> {
    (1..n_max).prop_flat_map(|n| {
        vec([0..n, 0..n], 0..4 * n as usize)
            .prop_map(move |pairs| ConstraintGraph::from_edges(n as usize, &pairs).expect("pairs below n"))
    })
}

/// Every kind of graph, with up to a few hundred vertices.
pub(crate) fn any_graph() -> impl Strategy<Value = ConstraintGraph> {
    let sides = || (2..16_usize, 2..16_usize);
    prop_oneof![
        6 => random_graph(120),
        1 => (0..60_u32, 0..2000_usize, any::<u64>()).prop_map(|(n, m, seed)| random(n, m, seed)),
        1 => Just(empty()),
        1 => (0..100_u32).prop_map(isolated),
        1 => (0..100_u32).prop_map(path),
        1 => (0..150_u32).prop_map(star),
        1 => (3..150_u32).prop_map(wheel),
        1 => (0..50_u32).prop_map(clique),
        1 => (0..40_u32, 0..40_u32).prop_map(|(a, b)| complete_bipartite(a, b)),
        1 => sides().prop_map(|(w, h)| regular_cloth(w, h)),
        1 => sides().prop_map(|(w, h)| regular_hinge_cloth(w, h)),
        2 => (sides(), any::<u64>()).prop_map(|((w, h), seed)| irregular_cloth(w, h, seed)),
        1 => (sides(), any::<u64>()).prop_map(|((w, h), seed)| irregular_hinge_cloth(w, h, seed)),
        2 => (5..200_usize, any::<u64>()).prop_map(|(n, seed)| tets(n, seed)),
        1 => (5..200_usize, any::<u64>()).prop_map(|(n, seed)| with_contacts(&tets(n, seed), 0.3, seed)),
    ]
}

/// Graphs large enough for several threads to share the work.
pub(crate) fn large_graph() -> impl Strategy<Value = ConstraintGraph> {
    prop_oneof![
        (2000..6000_u32, 0..20_000_usize, any::<u64>()).prop_map(|(n, m, seed)| random(n, m, seed)),
        (40..80_usize, 40..80_usize).prop_map(|(w, h)| regular_hinge_cloth(w, h)),
        (40..80_usize, 40..80_usize, any::<u64>()).prop_map(|(w, h, seed)| irregular_cloth(w, h, seed)),
        (1500..4000_usize, any::<u64>()).prop_map(|(n, seed)| with_contacts(&tets(n, seed), 0.1, seed)),
        (1000..3000_u32).prop_map(star),
    ]
}

/// Every algorithm with every setting that it has.
pub(crate) fn any_algorithm() -> impl Strategy<Value = Algorithm> {
    let shrink = prop_oneof![1.0..10.0_f32, Just(f32::INFINITY), Just(f32::NAN), Just(0.0), Just(-1.0)];
    let rule = prop_oneof![
        Just(ConflictRule::HighestHash),
        Just(ConflictRule::HighestIndex),
        Just(ConflictRule::None)
    ];
    let vivace = (shrink, any::<u64>(), rule)
        .prop_map(|(shrink, seed, conflict)| Algorithm::Vivace(Vivace { shrink, seed, conflict }));
    prop_oneof![
        2 => (0..Algorithm::ALL.len(), any::<u64>())
            .prop_map(|(which, seed)| Algorithm::ALL[which].with_seed(seed)),
        1 => vivace,
    ]
}

/// The round-based ones among them.
pub(crate) fn any_round_based() -> impl Strategy<Value = Algorithm> {
    any_algorithm().prop_filter("runs in rounds", Algorithm::is_seeded)
}
