//! A spring between two particles (Liu et al. 2013).
//!
//! A q = q_1 − q_0, p = its direction times the rest length: W = k/2 (|q_1 − q_0| − l)².

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3, Vec3A, Vec4};

use super::{Constraint, Xpbd};

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

    /// |∇C| = 1 at both ends. The same arithmetic as one lane of [`Spring::correct_all`].
    #[inline]
    fn correct(&self, particles: &[u32; 2], xpbd: &Xpbd<'_>, q: &[Vec3A], lambda: &mut f32) -> [Vec3A; 2] {
        let [a, b] = particles.map(|p| p as usize);
        let d = q[b] - q[a];
        let w = [xpbd.inverse_masses[a], xpbd.inverse_masses[b]];
        let length = (d.x * d.x + d.y * d.y + d.z * d.z).max(TINY * TINY).sqrt();
        let compliance = 1.0 / (self.stiffness * xpbd.squared_h);
        let step = xpbd.omega * (self.rest - length - compliance * *lambda) / (w[0] + w[1] + compliance);
        *lambda += step;
        let scaled = step / length;
        [d * -(scaled * w[0]), d * (scaled * w[1])]
    }

    /// Four at a time: one square root and three divisions for all of them.
    fn correct_all(
        rest: &[Self],
        particles: &[[u32; 2]],
        xpbd: &Xpbd<'_>,
        q: &mut [Vec3A],
        lambdas: &mut [f32],
    ) {
        let ((rest4, rest1), (particles4, particles1)) = (rest.as_chunks::<4>(), particles.as_chunks::<4>());
        let (lambdas4, lambdas1) = lambdas.as_chunks_mut::<4>();
        for ((rest, particles), lambdas) in rest4.iter().zip(particles4).zip(lambdas4) {
            // Written out: `array::map` is a call here, and twice as slow.
            let [[a0, b0], [a1, b1], [a2, b2], [a3, b3]] = *particles;
            let at = |p: u32| q[p as usize];
            let d = [at(b0) - at(a0), at(b1) - at(a1), at(b2) - at(a2), at(b3) - at(a3)];
            let w = |p: u32| xpbd.inverse_masses[p as usize];
            let w0 = Vec4::new(w(a0), w(a1), w(a2), w(a3));
            let w1 = Vec4::new(w(b0), w(b1), w(b2), w(b3));
            let x = Vec4::new(d[0].x, d[1].x, d[2].x, d[3].x);
            let y = Vec4::new(d[0].y, d[1].y, d[2].y, d[3].y);
            let z = Vec4::new(d[0].z, d[1].z, d[2].z, d[3].z);
            let length = (x * x + y * y + z * z).max(Vec4::splat(TINY * TINY)).sqrt();
            let [r0, r1, r2, r3] = *rest;
            let stiffness = Vec4::new(r0.stiffness, r1.stiffness, r2.stiffness, r3.stiffness);
            let compliance = Vec4::ONE / (stiffness * xpbd.squared_h);
            let lambda = Vec4::from_array(*lambdas);
            let stretch = Vec4::new(r0.rest, r1.rest, r2.rest, r3.rest) - length - compliance * lambda;
            let step = xpbd.omega * stretch / (w0 + w1 + compliance);
            *lambdas = (lambda + step).to_array();
            let scaled = step / length;
            let (ends0, ends1) = ((scaled * w0).to_array(), (scaled * w1).to_array());
            for (lane, [a, b]) in particles.iter().enumerate() {
                q[*a as usize] += d[lane] * -ends0[lane];
                q[*b as usize] += d[lane] * ends1[lane];
            }
        }
        for ((rest, &[a, b]), lambda) in rest1.iter().zip(particles1).zip(lambdas1) {
            let moves = rest.correct(&[a, b], xpbd, q, lambda);
            q[a as usize] += moves[0];
            q[b as usize] += moves[1];
        }
    }
}

/// Lengths below this are 0 \[m\]; its square is a normal number.
const TINY: f32 = 1e-18;

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
