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
        let from_here = point - self.position;
        // Most stand upright.
        if self.rotation == Quat::IDENTITY { from_here } else { self.rotation.conjugate() * from_here }
    }

    /// Where one is that has gone `part` of its way from here to `to`, evenly.
    fn toward(self, to: Self, part: f32) -> Self {
        if self == to || part <= 0.0 {
            return self;
        }
        if part >= 1.0 {
            return to;
        }
        let position = self.position.lerp(to.position, part);
        Self { position, rotation: self.rotation.slerp(to.rotation, part).normalize() }
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

/// A solid that the particles must stay out of. Over a step it moves from one pose to another, and no particle's way in the
/// solid's own coordinates, taken as straight, may lead into it.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// The solid.
    pub shape: Shape,
    /// Where it stands at the start of the step.
    pub from: Pose,
    /// Where it stands at the end of the step.
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

impl Obstacle {
    /// The same from one part of its way to another, each from 0 to 1.
    #[must_use]
    pub fn during(&self, from: f32, to: f32) -> Self {
        let at = |part: f32| self.from.toward(self.to, part);
        Self { from: at(from), to: at(to), ..self.clone() }
    }

    pub(crate) fn is_still(&self) -> bool {
        self.from == self.to
    }

    /// Whether there is such an obstacle, which is number `obstacle`.
    ///
    /// # Errors
    /// [`CollisionError::Obstacle`]: lengths, poses or friction that cannot be.
    pub fn check(&self, obstacle: usize) -> Result<(), CollisionError> {
        let lengths: &[f32] = match &self.shape {
            Shape::Plane | Shape::Field(_) => &[],
            Shape::Sphere { radius } => &[*radius],
            Shape::Capsule { half_length, radius } => &[*half_length, *radius],
            Shape::Cuboid { half_extent } => half_extent.as_ref(),
        };
        let is_length = |length: &f32| *length > 0.0 && *length <= MAX_POSITION;
        let fault = if !lengths.iter().all(is_length) {
            "its lengths must be positive, at most 1e12 m"
        } else if !(self.from.is_valid() && self.to.is_valid()) {
            "its poses need finite positions, at most 1e12 m along each axis, and rotations of length 1"
        } else if !(self.friction >= 0.0 && self.friction.is_finite()) {
            "its friction must be finite and not negative"
        } else {
            return Ok(());
        };
        Err(CollisionError::Obstacle { obstacle, fault })
    }
}

/// The surface as seen from a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Seen {
    /// Distance \[m\], negative inside; never more than it is.
    pub(crate) distance: f32,
    /// Out of the solid, of length 1.
    pub(crate) normal: Vec3,
}

impl Seen {
    /// By a vector from the nearest point of a core, and the core's radius.
    fn around(core: Vec3, radius: f32) -> Self {
        Self { distance: core.length() - radius, normal: core.normalize_or(Vec3::Y) }
    }
}

impl Shape {
    /// The distance of `point` and the direction in which it grows, in the solid's own coordinates \[m\].
    pub(crate) fn seen_from(&self, point: Vec3) -> Seen {
        match self {
            Self::Plane => Seen { distance: point.y, normal: Vec3::Y },
            Self::Sphere { radius } => Seen::around(point, *radius),
            Self::Capsule { half_length, radius } => {
                let core = Vec3::Y * point.y.clamp(-half_length, *half_length);
                Seen::around(point - core, *radius)
            }
            Self::Cuboid { half_extent } => cuboid(point, *half_extent),
            Self::Field(field) => field.seen_from(point),
        }
    }

    /// What the distance may change per metre, at most.
    fn slope(&self) -> f32 {
        match self {
            Self::Field(field) => field.slope(),
            _ => 1.0,
        }
    }

