//! The order in which a solver keeps particles: color by color, so that a class is a range; pinned ones last.

use std::ops::Range;

use vivace_coloring::{Coloring, ConstraintGraph, color};
use vivace_model::Model;

use crate::SolverError;

/// Numbering by color. Depends on the topology alone.
#[derive(Debug, Clone, Default)]
pub(crate) struct Layout {
    /// The model's number of each of the solver's particles.
    pub(crate) order: Vec<u32>,
    /// The solver's number of each of the model's particles.
    pub(crate) place: Vec<u32>,
    /// The classes C_1, …, C_p.
    pub(crate) classes: Vec<Range<usize>>,
    /// How many particles are free; the pinned ones follow.
    pub(crate) n_free: usize,
}

impl Layout {
    /// Line 2 of Algorithm 1; or, where there are `colors`, by these. Pinned particles are no unknowns and belong to no class.
    ///
    /// # Errors
    /// Neighbors of one color.
    pub(crate) fn new(model: &Model, graph: &ConstraintGraph, colors: &[u32]) -> Result<Self, SolverError> {
        let coloring = if colors.is_empty() {
            color(graph)
        } else {
            let proper = Coloring::new(graph, colors.to_vec());
            proper.map_err(|violation| SolverError::Coloring { violation })?
        };
        let partitions = coloring.partitions();
        let (mut order, mut classes) = (Vec::with_capacity(model.n_particles()), Vec::new());
        for class in partitions.csr().rows() {
            let start = order.len();
            order.extend(class.iter().filter(|&&p| !model.is_pinned(p)));
            if order.len() > start {
                classes.push(start..order.len());
            }
        }
        let n_free = order.len();
        // Particle numbers are 32-bit by construction of the model.
        let all = (0..).take(model.n_particles());
        order.extend(all.filter(|&p| model.is_pinned(p)));
        let mut place = vec![0; order.len()];
        for (slot, &particle) in (0..).zip(&order) {
            place[particle as usize] = slot;
        }
        Ok(Self { order, place, classes, n_free })
    }

    /// The model's own order, without classes.
    pub(crate) fn plain(model: &Model) -> Self {
        // Particle numbers are 32-bit by construction of the model.
        let order: Vec<u32> = (0..).take(model.n_particles()).collect();
        let n_free = order.iter().filter(|&&particle| !model.is_pinned(particle)).count();
        Self { place: order.clone(), order, classes: Vec::new(), n_free }
    }

    /// The solver's numbers of the particles of a constraint.
    pub(crate) fn places<const N: usize>(&self, particles: [u32; N]) -> [u32; N] {
        particles.map(|particle| self.place[particle as usize])
    }

    /// Whether one of the solver's particles is free.
    pub(crate) fn is_free(&self, slot: u32) -> bool {
        (slot as usize) < self.n_free
    }
}
