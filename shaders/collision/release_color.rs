//! The coloring of contacts: what nobody has is free again.

use crate::{HostViews, Kernel, Map};

/// Frees entry `i` unless its color is given away.
#[derive(Debug)]
pub struct ReleaseColor;

impl Kernel for ReleaseColor {
    const NAME: &'static str = "release_color";
    const WGSL: &'static [&'static str] = &[include_str!("release_color.wgsl")];
    type Uniform = ();
    type Inputs = ();
}

impl Map for ReleaseColor {
    type Output = u32;

    fn map(_: u32, (): &(), (): HostViews<'_, Self>, own: &mut u32) {
        if *own != 0 {
            *own = u32::MAX;
        }
    }
}
