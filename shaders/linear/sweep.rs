//! A colored sweep forward and one backward as a preconditioner: `((D + L) D⁻¹ (D + Lᵀ))⁻¹`.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use crate::pd::{self, Row, Tap};
use crate::{HostViews, Kernel, Update};

/// Forward `z_i = (r_i − Σ_{j<i} Y_ij z_j) / Y_ii`, backward `z_i −= Σ_{j>i} Y_ij z_j / Y_ii`, for the members of a color; reads (rows,
/// taps, r), where z is 0 at what is pinned. Particles are numbered color by color.
#[derive(Debug)]
pub struct Sweep;

/// Parameters of [`Sweep`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct SweepUniform {
    /// 1 or 0.
    pub is_backward: u32,
}

impl Kernel for Sweep {
    const NAME: &'static str = "sweep";
    const WGSL: &'static [&'static str] = &[pd::WGSL, include_str!("sweep.wgsl")];
    type Uniform = SweepUniform;
    type Inputs = (Row, Tap, Vec4);
}

impl Update for Sweep {
    type State = Vec4;

    #[inline]
    fn update(i: u32, uniform: &SweepUniform, (rows, taps, r): HostViews<'_, Self>, z: &[Vec4]) -> Vec4 {
        let (row, is_backward) = (&rows[i as usize], uniform.is_backward == 1);
        let mut sum = Vec3::ZERO;
        for e in row.entries(0, row.n) {
            if (taps[e].column > i) == is_backward {
                sum += z[taps[e].column as usize].truncate() * taps[e].weight;
            }
        }
        if is_backward {
            return (z[i as usize].truncate() + sum * row.inverse_diagonal).extend(0.0);
        }
        ((r[i as usize].truncate() + sum) * row.inverse_diagonal).extend(0.0)
    }
}
