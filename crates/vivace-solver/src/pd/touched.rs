//! How vertices with contacts are relaxed, and those that contacts drove out of their class.

use glam::{Mat3, Vec3, Vec3A};
use rayon::prelude::*;

use super::contacts::Contacts;
use super::islands::Islands;
use super::points::{LANES, Lanes3, Points};
use super::topology::Topology;
use super::{GRAIN, ProjectiveDynamics};
use crate::contacts::{Change, ContactMemory, Found};
use crate::{SolverError, VertexSolve};

/// Whose turn it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turn {
    /// That of a class: who has moved to another color stays.
    Class,
    /// That of the vertex in this lane on its own.
    One(usize),
    /// That of all vertices at once.
    All,
}

impl ProjectiveDynamics {
    /// The steps of a slice without contacts, whose forces are `residual`, with those of vertices that have contacts instead. They are not over-relaxed: a cloth on a sphere would
    /// not come to rest.
    #[cold]
    pub(super) fn with_contacts(
        &self,
        slice: usize,
        q: &Points,
        residual: Lanes3,
        step: Lanes3,
        omega: f32,
        turn: Turn,
    ) -> Lanes3 {
        let Some(all) = &self.contacts else { return step };
        let (contacts, topology) = &**all;
        let moved = if turn == Turn::Class { topology.mask(slice) } else { 0 };
        let asked = if let Turn::One(lane) = turn { 1 << lane } else { u8::MAX };
        let touched = contacts.mask(slice) & asked & !moved;
        if moved | touched == 0 {
            return step;
        }
        let (mut steps, forces) = (step.to_array(), residual.to_array());
        let (first, n) = self.slices.slices[slice];
        for lane in 0..n {
            let vertex = first + lane;
            if moved >> lane & 1 == 1 {
                steps[lane] = Vec3A::ZERO;
            } else if touched >> lane & 1 == 1 {
                let force = Vec3::from(forces[lane]);
                let block = self.own_block(slice, lane, q);
                let step = contacts.solve(vertex, q, force, block, turn == Turn::All);
                steps[lane] = Vec3A::from(step) * omega.min(1.0);
            }
        }
        Lanes3::from_array(steps)
    }

    /// The block of one vertex without contacts \[N/m\].
    fn own_block(&self, slice: usize, lane: usize, q: &Points) -> Mat3 {
        let vertex = self.slices.slices[slice].0 + lane;
        if self.vertex == VertexSolve::Block {
            self.vertices().block(slice, lane, q)
        } else {
            Mat3::from_diagonal(Vec3::splat(self.rows.diagonal[vertex] + self.anchor_weights[vertex]))
        }
    }

    /// What one vertex moves by \[m\].
    pub(super) fn step_of(&self, vertex: usize, omega: f32) -> Vec3A {
        let slice = self.slices.of_vertex(vertex);
        let lane = vertex - self.slices.slices[slice].0;
        self.step(slice, &self.q, omega, Turn::One(lane)).to_array()[lane]
    }

    /// Who has `color` and is not in its class.
    pub(super) fn moved_to(&self, color: usize) -> &[u32] {
        self.contacts.as_ref().map_or(&[], |all| all.1.moved(color))
    }

    /// Whether a vertex is not in its class.
    pub(super) fn has_moved(&self, vertex: usize) -> bool {
        let Some(all) = &self.contacts else { return false };
        let slice = self.slices.of_vertex(vertex);
        all.1.mask(slice) >> (vertex - self.slices.slices[slice].0) & 1 == 1
    }

    /// What each of the vertices of `color` that are not in its class moves by \[m\].
    pub(super) fn steps_of_moved(&self, color: usize, omega: f32) -> Vec<Vec3A> {
        let step = |&vertex: &u32| self.step_of(vertex as usize, omega);
        let moved = self.moved_to(color);
        if rayon::current_num_threads() == 1 || moved.len() < GRAIN / LANES {
            moved.iter().map(step).collect()
        } else {
            moved.par_iter().with_min_len(GRAIN / LANES).map(step).collect()
        }
    }

    /// Relaxes the vertices of `color` that are not in its class. None sees another, nor one of the class.
    pub(super) fn relax_moved(&mut self, color: usize, omega: f32) {
        let steps = self.steps_of_moved(color, omega);
        for (k, step) in steps.into_iter().enumerate() {
            let vertex = self.moved_to(color)[k] as usize;
            self.q.set(vertex, self.q.get(vertex) + step);
        }
    }

    /// Before each sweep.
    pub(super) fn lag(&mut self) {
        if let Some(all) = &mut self.contacts {
            all.0.lag(&self.q);
        }
    }

    /// Takes the contacts of a (small) step, before it begins.
    pub(super) fn take_contacts(&mut self, found: &Found<'_>) -> Result<Change, SolverError> {
        if found.contacts.is_empty() && self.contacts.is_none() {
            return Ok(Change::default());
        }
        let mut all = match self.contacts.take() {
            Some(all) => all,
            None => self.without_contacts()?,
        };
        let (contacts, topology) = &mut *all;
        contacts.set(found, &self.layout.place, &self.inverse_diagonal, &self.slices);
        if !found.is_new() {
            self.contacts = Some(all);
            return Ok(Change::default());
        }
        let members: Vec<([u32; 4], usize)> = contacts.vertices(self.layout.n_free).collect();
        let members = members.iter().map(|(vertices, n)| &vertices[..*n]);
        let change = topology.update(members, found.recoloring, &self.slices);
        self.contacts = Some(all);
        change
    }

    pub(super) fn contact_memory(&self) -> ContactMemory {
        self.contacts.as_ref().map_or_else(ContactMemory::default, |all| all.1.memory())
    }

    pub(super) fn take_memory(&mut self, memory: &ContactMemory) -> Result<(), SolverError> {
        if self.contacts.is_none() && *memory == ContactMemory::default() {
            return Ok(());
        }
        // Their contacts are those of the step that comes.
        let mut all = self.without_contacts()?;
        all.1.set_memory(memory, &self.slices)?;
        self.contacts = Some(all);
        Ok(())
    }

    /// Takes what hangs together by contacts.
    pub(super) fn join_islands(&mut self, found: &Found<'_>) {
        if found.contacts.is_empty() && self.islands.is_none() {
            return;
        }
        let Self { islands, rows, attachments, layout, .. } = self;
        let attached = attachments.iter().map(|attachment| attachment.0);
        let islands = islands.get_or_insert_with(|| Box::new(Islands::new(rows, attached)));
        islands.update(found.contacts.iter().map(|contact| layout.places(contact.particles)));
    }

    fn without_contacts(&self) -> Result<Box<(Contacts, Topology)>, SolverError> {
        let contacts = Contacts::none(self.layout.n_free, &self.slices);
        let topology = Topology::new(&self.rows, &self.layout, &self.slices)?;
        Ok(Box::new((contacts, topology)))
    }
}
