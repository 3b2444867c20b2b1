//! Luby's exclusion: a vertex leaves the contest for a color that a neighbor has got.

use bytemuck::{Pod, Zeroable};

use super::row;
use crate::{HostViews, Kernel, Select};

/// The vertices of the list that have a neighbor of one color, whose weight becomes 0; reads (offsets, neighbors, color).
#[derive(Debug)]
pub struct NeighborHasColor;

/// Parameters of [`NeighborHasColor`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct NeighborHasColorUniform {
    /// The color.
    pub color: u32,
}

impl Kernel for NeighborHasColor {
    const NAME: &'static str = "neighbor_has_color";
    const WGSL: &'static [&'static str] = &[include_str!("neighbor_has_color.wgsl")];
    type Uniform = NeighborHasColorUniform;
    type Inputs = (u32, u32, u32);
}

impl Select for NeighborHasColor {
    type Output = u32;

    #[inline]
    fn select(
        v: u32,
        uniform: &Self::Uniform,
        (offsets, neighbors, color): HostViews<'_, Self>,
        weight: &mut u32,
    ) -> bool {
        let beaten = row(v, offsets, neighbors).iter().any(|&u| color[u as usize] == uniform.color);
        if beaten {
            *weight = 0;
        }
        beaten
    }
}
