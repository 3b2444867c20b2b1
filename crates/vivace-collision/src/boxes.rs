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

    /// With `point` in it.
    pub(crate) fn including(self, point: Vec3) -> Self {
        self.union(Self { min: point, max: point })
    }

    pub(crate) fn meets(self, other: Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Around all of its way, if it goes as far as `way` \[m\] beside; never narrower for rounding.
    pub(crate) fn stretched(self, way: Vec3) -> Self {
        let wider = ROUNDING * way.abs();
        Self { min: self.min + way.min(Vec3::ZERO) - wider, max: self.max + way.max(Vec3::ZERO) + wider }
    }

    /// The longest side \[m\].
    pub(crate) fn extent(self) -> f32 {
        (self.max - self.min).max_element()
    }

    pub(crate) fn center(self) -> Vec3 {
        0.5 * (self.min + self.max)
    }
}
