//! `b − Y q` with springs projected from q, all rows alike.

use glam::Vec4;

use super::{FUSED, Row, Tap, VEC3, WGSL, fused};
use crate::{HostViews, Kernel, Map};

/// `(b − Y q)_i` \[N\] without passes, which are added to it; reads (rows, taps, spring pulls \[N\], anchors, q).
#[derive(Debug)]
pub struct FusedResidual;

impl Kernel for FusedResidual {
    const NAME: &'static str = "fused_residual";
    const WGSL: &'static [&'static str] = &[VEC3, WGSL, include_str!("fused_residual.wgsl"), FUSED];
    type Uniform = ();
    type Inputs = (Row, Tap, f32, Vec4, Vec4);
}

impl Map for FusedResidual {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (rows, taps, spring_pulls, anchors, q): HostViews<'_, Self>, own: &mut Vec4) {
        *own = fused(i, rows, taps, spring_pulls, anchors, q).extend(0.0);
    }
}
