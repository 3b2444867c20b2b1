//! Solids with a closed formula: sphere and box. Both functions are exact distances.

use glam::DVec3;

use super::{Bounds, SignedDistance};

/// A ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Its center \[m\].
    pub center: DVec3,
    /// Its radius \[m\].
    pub radius: f64,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    /// Its center \[m\].
    pub center: DVec3,
    /// Half of its edge lengths \[m\].
    pub half_extent: DVec3,
}

impl SignedDistance for Sphere {
    fn value(&self, point: DVec3) -> f64 {
        point.distance(self.center) - self.radius
    }

    fn bounds(&self) -> Bounds {
        Bounds::around(self.center, DVec3::splat(self.radius))
    }

    fn range(&self, center: DVec3, radius: f64) -> (f64, f64) {
        exact_range(self.value(center), radius)
    }
}

impl SignedDistance for Cuboid {
    fn value(&self, point: DVec3) -> f64 {
        let beyond = (point - self.center).abs() - self.half_extent;
        beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
    }

    fn bounds(&self) -> Bounds {
        Bounds::around(self.center, self.half_extent)
    }

    fn range(&self, center: DVec3, radius: f64) -> (f64, f64) {
        exact_range(self.value(center), radius)
    }
}

/// An exact distance changes by at most the way gone.
fn exact_range(value: f64, radius: f64) -> (f64, f64) {
    (value - radius, value + radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_distance_by_hand() {
        let cuboid = Cuboid { center: DVec3::new(1.0, 0.0, 0.0), half_extent: DVec3::new(1.0, 2.0, 3.0) };
        assert_eq!(cuboid.value(DVec3::new(1.0, 0.0, 0.0)), -1.0);
        assert_eq!(cuboid.value(DVec3::new(1.5, 0.0, 0.0)), -0.5);
        assert_eq!(cuboid.value(DVec3::new(2.0, 0.0, 0.0)), 0.0);
        assert_eq!(cuboid.value(DVec3::new(5.0, 6.0, 0.0)), 5.0);
    }

    #[test]
    fn sphere_range_holds() {
        let sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };
        assert_eq!(sphere.range(DVec3::X * 3.0, 0.5), (1.5, 2.5));
    }
}
