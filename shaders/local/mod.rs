//! Kernels over the constraints of one kind, whatever the kind: what a solver asks of [`crate::constraint`] on a device. One file
//! each; in WGSL the kind's text comes first and gives N, R, `Rest` and the functions that the kernel calls.
//!
//! [`Project`] to [`Energy`] are the local step of Projective Dynamics, [`Correct`] to [`XpbdGradient`] are Position Based Dynamics.
//! Positions are (x, y, z, inverse mass), the latter 0 where pinned.

mod block;
mod correct;
mod energy;
mod gather;
mod moves;
mod multiply;
mod project;
mod pull;
mod pull_fused;
mod xpbd_energy;
mod xpbd_gradient;

use glam::{Vec3, Vec4};

use crate::Shader;
use crate::constraint::{Constraint, Multiplier, WGSL, Xpbd};

pub use block::Block;
pub use correct::Correct;
pub use energy::Energy;
pub use gather::Gather;
pub use moves::Moves;
pub use multiply::Multiply;
pub use project::Project;
pub use pull::Pull;
pub use pull_fused::PullFused;
pub use xpbd_energy::XpbdEnergy;
pub use xpbd_gradient::XpbdGradient;

/// Every kernel of this module over kind `C`, in every form that solvers use.
#[must_use]
pub const fn shaders<C: Constraint<N, R>, const N: usize, const R: usize>() -> [Shader; 12] {
    [
        Shader::map::<Block<C, N, R>>(),
        Shader::scatter::<Correct<C, N, R>, N>(),
        Shader::scatter_in_order::<Correct<C, N, R>, N>(),
        Shader::map::<Energy<C, N, R>>(),
        Shader::map::<Gather<C, N, R>>(),
        Shader::map::<Moves<C, N, R>>(),
        Shader::map::<Multiply<C, N, R>>(),
        Shader::map::<Project<C, N, R>>(),
        Shader::map::<Pull<C, N, R>>(),
        Shader::map::<PullFused<C, N, R>>(),
        Shader::map::<XpbdEnergy<C, N, R>>(),
        Shader::map::<XpbdGradient<C, N, R>>(),
    ]
}

const CORNERS: &str = include_str!("corners.wgsl");

/// Parts of the text of a kernel over a kind, at most.
const MOST_PARTS: usize = 10;

/// The text of a kernel over a kind: what all kinds have, the kind's, the kernel's.
const fn join<C: Constraint<N, R>, const N: usize, const R: usize>(
    kernel: &[&'static str],
) -> [&'static str; MOST_PARTS] {
    let mut parts = [""; MOST_PARTS];
    let lists: [&[&'static str]; 4] = [&WGSL, &[C::Multiplier::WGSL], C::WGSL, kernel];
    let (mut n, mut list) = (0, 0);
    while list < lists.len() {
        let mut k = 0;
        while k < lists[list].len() {
            parts[n] = lists[list][k];
            (n, k) = (n + 1, k + 1);
        }
        list += 1;
    }
    parts
}

/// Over-relaxation shared with the constraint's busiest particle, as Jacobi's iteration has it.
#[inline]
fn averaged(xpbd: &Xpbd, busiest: f32) -> Xpbd {
    Xpbd { omega: xpbd.omega / busiest, ..*xpbd }
}

/// Where the particles of constraint `k` are \[m\].
#[inline]
fn corners<const N: usize>(k: usize, particles: &[[u32; N]], q: &[Vec4]) -> [Vec3; N] {
    particles[k].map(|particle| q[particle as usize].truncate())
}

/// Constraint and slot of each place that particle `i` has.
#[inline]
fn row<const N: usize>(i: u32, offsets: &[u32], slots: &[u32]) -> impl Iterator<Item = (usize, usize)> {
    let range = offsets[i as usize] as usize..offsets[i as usize + 1] as usize;
    slots[range].iter().map(|&slot| (slot as usize / N, slot as usize % N))
}
