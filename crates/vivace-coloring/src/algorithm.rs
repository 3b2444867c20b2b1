//! The list of algorithms: tests, benches and figures loop over it.

use std::fmt;
use std::str::FromStr;

use vivace_cpu::Cpu;
use vivace_graph::ConstraintGraph;
use vivace_kernels::Backend;

use crate::{
    Coloring, GraphBuffers, GraphView, Order, RoundColoring, Vivace, blocked_first_fit, dsatur, first_fit,
    jones_plassmann, largest_degree_first, luby, vivace,
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
        let coloring = match *self {
            Self::BlockedFirstFit => blocked_first_fit(graph),
            Self::FirstFit(order) => first_fit(graph, order),
            Self::Dsatur => dsatur(graph),
            Self::Luby { .. }
            | Self::JonesPlassmann { .. }
            | Self::LargestDegreeFirst { .. }
            | Self::Vivace(_) => {
                let cpu = Cpu::new();
                let Ok(outcome) = cpu.enter(|| self.outcome(&cpu, GraphView::of(graph)));
                return outcome.expect("it runs in rounds");
            }
        };
        let rounds = u32::from(graph.n_vertices() > 0);
        Outcome { rounds, visits: graph.n_vertices() as u64, stragglers: 0, coloring }
    }

    /// Colors `graph` on `backend`, for example a GPU. The answer is that of [`Algorithm::color`], bit for bit.
    ///
    /// ```
    /// use vivace_coloring::{Algorithm, ConstraintGraph, Vivace};
    /// use vivace_cpu::Cpu;
    ///
    /// let graph = ConstraintGraph::from_edges(3, &[[0, 1], [1, 2]])?;
    /// let algorithm = Algorithm::Vivace(Vivace::DEFAULT);
    /// // In place of `Cpu::serial()`, `vivace_gpu::Gpu::new()?` takes it to a GPU.
    /// assert_eq!(algorithm.color_on(&Cpu::serial(), &graph)?, algorithm.color(&graph));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The algorithm does not run in rounds, or the device failed.
    pub fn color_on<B: Backend>(
        &self,
        backend: &B,
        graph: &ConstraintGraph,
    ) -> Result<Outcome, ColorOnError<B::Error>> {
        let graph = GraphBuffers::upload(backend, graph);
        self.outcome(backend, graph.view(backend))?.ok_or(ColorOnError::NotInRounds(*self))
    }

    /// Goes through the motions of [`Algorithm::color_on`] for a graph of this size: what `vivace_gpu::Footprint` measures.
    pub fn rehearse<B: Backend>(&self, backend: &B, n_vertices: usize, n_edges: usize) {
        let graph = GraphBuffers::filled(backend, n_vertices, 2 * n_edges);
        // Nobody asks for the outcome.
        drop(self.outcome(backend, graph.view(backend)));
    }

    /// Colors a graph where it lies and leaves the colors there; `None` for an algorithm that does not run in rounds.
    pub fn run<B: Backend>(&self, backend: &B, graph: GraphView<'_, B::Memory>) -> Option<RoundColoring<B>> {
        match *self {
            Self::BlockedFirstFit | Self::FirstFit(_) | Self::Dsatur => None,
            Self::Luby { seed } => Some(luby(backend, graph, seed)),
            Self::JonesPlassmann { seed } => Some(jones_plassmann(backend, graph, seed)),
            Self::LargestDegreeFirst { seed } => Some(largest_degree_first(backend, graph, seed)),
            Self::Vivace(options) => Some(vivace(backend, graph, &options)),
        }
    }

    fn outcome<B: Backend>(
        &self,
        backend: &B,
        graph: GraphView<'_, B::Memory>,
    ) -> Result<Option<Outcome>, B::Error> {
        let Some(RoundColoring { colors, count, stragglers }) = self.run(backend, graph) else {
            return Ok(None);
        };
        Ok(Some(Outcome {
            coloring: Coloring::compacted(backend.read(colors)?),
            rounds: count.rounds,
            visits: count.visits,
            stragglers: crate::certificate::index(backend.indices(&stragglers)?.len()),
        }))
    }
}

/// Why [`Algorithm::color_on`] made no coloring.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ColorOnError<E> {
    /// The algorithm colors one vertex after another, or one block.
    #[error("{0} does not run in rounds, so it runs on the CPU only: take `Algorithm::color`")]
    NotInRounds(Algorithm),
    /// The device failed.
    #[error(transparent)]
    Backend(#[from] E),
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
