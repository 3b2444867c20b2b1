//! What a framework is told of contacts, and what it says.

use glam::{Vec3, Vec4};
use serde::{Deserialize, Serialize};
use vivace_kernels::constraint::{self, Constraint};

/// How much stiffer a contact is than what it holds: w Σ a²/Y_ii, where Y_ii is the diagonal without contacts. A particle that would
/// end so far beyond the surface ends an eleventh of that deep: 0.25 mm for one on its own that falls for 1/60 s, and less for one
/// that hangs on others.
pub(crate) const STIFFNESS: f32 = 10.0;

/// One of the small steps of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SmallStep {
    /// Its number, of so many.
    pub(crate) k: u32,
    pub(crate) n: u32,
    /// Its length \[s\].
    pub(crate) h: f32,
}

impl SmallStep {
    /// What is left of the step after it \[s\].
    fn left(&self) -> f32 {
        (self.n - 1 - self.k) as f32 * self.h
    }
}

/// The contacts of a step, in one of its small steps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found<'a> {
    pub(crate) contacts: &'a [vivace_collision::Contact],
    /// Positions at the beginning of the small step and as predicted, in the model's order \[m\].
    pub(crate) before: &'a [Vec3],
    pub(crate) predicted: &'a [Vec3],
    /// Masses \[kg\].
    pub(crate) masses: &'a [f32],
    pub(crate) small: SmallStep,
    pub(crate) recoloring: Recoloring,
}

impl Found<'_> {
    /// No contacts.
    pub(crate) fn none(&self) -> Self {
        Self { contacts: &[], ..*self }
    }

    /// Whether these are the contacts of another step than before.
    pub(crate) fn is_new(&self) -> bool {
        self.small.k == 0
    }

    /// Contact `k` as a constraint of `stiffness` \[N/m\].
    pub(crate) fn rest(&self, k: usize, stiffness: f32) -> constraint::Contact {
        let contact = &self.contacts[k];
        let inverse_mass = |slot: usize| {
            let weight = contact.weights[slot];
            weight * weight / self.masses[contact.particles[slot] as usize]
        };
        let h = self.small.h;
        let mut rest = constraint::Contact {
            weights: Vec4::from(contact.weights),
            normal: contact.normal,
            distance: contact.distance,
            origin: contact.origin,
            stiffness,
            start: Vec3::ZERO,
            friction: contact.friction,
            reach: f32::INFINITY,
            ahead: 0.0,
            mobility: stiffness * h * h * (0..4).map(inverse_mass).sum::<f32>(),
            padding: 0.0,
        };
        self.renew(k, &mut rest);
        rest
    }

    /// Makes `rest`, contact `k`, that of this small step.
    pub(crate) fn renew(&self, k: usize, rest: &mut constraint::Contact) {
        let contact = &self.contacts[k];
        rest.origin = contact.origin - contact.velocity * self.small.left();
        let [a, b, c, d] = contact.particles.map(|p| p as usize);
        let at = |q: &[Vec3]| rest.apply(&[q[a], q[b], q[c], q[d]])[0];
        let (start, predicted) = (at(self.before) + contact.velocity * self.small.h, at(self.predicted));
        rest.start = start;
        rest.ahead = rest.slip(predicted).length();
        rest.reach = f32::INFINITY;
        if rest.friction > 0.0 {
            rest.lag(start);
        }
    }
}

/// Sweeps before friction follows the depth: until then that is what was predicted without contacts, and friction is what the depth at
/// the start of the step stands for. Too much of it would be hard to take back: it stops a body at once, and inertia alone moves it on.
pub(crate) const DELAY: u32 = 5;

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
