//! Who has a value.

use bytemuck::{Pod, Zeroable};

use crate::{Expand, HostViews, Kernel};

/// Finds `i` if it has a value; reads (values).
#[derive(Debug)]
pub struct FindValue;

/// Parameters of [`FindValue`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct FindValueUniform {
    /// The value.
    pub value: u32,
}

impl Kernel for FindValue {
    const NAME: &'static str = "find_value";
    const WGSL: &'static [&'static str] = &[include_str!("find_value.wgsl")];
    type Uniform = FindValueUniform;
    type Inputs = (u32,);
}

impl Expand for FindValue {
    type Item = u32;

    fn expand(
        i: u32,
        uniform: &FindValueUniform,
        (values,): HostViews<'_, Self>,
        emit: &mut impl FnMut(u32),
    ) {
        if values[i as usize] == uniform.value {
            emit(i);
        }
    }
}
