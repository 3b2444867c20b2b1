//! What is held while it runs.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use vivace_model::{ModelError, State, Tear};
use vivace_scene::{Hold, Pose};

use crate::{SimError, Vec3};

/// Names particles that are held: see [`Simulation::grab`](crate::Simulation::grab).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Grab(pub(crate) u64);

/// Particles that are held, and where.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Patch {
    pub(crate) grab: Grab,
    pub(crate) particles: Vec<u32>,
    /// Where each was taken \[m\].
    pub(crate) taken_at: Vec<Vec3>,
    /// About which they are turned \[m\].
    pub(crate) middle: Vec3,
    pub(crate) hold: Hold,
    pub(crate) pose: Pose,
    /// The drag of the scene that leads them, if one does.
    pub(crate) drag: Option<usize>,
}

impl Patch {
    /// Its name.
    #[must_use]
    pub fn grab(&self) -> Grab {
        self.grab
    }

    /// The particles.
    #[must_use]
    pub fn particles(&self) -> &[u32] {
        &self.particles
    }

    /// How they are held.
    #[must_use]
    pub fn hold(&self) -> Hold {
        self.hold
    }

    /// By how much they are to be displaced from where they were taken.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Where each particle is to be \[m\].
    pub fn targets(&self) -> impl Iterator<Item = (u32, Vec3)> {
        let targets = self.taken_at.iter().map(|&at| self.pose.apply(self.middle, at));
        self.particles.iter().copied().zip(targets)
    }

    /// The middle of places \[m\].
    pub(crate) fn middle_of(places: &[Vec3]) -> Vec3 {
        let sum: DVec3 = places.iter().map(|at| at.as_dvec3()).sum();
        (sum / places.len().max(1) as f64).as_vec3()
    }

    /// What is pinned and torn stays pinned, its copies too.
    pub(crate) fn tear(&mut self, tears: &[Tear]) {
        for tear in tears {
            if let Tear::Split { particle, copy, .. } = *tear
                && self.hold == Hold::Pin
                && let Some(k) = self.particles.iter().position(|&held| held == particle)
            {
                self.particles.push(copy);
                self.taken_at.push(self.taken_at[k]);
            }
        }
    }

    /// Whether it can be among `n_particles`.
    pub(crate) fn check(&self, n_particles: usize) -> Result<(), SimError> {
        if self.particles.is_empty() || self.particles.len() != self.taken_at.len() {
            return Err(SimError::Nothing);
        }
        let mut particles = self.particles.clone();
        particles.sort_unstable();
        if let Some(pair) = particles.windows(2).find(|pair| pair[0] == pair[1]) {
            let (kind, particles) = ("a grab", pair.to_vec());
            return Err(ModelError::Degenerate { kind, element: 0, particles }.into());
        }
        let last = particles.last().copied().unwrap_or(0);
        if last as usize >= n_particles {
            let (kind, particle) = ("a grab", last.into());
            return Err(ModelError::Index { kind, element: 0, particle, n_particles }.into());
        }
        let length = self.pose.rotation.length();
        if (length - 1.0).abs() > 1e-3 || length.is_nan() {
            let what = "the length of a rotation";
            return Err(ModelError::Value { what, value: length, need: "1" }.into());
        }
        if let Hold::Spring(stiffness) = self.hold
            && !(stiffness > 0.0 && stiffness.is_finite())
        {
            let (what, need) = ("the stiffness of a grab [N/m]", "finite and positive");
            return Err(ModelError::Value { what, value: stiffness, need }.into());
        }
        match self.targets().find(|(_, target)| !State::is_in_range(*target)) {
            Some((particle, value)) => {
                let (what, particle) = ("targets of a grab", particle as usize);
                Err(ModelError::NotFinite { what, particle, value }.into())
            }
            None => Ok(()),
        }
    }
}
