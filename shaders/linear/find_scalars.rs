//! The scalars of conjugate gradients.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use super::sum_pairs::total;
use crate::{HostViews, Kernel, Map};

/// What conjugate gradients know, of which there is one: finds α, β and ρ, for x, y and z each; reads (pairs: of which one
/// sum is `r·z` or `d·Y d`, the other `r·r`).
///
/// Where all residuals are as small as rounding, ρ becomes 0, and nothing moves any more.
#[derive(Debug)]
pub struct FindScalars;

/// The scalars, for x, y and z.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Scalars {
    /// `r·z`.
    pub rho: Vec4,
    /// `r·r` below which there is nothing left to solve.
    pub enough: Vec4,
    /// The length of the step along d.
    pub alpha: Vec4,
    /// How much of the old direction is in the new.
    pub beta: Vec4,
}

/// Parameters of [`FindScalars`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct FindScalarsUniform {
    /// 0: a solve begins; 1: α; 2: β and ρ.
    pub stage: u32,
    /// How many pairs there are.
    pub n_sums: u32,
    /// The residual's norm, relative to the first, that is rounding; squared.
    pub squared_tolerance: f32,
}

impl Kernel for FindScalars {
    const NAME: &'static str = "find_scalars";
    const WGSL: &'static [&'static str] = &[super::PAIR, super::SCALARS, include_str!("find_scalars.wgsl")];
    type Uniform = FindScalarsUniform;
    type Inputs = ([Vec4; 2],);
}

impl Map for FindScalars {
    type Output = Scalars;

    fn map(_: u32, uniform: &FindScalarsUniform, (pairs,): HostViews<'_, Self>, scalars: &mut Scalars) {
        let [first, second] = total(pairs[..uniform.n_sums as usize].iter());
        match uniform.stage {
            0 => {
                scalars.rho = first;
                scalars.enough = second * uniform.squared_tolerance;
            }
            1 => scalars.alpha = ratio(scalars.rho, first),
            _ => {
                if second.truncate().cmple(scalars.enough.truncate()).all() {
                    (scalars.beta, scalars.rho) = (Vec4::ZERO, Vec4::ZERO);
                } else {
                    (scalars.beta, scalars.rho) = (ratio(first, scalars.rho), first);
                }
            }
        }
    }
}

/// `a / b`, 0 where b is: that column is solved.
fn ratio(a: Vec4, b: Vec4) -> Vec4 {
    let (a, b) = (a.truncate(), b.truncate());
    Vec3::select(b.cmpgt(Vec3::ZERO), a / b, Vec3::ZERO).extend(0.0)
}
