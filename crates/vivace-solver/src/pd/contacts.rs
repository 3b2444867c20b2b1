//! Contacts in Projective Dynamics: constraints of XPBD, projected after each iteration.
//!
//! A sweep resists a push on vertex i by the diagonal of Y as if its neighbors stood still, so between sweeps one over that is its
//! inverse mass; a linear solver moves all with it, and what is left is inertia. What contacts moved a vertex by, times what it resists
//! with, is their force: sweeps see it as a shift of the vertex's anchor. So neither coloring nor rows nor factor of Y know a contact,
//! and where nothing moves any more, forces are in balance and friction is within Coulomb's cone.

use glam::{Vec3, Vec3A, Vec4};
use vivace_kernels::constraint::Xpbd;
use wide::f32x8;

use super::points::{Points, load};
use crate::contacts::Found;
use crate::history::History;
use crate::pbd::contacts::Contacts;

/// Contacts, the particles that have some, and the anchors of all vertices as contacts shift them. Nothing until there are any.
#[derive(Debug, Default)]
pub(super) struct Touching {
    contacts: Contacts,
    /// By the solver's numbers.
    particles: Vec<u32>,
    /// Where they are \[m\], and by how much a force moves them \[m/N\].
    q: Vec<Vec4>,
    /// Of each of the model's particles, its place among these.
    places: Vec<u32>,
    /// By vertex: by how much it may be over-relaxed.
    most: Vec<f32>,
    anchors: Points,
    history: History<f32>,
}

const NONE: u32 = u32::MAX;
/// Multipliers are forces.
const FORCES: f32 = 1.0;

impl Touching {
    pub(super) fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// ω of eight vertices from `first` on, of which those that contacts have moved are not over-relaxed: what lies on something would not
    /// come to rest.
    pub(super) fn weights(&self, first: usize, omega: f32) -> f32x8 {
        load(&self.most, first).fast_min(f32x8::splat(omega))
    }

    /// Takes those of a (small) step. `place` has the solver's numbers, `mobility` one over what each free vertex resists with \[m/N\].
    pub(super) fn set(&mut self, found: &Found<'_>, place: &[u32], mobility: &[f32]) {
        if found.contacts.is_empty() && self.contacts.is_empty() {
            return;
        }
        if self.most.is_empty() {
            self.most.resize(mobility.len(), f32::INFINITY);
            self.anchors = Points::zeros(mobility.len());
            self.history = History::new(self.anchors.data().len());
        }
        self.particles.clear();
        self.q.clear();
        self.places.clear();
        self.places.resize(place.len(), NONE);
        for p in found.contacts.iter().flat_map(|contact| contact.particles) {
            let (here, there) = (&mut self.places[p as usize], place[p as usize]);
            if *here == NONE {
                // Fewer than particles, which are 32-bit.
                *here = u32::try_from(self.particles.len()).unwrap_or(NONE);
                self.particles.push(there);
                self.q.push(Vec3::ZERO.extend(mobility.get(there as usize).copied().unwrap_or(0.0)));
            }
        }
        self.contacts.set(found, &|p| self.places[p as usize], &self.q, FORCES);
    }

    pub(super) fn n_colors(&self) -> usize {
        self.contacts.n_colors()
    }

    /// A (small) step begins: nothing pushes yet.
    pub(super) fn begin(&mut self, anchors: &Points) {
        if !self.contacts.is_empty() {
            self.contacts.begin();
            self.anchors.data_mut().copy_from_slice(anchors.data());
            self.most.fill(f32::INFINITY);
        }
    }

    /// Before the first iteration: projects each once where particles were predicted. What moves as a whole resists with its inertia alone; with
    /// the diagonal of Y, what falls on something would be thrown back.
    pub(super) fn meet(&mut self, anchor_weights: &[f32], q: &mut Points) {
        if !self.contacts.is_empty() {
            for (own, &p) in self.q.iter_mut().zip(&self.particles).filter(|(own, _)| own.w > 0.0) {
                own.w = 1.0 / anchor_weights[p as usize];
            }
            self.project_all(anchor_weights, q);
        }
    }

    /// The anchors that sweeps see, which without contacts are `anchors`.
    pub(super) fn shifted<'a>(&'a self, anchors: &'a Points) -> &'a Points {
        if self.contacts.is_empty() { anchors } else { &self.anchors }
    }

    /// After an iteration: projects each once; `mobility` as in [`Touching::set`].
    pub(super) fn project(&mut self, mobility: &[f32], anchor_weights: &[f32], q: &mut Points) {
        for (own, &p) in self.q.iter_mut().zip(&self.particles).filter(|(own, _)| own.w > 0.0) {
            own.w = mobility[p as usize];
        }
        self.project_all(anchor_weights, q);
    }

    fn project_all(&mut self, anchor_weights: &[f32], q: &mut Points) {
        if self.contacts.is_empty() {
            return;
        }
        for (own, &p) in self.q.iter_mut().zip(&self.particles) {
            *own = Vec3::from(q.get(p as usize)).extend(own.w);
        }
        let xpbd = Xpbd { squared_h: FORCES, omega: 1.0 };
        for color in 0..self.contacts.n_colors() {
            self.contacts.relax_color(color, &xpbd, &mut self.q);
        }
        for (own, &p) in self.q.iter().zip(&self.particles) {
            if own.w > 0.0 {
                let (p, to) = (p as usize, Vec3A::from(own.truncate()));
                let moved = to - q.get(p);
                if moved != Vec3A::ZERO {
                    self.anchors.set(p, self.anchors.get(p) + moved / (own.w * anchor_weights[p]));
                    self.most[p] = 1.0;
                    q.set(p, to);
                }
            }
        }
    }

    /// w d²/2 of all that are violated \[J\].
    pub(super) fn energy(&self, q: &Points) -> f64 {
        self.contacts.energy(&|p| q.get(self.particles[p as usize] as usize).into())
    }

    pub(super) fn save(&mut self) {
        if self.contacts.is_empty() {
            return;
        }
        let (history, lambdas) = self.contacts.history();
        history.save(lambdas);
        self.history.save(self.anchors.data());
    }

    pub(super) fn restore(&mut self) {
        if self.contacts.is_empty() {
            return;
        }
        let (history, lambdas) = self.contacts.history();
        history.restore(lambdas);
        self.history.restore(self.anchors.data_mut());
    }
}
