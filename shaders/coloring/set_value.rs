//! One value for each vertex of the list.

use bytemuck::{Pod, Zeroable};

use crate::{HostViews, Kernel, Map};

/// Sets each element of the list to a value; reads no array.
#[derive(Debug)]
pub struct SetValue;

/// Parameters of [`SetValue`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct SetValueUniform {
    /// The value.
    pub value: u32,
}

impl Kernel for SetValue {
    const NAME: &'static str = "set_value";
    const WGSL: &'static [&'static str] = &[include_str!("set_value.wgsl")];
    type Uniform = SetValueUniform;
    type Inputs = ();
}

impl Map for SetValue {
    type Output = u32;

    #[inline]
    fn map(_: u32, uniform: &Self::Uniform, (): HostViews<'_, Self>, own: &mut u32) {
        *own = uniform.value;
    }
}
