//! Chebyshev's three-term recurrence.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// `q = previous + omega · (q − previous)`, nothing for ω = 1; reads (previous), keeps w.
///
/// A device may fuse a product with a sum: two roundings of q.
#[derive(Debug)]
pub struct Extrapolate;

/// Parameters of [`Extrapolate`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct ExtrapolateUniform {
    /// The weight \[1\].
    pub omega: f32,
}

impl Kernel for Extrapolate {
    const NAME: &'static str = "extrapolate";
    const WGSL: &'static [&'static str] = &[include_str!("extrapolate.wgsl")];
    type Uniform = ExtrapolateUniform;
    type Inputs = (Vec4,);
}

impl Map for Extrapolate {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, uniform: &ExtrapolateUniform, (previous,): HostViews<'_, Self>, q: &mut Vec4) {
        if uniform.omega == 1.0 {
            return;
        }
        let previous = previous[i as usize].truncate();
        *q = (previous + (q.truncate() - previous) * uniform.omega).extend(q.w);
    }
}
