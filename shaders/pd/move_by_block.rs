//! A particle moves by its residual and its own block of the Hessian.

use glam::Vec4;

use super::{Omega, Row, SYMMETRIC, VEC3, WGSL, eased, solved};
use crate::{HostViews, Kernel, Map};

/// `q += ω B⁻¹ r_i` \[m\], by the diagonal of Y where `f32` cannot invert B; reads (rows, residuals \[N\], anchors, blocks
/// \[N/m\]).
#[derive(Debug)]
pub struct MoveByBlock;

impl Kernel for MoveByBlock {
    const NAME: &'static str = "move_by_block";
    const WGSL: &'static [&'static str] = &[VEC3, WGSL, SYMMETRIC, include_str!("move_by_block.wgsl")];
    type Uniform = Omega;
    type Inputs = (Row, Vec4, Vec4, [Vec4; 2]);
}

impl Map for MoveByBlock {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, uniform: &Omega, (rows, residuals, anchors, blocks): HostViews<'_, Self>, own: &mut Vec4) {
        let (residual, [diagonal, off]) = (residuals[i as usize].truncate(), blocks[i as usize]);
        let fallback = residual * rows[i as usize].inverse_diagonal;
        let step = solved(diagonal.truncate(), off.truncate(), residual, fallback);
        *own = (own.truncate() + step * eased(uniform.omega, anchors[i as usize])).extend(own.w);
    }
}
