//! Any solid as an obstacle: its signed distance, sampled on a grid.

use glam::{DVec3, UVec3, Vec3};
use vivace_mesh::sdf::SignedDistance;

use crate::CollisionError;
use crate::obstacle::{MAX_POSITION, Seen};
use crate::parallel::for_each;

/// Values on a grid around a solid, linear along each axis in between. A feature finer than the spacing is lost.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The node with the smallest coordinates \[m\].
    min: Vec3,
    /// Edge of a cell \[m\].
    spacing: f32,
    /// Nodes along each axis.
    size: UVec3,
    /// Signed distances \[m\], x fastest.
    values: Vec<f32>,
    /// The largest slope of any cell \[1\].
    slope: f32,
}

/// Cells around the solid's box on each side.
const PAD: f64 = 2.0;

impl Field {
    /// Samples `solid` every `spacing` \[m\]. Its values have to be distances near its surface: those of
    /// [`ClosedSurface`](vivace_mesh::sdf::ClosedSurface), `Sphere` and `Cuboid` are. Takes at most `max_bytes`.
    ///
    /// # Errors
    /// [`CollisionError::Setting`] for a spacing that is not positive; [`CollisionError::Memory`] beyond `max_bytes`;
    /// [`CollisionError::Field`] for a solid whose box or values are not finite, or that has no inside on this grid.
    pub fn new(
        solid: &(impl SignedDistance + Sync),
        spacing: f32,
        max_bytes: u64,
    ) -> Result<Self, CollisionError> {
        if !(spacing > 0.0 && spacing.is_finite()) {
            let (what, need) = ("the spacing of a field [m]", "positive and finite");
            return Err(CollisionError::Setting { what, value: spacing, need });
        }
        let bounds = solid.bounds();
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        if !(reach <= f64::from(MAX_POSITION) && bounds.min.cmple(bounds.max).all()) {
            return Err(CollisionError::Field { fault: "its box is not finite, beyond 1e12 m, or empty" });
        }
        let step = f64::from(spacing);
        let min = (bounds.min - PAD * step).as_vec3();
        let nodes = ((bounds.max + PAD * step - min.as_dvec3()) / step).ceil() + 1.0;
        let bytes = 4.0 * nodes.element_product();
        if !(bytes <= max_bytes as f64 && nodes.max_element() <= f64::from(u32::MAX)) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
            let (cells, bytes) = (nodes.to_array().map(|n| n as u64 - 1), bytes as u64);
            return Err(CollisionError::Memory { cells, bytes, limit: max_bytes });
        }
        let size = nodes.as_uvec3();
        let [nx, ny, nz] = size.to_array().map(|n| n as usize);
        let mut values = vec![0.0; nx * ny * nz];
        for_each(&mut values, nx.max(64), &|idx, value: &mut f32| {
            let node = DVec3::new((idx % nx) as f64, (idx / nx % ny) as f64, (idx / nx / ny) as f64);
            #[expect(clippy::cast_possible_truncation, reason = "rounded")]
            let sample = solid.value(min.as_dvec3() + step * node) as f32;
            *value = sample;
        });
        if !values.iter().all(|value| value.is_finite()) {
            return Err(CollisionError::Field { fault: "a value is not finite" });
        }
        if values.iter().all(|value| *value > 0.0) {
            return Err(CollisionError::Field {
                fault: "it has no inside on this grid: take a finer spacing",
            });
        }
        let mut field = Self { min, spacing, size, values, slope: 1.0 };
        field.slope = field.steepest().max(1.0);
        Ok(field)
    }

    /// How many bytes the values take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice())
    }

    /// The first node \[m\], the distance between nodes \[m\], and how many there are along each axis.
    #[must_use]
    pub fn nodes(&self) -> (Vec3, f32, UVec3) {
        (self.min, self.spacing, self.size)
    }

    /// Signed distances at the nodes \[m\], x fastest.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Values at the corners of a cell, x fastest.
    fn corners(&self, cell: UVec3) -> [f32; 8] {
        let [nx, ny] = [self.size.x as usize, self.size.y as usize];
        let first = (cell.z as usize * ny + cell.y as usize) * nx + cell.x as usize;
        let (y, z) = (nx, nx * ny);
        [0, 1, y, y + 1, z, z + 1, z + y, z + y + 1].map(|k| self.values[first + k])
    }

    /// The largest slope of any cell: each part of a linear cell's gradient lies between its four edges'.
    fn steepest(&self) -> f32 {
        let mut steepest: f32 = 0.0;
        for z in 0..self.size.z - 1 {
            for y in 0..self.size.y - 1 {
                for x in 0..self.size.x - 1 {
                    let v = self.corners(UVec3::new(x, y, z));
                    let along = |bit: usize| {
                        let lows = (0..8).filter(|k| k & bit == 0);
                        lows.map(|k| (v[k | bit] - v[k]).abs()).fold(0.0, f32::max)
                    };
                    steepest = steepest.max(Vec3::new(along(1), along(2), along(4)).length());
                }
            }
        }
        steepest / self.spacing
    }

    /// The largest slope of any cell, 1 at least \[1\].
    #[must_use]
    pub fn slope(&self) -> f32 {
        self.slope
    }

    /// The value and its direction; beyond the grid, what is certain from the grid's box and the value on it.
    pub(crate) fn seen_from(&self, point: Vec3) -> Seen {
        let last = (self.size - 1).as_vec3();
        let at = (point - self.min) / self.spacing;
        let clamped = at.clamp(Vec3::ZERO, last);
        let cell = clamped.floor().min(last - 1.0);
        let f = clamped - cell;
        let v = self.corners(cell.as_uvec3());
        let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
        let x = [0, 2, 4, 6].map(|k| mix(v[k], v[k + 1], f.x));
        let y = [mix(x[0], x[1], f.y), mix(x[2], x[3], f.y)];
        let value = mix(y[0], y[1], f.z);
        let dx = [0, 2, 4, 6].map(|k| v[k + 1] - v[k]);
        let gradient = Vec3::new(
            mix(mix(dx[0], dx[1], f.y), mix(dx[2], dx[3], f.y), f.z),
            mix(x[1] - x[0], x[3] - x[2], f.z),
            y[1] - y[0],
        );
        let beyond = self.spacing * (at - clamped);
        let away = beyond.length();
        let normal = gradient.normalize_or(Vec3::Y);
        if away == 0.0 {
            return Seen { distance: value, normal };
        }
        let distance = away.max(value - away);
        Seen { distance, normal: (value * normal + beyond).normalize_or(normal) }
    }
}

