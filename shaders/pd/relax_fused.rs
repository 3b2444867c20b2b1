//! Lines 5 to 7 for a particle whose constraints are springs and flat hinges.

use glam::Vec4;

use super::{FUSED, Omega, Row, Tap, VEC3, WGSL, eased, fused};
use crate::{HostViews, Kernel, Update};

/// `q += ω (b − Y q)_i / Y_ii` \[m\], springs projected from the latest q; reads (rows, taps, spring pulls \[N\], anchors).
#[derive(Debug)]
pub struct RelaxFused;

impl Kernel for RelaxFused {
    const NAME: &'static str = "relax_fused";
    const WGSL: &'static [&'static str] = &[VEC3, WGSL, include_str!("relax_fused.wgsl"), FUSED];
    type Uniform = Omega;
    type Inputs = (Row, Tap, f32, Vec4);
}

impl Update for RelaxFused {
    type State = Vec4;

    #[inline]
    fn update(
        i: u32,
        uniform: &Omega,
        (rows, taps, spring_pulls, anchors): HostViews<'_, Self>,
        q: &[Vec4],
    ) -> Vec4 {
        let (at, step) = (q[i as usize], rows[i as usize].inverse_diagonal);
        let residual = fused(i, rows, taps, spring_pulls, anchors, q);
        (at.truncate() + residual * step * eased(uniform.omega, anchors[i as usize])).extend(at.w)
    }
}
