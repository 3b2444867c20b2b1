//! The kinds of constraints, one file each.
//!
//! Every kind has the form of Projective Dynamics (Bouaziz et al. 2014): an energy
//!
//! ```text
//! W(q) = w/2 ‖A q − p(A q)‖²
//! ```
//!
//! of its `N` particles q, where the `R` × `N` matrix A is constant and p projects A q on the set where the constraint is at
//! rest. What a solver needs follows from A, w and p: the entries of Y (Eq. 1), the right-hand side, gradients (p moves along
//! the set, so its derivative drops out), and the scalar C with its gradient that Position Based Dynamics wants.

mod attachment;
mod bending;
mod contact;
mod multiplier;
mod spring;
mod tet_strain;
mod tet_volume;
mod triangle_strain;

#[cfg(test)]
mod tests;

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3, Vec4};
use wide::f32x4;

pub use attachment::Attachment;
pub use bending::Bending;
pub use contact::Contact;
pub use multiplier::Multiplier;
pub use spring::Spring;
pub use tet_strain::TetStrain;
pub use tet_volume::TetVolume;
pub use triangle_strain::TriangleStrain;

use crate::Element;
use crate::lanes::Lanes3;

/// What all kinds have in WGSL, beside [`Constraint::WGSL`].
pub(crate) const WGSL: [&str; 2] = [include_str!("../common/vec3.wgsl"), include_str!("mod.wgsl")];

// What kinds have by default.
const APPLY: &str = include_str!("apply.wgsl");
const BLOCK: &str = include_str!("block.wgsl");
const DEVIATION: &str = include_str!("deviation.wgsl");

/// Constraints that are projected together: what SSE2 and NEON hold in a register.
pub const BATCH: usize = 4;

/// What a projection of Position Based Dynamics needs beside the constraint.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Xpbd {
    /// h² \[s²\].
    pub squared_h: f32,
    /// Over-relaxation \[1\].
    pub omega: f32,
}

/// [`Constraint::deviation`] of four constraints.
#[derive(Debug, Clone, Copy)]
pub struct Deviations<const N: usize> {
    /// C \[m\], or \[1\] where A q has no unit.
    pub c: f32x4,
    /// ∇C, by particle.
    pub gradient: [Lanes3<f32x4>; N],
    /// |∇C|², by particle. Of many kinds it is known before q is, and nothing has to wait for it.
    pub squared: [f32x4; N],
}

/// [`Constraint::residual`] of four constraints of one row.
#[derive(Debug, Clone, Copy)]
pub struct Residuals<const N: usize> {
    /// A q − p \[m\].
    pub r: Lanes3<f32x4>,
    /// The row of A, by particle.
    pub row: [f32x4; N],
}