#[cfg(test)]
mod tests {
    use vivace_mesh::sdf::{Bounds, Cuboid, Sphere};

    use super::*;

    #[test]
    fn a_sampled_sphere_is_a_sphere_within_its_spacing_squared() {
        let solid = Sphere { center: DVec3::new(3.0, -2.0, 1.0), radius: 1.0 };
        let field = Field::new(&solid, 0.05, 1 << 20).unwrap();
        assert!((1.0..1.74).contains(&field.slope()), "{}", field.slope());
        for k in 0..200 {
            let direction =
                Vec3::new((k % 7) as f32 - 3.0, (k % 11) as f32 - 5.0, (k % 5) as f32 - 1.5).normalize();
            for distance in [-0.3, -0.01, 0.02, 0.08] {
                let seen = field.seen_from(solid.center.as_vec3() + (1.0 + distance) * direction);
                assert!((seen.distance - distance).abs() < 2e-3, "{distance}: {seen:?}");
                assert!(seen.normal.distance(direction) < 0.1, "{direction}: {seen:?}");
            }
            // Beyond the grid it is a lower bound, and still positive.
            let far = field.seen_from(solid.center.as_vec3() + 5.0 * direction).distance;
            assert!(far > 0.5 && far < 4.01, "{far}");
        }
    }

    #[test]
    fn hostile_solids_and_spacings_are_refused() {
        let cuboid = Cuboid { center: DVec3::ZERO, half_extent: DVec3::splat(0.5) };
        let refused = |spacing, bytes| Field::new(&cuboid, spacing, bytes).unwrap_err().to_string();
        for spacing in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(refused(spacing, 1 << 20).contains("positive and finite"));
        }
        assert!(refused(1e-3, 1 << 20).contains("wider spacing"));
        assert!(refused(1e-30, u64::MAX).contains("wider spacing"));
        struct Odd(f64, f64);
        impl SignedDistance for Odd {
            fn value(&self, _: DVec3) -> f64 {
                self.0
            }
            fn bounds(&self) -> Bounds {
                Bounds::around(DVec3::ZERO, DVec3::splat(self.1))
            }
        }
        for (solid, fault) in [
            (Odd(1.0, 1.0), "no inside"),
            (Odd(f64::NAN, 1.0), "not finite"),
            (Odd(1.0, -1.0), "empty"),
            (Odd(1.0, f64::NAN), "not finite"),
            (Odd(1.0, 1e13), "1e12"),
        ] {
            let error = Field::new(&solid, 0.5, 1 << 20).unwrap_err().to_string();
            assert!(error.contains(fault), "{error}");
        }
    }
}
