//! What the contacts of each frame do to the graph of a model and to its coloring: line 2 of Algorithm 1, by itself.

use std::time::Instant;

use vivace_coloring::{Certificate, Follower, color};
use vivace_graph::{ConstraintGraph, DynamicGraph};
use vivace_model::Model;
use vivace_solver::collision::Contact;

use crate::figures::FigureError;

/// The graph of a model with the contacts of a frame, and its coloring, which follows.
pub(super) struct Recoloring {
    fixed: ConstraintGraph,
    graph: DynamicGraph,
    /// Edges that contacts alone have, ascending.
    edges: Vec<[u32; 2]>,
    follower: Follower,
}

/// What a frame changed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Change {
    /// Edges that came or went.
    pub edges: usize,
    /// Vertices that got another color.
    pub vertices: usize,
    /// Colors of the vertices.
    pub colors: u32,
    /// Coloring, where it follows \[s\].
    pub seconds: f64,
    /// Coloring all anew \[s\].
    pub seconds_anew: f64,
}

impl Recoloring {
    /// Without contacts.
    pub(super) fn new(model: &Model) -> Result<Self, FigureError> {
        let fixed = model.graph()?;
        let (graph, follower) = (DynamicGraph::from(&fixed), Follower::new(&color(&fixed)));
        Ok(Self { fixed, graph, edges: Vec::new(), follower })
    }

    /// Takes the contacts of a frame.
    pub(super) fn follow(&mut self, contacts: &[Contact]) -> Result<Change, FigureError> {
        let pairs = |contact: &Contact| {
            let p = contact.particles;
            [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].map(|[a, b]| [p[a].min(p[b]), p[a].max(p[b])])
        };
        let is_new = |[u, v]: &[u32; 2]| u != v && self.fixed.neighbors(*u).binary_search(v).is_err();
        let mut edges: Vec<[u32; 2]> = contacts.iter().flat_map(pairs).filter(is_new).collect();
        edges.sort_unstable();
        edges.dedup();
        let without = |these: &[[u32; 2]], those: &[[u32; 2]]| -> Vec<[u32; 2]> {
            these.iter().filter(|edge| those.binary_search(edge).is_err()).copied().collect()
        };
        let (gone, come) = (without(&self.edges, &edges), without(&edges, &self.edges));
        self.graph.apply(&gone, &come)?;
        self.edges = edges;

        let start = Instant::now();
        let work = self.follower.update(&self.graph, &gone, &come);
        let seconds = start.elapsed().as_secs_f64();
        Certificate::check(&self.graph, self.follower.colors())
            .map_err(|violation| FigureError::Coloring { method: "Follower".to_owned(), violation })?;
        let mut other = self.follower.clone();
        let start = Instant::now();
        other.anew(&self.graph);
        Ok(Change {
            edges: gone.len() + come.len(),
            vertices: work.recolored,
            colors: self.follower.n_colors(),
            seconds,
            seconds_anew: start.elapsed().as_secs_f64(),
        })
    }
}

#[cfg(test)]
mod tests {
    use vivace_scene::drape;
    use vivace_sim::{Budget, Simulation, Solver};

    use super::*;

    #[test]
    fn contacts_come_and_go_with_their_edges() {
        let mut simulation = Simulation::new(&drape(12), Solver::default()).unwrap();
        let mut recoloring = Recoloring::new(simulation.model()).unwrap();
        let before = recoloring.follower.colors().to_vec();
        let mut changed = 0;
        for _ in 0..40 {
            simulation.step(Budget::iterations(8)).unwrap();
            changed += recoloring.follow(simulation.contacts()).unwrap().edges;
        }
        assert!(changed > 0, "nothing touched");
        let change = recoloring.follow(&[]).unwrap();
        assert_eq!((recoloring.edges.len(), recoloring.follower.colors()), (0, before.as_slice()));
        assert!(change.seconds_anew > 0.0);
    }
}
