//! What does not change while it is simulated.

use std::ops::Range;

use glam::Vec3;
use vivace_graph::{ConstraintGraph, GraphError};

use crate::builder::check_target;
use crate::{Constraints, ModelError};

/// Particles and constraints. Made by [`ModelBuilder`](crate::ModelBuilder), checked once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    masses: Vec<f32>,
    constraints: Constraints,
    surface: Vec<[u32; 3]>,
    bodies: Vec<Range<u32>>,
}

impl Model {
    pub(crate) fn from_parts(
        masses: Vec<f32>,
        constraints: Constraints,
        surface: Vec<[u32; 3]>,
        bodies: Vec<Range<u32>>,
    ) -> Self {
        Self { masses, constraints, surface, bodies }
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

    /// The particles of each body, in the order in which they were added: one range for each call of
    /// [`ModelBuilder::particles`](crate::ModelBuilder::particles), `cloth` or `volume`, so one for each body of a scene.
    #[must_use]
    pub fn bodies(&self) -> &[Range<u32>] {
        &self.bodies
    }

    /// The numbers of the attachments that hold particles of `body`, ascending; none if there is no such body.
    pub fn attachments_of(&self, body: usize) -> impl Iterator<Item = usize> {
        let particles = self.bodies.get(body).cloned().unwrap_or_default();
        let held = self.constraints.attachments.particles.iter().enumerate();
        held.filter(move |(_, [particle])| particles.contains(particle)).map(|(attachment, _)| attachment)
    }

    /// Moves the target of attachment `idx` \[m\].
    ///
    /// # Errors
    /// There is no such attachment; a target that [`State::is_in_range`](crate::State::is_in_range) refuses.
    pub fn set_attachment_target(&mut self, idx: usize, target: Vec3) -> Result<(), ModelError> {
        let n_attachments = self.constraints.attachments.len();
        let Some(attachment) = self.constraints.attachments.rest.get_mut(idx) else {
            return Err(ModelError::Attachment { attachment: idx, n_attachments });
        };
        check_target(idx, target)?;
        attachment.target = target;
        Ok(())
    }

    /// Who shares a constraint with whom: G of the paper. Built anew.
    ///
    /// # Errors
    /// More edges than 32 bits can number.
    pub fn graph(&self) -> Result<ConstraintGraph, GraphError> {
        self.constraints.graph_builder(self.n_particles()).build()
    }
}
