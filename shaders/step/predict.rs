//! Line 1 of Algorithm 1.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// `q⁰ = q + h (v + h a)` of a free particle \[m\], q of a pinned one; reads (positions \[m\], velocities \[m/s\], accelerations
/// \[m/s²\]).
///
/// A device may fuse products with sums: two roundings of q.
#[derive(Debug)]
pub struct Predict;

/// Parameters of [`Predict`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct PredictUniform {
    /// The time step \[s\].
    pub h: f32,
}

impl Kernel for Predict {
    const NAME: &'static str = "predict";
    const WGSL: &'static [&'static str] = &[include_str!("predict.wgsl")];
    type Uniform = PredictUniform;
    type Inputs = (Vec4, Vec4, Vec4);
}

impl Map for Predict {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, uniform: &PredictUniform, (before, v, a): HostViews<'_, Self>, own: &mut Vec4) {
        let (h, i) = (uniform.h, i as usize);
        let moved = before[i].truncate() + h * (v[i].truncate() + h * a[i].truncate());
        *own = if before[i].w > 0.0 { moved.extend(before[i].w) } else { before[i] };
    }
}
