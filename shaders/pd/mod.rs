//! Kernels of Projective Dynamics over the rows of Y. One file each.
//!
//! Particles are numbered color by color, pinned ones last, so a color is a range. Rows lie in slices of 32, entry by entry (sliced
//! ELLPACK), so that what the invocations of a device read together lies together. Springs come first in each row.
//!
//! The w of an anchor is its weight, m/h² and the stiffness of attachments \[N/m\]; negative where contacts have moved the particle in this step,
//! which is not over-relaxed then.
//!
//! A device may fuse products with sums: what a vertex adds up differs by 10⁻⁵ of its largest term.

mod anchor;
mod fused_residual;
mod linear_residual;
mod move_by_block;
mod move_by_diagonal;
mod relax_fused;
mod relax_linear;
mod row_energy;
mod shift_anchor;
mod spring_block;
mod spring_pull;

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use crate::Shader;

pub use anchor::Anchor;
pub use fused_residual::FusedResidual;
pub use linear_residual::LinearResidual;
pub use move_by_block::MoveByBlock;
pub use move_by_diagonal::MoveByDiagonal;
pub use relax_fused::RelaxFused;
pub use relax_linear::RelaxLinear;
pub use row_energy::RowEnergy;
pub use shift_anchor::ShiftAnchor;
pub use spring_block::SpringBlock;
pub use spring_pull::SpringPull;

/// Every kernel of this module.
pub const SHADERS: [Shader; 11] = [
    Shader::map::<Anchor>(),
    Shader::map::<FusedResidual>(),
    Shader::map::<LinearResidual>(),
    Shader::map::<MoveByBlock>(),
    Shader::map::<MoveByDiagonal>(),
    Shader::update::<RelaxFused>(),
    Shader::update::<RelaxLinear>(),
    Shader::map::<RowEnergy>(),
    Shader::update::<ShiftAnchor>(),
    Shader::map::<SpringBlock>(),
    Shader::map::<SpringPull>(),
];

const VEC3: &str = include_str!("../common/vec3.wgsl");
pub(crate) const WGSL: &str = include_str!("mod.wgsl");
const FUSED: &str = include_str!("fused.wgsl");
const LINEAR: &str = include_str!("linear.wgsl");
const SYMMETRIC: &str = include_str!("symmetric.wgsl");

/// Rows that lie side by side, entry by entry.
pub const SLICE: u32 = 32;

/// A row of Y: its entries are `first`, `first + SLICE`, `first + 2 SLICE`, …
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Row {
    /// The first entry.
    pub first: u32,
    /// How many entries, from the first, have a spring in them.
    pub n_springs: u32,
    /// How many entries there are.
    pub n: u32,
    /// One over the diagonal of Y, inertia and attachments included \[m/N\].
    pub inverse_diagonal: f32,
}

/// An entry of Y.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Tap {
    /// The other particle.
    pub column: u32,
    /// −Y_ij \[N/m\].
    pub weight: f32,
}

/// What energies and blocks know of an entry.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SpringTap {
    /// Stiffness times rest length \[N\].
    pub pull: f32,
    /// Stiffness k \[N/m\].
    pub stiffness: f32,
    /// The row's share of the entry's energy, over k \[m/N\].
    pub compliance: f32,
    /// The part of flat hinges in the entry, times that share \[N/m\].
    pub linear: f32,
}

/// The parameter of every kernel that moves particles.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Omega {
    /// Over-relaxation \[1\].
    pub omega: f32,
}

impl Row {
    /// Places of the entries from number `from` up to number `to`.
    #[inline]
    pub(crate) fn entries(&self, from: u32, to: u32) -> impl Iterator<Item = usize> {
        let first = self.first;
        (from..to).map(move |k| (first + k * SLICE) as usize)
    }
}

/// The weight of a particle's step: no more than 1 where contacts have moved it, or what lies on something would not come to rest.
#[inline]
fn eased(omega: f32, anchor: Vec4) -> f32 {
    if anchor.w < 0.0 { omega.min(1.0) } else { omega }
}

#[inline]
fn guarded(squared: f32) -> f32 {
    squared.max(1e-36)
}

/// `(b − Y q)` of row `i` \[N\] without its passes, springs projected from q.
#[inline]
fn fused(i: u32, rows: &[Row], taps: &[Tap], pulls: &[f32], anchors: &[Vec4], q: &[Vec4]) -> Vec3 {
    let (row, at, anchor) = (&rows[i as usize], q[i as usize].truncate(), anchors[i as usize]);
    let mut sum = (anchor.truncate() - at) * anchor.w.abs();
    for e in row.entries(0, row.n_springs) {
        let d = q[taps[e].column as usize].truncate() - at;
        sum += d * (taps[e].weight - pulls[e] / guarded(d.length_squared()).sqrt());
    }
    for e in row.entries(row.n_springs, row.n) {
        sum += (q[taps[e].column as usize].truncate() - at) * taps[e].weight;
    }
    sum
}

/// `(b − Y q)` of row `i` \[N\], all projections in `pulls`.
#[inline]
fn linear(i: u32, rows: &[Row], taps: &[Tap], anchors: &[Vec4], pulls: &[Vec4], q: &[Vec4]) -> Vec3 {
    let (row, at, anchor) = (&rows[i as usize], q[i as usize].truncate(), anchors[i as usize]);
    let mut sum = (anchor.truncate() - at) * anchor.w.abs() + pulls[i as usize].truncate();
    for e in row.entries(0, row.n) {
        sum += (q[taps[e].column as usize].truncate() - at) * taps[e].weight;
    }
    sum
}

/// The symmetric matrix of this diagonal and these entries yz, zx, xy, times `x`.
#[inline]
pub(crate) fn multiplied(diagonal: Vec3, off: Vec3, x: Vec3) -> Vec3 {
    Vec3::new(
        Vec3::new(diagonal.x, off.z, off.y).dot(x),
        Vec3::new(off.z, diagonal.y, off.x).dot(x),
        Vec3::new(off.y, off.x, diagonal.z).dot(x),
    )
}

/// What that matrix takes to `b`; `fallback` where `f32` cannot say.
#[inline]
pub(crate) fn solved(diagonal: Vec3, off: Vec3, b: Vec3, fallback: Vec3) -> Vec3 {
    let x = Vec3::new(diagonal.x, off.z, off.y);
    let y = Vec3::new(off.z, diagonal.y, off.x);
    let z = Vec3::new(off.y, off.x, diagonal.z);
    let yz = y.cross(z);
    let determinant = x.dot(yz);
    let solution = Vec3::new(yz.dot(b), z.cross(x).dot(b), x.cross(y).dot(b)) * (1.0 / determinant);
    let size = solution.x.abs() + solution.y.abs() + solution.z.abs();
    if determinant > 0.0 && size <= f32::MAX { solution } else { fallback }
}
