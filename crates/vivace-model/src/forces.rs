//! What acts on the particles from outside.

use glam::{DMat3, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use crate::{Model, ModelError};

/// Outer forces, and the damping of velocities.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Forces {
    /// Acceleration of every particle \[m/s²\].
    pub gravity: Vec3,
    /// Rate at which velocities decay \[1/s\]: after each (small) step of h v is multiplied by exp(−damping · h).
    pub damping: f32,
    /// Wind on the triangles of the surface.
    pub wind: Option<Wind>,
}

/// A steady wind: each triangle is pushed by `drag` · area · (the relative velocity across it, and a tenth of that along it, which
/// is what keeps a flag taut). A third of it goes to each corner, by that corner's own velocity (Provot 1995, with the part along
/// the triangle added): D (w − v), where D sums `drag` · area / 3 · (0.1 I + 0.9 n nᵀ) over a particle's triangles.
///
/// The force is that at the end of the prediction, backward Euler on the triangles as they lie at its start:
/// (m + h D) v' = m (v + h g) + h D w, one 3 × 3 system for each particle. So what a particle's velocity differs from the wind's
/// never grows by it nor changes sign, for any drag, mass and h, and a free fall ends at m g / D exactly.
///
/// Limits: drag is linear in the velocity, the same on both sides, without lift, and no triangle shelters another. It is of first order
/// in h: where h · drag · area / mass is far above 1, a cloth takes up the wind's velocity within a step.
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

    /// Shows to `add` the acceleration by the wind \[m/s²\] of each particle that it pushes, over a time step of `h` \[s\] from these
    /// positions \[m\] and velocities \[m/s\]: see [`Wind`]. `drags` is scratch. No wind, no cost.
    pub fn add_wind<V: Copy + Into<DVec3>>(
        &self,
        model: &Model,
        h: f64,
        positions: &[V],
        velocities: &[V],
        drags: &mut Vec<DMat3>,
        mut add: impl FnMut(usize, DVec3),
    ) {
        let Some(wind) = self.wind else { return };
        drags.clear();
        drags.resize(model.n_particles(), DMat3::ZERO);
        for triangle in model.surface() {
            let [a, b, c]: [DVec3; 3] = triangle.map(|p| positions[p as usize].into());
            let drag = wind.drag_of(a, b, c);
            triangle.iter().for_each(|&p| drags[p as usize] += drag);
        }
        for (particle, (drag, &mass)) in drags.iter().zip(model.masses()).enumerate() {
            if *drag != DMat3::ZERO && mass.is_finite() {
                let falling = velocities[particle].into() + h * self.gravity.as_dvec3();
                let implicit = DMat3::from_diagonal(DVec3::splat(mass.into())) + h * *drag;
                add(particle, implicit.inverse() * (*drag * (wind.velocity.as_dvec3() - falling)));
            }
        }
    }
}

impl Wind {
    /// A corner's third of the drag of a triangle \[kg/s\], by which the relative velocity is multiplied.
    fn drag_of(&self, a: DVec3, b: DVec3, c: DVec3) -> DMat3 {
        let twice_area = (b - a).cross(c - a);
        let Some(normal) = twice_area.try_normalize() else { return DMat3::ZERO };
        let skin = f64::from(Self::SKIN);
        let across = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        (DMat3::IDENTITY * skin + across * (1.0 - skin)) * (f64::from(self.drag) * twice_area.length() / 6.0)
    }
}
