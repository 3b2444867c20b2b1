//! A vector in another order.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// `own_i = from[places_i]`, or adds that; reads (places, from).
#[derive(Debug)]
pub struct Pick;

/// Parameters of [`Pick`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct PickUniform {
    /// 1 or 0.
    pub adds: u32,
}

impl Kernel for Pick {
    const NAME: &'static str = "pick";
    const WGSL: &'static [&'static str] = &[include_str!("pick.wgsl")];
    type Uniform = PickUniform;
    type Inputs = (u32, Vec4);
}

impl Map for Pick {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, uniform: &PickUniform, (places, from): HostViews<'_, Self>, own: &mut Vec4) {
        let picked = from[places[i as usize] as usize].truncate().extend(0.0);
        *own = if uniform.adds == 1 { *own + picked } else { picked };
    }
}
