//! The same vector everywhere.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// A value for element `i`.
#[derive(Debug)]
pub struct SetVector;

/// Parameters of [`SetVector`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct SetVectorUniform {
    /// The value.
    pub value: Vec4,
}

impl Kernel for SetVector {
    const NAME: &'static str = "set_vector";
    const WGSL: &'static [&'static str] = &[include_str!("set_vector.wgsl")];
    type Uniform = SetVectorUniform;
    type Inputs = ();
}

impl Map for SetVector {
    type Output = Vec4;

    #[inline]
    fn map(_: u32, uniform: &SetVectorUniform, (): HostViews<'_, Self>, own: &mut Vec4) {
        *own = uniform.value;
    }
}
