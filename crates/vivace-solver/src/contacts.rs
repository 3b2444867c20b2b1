//! What a framework is told of contacts, and what it says.

use glam::{Vec3, Vec4};
use serde::{Deserialize, Serialize};
use vivace_kernels::constraint;

/// How much stiffer a contact is than what it holds: w Σ a²/Y_ii, where Y_ii is the diagonal without contacts. A particle that would
/// end so far beyond the surface ends a part in so many and one of that deep. At 10, that is 0.25 mm for a particle on its own that
/// falls for 1/60 s, and less for one that hangs on others. Stiffer contacts pass on an impact no better, and take more sweeps.
pub(crate) const STIFFNESS: f32 = 10.0;

/// The contacts of a (small) step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found<'a> {
    pub(crate) contacts: &'a [vivace_collision::Contact],
    /// Positions at its start, in the model's order \[m\].
    pub(crate) before: &'a [Vec3],
    pub(crate) h: f32,
    pub(crate) recoloring: Recoloring,
}

impl Found<'_> {
    /// Contact `k` as a constraint of `stiffness` \[N/m\].
    pub(crate) fn rest(&self, k: usize, stiffness: f32) -> constraint::Contact {
        use constraint::Constraint;
        let contact = &self.contacts[k];
        let mut rest = constraint::Contact {
            weights: Vec4::from(contact.weights),
            normal: contact.normal,
            distance: contact.distance,
            origin: contact.origin,
            stiffness,
            start: Vec3::ZERO,
            friction: contact.friction,
            limit: 0.0,
            padding: [0.0; 3],
        };
        let [start] = rest.apply(&contact.particles.map(|p| self.before[p as usize]));
        rest.start = start + contact.velocity * self.h;
        rest
    }
}

/// What is done to a coloring when contacts come and go.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Recoloring {
    /// What the change makes improper is mended: work in proportion to the change.
    #[default]
    Incremental,
    /// All is colored anew.
    Full,
}

/// What contacts changed in the graph and the coloring.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Change {
    pub(crate) edges: usize,
    pub(crate) recolored: usize,
    pub(crate) visited: [usize; 2],
}

/// What the coloring of the next step depends on, beside the contacts of that step: those of the last one.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactMemory {
    pub(crate) edges: Vec<[u32; 2]>,
    pub(crate) colors: Vec<(u32, u32)>,
}
