//! The graphs that benches and figures run on: the same on every machine.

use std::sync::OnceLock;

use vivace_graph::ConstraintGraph;

use crate::generators::{
    irregular_cloth, irregular_hinge_cloth, regular_cloth, regular_hinge_cloth, shuffled, tets,
    with_contacts, with_hubs,
};

/// A named graph.
#[derive(Debug, Clone, Copy)]
pub struct Workload {
    /// What it is and, roughly, of how many vertices.
    pub name: &'static str,
    /// Number of vertices.
    pub n_vertices: usize,
    /// What the best serial colorings need: smallest last, DSATUR, iterated greedy. Not always the least possible.
    pub few_colors: u32,
    build: fn() -> ConstraintGraph,
}

const fn workload(
    name: &'static str,
    n_vertices: usize,
    few_colors: u32,
    build: fn() -> ConstraintGraph,
) -> Workload {
    Workload { name, n_vertices, few_colors, build }
}

/// Degrees of the vertices added to make `hubs-100k`.
pub const HUB_DEGREES: [u32; 8] = [50_000, 20_000, 10_000, 5_000, 2_000, 1_000, 500, 200];

const K: usize = 1_000;

static SHARED: [OnceLock<ConstraintGraph>; Workload::ALL.len()] =
    [const { OnceLock::new() }; Workload::ALL.len()];

impl Workload {
    /// Each of them.
    pub const ALL: [Self; 19] = [
        workload("cloth-10k", 10 * K, 3, || regular_cloth(100, 100)),
        workload("cloth-100k", 100 * K, 3, || regular_cloth(400, 250)),
        workload("cloth-1m", 1000 * K, 3, || regular_cloth(1000, 1000)),
        workload("hinge-cloth-10k", 10 * K, 4, || regular_hinge_cloth(100, 100)),
        workload("hinge-cloth-100k", 100 * K, 4, || regular_hinge_cloth(400, 250)),
        workload("hinge-cloth-1m", 1000 * K, 4, || regular_hinge_cloth(1000, 1000)),
        workload("irregular-cloth-10k", 10 * K, 5, || irregular_cloth(100, 100, 11)),
        workload("irregular-cloth-100k", 100 * K, 5, || irregular_cloth(400, 250, 12)),
        workload("irregular-hinge-cloth-10k", 10 * K, 8, || irregular_hinge_cloth(100, 100, 11)),
        workload("irregular-hinge-cloth-100k", 100 * K, 8, || irregular_hinge_cloth(400, 250, 12)),
        workload("tets-10k", 10 * K, 10, || tets(10 * K, 21)),
        workload("tets-100k", 100 * K, 10, || tets(100 * K, 22)),
        workload("tets-1m", 1000 * K, 10, || tets(1000 * K, 23)),
        workload("hubs-100k", 100 * K + HUB_DEGREES.len(), 6, || {
            with_hubs(shared("irregular-cloth-100k"), &HUB_DEGREES, 31)
        }),
        workload("cloth-contacts-100k", 100 * K, 5, || {
            with_contacts(shared("irregular-cloth-100k"), 0.1, 41)
        }),
        workload("tets-contacts-10k", 10 * K, 10, || with_contacts(shared("tets-10k"), 0.1, 42)),
        workload("tets-contacts-100k", 100 * K, 10, || with_contacts(shared("tets-100k"), 0.1, 42)),
        workload("tets-shuffled-100k", 100 * K, 10, || shuffled(shared("tets-100k"), 52)),
        workload("cloth-shuffled-1m", 1000 * K, 3, || shuffled(shared("cloth-1m"), 51)),
    ];

    /// The workload of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        const ALL: &[Workload] = &Workload::ALL;
        ALL.iter().find(|workload| workload.name == name)
    }

    /// Those of at most `n_vertices` vertices.
    pub fn up_to(n_vertices: usize) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |workload| workload.n_vertices <= n_vertices)
    }

    /// Makes the graph; seconds for a million tetrahedra.
    #[must_use]
    pub fn build(&self) -> ConstraintGraph {
        (self.build)()
    }

    /// The graph, made when it is first asked for and kept until the process ends.
    #[must_use]
    pub fn shared(&self) -> &'static ConstraintGraph {
        let place = Self::ALL.iter().position(|workload| workload.name == self.name).expect("one of all");
        SHARED[place].get_or_init(self.build)
    }
}

/// [`Workload::shared`] by name.
///
/// # Panics
/// When no workload has this name.
#[must_use]
pub fn shared(name: &str) -> &'static ConstraintGraph {
    Workload::named(name).unwrap_or_else(|| panic!("no workload is called {name}")).shared()
}
