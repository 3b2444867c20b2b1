//! The contacts of a frame in Projective Dynamics.
//!
//! They are entries of Y like any other constraint, w a², but are projected from the latest positions whenever a vertex is relaxed,
//! wherever the other projections are: a gap closes and opens within a few sweeps. And a vertex that has one is solved with a block of
//! its own: along the normal stiff, across it no stiffer than friction makes it.

use glam::{Mat3, Vec3};
use vivace_kernels::constraint::{Constraint, Contact};

use super::points::Points;
use super::slices::Slices;
use crate::contacts::{DELAY, Found, STIFFNESS};
use crate::parallel::sum;

/// Contacts, and who has them.
#[derive(Debug, Default)]
pub(super) struct Contacts {
    particles: Vec<[u32; 4]>,
    rest: Vec<Contact>,
    /// Where each is among those that were found.
    places: Vec<usize>,
    /// Vertex to `contact · 4 + slot`.
    offsets: Vec<u32>,
    slots: Vec<u32>,
    /// By slice: a bit for each lane whose vertex has contacts.
    masks: Vec<u8>,
    /// Sweeps since the step began.
    n_sweeps: u32,
}

impl Contacts {
    /// Takes those of a frame. `inverse_diagonal` is that of Y without them, of the free vertices \[m/N\].
    pub(super) fn set(
        &mut self,
        found: &Found<'_>,
        place: &[u32],
        inverse_diagonal: &[f32],
        slices: &Slices,
    ) {
        self.n_sweeps = 0;
        if !found.is_new() {
            self.rest.iter_mut().zip(&self.places).for_each(|(rest, &k)| found.renew(k, rest));
            return;
        }
        let n_free = inverse_diagonal.len();
        self.particles.clear();
        self.rest.clear();
        self.places.clear();
        for k in 0..found.contacts.len() {
            let particles = found.contacts[k].particles.map(|p| place[p as usize]);
            let softness = |slot: usize| {
                let squared = found.contacts[k].weights[slot] * found.contacts[k].weights[slot];
                squared * inverse_diagonal.get(particles[slot] as usize).copied().unwrap_or(0.0)
            };
            let softness: f32 = (0..4).map(softness).sum();
            // Between pinned particles nothing can be done.
            if softness > 0.0 && (STIFFNESS / softness).is_finite() {
                self.particles.push(particles);
                self.rest.push(found.rest(k, STIFFNESS / softness));
                self.places.push(k);
            }
        }
        self.index(n_free);
        self.masks.clear();
        self.masks.resize(slices.slices.len(), 0);
        for (slice, &(first, n)) in slices.slices.iter().enumerate() {
            let bit =
                |lane: usize| u8::from(self.offsets[first + lane] < self.offsets[first + lane + 1]) << lane;
            self.masks[slice] = (0..n).map(bit).sum();
        }
    }

    fn index(&mut self, n_free: usize) {
        self.offsets.clear();
        self.offsets.resize(n_free + 1, 0);
        let all = (0..).zip(self.particles.iter().flatten());
        let weight = |k: u32| self.rest[k as usize / 4].weights[k as usize % 4];
        let members = all.filter(|&(k, &p)| (p as usize) < n_free && weight(k) != 0.0);
        members.clone().for_each(|(_, &p)| self.offsets[p as usize + 1] += 1);
        for vertex in 0..n_free {
            self.offsets[vertex + 1] += self.offsets[vertex];
        }
        let mut next = self.offsets.clone();
        self.slots.clear();
        self.slots.resize(self.offsets[n_free] as usize, 0);
        for (k, &p) in members {
            self.slots[next[p as usize] as usize] = k;
            next[p as usize] += 1;
        }
    }

    /// None, for `n_free` vertices.
    pub(super) fn none(n_free: usize, slices: &Slices) -> Self {
        Self { offsets: vec![0; n_free + 1], masks: vec![0; slices.slices.len()], ..Self::default() }
    }

    /// The vertices of each contact, also those of weight 0: where they are shows in the rounding.
    pub(super) fn vertices(&self, n_free: usize) -> impl Iterator<Item = ([u32; 4], usize)> {
        self.particles.iter().map(move |particles| {
            let (mut vertices, mut n) = ([0; 4], 0);
            for &p in particles {
                if (p as usize) < n_free && !vertices[..n].contains(&p) {
                    vertices[n] = p;
                    n += 1;
                }
            }
            (vertices, n)
        })
    }

    /// A bit for each lane of `slice` whose vertex has contacts.
    #[inline]
    pub(super) fn mask(&self, slice: usize) -> u8 {
        self.masks[slice]
    }

    /// Whether friction needs to be lagged.
    pub(super) fn has_friction(&self) -> bool {
        self.rest.iter().any(|rest| rest.friction > 0.0)
    }

    /// The local step of friction, before each sweep: how much it may hold.
    pub(super) fn lag(&mut self, q: &Points) {
        self.n_sweeps = self.n_sweeps.saturating_add(1);
        if self.n_sweeps <= DELAY {
            return;
        }
        for (particles, rest) in self.particles.iter().zip(&mut self.rest) {
            if rest.friction > 0.0 {
                let [aq] = rest.apply(&corners(particles, q));
                rest.lag(aq);
            }
        }
    }

    /// What contacts ask of `vertex` at q \[N\].
    pub(super) fn pull(&self, vertex: usize, q: &Points) -> Vec3 {
        let of = |(contact, slot): (usize, usize)| {
            let rest = &self.rest[contact];
            -rest.pull(slot, &rest.residual(&corners(&self.particles[contact], q)))
        };
        self.slots(vertex).map(of).sum()
    }

    /// By how much `vertex` moves \[m\] under `force` \[N\] and its contacts, with `block` \[N/m\] without them. Where all vertices move at
    /// once, a contact counts for as much as all its particles may move it.
    pub(super) fn solve(
        &self,
        vertex: usize,
        q: &Points,
        mut force: Vec3,
        block: Mat3,
        is_all_at_once: bool,
    ) -> Vec3 {
        let mut sum = block;
        for (contact, slot) in self.slots(vertex) {
            let rest = &self.rest[contact];
            let [aq] = rest.apply(&corners(&self.particles[contact], q));
            let (asked, along, across) = rest.act(slot, aq);
            let others = if is_all_at_once {
                rest.weights.abs().element_sum() / rest.weights[slot].abs()
            } else {
                1.0
            };
            let (n, along, across) = (rest.normal, (along - across) * others, across * others);
            force += asked;
            sum += Mat3::from_cols(n * (along * n.x), n * (along * n.y), n * (along * n.z));
            sum += Mat3::from_diagonal(Vec3::splat(across));
        }
        // Scaled, so that no determinant leaves the range of numbers.
        let scale = sum.x_axis.x.max(sum.y_axis.y).max(sum.z_axis.z);
        let step = (sum * (1.0 / scale)).inverse() * (force / scale);
        if step.is_finite() { step } else { force / scale }
    }

    /// Energy of all contacts \[J\].
    pub(super) fn energy(&self, q: &Points) -> f64 {
        let of = |k: usize| f64::from(self.rest[k].energy(&corners(&self.particles[k], q)));
        sum(0..self.rest.len(), &of)
    }

    fn slots(&self, vertex: usize) -> impl Iterator<Item = (usize, usize)> {
        let range = self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize;
        self.slots[range].iter().map(|&k| (k as usize / 4, k as usize % 4))
    }
}

#[inline]
fn corners(particles: &[u32; 4], q: &Points) -> [Vec3; 4] {
    particles.map(|p| q.get(p as usize).into())
}
