//! What detection finds, and what it says of itself.

use glam::Vec3;

/// One contact, an inequality of positions q \[m\]: `normal · (Σ weights[k] · q[particles[k]] − origin) ≥ distance`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Particles: a point, then a triangle's corners; or the ends of one edge, then of the other. Against an obstacle, the
    /// first four times.
    pub particles: [u32; 4],
    /// They add up to 0 between two primitives of bodies, the first side's being positive; (1, 0, 0, 0) against an obstacle \[1\].
    pub weights: [f32; 4],
    /// Unit vector towards the first side, or out of the obstacle \[1\].
    pub normal: Vec3,
    /// Point of an obstacle's surface at the end of the frame \[m\]; 0 between bodies.
    pub origin: Vec3,
    /// Velocity of the obstacle's surface there \[m/s\]; 0 between bodies.
    pub velocity: Vec3,
    /// The least distance to be kept \[m\].
    pub distance: f32,
    /// Coulomb's coefficient \[1\].
    pub friction: f32,
}

impl Contact {
    /// `normal · (Σ weights · q − origin) − distance` \[m\]: negative where the contact is violated.
    ///
    /// # Panics
    /// If a particle is not one of `positions` \[m\].
    #[must_use]
    pub fn gap(&self, positions: &[Vec3]) -> f32 {
        let q = self.particles.map(|p| positions[p as usize]);
        // Relative to the first particle, so that nothing cancels far from the origin.
        let base = if self.weights[1..] == [0.0; 3] { self.origin } else { q[0] };
        let sum: Vec3 = (0..4).map(|k| self.weights[k] * (q[k] - base)).sum();
        self.normal.dot(sum) - self.distance
    }
}

/// What one call of [`Detector::detect`](crate::Detector::detect) or [`Detector::limit`](crate::Detector::limit) did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Report {
    /// Pairs of primitives that a quick look could not tell to stay apart, neighbors left out.
    pub candidates: usize,
    /// Contacts found; of `limit`: particles that were held back.
    pub contacts: usize,
    /// Contacts beyond [`Options::max_contacts`](crate::Options::max_contacts), which were left out.
    pub left_out: usize,
    /// Rounds of `limit`; 1 if nothing hit, 0 of `detect`.
    pub rounds: usize,
    /// Seconds in each phase.
    pub times: Times,
}

/// Seconds spent in each phase.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Times {
    /// Boxes, grids, pairs that may come near; of `limit`, all but obstacles.
    pub broad: f64,
    /// Distances and times of impact of these pairs.
    pub narrow: f64,
    /// Obstacles.
    pub obstacles: f64,
}
