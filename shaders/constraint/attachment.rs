//! A particle held at a point: a pin, or the target of a drag.
//!
//! A q = q_0, p = the target: W = w/2 |q_0 − target|². For a particle that must not give at all, take an infinite mass instead.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use super::{BLOCK, Constraint, DEVIATION};

/// Where a particle is held.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Attachment {
    /// The target \[m\].
    pub target: Vec3,
    /// Stiffness w \[N/m\].
    pub stiffness: f32,
}

impl Constraint<1, 1> for Attachment {
    const NAME: &'static str = "attachment";
    const WGSL: &'static [&'static str] = &[BLOCK, DEVIATION, include_str!("attachment.wgsl")];
    type Multiplier = Vec4;

    #[inline]
    fn weight(&self) -> f32 {
        self.stiffness
    }

    #[inline]
    fn column(&self, _slot: usize) -> [f32; 1] {
        [1.0]
    }

    #[inline]
    fn project(&self, _aq: [Vec3; 1]) -> [Vec3; 1] {
        [self.target]
    }

    #[inline]
    fn is_linear(&self) -> bool {
        true
    }

    fn set_target(&mut self, target: Vec3) {
        self.target = target;
    }

    #[inline]
    fn apply(&self, q: &[Vec3; 1]) -> [Vec3; 1] {
        *q
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulls_to_the_target() {
        let mut pin = Attachment { target: Vec3::ONE, stiffness: 4.0 };
        assert!(pin.is_linear());
        assert_eq!(pin.energy(&[Vec3::new(1.0, 1.0, 3.0)]), 8.0);
        assert_eq!(pin.energy(&[Vec3::ONE]), 0.0);
        pin.set_target(Vec3::ZERO);
        let q = [Vec3::new(0.0, 3.0, 4.0)];
        assert_eq!(pin.pull(0, &pin.residual(&q)), 4.0 * q[0]);
        assert_eq!(pin.deviation(&q), (5.0, [q[0] / 5.0]));
        assert_eq!(pin.entry(0, 0), 4.0);
    }
}
