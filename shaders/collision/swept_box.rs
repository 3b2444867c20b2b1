//! Boxes around the ways of primitives.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// The box around the way of primitive `i` from its start to its end less the drift \[m\], wider by a margin on each side; reads
/// (primitives, from \[m\], to \[m\], drift \[m\], one element).
///
/// The margin for rounding is a power of two times a coordinate, so that no device rounds otherwise.
#[derive(Debug)]
pub struct SweptBox;

/// Parameters of [`SweptBox`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct SweptBoxUniform {
    /// Half of the distance at which two primitives meet \[m\].
    pub margin: f32,
}

/// Of a coordinate, more than its roundings add up to.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

impl Kernel for SweptBox {
    const NAME: &'static str = "swept_box";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("swept_box.wgsl")];
    type Uniform = SweptBoxUniform;
    type Inputs = ([u32; 4], Vec4, Vec4, Vec4);
}

impl Map for SweptBox {
    type Output = [Vec4; 2];

    fn map(
        i: u32,
        uniform: &SweptBoxUniform,
        (primitives, from, to, drift): HostViews<'_, Self>,
        own: &mut [Vec4; 2],
    ) {
        let [mut least, mut greatest] = [Vec4::splat(f32::INFINITY), Vec4::splat(f32::NEG_INFINITY)];
        for particle in primitives[i as usize] {
            let (a, b) = (from[particle as usize], to[particle as usize] - drift[0]);
            (least, greatest) = (least.min(a.min(b)), greatest.max(a.max(b)));
        }
        let wider = |v: Vec4| Vec4::splat(uniform.margin) + ROUNDING * v.abs();
        *own = [least - wider(least), greatest + wider(greatest)];
    }
}
