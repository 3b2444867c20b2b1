//! Lines 5 to 7 for a particle, all projections apart.

use glam::Vec4;

use super::{LINEAR, Omega, Row, Tap, WGSL, eased, linear};
use crate::{HostViews, Kernel, Update};

/// `q += ω (b − Y q)_i / Y_ii` \[m\]; reads (rows, taps, anchors, pulls \[N\]).
#[derive(Debug)]
pub struct RelaxLinear;

impl Kernel for RelaxLinear {
    const NAME: &'static str = "relax_linear";
    const WGSL: &'static [&'static str] = &[WGSL, include_str!("relax_linear.wgsl"), LINEAR];
    type Uniform = Omega;
    type Inputs = (Row, Tap, Vec4, Vec4);
}

impl Update for RelaxLinear {
    type State = Vec4;

    #[inline]
    fn update(
        i: u32,
        uniform: &Omega,
        (rows, taps, anchors, pulls): HostViews<'_, Self>,
        q: &[Vec4],
    ) -> Vec4 {
        let (at, step) = (q[i as usize], rows[i as usize].inverse_diagonal);
        let residual = linear(i, rows, taps, anchors, pulls, q);
        (at.truncate() + residual * step * eased(uniform.omega, anchors[i as usize])).extend(at.w)
    }
}
