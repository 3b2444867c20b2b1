//! The momentum of bodies that touch one another and nothing else.
//!
//! What acts within such an island acts in opposite pairs, so it cannot move the center from where that was predicted. Sweeps that have
//! not converged do: the diagonal of a light vertex is far beyond its inertia, and one side gives more than the other gets. So after the
//! sweeps an island is moved as a whole until its center is there. No gap between its bodies changes.

use glam::{DVec3, Vec3A};
use vivace_graph::DisjointSets;

use super::points::Points;
use super::rows::Rows;

/// The body that stands for all that does not move: what is pinned, targets, obstacles.
const OUTSIDE: u32 = 0;

/// Bodies, and which of them are together in a step.
#[derive(Debug, Default)]
pub(super) struct Islands {
    /// By vertex, from 1 on.
    bodies: Vec<u32>,
    n_bodies: u32,
    /// Bodies that are held.
    held: Vec<u32>,
    sets: DisjointSets,
    /// By body: Σ m (predicted − q) \[kg m\] and Σ m \[kg\] of the island that it is the first of; 0 where that has no contacts.
    moments: Vec<(DVec3, f64)>,
    has_contacts: Vec<bool>,
}

impl Islands {
    /// A body is what hangs together in `rows`; it is held if one of its vertices is among those `attached` or next to what is pinned.
    pub(super) fn new(rows: &Rows, attached: impl Iterator<Item = u32>) -> Self {
        // Rows are numbered in 32 bits.
        let n = u32::try_from(rows.len()).unwrap_or(u32::MAX);
        let neighbors = |i: u32| {
            let row = rows.offsets[i as usize] as usize..rows.offsets[i as usize + 1] as usize;
            rows.columns[row].iter().copied()
        };
        let mut sets = DisjointSets::new(n);
        for i in 0..n {
            neighbors(i).filter(|&j| j < n).for_each(|j| sets.unite(i, j));
        }
        let (mut bodies, mut n_bodies) = (vec![OUTSIDE; n as usize], OUTSIDE + 1);
        for i in 0..n {
            let first = sets.first(i);
            if first == i {
                bodies[i as usize] = n_bodies;
                n_bodies += 1;
            } else {
                bodies[i as usize] = bodies[first as usize];
            }
        }
        let beside_pins = (0..n).filter(|&i| neighbors(i).any(|j| j >= n));
        let held = beside_pins.chain(attached).filter_map(|i| bodies.get(i as usize).copied());
        let mut held: Vec<u32> = held.collect();
        held.sort_unstable();
        held.dedup();
        Self { bodies, n_bodies, held, ..Self::default() }
    }

    /// Takes the contacts of a step by their particles, which are the same four times against an obstacle.
    pub(super) fn update(&mut self, contacts: impl Iterator<Item = [u32; 4]> + Clone) {
        self.sets.reset(self.n_bodies);
        self.held.iter().for_each(|&body| self.sets.unite(OUTSIDE, body));
        let body = |p: u32| self.bodies.get(p as usize).copied().unwrap_or(OUTSIDE);
        for particles in contacts.clone() {
            let [a, b, c, d] = particles.map(body);
            let other = if particles[0] == particles[1] { OUTSIDE } else { d };
            [b, c, other].into_iter().for_each(|other| self.sets.unite(a, other));
        }
        self.has_contacts.clear();
        self.has_contacts.resize(self.n_bodies as usize, false);
        for p in contacts.flatten() {
            self.has_contacts[self.sets.first(body(p)) as usize] = true;
        }
        self.has_contacts[OUTSIDE as usize] = false;
    }

    /// Moves what has contacts and is held by nothing to where it was predicted, as a whole.
    pub(super) fn put_back(&mut self, masses: &[f32], predicted: &Points, q: &mut Points) {
        if !self.has_contacts.contains(&true) {
            return;
        }
        self.moments.clear();
        self.moments.resize(self.n_bodies as usize, (DVec3::ZERO, 0.0));
        for (i, &body) in self.bodies.iter().enumerate() {
            let (way, mass) = &mut self.moments[self.sets.first(body) as usize];
            *way += (predicted.get(i) - q.get(i)).as_dvec3() * f64::from(masses[i]);
            *mass += f64::from(masses[i]);
        }
        for (i, &body) in self.bodies.iter().enumerate() {
            let first = self.sets.first(body) as usize;
            if self.has_contacts[first] {
                let (way, mass) = self.moments[first];
                q.set(i, q.get(i) + Vec3A::from((way / mass).as_vec3()));
            }
        }
    }
}