    /// Where on the segment from `a` to `b`, from part `from` of it on, the distance is first `level` \[m\] or less: marched in steps as long as the
    /// distance allows (Hart 1996), so nothing is jumped over but what is less than a tenth of `level` deep.
    pub(crate) fn first_within(&self, a: Vec3, b: Vec3, level: f32, from: f32) -> Option<f32> {
        const MAX_STEPS: usize = 1000;
        let speed = (b - a).length() * self.slope();
        let mut part = from;
        for _ in 0..MAX_STEPS {
            let left = self.seen_from(a.lerp(b, part)).distance - level;
            if left <= 0.0 {
                return Some(part);
            }
            let (step, to_go) = (left.max(0.1 * level), (1.0 - part) * speed);
            if left >= to_go {
                return None;
            }
            if step >= to_go {
                return (self.seen_from(b).distance <= level).then_some(1.0);
            }
            part += step / speed;
        }
        Some(part)
    }
}

fn cuboid(point: Vec3, half_extent: Vec3) -> Seen {
    let beyond = point.abs() - half_extent;
    let sign = Vec3::ONE.copysign(point);
    let outside = beyond.max(Vec3::ZERO);
    if outside != Vec3::ZERO {
        return Seen { distance: outside.length(), normal: (sign * outside).normalize_or(Vec3::Y) };
    }
    let axis = beyond.max_position();
    let mut normal = Vec3::ZERO;
    normal[axis] = sign[axis];
    Seen { distance: beyond[axis], normal }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parts of a way are even, begin and end where it does, and follow one another.
    #[test]
    fn a_way_in_parts_is_the_way() {
        let to = Pose { position: Vec3::new(4.0, -2.0, 1.0), rotation: Quat::from_rotation_y(1.0) };
        let whole = Obstacle { to, ..Obstacle::fixed(Shape::Plane, Pose::at(Vec3::X), 0.5) };
        assert_eq!(whole.during(0.0, 1.0), whole);
        let [first, last] = [whole.during(0.0, 0.25), whole.during(0.25, 1.0)];
        assert_eq!((first.from, first.to, last.to, first.friction), (whole.from, last.from, whole.to, 0.5));
        assert!(first.to.position.distance(Vec3::new(1.75, -0.5, 0.25)) < 1e-6, "{first:?}");
        assert!(first.to.rotation.angle_between(Quat::from_rotation_y(0.25)) < 1e-3, "{first:?}");
    }

    #[test]
    fn distances_by_hand() {
        let cuboid = Shape::Cuboid { half_extent: Vec3::new(1.0, 2.0, 3.0) };
        let capsule = Shape::Capsule { half_length: 1.0, radius: 0.5 };
        for (shape, point, distance, normal) in [
            (&Shape::Plane, Vec3::new(5.0, -2.0, 1.0), -2.0, Vec3::Y),
            (&Shape::Sphere { radius: 2.0 }, Vec3::new(0.0, 0.0, 3.0), 1.0, Vec3::Z),
            (&Shape::Sphere { radius: 2.0 }, Vec3::ZERO, -2.0, Vec3::Y),
            (&capsule, Vec3::new(2.0, 0.5, 0.0), 1.5, Vec3::X),
            (&capsule, Vec3::new(0.0, -3.0, 0.0), 1.5, Vec3::NEG_Y),
            (&cuboid, Vec3::new(-0.5, 0.0, 0.0), -0.5, Vec3::NEG_X),
            (&cuboid, Vec3::new(4.0, -6.0, 0.0), 5.0, Vec3::new(0.6, -0.8, 0.0)),
        ] {
            assert_eq!(shape.seen_from(point), Seen { distance, normal }, "{shape:?} {point}");
        }
    }

    #[test]
    fn nothing_thin_is_jumped_over() {
        let wall = Shape::Cuboid { half_extent: Vec3::new(0.001, 10.0, 10.0) };
        let part = wall.first_within(Vec3::new(-90.0, 1.0, 2.0), Vec3::new(310.0, 1.0, 2.0), 0.01, 0.0);
        assert!((part.unwrap() * 400.0 - 90.0 + 0.01).abs() < 0.02, "{part:?}");
        let beside = wall.first_within(Vec3::new(-100.0, 11.0, 2.0), Vec3::new(300.0, 11.0, 2.0), 0.01, 0.0);
        assert_eq!(beside, None);
    }
}
