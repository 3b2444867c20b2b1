//! Whether a coloring is one.

use bytemuck::{Pod, Zeroable};

use crate::{CountDown, HostViews, Kernel};

/// Takes one from counter 0 for each vertex without a color below a bound; reads (color).
#[derive(Debug)]
pub struct LacksColor;

/// Parameters of [`LacksColor`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct LacksColorUniform {
    /// Colors that there may be.
    pub n_colors: u32,
}

impl Kernel for LacksColor {
    const NAME: &'static str = "lacks_color";
    const WGSL: &'static [&'static str] = &[include_str!("lacks_color.wgsl")];
    type Uniform = LacksColorUniform;
    type Inputs = (u32,);
}

impl CountDown for LacksColor {
    #[inline]
    fn targets<'a>(v: u32, uniform: &LacksColorUniform, (color,): HostViews<'a, Self>) -> &'a [u32] {
        if color[v as usize] < uniform.n_colors { &[] } else { &[0] }
    }
}
