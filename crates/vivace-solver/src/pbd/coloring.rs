//! Colors for constraints: two that share a particle differ. Attachments, which come and go, differ among themselves only: the kinds
//! that have a color are projected one after another.

use std::collections::BTreeMap;

use vivace_coloring::{ConstraintGraph, color};
use vivace_kernels::constraint::Attachment;
use vivace_model::{Model, Store};

use crate::SolverError;
use crate::error::narrow;

/// The color of each constraint, numbered through in the order of [`vivace_model::Constraints`], and how many colors there are.
pub(crate) fn color_constraints(model: &Model) -> Result<(Vec<u32>, u32), SolverError> {
    let incidence = model.constraints().graph_builder(model.n_particles()).incidence()?;
    let attachments = &model.constraints().attachments;
    // They are numbered last.
    let n = model.constraints().len() - attachments.len();
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); n];
    for particle in (0..).take(model.n_particles()) {
        // A pinned particle is never written, so it keeps nobody apart.
        if !model.is_pinned(particle) {
            for &constraint in incidence.constraints(particle) {
                if let Some(members) = members.get_mut(constraint as usize) {
                    members.push(particle);
                }
            }
        }
    }
    let (mut offsets, mut neighbors) = (vec![0_u32], Vec::new());
    for particles in &members {
        let first = neighbors.len();
        for &particle in particles {
            let around = incidence.constraints(particle);
            neighbors.extend(around.iter().filter(|&&constraint| (constraint as usize) < n));
        }
        neighbors[first..].sort_unstable();
        let mut row = neighbors.split_off(first);
        row.dedup();
        neighbors.append(&mut row);
        offsets.push(narrow("neighbors of constraints", neighbors.len())?);
    }
    let coloring = color(&ConstraintGraph::from_csr(offsets, neighbors)?);
    let (of_attachments, n_colors) = color_attachments(attachments, coloring.n_colors());
    Ok(([coloring.colors(), &of_attachments].concat(), n_colors))
}

/// The color of each attachment, and how many colors there are then; `n_colors` without them. The first of each particle has the last
/// color, the second the one before, …: a particle that is held ends where that takes it.
pub(crate) fn color_attachments(attachments: &Store<Attachment, 1>, n_colors: u32) -> (Vec<u32>, u32) {
    let mut n_of = BTreeMap::new();
    let color = |&[particle]: &[u32; 1]| {
        let n = n_of.entry(particle).or_insert(0);
        *n += 1;
        n_colors.checked_sub(*n).unwrap_or(*n - 1)
    };
    let colors: Vec<u32> = attachments.particles.iter().map(color).collect();
    (colors, n_of.into_values().max().unwrap_or(0).max(n_colors))
}
