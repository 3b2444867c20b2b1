//! A particle moves by its residual over the diagonal of Y.

use glam::Vec4;

use super::{Omega, Row, WGSL, eased};
use crate::{HostViews, Kernel, Map};

/// `q += ω r_i / Y_ii` \[m\]; reads (rows, residuals \[N\], anchors).
#[derive(Debug)]
pub struct MoveByDiagonal;

impl Kernel for MoveByDiagonal {
    const NAME: &'static str = "move_by_diagonal";
    const WGSL: &'static [&'static str] = &[WGSL, include_str!("move_by_diagonal.wgsl")];
    type Uniform = Omega;
    type Inputs = (Row, Vec4, Vec4);
}

impl Map for MoveByDiagonal {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, uniform: &Omega, (rows, residuals, anchors): HostViews<'_, Self>, own: &mut Vec4) {
        let step = residuals[i as usize].truncate() * rows[i as usize].inverse_diagonal;
        *own = (own.truncate() + step * eased(uniform.omega, anchors[i as usize])).extend(own.w);
    }
}
