//! The list of algorithms: tests, benches and figures loop over it.

use std::fmt;
use std::str::FromStr;

use vivace_cpu::Cpu;
use vivace_graph::ConstraintGraph;

use crate::{
    Coloring, GraphView, Order, RoundColoring, Vivace, blocked_first_fit, dsatur, first_fit, jones_plassmann,
    largest_degree_first, luby, vivace,
};

/// A way to color a graph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Algorithm {
    /// First fit in fixed blocks, conflicts repaired in a fixed order: the fastest on a CPU.
    BlockedFirstFit,
    /// First fit, one vertex after another.
    FirstFit(Order),
    /// Brélaz (1979): next comes the vertex with the most differently colored neighbors. Serial.
    Dsatur,
    /// Luby (1985): a maximal independent set for each color.
    Luby {
        /// Seed of the weights.
        seed: u64,
    },
    /// Jones and Plassmann (1993): first fit for the local maxima of random weights.
    JonesPlassmann {
        /// Seed of the weights.
        seed: u64,
    },
    /// Welsh and Powell (1967), in parallel: first fit for the local maxima of the current degree.
    LargestDegreeFirst {
        /// Seed of the hash that decides between equal degrees.
        seed: u64,
    },
    /// Algorithm 2 of the paper (Grable and Panconesi 2000).
    Vivace(Vivace),
}

/// What an algorithm did.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outcome {
    /// The coloring.
    pub coloring: Coloring,
    /// Rounds in which all uncolored vertices act at once; 1 for a serial algorithm.
    pub rounds: u32,
    /// Vertices that acted, summed over the rounds.
    pub visits: u64,
    /// Vertices still uncolored when the bound on rounds was met, and then colored one by one.
    pub stragglers: u32,
}

/// Colors a graph with the algorithm that is fastest on a CPU, [`Algorithm::BlockedFirstFit`].
#[must_use]
pub fn color(graph: &ConstraintGraph) -> Coloring {
    blocked_first_fit(graph)
}

impl Algorithm {
    /// One of each, with default settings.
    pub const ALL: [Self; 10] = [
        Self::BlockedFirstFit,
        Self::FirstFit(Order::Natural),
        Self::FirstFit(Order::LargestFirst),
        Self::FirstFit(Order::SmallestLast),
        Self::Dsatur,
        Self::Luby { seed: 0 },
        Self::JonesPlassmann { seed: 0 },
        Self::LargestDegreeFirst { seed: 0 },
        Self::Vivace(Vivace::DEFAULT),
        Self::Vivace(Vivace { conflict: crate::ConflictRule::HighestIndex, ..Vivace::DEFAULT }),
    ];

    /// Short name, as the command line takes it.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::BlockedFirstFit => "blocked",
            Self::FirstFit(Order::Natural) => "first-fit",
            Self::FirstFit(Order::LargestFirst) => "largest-first",
            Self::FirstFit(Order::SmallestLast) => "smallest-last",
            Self::Dsatur => "dsatur",
            Self::Luby { .. } => "luby",
            Self::JonesPlassmann { .. } => "jones-plassmann",
            Self::LargestDegreeFirst { .. } => "ldf",
            Self::Vivace(vivace) => match vivace.conflict {
                crate::ConflictRule::HighestHash => "vivace",
                crate::ConflictRule::HighestIndex => "vivace-index",
                crate::ConflictRule::None => "vivace-no-rule",
            },
        }
    }

    /// The same algorithm with another seed, where it has one.
    #[must_use]
    pub const fn with_seed(self, seed: u64) -> Self {
        match self {
            Self::Luby { .. } => Self::Luby { seed },
            Self::JonesPlassmann { .. } => Self::JonesPlassmann { seed },
            Self::LargestDegreeFirst { .. } => Self::LargestDegreeFirst { seed },
            Self::Vivace(vivace) => Self::Vivace(Vivace { seed, ..vivace }),
            serial => serial,
        }
    }

    /// Whether the answer depends on a seed.
    #[must_use]
    pub const fn is_seeded(&self) -> bool {
        matches!(
            self,
            Self::Luby { .. }
                | Self::JonesPlassmann { .. }
                | Self::LargestDegreeFirst { .. }
                | Self::Vivace(_)
        )
    }

    /// Colors `graph` on the CPU, in the rayon pool it is called in.
    #[must_use]
    pub fn color(&self, graph: &ConstraintGraph) -> Outcome {
        let serial = |coloring: Coloring| Outcome {
            rounds: u32::from(graph.n_vertices() > 0),
            visits: graph.n_vertices() as u64,
            stragglers: 0,
            coloring,
        };
        let view = GraphView::of(graph);
        let cpu = Cpu::new();
        let in_rounds = |run: &(dyn Fn() -> RoundColoring<Cpu> + Sync)| {
            let RoundColoring { colors, count, stragglers } = cpu.enter(run);
            Outcome {
                coloring: Coloring::compacted(colors),
                rounds: count.rounds,
                visits: count.visits,
                stragglers: crate::certificate::index(stragglers.len()),
            }
        };
        match *self {
            Self::BlockedFirstFit => serial(blocked_first_fit(graph)),
            Self::FirstFit(order) => serial(first_fit(graph, order)),
            Self::Dsatur => serial(dsatur(graph)),
            Self::Luby { seed } => in_rounds(&|| luby(&cpu, view, seed)),
            Self::JonesPlassmann { seed } => in_rounds(&|| jones_plassmann(&cpu, view, seed)),
            Self::LargestDegreeFirst { seed } => in_rounds(&|| largest_degree_first(&cpu, view, seed)),
            Self::Vivace(options) => in_rounds(&|| vivace(&cpu, view, &options)),
        }
    }
}

impl fmt::Display for Algorithm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that no algorithm has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no algorithm is called {name:?}; there are {}", Algorithm::ALL.map(|a| a.name()).join(", "))]
pub struct UnknownAlgorithm {
    name: String,
}

impl FromStr for Algorithm {
    type Err = UnknownAlgorithm;

    fn from_str(name: &str) -> Result<Self, UnknownAlgorithm> {
        let found = Self::ALL.into_iter().find(|algorithm| algorithm.name() == name);
        found.ok_or_else(|| UnknownAlgorithm { name: name.to_owned() })
    }
}
