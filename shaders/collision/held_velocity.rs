//! The guard: velocities of what it has held.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// Where the guard has moved particle `i`, its velocity is that of the whole step: `v = scale · (q − start)` \[m/s\]. Reads (positions as the guard has
/// left them, as it has found them, at the start of the step \[m\]).
///
/// A device may round otherwise: velocities differ by 10⁻⁶ of their size.
#[derive(Debug)]
pub struct HeldVelocity;

/// Parameters of [`HeldVelocity`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct HeldVelocityUniform {
    /// One over the time step, damped \[1/s\].
    pub scale: f32,
}

impl Kernel for HeldVelocity {
    const NAME: &'static str = "held_velocity";
    const WGSL: &'static [&'static str] = &[include_str!("held_velocity.wgsl")];
    type Uniform = HeldVelocityUniform;
    type Inputs = (Vec4, Vec4, Vec4);
}

impl Map for HeldVelocity {
    type Output = Vec4;

    fn map(i: u32, uniform: &HeldVelocityUniform, (q, found, start): HostViews<'_, Self>, own: &mut Vec4) {
        let [q, found, start] = [q, found, start].map(|at| at[i as usize].truncate());
        if q != found {
            *own = ((q - start) * uniform.scale).extend(0.0);
        }
    }
}
