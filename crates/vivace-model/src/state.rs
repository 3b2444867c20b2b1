//! Where the particles are, and how they move.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::{Model, ModelError, Tear};

/// Positions and velocities, one of each for every particle of a [`Model`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// q \[m\].
    pub positions: Vec<Vec3>,
    /// v \[m/s\].
    pub velocities: Vec<Vec3>,
}

/// Positions beyond this \[m\] are refused: their squares would leave the range of `f32`.
const MAX_POSITION: f32 = 1e12;

impl State {
    /// At rest in these positions \[m\].
    #[must_use]
    pub fn at_rest(positions: Vec<Vec3>) -> Self {
        let velocities = vec![Vec3::ZERO; positions.len()];
        Self { positions, velocities }
    }

    /// Copies inherit position and velocity: see [`Model::tear`].
    ///
    /// # Panics
    /// When the tears are not those of this state's model.
    pub fn tear(&mut self, tears: &[Tear]) {
        for tear in tears {
            if let Tear::Split { particle, .. } = *tear {
                self.positions.push(self.positions[particle as usize]);
                self.velocities.push(self.velocities[particle as usize]);
            }
        }
    }

    /// Whether a position \[m\] or velocity \[m/s\] is one that a step can start from: a number, at most 10¹² along each axis. The one
    /// bound for states, models and targets.
    #[must_use]
    pub fn is_in_range(v: Vec3) -> bool {
        !v.is_nan() && v.abs().max_element() <= MAX_POSITION
    }

    /// Whether a solver may take this as the state of `model`.
    ///
    /// # Errors
    /// Arrays of a wrong length; the first particle whose position or velocity is not finite, or is beyond 10¹² m or m/s.
    pub fn check(&self, model: &Model) -> Result<(), ModelError> {
        let n = model.n_particles();
        for (what, values) in [("positions", &self.positions), ("velocities", &self.velocities)] {
            if values.len() != n {
                return Err(ModelError::Length { what, expected: n, found: values.len() });
            }
            if let Some(particle) = values.iter().position(|v| !Self::is_in_range(*v)) {
                return Err(ModelError::NotFinite { what, particle, value: values[particle] });
            }
        }
        Ok(())
    }
}
