//! `b − Y q` with all projections apart.

use glam::Vec4;

use super::{LINEAR, Row, Tap, WGSL, linear};
use crate::{HostViews, Kernel, Map};

/// `(b − Y q)_i` \[N\]; reads (rows, taps, anchors, pulls \[N\], q).
#[derive(Debug)]
pub struct LinearResidual;

impl Kernel for LinearResidual {
    const NAME: &'static str = "linear_residual";
    const WGSL: &'static [&'static str] = &[WGSL, include_str!("linear_residual.wgsl"), LINEAR];
    type Uniform = ();
    type Inputs = (Row, Tap, Vec4, Vec4, Vec4);
}

impl Map for LinearResidual {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (rows, taps, anchors, pulls, q): HostViews<'_, Self>, own: &mut Vec4) {
        *own = linear(i, rows, taps, anchors, pulls, q).extend(0.0);
    }
}
