//! Signed distance functions: which points belong to a solid.
//!
//! A value is a length \[m\], negative inside. Only the zero level has to be right: away from it the value may be any length
//! of the right sign, as it is for smooth unions. Points are `f64`, whatever the precision of the source.

mod basic;
mod blend;
mod surface;
mod winding;

use glam::DVec3;

use crate::MeshError;

pub use basic::{Cuboid, Sphere};
pub use blend::Blend;
pub use surface::ClosedSurface;

/// The text of an armored animal, 1 m high, that stands in for the Stanford Armadillo: read it as a [`Blend`].
pub const DILLO: &str = include_str!("../../shapes/dillo.txt");
/// The text of a hare that stands in for the Stanford Bunny: read it as a [`Blend`].
pub const HARE: &str = include_str!("../../shapes/hare.txt");
/// The text of an armchair, 1.09 m high, that faces +z and stands on y = 0: read it as a [`Blend`].
pub const ARMCHAIR: &str = include_str!("../../shapes/armchair.txt");

/// A solid given by a function that is negative inside it.
pub trait SignedDistance {
    /// The value at `point` \[m\]: negative inside, zero on the surface.
    fn value(&self, point: DVec3) -> f64;

    /// A box that contains every point with a negative value; it may be larger than needed.
    fn bounds(&self) -> Bounds;

    /// Bounds `(low, high)` of the values within `radius` \[m\] of `center`. They must hold, but need not be tight; where they
    /// have one sign, nobody asks for the values in between. The default knows nothing.
    fn range(&self, center: DVec3, radius: f64) -> (f64, f64) {
        let _ = (center, radius);
        (f64::NEG_INFINITY, f64::INFINITY)
    }
}

impl<S: SignedDistance + ?Sized> SignedDistance for &S {
    fn value(&self, point: DVec3) -> f64 {
        (**self).value(point)
    }

    fn bounds(&self) -> Bounds {
        (**self).bounds()
    }

    fn range(&self, center: DVec3, radius: f64) -> (f64, f64) {
        (**self).range(center, radius)
    }
}

/// An axis-aligned box \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates \[m\].
    pub min: DVec3,
    /// The corner with the largest coordinates \[m\].
    pub max: DVec3,
}

impl Bounds {
    /// The box that contains nothing: a start for [`Bounds::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The box around `center` that reaches `half_extent` \[m\] to each side.
    pub fn around(center: DVec3, half_extent: DVec3) -> Self {
        Self { min: center - half_extent, max: center + half_extent }
    }

    /// The smallest box that contains both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Edge lengths \[m\].
    pub fn size(self) -> DVec3 {
        self.max - self.min
    }

    /// # Errors
    /// [`MeshError::BadBounds`] unless the box is finite and its corners are in order.
    pub(crate) fn check(self) -> Result<(), MeshError> {
        let Self { min, max } = self;
        if min.is_finite() && max.is_finite() && self.size().is_finite() && min.cmple(max).all() {
            return Ok(());
        }
        Err(MeshError::BadBounds { min: min.to_array(), max: max.to_array() })
    }
}
