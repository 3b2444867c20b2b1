//! Colors for constraints: two that share a particle differ.

use vivace_coloring::{ConstraintGraph, color};
use vivace_model::Model;

use crate::SolverError;
use crate::error::narrow;

/// The color of each constraint, numbered through in the order of [`vivace_model::Constraints`], and how many colors there are.
pub(crate) fn color_constraints(model: &Model) -> Result<(Vec<u32>, u32), SolverError> {
    let incidence = model.constraints().graph_builder(model.n_particles()).incidence()?;
    let n = model.constraints().len();
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); n];
    for particle in (0..).take(model.n_particles()) {
        // A pinned particle is never written, so it keeps nobody apart.
        if !model.is_pinned(particle) {
            for &constraint in incidence.constraints(particle) {
                members[constraint as usize].push(particle);
            }
        }
    }
    let (mut offsets, mut neighbors) = (vec![0_u32], Vec::new());
    for particles in &members {
        let first = neighbors.len();
        for &particle in particles {
            neighbors.extend_from_slice(incidence.constraints(particle));
        }
        neighbors[first..].sort_unstable();
        let mut row = neighbors.split_off(first);
        row.dedup();
        neighbors.append(&mut row);
        offsets.push(narrow("neighbors of constraints", neighbors.len())?);
    }
    let coloring = color(&ConstraintGraph::from_csr(offsets, neighbors)?);
    Ok((coloring.colors().to_vec(), coloring.n_colors()))
}