/// A constraint on `N` particles with `R` rows. A value of the type is the rest data of one constraint.
pub trait Constraint<const N: usize, const R: usize>: Element + std::fmt::Debug {
    /// The kind's one name.
    const NAME: &'static str;
    /// The kind in WGSL, in parts that are joined: constants N and R, the rest data as `Rest`, and what it says here of `weight`,
    /// `column`, `project`, `apply`, `block` and `deviation`, under these names.
    const WGSL: &'static [&'static str];

    /// What Position Based Dynamics solves for: `f32` for C; `Vec4` for A q − p, of kinds of one row where that passes through 0.
    type Multiplier: Multiplier<N, R>;

    /// Weight w: \[N/m\] where A q is a length \[m\], \[J\] = \[N m\] where A q has no unit.
    fn weight(&self) -> f32;

    /// Column `slot` of A: what particle `slot` contributes to each of the rows.
    fn column(&self, slot: usize) -> [f32; R];

    /// p: the point nearest to `aq` in the set where the constraint is at rest. Finite for every finite `aq`.
    fn project(&self, aq: [Vec3; R]) -> [Vec3; R];

    /// [`Constraint::project`] of several, bit for bit: A q becomes p, of the constraint `rest` of its number. For kinds that are
    /// faster in bulk.
    #[inline]
    fn project_all<'a>(rest: impl Fn(usize) -> &'a Self, aq: &mut [[Vec3; R]]) {
        for (k, aq) in aq.iter_mut().enumerate() {
            *aq = rest(k).project(*aq);
        }
    }

    /// Whether p is the same whatever q is: the constraint is then linear and needs no local step.
    fn is_linear(&self) -> bool {
        false
    }

    /// Moves the point that the constraint holds to, of kinds that have one.
    fn set_target(&mut self, _target: Vec3) {}

    /// A q, from differences to the first particle: the rows of A add up to 0, so far from the origin nothing cancels.
    #[inline]
    fn apply(&self, q: &[Vec3; N]) -> [Vec3; R] {
        let mut aq = [Vec3::ZERO; R];
        for slot in 1..N {
            let (column, d) = (self.column(slot), q[slot] - q[0]);
            for row in 0..R {
                aq[row] += column[row] * d;
            }
        }
        aq
    }

    /// A q − p(A q).
    #[inline]
    fn residual(&self, q: &[Vec3; N]) -> [Vec3; R] {
        let aq = self.apply(q);
        let p = self.project(aq);
        std::array::from_fn(|row| aq[row] - p[row])
    }

    /// W(q) \[J\].
    #[inline]
    fn energy(&self, q: &[Vec3; N]) -> f32 {
        0.5 * self.weight() * self.residual(q).iter().map(|r| r.length_squared()).sum::<f32>()
    }

    /// w Aᵀ x for particle `slot`: with x = p its share of the right-hand side of Eq. 1, with x = A q − p the gradient of W.
    #[inline]
    fn pull(&self, slot: usize, x: &[Vec3; R]) -> Vec3 {
        let column = self.column(slot);
        let mut sum = Vec3::ZERO;
        for row in 0..R {
            sum += column[row] * x[row];
        }
        self.weight() * sum
    }

    /// Entry (`a`, `b`) of w AᵀA, which this constraint adds to Y.
    #[inline]
    fn entry(&self, a: usize, b: usize) -> f32 {
        let (a, b) = (self.column(a), self.column(b));
        self.weight() * a.iter().zip(&b).map(|(a, b)| a * b).sum::<f32>()
    }

    /// The 3 × 3 block of the Hessian of W at particle `slot`, made positive semi-definite. By default the block of Y, which is
    /// an upper bound of it.
    #[inline]
    fn block(&self, _q: &[Vec3; N], slot: usize) -> Mat3 {
        Mat3::from_diagonal(Vec3::splat(self.entry(slot, slot)))
    }

    /// The scalar C(q) with W = w/2 C², and its gradient for each particle: what Position Based Dynamics projects. By default
    /// C = ‖A q − p‖; the gradient is 0 at rest.
    #[inline]
    fn deviation(&self, q: &[Vec3; N]) -> (f32, [Vec3; N]) {
        let r = self.residual(q);
        let c = r.iter().map(|r| r.length_squared()).sum::<f32>().sqrt();
        let scale = if c > 0.0 { 1.0 / c } else { 0.0 };
        let gradient = std::array::from_fn(|slot| {
            let column = self.column(slot);
            let mut sum = Vec3::ZERO;
            for row in 0..R {
                sum += column[row] * r[row];
            }
            sum * scale
        });
        (c, gradient)
    }

    /// [`Constraint::deviation`] of four constraints at once, for kinds of a scalar multiplier that have it.
    #[inline]
    fn deviations(_rest: &[Self; BATCH], _q: &[Lanes3<f32x4>; N]) -> Option<Deviations<N>> {
        None
    }

    /// [`Constraint::residual`] of four constraints at once, for kinds of a vector multiplier that have it.
    #[inline]
    fn residuals(_rest: &[Self; BATCH], _q: &[Lanes3<f32x4>; N]) -> Option<Residuals<N>> {
        None
    }

    /// One projection of XPBD (Macklin, Müller, Chentanez 2016, Eq. 18): adds Δλ to `lambda`, returns by how much each particle moves
    /// \[m\], and 0. `q` is the position \[m\] and the inverse mass w \[1/kg\] of every particle, w = 0 where pinned. See
    /// [`Multiplier`].
    #[inline]
    fn correct(
        &self,
        particles: &[u32; N],
        xpbd: &Xpbd,
        q: &[Vec4],
        lambda: &mut Self::Multiplier,
    ) -> [Vec4; N] {
        lambda.correct(self, particles, xpbd, q)
    }

    /// [`Constraint::correct`] of four constraints that share no free particle: by how much each slot's particles move; `None` for
    /// kinds that have neither [`Constraint::deviations`] nor [`Constraint::residuals`]. (Where a scalar C has no direction, nothing
    /// moves either way, but the multiplier differs.)
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "four constraints stay in registers only if it is")]
    fn correct_batch(
        rest: &[Self; BATCH],
        particles: &[[u32; N]; BATCH],
        xpbd: &Xpbd,
        q: &[Vec4],
        lambdas: &mut [Self::Multiplier; BATCH],
    ) -> Option<[[Vec4; BATCH]; N]> {
        Multiplier::correct_batch(lambdas, rest, particles, xpbd, q)
    }
}
