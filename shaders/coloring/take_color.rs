//! One given color for whoever can have it.

use super::{UNCOLORED, row};
use crate::{HostViews, Kernel, Update};

pub use super::neighbor_has_color::NeighborHasColorUniform as TakeColorUniform;

/// Gives each vertex of the list the color, unless a neighbor owns it; reads (offsets, neighbors) and the colors.
#[derive(Debug)]
pub struct TakeColor;

impl Kernel for TakeColor {
    const NAME: &'static str = "take_color";
    const WGSL: &'static [&'static str] = &[include_str!("take_color.wgsl")];
    type Uniform = TakeColorUniform;
    type Inputs = (u32, u32);
}

impl Update for TakeColor {
    type State = u32;

    #[inline]
    fn update(
        v: u32,
        uniform: &Self::Uniform,
        (offsets, neighbors): HostViews<'_, Self>,
        color: &[u32],
    ) -> u32 {
        let taken = row(v, offsets, neighbors).iter().any(|&u| color[u as usize] == uniform.color);
        if taken { UNCOLORED } else { uniform.color }
    }
}
