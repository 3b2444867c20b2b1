//! What a framework is told of contacts, and what it says.

use glam::{Vec3, Vec4};
use vivace_kernels::constraint::{self, Constraint};

/// The contacts of a (small) step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found<'a> {
    pub(crate) contacts: &'a [vivace_collision::Contact],
    /// Positions at the beginning, in the model's order \[m\].
    pub(crate) before: &'a [Vec3],
    /// Length of the step \[s\].
    pub(crate) h: f32,
}

impl Found<'_> {
    /// Contact `k` as a constraint of `stiffness` \[N/m\].
    pub(crate) fn rest(&self, k: usize, stiffness: f32) -> constraint::Contact {
        let contact = &self.contacts[k];
        let mut rest = constraint::Contact {
            weights: Vec4::from(contact.weights),
            normal: contact.normal,
            distance: contact.distance,
            origin: contact.origin,
            stiffness,
            start: Vec3::ZERO,
            friction: contact.friction,
        };
        let [aq] = rest.apply(&contact.particles.map(|p| self.before[p as usize]));
        rest.start = aq + contact.velocity * self.h;
        rest
    }
}
