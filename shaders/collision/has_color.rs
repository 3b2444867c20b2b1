//! One color of many.

use bytemuck::{Pod, Zeroable};

use crate::{HostViews, Kernel, Select};

/// Selects what has a color.
#[derive(Debug)]
pub struct HasColor;

/// Parameters of [`HasColor`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct HasColorUniform {
    /// The color.
    pub color: u32,
}

impl Kernel for HasColor {
    const NAME: &'static str = "has_color";
    const WGSL: &'static [&'static str] = &[include_str!("has_color.wgsl")];
    type Uniform = HasColorUniform;
    type Inputs = ();
}

impl Select for HasColor {
    type Output = u32;

    fn select(_: u32, uniform: &HasColorUniform, (): HostViews<'_, Self>, own: &mut u32) -> bool {
        *own == uniform.color
    }
}
