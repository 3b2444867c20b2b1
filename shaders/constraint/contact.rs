//! A contact: a distance that must be kept along a normal. Who projects it holds it across that too, by Coulomb's friction.
//!
//! A q = Σ a q, the place of one side as seen from the other. p is the nearest place to A q that is at least the distance out along
//! the normal n.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use super::Constraint;

/// The data of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Contact {
    /// a: what each particle counts \[1\]. They add up to 0 between bodies; (1, 0, 0, 0) against an obstacle.
    pub weights: Vec4,
    /// n, of length 1 \[1\].
    pub normal: Vec3,
    /// The least distance \[m\].
    pub distance: f32,
    /// What the distance is measured from \[m\]; 0 between bodies.
    pub origin: Vec3,
    /// Stiffness w \[N/m\].
    pub stiffness: f32,
    /// A q at the start of the (small) step, moved along with an obstacle \[m\].
    pub start: Vec3,
    /// Coulomb's coefficient \[1\].
    pub friction: f32,
}

impl Contact {
    /// d \[m\], negative where there is a gap.
    #[inline]
    #[must_use]
    pub fn depth(&self, aq: Vec3) -> f32 {
        self.distance - self.normal.dot(aq - self.origin)
    }

    /// How far `aq` has slipped across the normal since the start of the (small) step \[m\].
    #[inline]
    #[must_use]
    pub fn slip(&self, aq: Vec3) -> Vec3 {
        let moved = aq - self.start;
        moved - self.normal * self.normal.dot(moved)
    }

    /// Whether one side is an obstacle.
    #[inline]
    fn is_outer(&self) -> bool {
        self.weights.y == 0.0 && self.weights.z == 0.0 && self.weights.w == 0.0
    }
}

impl Constraint<4, 1> for Contact {
    const NAME: &'static str = "contact";
    // A device has contacts of its own: `crate::collision`.
    const WGSL: &'static [&'static str] = &[];
    type Multiplier = f32;

    #[inline]
    fn weight(&self) -> f32 {
        self.stiffness
    }

    #[inline]
    fn column(&self, slot: usize) -> [f32; 1] {
        [self.weights[slot]]
    }

    #[inline]
    fn project(&self, [aq]: [Vec3; 1]) -> [Vec3; 1] {
        [aq + self.normal * self.depth(aq).max(0.0)]
    }

    #[inline]
    fn apply(&self, q: &[Vec3; 4]) -> [Vec3; 1] {
        if self.is_outer() {
            return [self.weights.x * q[0]];
        }
        let [a, b, c] = [1, 2, 3].map(|slot| self.weights[slot] * (q[slot] - q[0]));
        [a + b + c]
    }

    /// C = −d where that is negative, and 0; without friction.
    #[inline]
    fn deviation(&self, q: &[Vec3; 4]) -> (f32, [Vec3; 4]) {
        let [aq] = self.apply(q);
        let c = (-self.depth(aq)).min(0.0);
        let n = if c < 0.0 { self.normal } else { Vec3::ZERO };
        (c, std::array::from_fn(|slot| n * self.weights[slot]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the plane y = 1, to be kept by 0.5, from x = 3 on.
    const FLOOR: Contact = Contact {
        weights: Vec4::X,
        normal: Vec3::Y,
        distance: 0.5,
        origin: Vec3::Y,
        stiffness: 2.0,
        start: Vec3::new(3.0, 1.0, 0.0),
        friction: 0.5,
    };

    fn at(x: f32, y: f32) -> [Vec3; 4] {
        [Vec3::new(x, y, 0.0); 4]
    }

    #[test]
    fn what_is_apart_is_left_alone() {
        let q = at(9.0, 1.75);
        assert_eq!((FLOOR.energy(&q), FLOOR.deviation(&q)), (0.0, (0.0, [Vec3::ZERO; 4])));
        assert_eq!(FLOOR.project(FLOOR.apply(&q)), [q[0]]);
    }

    #[test]
    fn what_is_too_near_is_put_out_along_the_normal() {
        let q = at(4.0, 1.25);
        assert_eq!(FLOOR.project(FLOOR.apply(&q)), [Vec3::new(4.0, 1.5, 0.0)]);
        assert_eq!((FLOOR.energy(&q), FLOOR.deviation(&q).0), (0.0625, -0.25));
        assert_eq!(FLOOR.slip(q[0]), Vec3::X);
    }

    #[test]
    fn far_from_the_origin_nothing_cancels() {
        let far = Vec3::splat(1e6);
        let between = Contact { weights: Vec4::new(1.0, -0.5, -0.25, -0.25), origin: Vec3::ZERO, ..FLOOR };
        let q = [Vec3::new(0.25, 0.5, 0.0), Vec3::ZERO, Vec3::X, Vec3::Z];
        assert_eq!(between.apply(&q.map(|q| q + far)), between.apply(&q));
    }
}
