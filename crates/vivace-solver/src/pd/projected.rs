//! Contacts of small steps, and of what solves for all vertices at once: projected after each iteration, as in Position Based Dynamics.
//!
//! What a contact has to push back in a small step is little, and that it did is in the velocity of the next one. So each is looked at
//! once in an iteration, and neither coloring nor rows nor factor of Y know it.

use glam::{Vec3, Vec3A, Vec4};
use vivace_kernels::constraint::Xpbd;

use super::points::Points;
use crate::contacts::Found;
use crate::pbd::contacts::Contacts;

/// Contacts, and the particles that have some.
#[derive(Debug, Default)]
pub(super) struct Projected {
    contacts: Contacts,
    /// By the solver's numbers.
    particles: Vec<u32>,
    /// Where they are \[m\], and inverse masses \[1/kg\].
    q: Vec<Vec4>,
    /// Of each of the model's particles, its place among these.
    places: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Projected {
    /// Takes those of a small step. `place` has the solver's numbers.
    pub(super) fn set(&mut self, found: &Found<'_>, place: &[u32]) {
        if found.contacts.is_empty() && self.contacts.is_empty() {
            return;
        }
        if found.is_new() {
            self.particles.clear();
            self.q.clear();
            self.places.clear();
            self.places.resize(place.len(), NONE);
            for p in found.contacts.iter().flat_map(|contact| contact.particles) {
                let p = p as usize;
                if self.places[p] == NONE {
                    // Fewer than particles, which are 32-bit.
                    self.places[p] = u32::try_from(self.particles.len()).unwrap_or(NONE);
                    self.particles.push(place[p]);
                    self.q.push(Vec3::ZERO.extend(1.0 / found.masses[p]));
                }
            }
        }
        self.contacts.set(found, &|p| self.places[p as usize], &self.q);
        self.contacts.begin();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Projects each once, in a small step of `h` \[s\].
    pub(super) fn project(&mut self, h: f32, q: &mut Points) {
        if self.contacts.is_empty() {
            return;
        }
        for (own, &p) in self.q.iter_mut().zip(&self.particles) {
            *own = Vec3::from(q.get(p as usize)).extend(own.w);
        }
        let xpbd = Xpbd { squared_h: h * h, omega: 1.0 };
        for color in 0..self.contacts.n_colors() {
            self.contacts.relax_color(color, &xpbd, &mut self.q);
        }
        for (own, &p) in self.q.iter().zip(&self.particles) {
            q.set(p as usize, Vec3A::from(own.truncate()));
        }
    }
}
