//! What acts on the particles from outside.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::{Model, ModelError};

/// Outer forces, and the damping of velocities.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Forces {
    /// Acceleration of every particle \[m/s²\].
    pub gravity: Vec3,
    /// Share of the velocity lost per second \[1/s\]: v is multiplied by exp(−damping · h).
    pub damping: f32,
    /// Wind on the triangles of the surface.
    pub wind: Option<Wind>,
}

/// A steady wind: each triangle is pushed by `drag` · area · (the relative velocity across it, and a tenth of that along it, which
/// is what keeps a flag taut).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wind {
    /// Velocity of the air \[m/s\].
    pub velocity: Vec3,
    /// Drag \[kg/(m² s)\].
    pub drag: f32,
}

impl Wind {
    /// Drag along a triangle, as a share of that across it \[1\].
    pub const SKIN: f32 = 0.1;
}

impl Default for Forces {
    fn default() -> Self {
        Self { gravity: Vec3::new(0.0, -9.81, 0.0), damping: 0.0, wind: None }
    }
}

impl Forces {
    /// Whether all values can be simulated.
    ///
    /// # Errors
    /// Values that are not finite; negative damping or drag.
    pub fn check(&self) -> Result<(), ModelError> {
        let wind = self.wind.unwrap_or(Wind { velocity: Vec3::ZERO, drag: 0.0 });
        let vectors = [("gravity", self.gravity), ("the velocity of the wind", wind.velocity)];
        for (what, value) in vectors {
            if !value.is_finite() {
                return Err(ModelError::Value { what, value: value.length(), need: "finite" });
            }
        }
        for (what, value) in [("damping", self.damping), ("the drag of the wind", wind.drag)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(ModelError::Value { what, value, need: "finite and not negative" });
            }
        }
        Ok(())
    }

    /// Adds what the wind does to each particle \[m/s²\] at these positions \[m\] and velocities \[m/s\].
    pub fn add_wind(
        &self,
        model: &Model,
        positions: &[Vec3],
        velocities: &[Vec3],
        accelerations: &mut [Vec3],
    ) {
        let Some(wind) = self.wind else { return };
        for triangle in model.surface() {
            let [a, b, c] = triangle.map(|p| positions[p as usize]);
            let twice_area = (b - a).cross(c - a);
            let Some(normal) = twice_area.try_normalize() else { continue };
            let mean = triangle.iter().map(|&p| velocities[p as usize]).sum::<Vec3>() / 3.0;
            let relative = wind.velocity - mean;
            let felt = Wind::SKIN * relative + (1.0 - Wind::SKIN) * relative.dot(normal) * normal;
            let force = felt * (wind.drag * 0.5 * twice_area.length());
            for &p in triangle {
                accelerations[p as usize] += force / (3.0 * model.masses()[p as usize]);
            }
        }
    }
}
