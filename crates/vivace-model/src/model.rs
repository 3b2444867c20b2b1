//! What does not change while it is simulated.

use vivace_graph::{ConstraintGraph, GraphBuilder, GraphError};

use crate::{Constraints, ModelError};

/// Particles and constraints. Made by [`ModelBuilder`](crate::ModelBuilder), checked once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    masses: Vec<f32>,
    constraints: Constraints,
    surface: Vec<[u32; 3]>,
}

impl Model {
    pub(crate) fn from_parts(masses: Vec<f32>, constraints: Constraints, surface: Vec<[u32; 3]>) -> Self {
        Self { masses, constraints, surface }
    }

    /// How many particles there are.
    #[must_use]
    pub fn n_particles(&self) -> usize {
        self.masses.len()
    }

    /// Mass of each particle \[kg\]: positive, or infinite where the particle is pinned.
    #[must_use]
    pub fn masses(&self) -> &[f32] {
        &self.masses
    }

    /// Whether a particle stays where it is put.
    #[must_use]
    pub fn is_pinned(&self, particle: u32) -> bool {
        self.masses[particle as usize].is_infinite()
    }

    /// The constraints.
    #[must_use]
    pub fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    /// The triangles of the surface, for wind and for pictures.
    #[must_use]
    pub fn surface(&self) -> &[[u32; 3]] {
        &self.surface
    }

    /// Moves the target of attachment `idx` \[m\].
    ///
    /// # Errors
    /// There is no such attachment; the target is not finite.
    pub fn set_attachment_target(&mut self, idx: usize, target: glam::Vec3) -> Result<(), ModelError> {
        let n = self.constraints.attachments.len();
        let Some(attachment) = self.constraints.attachments.rest.get_mut(idx) else {
            return Err(ModelError::Length { what: "attachments", expected: idx + 1, found: n });
        };
        if !target.is_finite() {
            return Err(ModelError::Value { what: "a target", value: target.length(), need: "finite" });
        }
        attachment.target = target;
        Ok(())
    }

    /// Who shares a constraint with whom: G of the paper. Built anew.
    ///
    /// # Errors
    /// More edges than 32 bits can number.
    pub fn graph(&self) -> Result<ConstraintGraph, GraphError> {
        let c = &self.constraints;
        GraphBuilder::new(self.n_particles())
            .constraints(&c.springs.particles)
            .constraints(&c.bending.particles)
            .constraints(&c.triangle_strain.particles)
            .constraints(&c.tet_strain.particles)
            .constraints(&c.tet_volume.particles)
            .build()
    }
}
