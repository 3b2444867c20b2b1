//! Line 9 of Algorithm 1.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// `v = scale · (q' − q)` \[m/s\]; reads (positions after the step, positions before it \[m\]).
#[derive(Debug)]
pub struct UpdateVelocity;

/// Parameters of [`UpdateVelocity`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct UpdateVelocityUniform {
    /// One over the time step, damped \[1/s\].
    pub scale: f32,
}

impl Kernel for UpdateVelocity {
    const NAME: &'static str = "update_velocity";
    const WGSL: &'static [&'static str] = &[include_str!("update_velocity.wgsl")];
    type Uniform = UpdateVelocityUniform;
    type Inputs = (Vec4, Vec4);
}

impl Map for UpdateVelocity {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, uniform: &UpdateVelocityUniform, (after, before): HostViews<'_, Self>, own: &mut Vec4) {
        let i = i as usize;
        *own = ((after[i].truncate() - before[i].truncate()) * uniform.scale).extend(0.0);
    }
}
