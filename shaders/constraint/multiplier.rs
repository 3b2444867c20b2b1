//! What Position Based Dynamics solves for: a multiplier for the scalar C, or for the vector A q − p.
//!
//! A scalar is enough where C keeps its direction while a step is solved. Of A q − p, which may pass through 0, |A q − p| turns its
//! gradient about there, and a scalar multiplier does not follow; nor does it know what was added along earlier directions. With a
//! vector the moves add up to w Aᵀ λ, so that XPBD comes to rest where the gradient of the objective is 0.

#![allow(clippy::inline_always, reason = "four constraints stay in registers only if it is")]

use std::fmt::Debug;
use std::ops::{Add, Mul, Sub};

use glam::Vec4;
use wide::f32x4;

use super::{BATCH, Constraint, Deviations, Residuals, Xpbd};
use crate::Element;
use crate::lanes::{Lanes3, each};

/// The multiplier of a constraint of `N` particles and `R` rows \[N s²\], and what a projection of XPBD does with it.
pub trait Multiplier<const N: usize, const R: usize>:
    Element + Debug + Default + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self>
{
    /// The projection in WGSL.
    const WGSL: &'static str;

    /// The multiplier that a device keeps in a vector, as it keeps those of all kinds.
    fn within(vector: &mut Vec4) -> &mut Self;

    /// See [`Constraint::correct`].
    fn correct<C: Constraint<N, R>>(
        &mut self,
        rest: &C,
        particles: &[u32; N],
        xpbd: &Xpbd,
        q: &[Vec4],
    ) -> [Vec4; N];

    /// See [`Constraint::correct_batch`].
    fn correct_batch<C: Constraint<N, R>>(
        of: &mut [Self; BATCH],
        rest: &[C; BATCH],
        particles: &[[u32; N]; BATCH],
        xpbd: &Xpbd,
        q: &[Vec4],
    ) -> Option<[[Vec4; BATCH]; N]>;
}

/// That of C: `Δλ = ω (−C − α̃ λ) / (Σ w |∇C|² + α̃)`.
impl<const N: usize, const R: usize> Multiplier<N, R> for f32 {
    const WGSL: &'static str = include_str!("correct.wgsl");

    #[inline]
    fn within(vector: &mut Vec4) -> &mut Self {
        &mut vector.x
    }

    #[inline]
    fn correct<C: Constraint<N, R>>(
        &mut self,
        rest: &C,
        particles: &[u32; N],
        xpbd: &Xpbd,
        q: &[Vec4],
    ) -> [Vec4; N] {
        let q = particles.map(|p| q[p as usize]);
        let (c, gradient) = rest.deviation(&q.map(Vec4::truncate));
        let compliance = 1.0 / (rest.weight() * xpbd.squared_h);
        let mut denominator = compliance;
        for (gradient, q) in gradient.iter().zip(&q) {
            denominator += q.w * gradient.length_squared();
        }
        let step = xpbd.omega * (-c - compliance * *self) / denominator;
        *self += step;
        std::array::from_fn(|slot| (gradient[slot] * (q[slot].w * step)).extend(0.0))
    }

    #[inline(always)]
    fn correct_batch<C: Constraint<N, R>>(
        of: &mut [Self; BATCH],
        rest: &[C; BATCH],
        particles: &[[u32; N]; BATCH],
        xpbd: &Xpbd,
        q: &[Vec4],
    ) -> Option<[[Vec4; BATCH]; N]> {
        let (corners, w) = gather(particles, q);
        let Deviations { c, gradient, squared } = C::deviations(rest, &corners)?;
        let compliance = f32x4::ONE / (each(rest, C::weight) * f32x4::splat(xpbd.squared_h));
        let mut denominator = compliance;
        for (squared, w) in squared.iter().zip(&w) {
            denominator += *w * *squared;
        }
        let lambda = f32x4::new(*of);
        let step = f32x4::splat(xpbd.omega) * (-c - compliance * lambda) / denominator;
        *of = (lambda + step).to_array();
        let mut moves = [[Vec4::ZERO; BATCH]; N];
        for slot in 0..N {
            moves[slot] = (gradient[slot] * (w[slot] * step)).to_vec4s();
        }
        Some(moves)
    }
}

/// That of A q − p, a fourth coordinate of 0 beside it: `Δλ = ω (−(A q − p) − α̃ λ) / (Σ w a² + α̃)`, a the entries of A's one row.
impl<const N: usize> Multiplier<N, 1> for Vec4 {
    const WGSL: &'static str = include_str!("correct_vector.wgsl");

    #[inline]
    fn within(vector: &mut Vec4) -> &mut Self {
        vector
    }

    #[inline]
    fn correct<C: Constraint<N, 1>>(
        &mut self,
        rest: &C,
        particles: &[u32; N],
        xpbd: &Xpbd,
        q: &[Vec4],
    ) -> [Vec4; N] {
        let q = particles.map(|p| q[p as usize]);
        let [r] = rest.residual(&q.map(Vec4::truncate));
        let compliance = 1.0 / (rest.weight() * xpbd.squared_h);
        let mut denominator = compliance;
        for (slot, q) in q.iter().enumerate() {
            let [a] = rest.column(slot);
            denominator += q.w * (a * a);
        }
        let step = (-r - self.truncate() * compliance) * (xpbd.omega / denominator);
        *self += step.extend(0.0);
        std::array::from_fn(|slot| {
            let [a] = rest.column(slot);
            (step * (q[slot].w * a)).extend(0.0)
        })
    }

    #[inline(always)]
    fn correct_batch<C: Constraint<N, 1>>(
        of: &mut [Self; BATCH],
        rest: &[C; BATCH],
        particles: &[[u32; N]; BATCH],
        xpbd: &Xpbd,
        q: &[Vec4],
    ) -> Option<[[Vec4; BATCH]; N]> {
        let (corners, w) = gather(particles, q);
        let Residuals { r, row } = C::residuals(rest, &corners)?;
        let compliance = f32x4::ONE / (each(rest, C::weight) * f32x4::splat(xpbd.squared_h));
        let mut denominator = compliance;
        for (a, w) in row.iter().zip(&w) {
            denominator += *w * (*a * *a);
        }
        let (lambda, _) = Lanes3::from_vec4s(*of);
        let step = (-r - lambda * compliance) * (f32x4::splat(xpbd.omega) / denominator);
        *of = (lambda + step).to_vec4s();
        let mut moves = [[Vec4::ZERO; BATCH]; N];
        for slot in 0..N {
            moves[slot] = (step * (w[slot] * row[slot])).to_vec4s();
        }
        Some(moves)
    }
}

/// Where the particles of four constraints are, and their inverse masses.
#[inline(always)]
fn gather<const N: usize>(particles: &[[u32; N]; BATCH], q: &[Vec4]) -> ([Lanes3<f32x4>; N], [f32x4; N]) {
    // Loops: `array::from_fn` and `array::map` may become calls, and everything here is to stay in registers.
    let (mut corners, mut w) = ([Lanes3::<f32x4>::ZERO; N], [f32x4::ZERO; N]);
    for slot in 0..N {
        let [a, b, c, d] = particles;
        let of = |particle: u32| q[particle as usize];
        (corners[slot], w[slot]) = Lanes3::from_vec4s([of(a[slot]), of(b[slot]), of(c[slot]), of(d[slot])]);
    }
    (corners, w)
}
