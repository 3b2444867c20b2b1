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

#[cfg(test)]
mod tests {
    use vivace_mesh::cloth;

    use super::*;
    use crate::ModelBuilder;

    /// A sheet in the xz plane.
    fn sheet(density: f32) -> (Model, Vec<DVec3>) {
        let mesh = cloth::alternating(5, 4, 0.1).unwrap();
        let mut builder = ModelBuilder::new();
        builder.cloth(&mesh, density).unwrap();
        let (model, state) = builder.build().unwrap();
        (model, state.positions.iter().map(|q| q.as_dvec3()).collect())
    }

    /// Velocities after gravity and wind alone.
    fn blown(forces: &Forces, model: &Model, h: f64, q: &[DVec3], v: &[DVec3]) -> Vec<DVec3> {
        let mut after: Vec<DVec3> = v.iter().map(|v| *v + h * forces.gravity.as_dvec3()).collect();
        forces.add_wind(model, h, q, v, &mut Vec::new(), |i, a| after[i] += h * a);
        after
    }

    /// Gusts that differ from particle to particle.
    fn gust(i: usize) -> DVec3 {
        let i = i as f64;
        10.0 * DVec3::new((7.0 * i).sin(), (11.0 * i).sin(), (13.0 * i).sin())
    }

    #[test]
    fn relative_velocity_never_grows_nor_turns() {
        let wind = Wind { velocity: Vec3::new(1.0, 2.0, 3.0), drag: 8.0 };
        let still = Forces { gravity: Vec3::ZERO, wind: Some(wind), ..Forces::default() };
        for density in [1e-6, 0.05, 1e3] {
            let (model, q) = sheet(density);
            let normal = (q[1] - q[0]).cross(q[6] - q[0]).normalize();
            for h in [1e-4, 1.0 / 30.0, 1000.0] {
                let v: Vec<DVec3> = (0..q.len()).map(gust).collect();
                for (before, after) in v.iter().zip(blown(&still, &model, h, &q, &v)) {
                    let relative = |v: DVec3| v - wind.velocity.as_dvec3();
                    let (before, after) = (relative(*before), relative(after));
                    let c = h * f64::from(wind.drag) / f64::from(density);
                    let (across, along) = (before.dot(normal) * normal, before.reject_from(normal));
                    let expected = across / (1.0 + c) + along / (1.0 + c * f64::from(Wind::SKIN));
                    assert!((after - expected).length() <= 1e-6 * before.length(), "{density} {h}");
                    assert!(after.length() < before.length() && after.dot(before) > 0.0, "{density} {h}");
                }
            }
        }
    }

    #[test]
    fn a_sheet_falls_as_fast_as_drag_lets_it() {
        let (model, q) = sheet(0.2);
        let (density, drag) = (0.2_f64, 5.0_f64);
        let wind = Wind { velocity: Vec3::ZERO, drag: 5.0 };
        // Flat on the air, and edge on.
        for (gravity, share) in [(-10.0 * Vec3::Y, 1.0), (-10.0 * Vec3::Z, f64::from(Wind::SKIN))] {
            let forces = Forces { gravity, wind: Some(wind), ..Forces::default() };
            let mut v = vec![DVec3::ZERO; q.len()];
            for _ in 0..2000 {
                v = blown(&forces, &model, 0.1, &q, &v);
            }
            let fastest = gravity.as_dvec3() * density / (drag * share);
            assert!(v.iter().all(|v| (*v - fastest).length() < 1e-5 * fastest.length()), "{v:?}");
        }
    }

    #[test]
    fn what_is_pinned_or_without_wind_is_left_alone() {
        let mesh = cloth::regular(2, 2, 1.0).unwrap();
        let mut builder = ModelBuilder::new();
        builder.cloth(&mesh, 0.2).unwrap();
        builder.pin(1).unwrap();
        let (model, state) = builder.build().unwrap();
        let mut forces = Forces::default();
        let (mut drags, mut seen) = (Vec::new(), Vec::new());
        let (q, v) = (&state.positions, &state.velocities);
        forces.add_wind(&model, 0.1, q, v, &mut drags, |i, _| seen.push(i));
        assert!(seen.is_empty() && drags.capacity() == 0);
        forces.wind = Some(Wind { velocity: Vec3::ONE, drag: 1.0 });
        forces.add_wind(&model, 0.1, q, v, &mut drags, |i, _| seen.push(i));
        assert_eq!(seen, [0, 2, 3]);
    }
}
