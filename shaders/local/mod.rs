//! Kernels over the constraints of one kind, whatever the kind: what a solver asks of [`crate::constraint`] on a device. One file
//! each; in WGSL the kind's text comes first and gives N, R, `Rest` and the functions that the kernel calls.
//!
//! Positions are (x, y, z, inverse mass).

mod block;
mod energy;
mod project;
mod pull;
mod pull_fused;

use glam::{Vec3, Vec4};

use crate::Shader;
use crate::constraint::Constraint;

pub use block::Block;
pub use energy::Energy;
pub use project::Project;
pub use pull::Pull;
pub use pull_fused::PullFused;

/// Every kernel of this module over kind `C`, in every form that solvers use.
#[must_use]
pub const fn shaders<C: Constraint<N, R>, const N: usize, const R: usize>() -> [Shader; 5] {
    [
        Shader::map::<Block<C, N, R>>(),
        Shader::map::<Energy<C, N, R>>(),
        Shader::map::<Project<C, N, R>>(),
        Shader::map::<Pull<C, N, R>>(),
        Shader::map::<PullFused<C, N, R>>(),
    ]
}

const CORNERS: &str = include_str!("corners.wgsl");

/// Parts of the text of a kernel over a kind, at most.
const MOST_PARTS: usize = 10;

/// The text of a kind and that of a kernel, one after the other.
const fn join(kind: &[&'static str], kernel: &[&'static str]) -> [&'static str; MOST_PARTS] {
    let mut parts = [""; MOST_PARTS];
    let mut k = 0;
    while k < kind.len() {
        parts[k] = kind[k];
        k += 1;
    }
    while k < kind.len() + kernel.len() {
        parts[k] = kernel[k - kind.len()];
        k += 1;
    }
    parts
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
