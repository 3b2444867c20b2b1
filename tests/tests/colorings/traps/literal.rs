//! Algorithm 2 taken literally: palettes as lists, one rule for each place where the printed lines can be read wrongly.

use std::collections::BTreeSet;

use vivace_graph::ConstraintGraph;
use vivace_kernels::coloring::UNCOLORED;
use vivace_kernels::pcg;

/// What a hungry vertex is given (line 16).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Feed {
    /// "|P| + 1", and the palette is empty: always the same color.
    SizePlusOne,
    /// The next color never offered, whoever owns it.
    Next,
    /// The next color never offered that no colored neighbor owns.
    NextFree,
}

/// Whose color stands in a conflict (lines 8-12).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Winner {
    /// Nobody's.
    Nobody,
    /// That of the highest index among all neighbors.
    HighestOfAll,
    /// That of the highest index among the uncolored neighbors.
    HighestOfUncolored,
    /// That of the highest index among the uncolored neighbors that drew the same.
    HighestOfSame,
    /// As before, and it stands against a colored neighbor, too.
    HighestAgainstColored,
}

/// A reading of Algorithm 2.
#[derive(Debug, Clone, Copy)]
pub(super) struct Literal {
    pub(super) shrink: f32,
    pub(super) feed: Feed,
    pub(super) winner: Winner,
    /// Whether flags are written while others read them.
    pub(super) commits_at_once: bool,
}

impl Literal {
    /// The reading that works, but for hubs and long chains.
    pub(super) const SOUND: Self =
        Self { shrink: 2.0, feed: Feed::NextFree, winner: Winner::HighestOfSame, commits_at_once: false };
}

/// What came of it.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) colors: Vec<u32>,
    pub(super) rounds: u32,
    /// Vertices without a color after the last round.
    pub(super) n_stuck: usize,
    /// Edges whose ends have one color.
    pub(super) n_bad_edges: usize,
}

impl Literal {
    /// Runs until all are colored, at most `limit` rounds.
    pub(super) fn run(&self, graph: &ConstraintGraph, limit: u32) -> Run {
        let n = u32::try_from(graph.n_vertices()).expect("32 bits");
        let mut colors = vec![UNCOLORED; n as usize];
        let mut drawn = colors.clone();
        let mut n_offered: Vec<u32> = graph.degrees().map(|degree| self.palette_size(degree)).collect();
        let mut palettes: Vec<BTreeSet<u32>> = n_offered.iter().map(|&size| (0..size).collect()).collect();
        let mut uncolored: Vec<u32> = (0..n).collect();
        let mut rounds = 0;
        while !uncolored.is_empty() && rounds < limit {
            for &v in &uncolored {
                let skip = pcg::hash(v, pcg::key(1, rounds)) as usize % palettes[v as usize].len();
                drawn[v as usize] = *palettes[v as usize].iter().nth(skip).expect("skip < len");
            }
            // Descending: where flags are read while they are written, the worst order.
            let snapshot = colors.clone();
            for &v in uncolored.iter().rev() {
                let flags = if self.commits_at_once { &colors } else { &snapshot };
                if self.stands(graph, v, &drawn, flags) {
                    colors[v as usize] = drawn[v as usize];
                }
            }
            let is_colored = |v: &u32| colors[*v as usize] != UNCOLORED;
            for &v in uncolored.iter().filter(|v| is_colored(v)) {
                for &u in graph.neighbors(v) {
                    palettes[u as usize].remove(&colors[v as usize]);
                }
            }
            uncolored.retain(|v| !is_colored(v));
            for &v in &uncolored {
                if palettes[v as usize].is_empty() {
                    let fed = self.fed(graph, v, &colors, &mut n_offered[v as usize]);
                    palettes[v as usize].insert(fed);
                }
            }
            rounds += 1;
        }
        let is_bad = |[u, v]: &[u32; 2]| {
            colors[*u as usize] != UNCOLORED && colors[*u as usize] == colors[*v as usize]
        };
        let n_bad_edges = graph.edges().filter(is_bad).count();
        Run { rounds, n_stuck: uncolored.len(), n_bad_edges, colors }
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most the degree")]
    fn palette_size(&self, degree: u32) -> u32 {
        (f64::from(degree) / f64::from(self.shrink)) as u32 + 1
    }

    fn stands(&self, graph: &ConstraintGraph, v: u32, drawn: &[u32], colors: &[u32]) -> bool {
        let color_of = |u: u32| match colors[u as usize] {
            UNCOLORED => drawn[u as usize],
            color => color,
        };
        let is_uncolored = |u: u32| colors[u as usize] == UNCOLORED;
        let row = graph.neighbors(v);
        let clashes = |u: u32| color_of(u) == drawn[v as usize];
        // While flags are read live, a neighbor that has just won no longer counts as uncolored, nor yet as colored.
        let clashes_with_colored =
            !self.commits_at_once && row.iter().any(|&u| !is_uncolored(u) && clashes(u));
        let mut rivals = row.iter().filter(|&&u| is_uncolored(u) && clashes(u));
        match self.winner {
            Winner::HighestAgainstColored => rivals.all(|&u| u < v),
            _ if clashes_with_colored => false,
            Winner::Nobody => rivals.next().is_none(),
            Winner::HighestOfAll => rivals.next().is_none() || row.iter().all(|&u| u < v),
            Winner::HighestOfUncolored => {
                rivals.next().is_none() || row.iter().all(|&u| u < v || !is_uncolored(u))
            }
            Winner::HighestOfSame => rivals.all(|&u| u < v),
        }
    }

    fn fed(&self, graph: &ConstraintGraph, v: u32, colors: &[u32], n_offered: &mut u32) -> u32 {
        if self.feed == Feed::SizePlusOne {
            return 1;
        }
        let owned = |c: u32| graph.neighbors(v).iter().any(|&u| colors[u as usize] == c);
        while self.feed == Feed::NextFree && owned(*n_offered) {
            *n_offered += 1;
        }
        *n_offered += 1;
        *n_offered - 1
    }
}
