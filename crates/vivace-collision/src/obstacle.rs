//! Solids that stand still or move as they are told.

use std::sync::Arc;

use glam::{Quat, Vec3};

use crate::{CollisionError, Field};

/// Where a rigid solid stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Where its own origin lies \[m\].
    pub position: Vec3,
    /// How it is turned, of length 1.
    pub rotation: Quat,
}

impl Pose {
    /// At the origin, not turned.
    pub const IDENTITY: Self = Self { position: Vec3::ZERO, rotation: Quat::IDENTITY };

    /// Not turned.
    #[must_use]
    pub fn at(position: Vec3) -> Self {
        Self { position, ..Self::IDENTITY }
    }

    pub(crate) fn to_world(self, point: Vec3) -> Vec3 {
        self.rotation * point + self.position
    }

    pub(crate) fn to_local(self, point: Vec3) -> Vec3 {
        self.rotation.conjugate() * (point - self.position)
    }

    fn is_valid(self) -> bool {
        self.position.abs().max_element() <= MAX_POSITION
            && self.position.is_finite()
            && self.rotation.is_finite()
            && self.rotation.is_normalized()
    }
}

/// Positions beyond this \[m\] are refused: their squares would leave the range of `f32`.
pub(crate) const MAX_POSITION: f32 = 1e12;

/// A solid in its own coordinates.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// The half space y ≤ 0.
    Plane,
    /// A ball around the origin.
    Sphere {
        /// Its radius \[m\].
        radius: f32,
    },
    /// All that is within `radius` of the y axis from −`half_length` to `half_length`.
    Capsule {
        /// Half the length of the straight part \[m\].
        half_length: f32,
        /// Its radius \[m\].
        radius: f32,
    },
    /// A box around the origin.
    Cuboid {
        /// Half of its edge lengths \[m\].
        half_extent: Vec3,
    },
    /// Any solid, sampled. Shared, so that a clone costs nothing.
    Field(Arc<Field>),
}

/// A solid that the particles must stay out of. Over a frame it moves from one pose to another, and no particle's way in the
/// solid's own coordinates, taken as straight, may lead into it.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// The solid.
    pub shape: Shape,
    /// Where it stands at the start of the frame.
    pub from: Pose,
    /// Where it stands at the end of the frame.
    pub to: Pose,
    /// Coulomb's coefficient \[1\].
    pub friction: f32,
}

impl Obstacle {
    /// One that stands still.
    #[must_use]
    pub fn fixed(shape: Shape, pose: Pose, friction: f32) -> Self {
        Self { shape, from: pose, to: pose, friction }
    }
}
