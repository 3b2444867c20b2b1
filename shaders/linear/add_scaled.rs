//! One vector and a part of another.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use super::Scalars;
use crate::{HostViews, Kernel, Map};

/// `own + factor · s a`, where s is α or 1; keeps w; reads (scalars, a).
#[derive(Debug)]
pub struct AddScaled;

/// Parameters of [`AddScaled`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct AddScaledUniform {
    /// 1 or −1.
    pub factor: f32,
    /// Whether s is α: 1 or 0.
    pub by_alpha: u32,
}

impl Kernel for AddScaled {
    const NAME: &'static str = "add_scaled";
    const WGSL: &'static [&'static str] = &[super::SCALARS, include_str!("add_scaled.wgsl")];
    type Uniform = AddScaledUniform;
    type Inputs = (Scalars, Vec4);
}

impl Map for AddScaled {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, uniform: &AddScaledUniform, (scalars, a): HostViews<'_, Self>, own: &mut Vec4) {
        let scale = if uniform.by_alpha == 1 { scalars[0].alpha.truncate() } else { Vec3::ONE };
        *own = (own.truncate() + a[i as usize].truncate() * (scale * uniform.factor)).extend(own.w);
    }
}
