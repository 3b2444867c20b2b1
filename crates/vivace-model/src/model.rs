//! What does not change while it is simulated.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::Vec3;
use vivace_graph::{ConstraintGraph, GraphError};
use vivace_kernels::constraint::Attachment;

use crate::builder::{check_target, positive};
use crate::tear::Tearing;
use crate::{Constraints, ModelError};

/// Particles and constraints. Made by [`ModelBuilder`](crate::ModelBuilder), checked once.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    pub(crate) masses: Vec<f32>,
    pub(crate) constraints: Constraints,
    pub(crate) surface: Vec<[u32; 3]>,
    bodies: Vec<Range<u32>>,
    /// Masses of what [`Model::pin`] holds \[kg\].
    pub(crate) own_masses: BTreeMap<u32, f32>,
    pub(crate) tearing: Option<Tearing>,
}

impl Model {
    pub(crate) fn from_parts(
        masses: Vec<f32>,
        constraints: Constraints,
        surface: Vec<[u32; 3]>,
        bodies: Vec<Range<u32>>,
        tearing: Option<Tearing>,
    ) -> Self {
        Self { masses, constraints, surface, bodies, own_masses: BTreeMap::new(), tearing }
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
    /// [`ModelBuilder::particles`](crate::ModelBuilder::particles), `cloth` or `volume`, so one for each body of a scene. Copies that
    /// tears make come after all of them: see [`Model::origin`].
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

    /// The attachments: particle, target \[m\], stiffness \[N/m\].
    pub fn attachments(&self) -> impl ExactSizeIterator<Item = (u32, Vec3, f32)> {
        let all = &self.constraints.attachments;
        all.particles.iter().zip(&all.rest).map(|(&[particle], rest)| (particle, rest.target, rest.stiffness))
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

    /// Keeps the first `n` attachments, and puts `more` in place of the others: particle, target \[m\], stiffness \[N/m\]. The graph stays as
    /// it is.
    ///
    /// # Errors
    /// There are fewer than `n`; a particle that does not exist; a target that [`State::is_in_range`](crate::State::is_in_range)
    /// refuses; a stiffness that is not finite and positive. Nothing has changed.
    pub fn replace_attachments(&mut self, n: usize, more: &[(u32, Vec3, f32)]) -> Result<(), ModelError> {
        let n_attachments = self.constraints.attachments.len();
        if n > n_attachments {
            return Err(ModelError::Attachment { attachment: n - 1, n_attachments });
        }
        for (attachment, &(particle, target, stiffness)) in (n..).zip(more) {
            self.check_particle("attachment", attachment, particle)?;
            check_target(attachment, target)?;
            positive("the stiffness of an attachment [N/m]", stiffness)?;
        }
        let attachments = &mut self.constraints.attachments;
        attachments.particles.truncate(n);
        attachments.rest.truncate(n);
        attachments.extend(
            more.iter().map(|&(particle, target, stiffness)| ([particle], Attachment { target, stiffness })),
        );
        Ok(())
    }

    /// Makes a particle stay where it is put until [`Model::unpin`].
    ///
    /// # Errors
    /// It does not exist, or is pinned already.
    pub fn pin(&mut self, particle: u32) -> Result<(), ModelError> {
        self.check_particle("pin", self.own_masses.len(), particle)?;
        if self.is_pinned(particle) {
            return Err(ModelError::Pinned { particle });
        }
        let mass = std::mem::replace(&mut self.masses[particle as usize], f32::INFINITY);
        self.own_masses.insert(particle, mass);
        Ok(())
    }

    /// Takes [`Model::pin`] back: the particle has its mass again.
    ///
    /// # Errors
    /// [`Model::pin`] does not hold it: what the builder has pinned stays so.
    pub fn unpin(&mut self, particle: u32) -> Result<(), ModelError> {
        let mass = self.own_masses.remove(&particle).ok_or(ModelError::NotPinned { particle })?;
        self.masses[particle as usize] = mass;
        Ok(())
    }

    fn check_particle(&self, kind: &'static str, element: usize, particle: u32) -> Result<(), ModelError> {
        let n_particles = self.n_particles();
        if (particle as usize) < n_particles {
            return Ok(());
        }
        Err(ModelError::Index { kind, element, particle: particle.into(), n_particles })
    }

    /// Who shares a constraint with whom: G of the paper. Built anew.
    ///
    /// # Errors
    /// More edges than 32 bits can number.
    pub fn graph(&self) -> Result<ConstraintGraph, GraphError> {
        self.constraints.graph_builder(self.n_particles()).build()
    }
}
