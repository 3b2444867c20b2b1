//! A spring between two particles (Liu et al. 2013).
//!
//! A q = q_1 − q_0, p = its direction times the rest length: W = k/2 (|q_1 − q_0| − l)².

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3};
use wide::f32x4;

use super::{APPLY, BATCH, Constraint, Deviations};
use crate::lanes::{Lanes3, each};

/// The rest data of a spring.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Spring {
    /// Rest length l \[m\].
    pub rest: f32,
    /// Stiffness k \[N/m\].
    pub stiffness: f32,
}

impl Constraint<2, 1> for Spring {
    const NAME: &'static str = "spring";
    const WGSL: &'static [&'static str] = &[APPLY, include_str!("spring.wgsl")];
    type Multiplier = f32;

    #[inline]
    fn weight(&self) -> f32 {
        self.stiffness
    }

    #[inline]
    fn column(&self, slot: usize) -> [f32; 1] {
        [if slot == 0 { -1.0 } else { 1.0 }]
    }

    #[inline]
    fn project(&self, [d]: [Vec3; 1]) -> [Vec3; 1] {
        let length = d.length();
        // Coincident ends have no direction: any is nearest, and none keeps the momentum.
        [if length > 0.0 { d * (self.rest / length) } else { Vec3::ZERO }]
    }

    /// k (u uᵀ + max(0, 1 − l/|d|) (I − u uᵀ)): along the spring stiff, across it only under tension.
    #[inline]
    fn block(&self, q: &[Vec3; 2], _slot: usize) -> Mat3 {
        let d = q[1] - q[0];
        let length = d.length();
        if length == 0.0 {
            return Mat3::from_diagonal(Vec3::splat(self.stiffness));
        }
        let u = d / length;
        let across = (1.0 - self.rest / length).max(0.0);
        let along = self.stiffness * (1.0 - across);
        Mat3::from_cols(u * (along * u.x), u * (along * u.y), u * (along * u.z))
            + Mat3::from_diagonal(Vec3::splat(self.stiffness * across))
    }

    /// C = |d| − l, signed: a spring that goes from tension to compression keeps its multiplier.
    #[inline]
    fn deviation(&self, q: &[Vec3; 2]) -> (f32, [Vec3; 2]) {
        let d = q[1] - q[0];
        let length = d.length();
        let u = if length > 0.0 { d / length } else { Vec3::ZERO };
        (length - self.rest, [-u, u])
    }

    #[inline]
    fn deviations(rest: &[Self; BATCH], q: &[Lanes3<f32x4>; 2]) -> Option<Deviations<2>> {
        let d = q[1] - q[0];
        let length = d.length();
        let u = d * (f32x4::ONE / length);
        let c = length - each(rest, |rest| rest.rest);
        Some(Deviations { c, gradient: [-u, u], squared: [f32x4::ONE; 2] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPRING: Spring = Spring { rest: 2.0, stiffness: 3.0 };

    #[test]
    fn energy_and_gradient_of_a_stretched_spring() {
        let q = [Vec3::ZERO, Vec3::new(0.0, 3.0, 0.0)];
        assert!((SPRING.energy(&q) - 1.5).abs() < 1e-6);
        let residual = SPRING.residual(&q);
        assert!((SPRING.pull(1, &residual) - Vec3::new(0.0, 3.0, 0.0)).length() < 1e-6);
        assert!((SPRING.pull(0, &residual) + SPRING.pull(1, &residual)).length() < 1e-6);
    }

    #[test]
    fn block_is_the_derivative_of_the_gradient() {
        let q = [Vec3::new(0.1, -0.2, 0.3), Vec3::new(1.4, 1.5, 1.6)];
        let (block, step) = (SPRING.block(&q, 1), 1e-3);
        for axis in 0..3 {
            let e = Vec3::AXES[axis] * step;
            let at = |e: Vec3| SPRING.pull(1, &SPRING.residual(&[q[0], q[1] + e]));
            let difference = (at(e) - at(-e)) / (2.0 * step);
            assert!((block.col(axis) - difference).length() < 2e-3, "{axis}: {block} {difference}");
        }
    }

    #[test]
    fn coincident_ends_stay_finite() {
        let q = [Vec3::ONE; 2];
        assert_eq!(SPRING.project(SPRING.apply(&q)), [Vec3::ZERO]);
        assert!(SPRING.block(&q, 0).is_finite());
    }
}
