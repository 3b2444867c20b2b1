//! Boxes around the ways of primitives.

use glam::Vec3;

/// Of a coordinate, more than its roundings add up to.
pub(crate) const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// An axis-aligned box \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Aabb {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

impl Aabb {
    pub(crate) const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Around the way from `a` to `b`, `margin` \[m\] wider on each side; never narrower for rounding.
    pub(crate) fn around(a: Vec3, b: Vec3, margin: f32) -> Self {
        let wider = |v: Vec3| Vec3::splat(margin) + ROUNDING * v.abs();
        let (min, max) = (a.min(b), a.max(b));
        Self { min: min - wider(min), max: max + wider(max) }
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The longest side \[m\].
    pub(crate) fn extent(self) -> f32 {
        (self.max - self.min).max_element()
    }

    pub(crate) fn center(self) -> Vec3 {
        0.5 * (self.min + self.max)
    }
}
