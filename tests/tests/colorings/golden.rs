//! One hash for each algorithm on a few small graphs: a coloring is a promise to whoever compares runs.
//!
//! A hash that changes comes with the reason, in the message of the commit that changes it: an algorithm was *meant* to color
//! otherwise. If only this test fails, find out why before touching it.

use vivace_coloring::Algorithm;
use vivace_graph::ConstraintGraph;
use vivace_tests::generators::{
    complete_bipartite, irregular_hinge_cloth, random, regular_cloth, tets, with_hubs,
};

/// FNV-1a, 64 bits, over the bytes of each number.
fn hash(hash: u64, numbers: impl IntoIterator<Item = u32>) -> u64 {
    let bytes = numbers.into_iter().flat_map(u32::to_le_bytes);
    bytes.fold(hash, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

const START: u64 = 0xcbf2_9ce4_8422_2325;

fn graphs() -> [ConstraintGraph; 7] {
    [
        regular_cloth(40, 30),
        irregular_hinge_cloth(30, 20, 7),
        tets(600, 7),
        random(400, 2000, 7),
        with_hubs(&regular_cloth(30, 30), &[500, 50], 7),
        complete_bipartite(20, 30),
        irregular_hinge_cloth(90, 80, 7), // more than one block
    ]
}

/// The graphs themselves: if these change, so does everything below.
#[test]
fn graphs_are_what_they_were() {
    let hashes = graphs().map(|graph| {
        let csr = graph.csr();
        hash(START, csr.offsets().iter().chain(csr.items()).copied())
    });
    assert_eq!(hashes, GRAPHS, "now {hashes:#018x?}");
}

#[test]
fn colorings_are_what_they_were() {
    let graphs = graphs();
    let of = |algorithm: Algorithm| {
        graphs.iter().fold(START, |state, graph| {
            let outcome = algorithm.with_seed(20_160).color(graph);
            let state = hash(state, outcome.coloring.colors().iter().copied());
            hash(state, [outcome.rounds, u32::try_from(outcome.visits).unwrap()])
        })
    };
    let hashes = Algorithm::ALL.map(|algorithm| (algorithm.name(), of(algorithm)));
    assert_eq!(hashes, COLORINGS, "now {hashes:#018x?}");
}

const GRAPHS: [u64; 7] = [
    0x91cd_6e54_5dd9_4a13,
    0x5028_6e3a_a4ac_ba61,
    0x34f7_641c_8889_c26a,
    0xe998_aae6_c599_0cdf,
    0xfb43_0709_38d5_d78a,
    0xf982_fe50_3783_95e1,
    0x1b93_3096_c24d_0d92,
];

const COLORINGS: [(&str, u64); 10] = [
    ("blocked", 0x7bde_53ac_9f69_6f1a),
    ("first-fit", 0x7773_bd88_9c58_b58e),
    ("largest-first", 0x0f3d_f279_94c9_3834),
    ("smallest-last", 0x4a4d_b328_f1a8_3f1e),
    ("dsatur", 0xf59e_8c75_3a7c_aadd),
    ("luby", 0x2127_53db_2d00_bd7e),
    ("jones-plassmann", 0x32d1_fc81_fa1f_6cb7),
    ("ldf", 0x9542_a256_ff0d_fd5f),
    ("vivace", 0xd7fd_b2fe_677d_6472),
    ("vivace-index", 0x2b52_8580_517b_660b),
];
