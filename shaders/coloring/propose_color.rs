//! Algorithm 2, lines 5-6 and 14-16: an uncolored vertex draws a color from its palette; a hungry one is fed first.
//!
//! The palette of v is what was offered to it, `{0, …, floor(degree / shrink)}`, less the colors that colored neighbors own. It
//! needs no storage: a color once owned stays owned, so a palette that ran empty and was fed (with colors not owned, until one is
//! free) holds exactly the smallest free color above the initial palette, and that can be found afresh in each round. Read
//! literally, line 16 offers the same color for ever, and the color offered may be a neighbor's.

use bytemuck::{Pod, Zeroable};

use super::{UNCOLORED, first_free_color, row, used_colors};
use crate::pcg::{self, hash};
use crate::{HostViews, Kernel, Map};

/// Proposal of each vertex of the list that has no color; reads (offsets, neighbors, color).
#[derive(Debug)]
pub struct ProposeColor;

/// Parameters of [`ProposeColor`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct ProposeColorUniform {
    /// Key of this round's draw.
    pub key: u32,
    /// Palette shrinking factor s, times 256. Integer division is the same on every device.
    pub shrink_q8: u32,
    /// No initial palette is larger: a hub needs no more colors than its neighbors.
    pub palette_cap: u32,
}

impl ProposeColorUniform {
    /// Size of the initial palette of a vertex: never empty, never above degree + 1.
    #[inline]
    #[must_use]
    pub fn palette_size(&self, degree: u32) -> u32 {
        ((degree.min((1 << 24) - 1) << 8) / self.shrink_q8 + 1).min(degree + 1).min(self.palette_cap)
    }
}

impl Kernel for ProposeColor {
    const NAME: &'static str = "propose_color";
    const WGSL: &'static [&'static str] = &[pcg::WGSL, super::WGSL, include_str!("propose_color.wgsl")];
    type Uniform = ProposeColorUniform;
    type Inputs = (u32, u32, u32);
}

impl Map for ProposeColor {
    type Output = u32;

    #[inline]
    fn map(
        v: u32,
        uniform: &Self::Uniform,
        (offsets, neighbors, color): HostViews<'_, Self>,
        proposal: &mut u32,
    ) {
        if color[v as usize] != UNCOLORED {
            return;
        }
        let neighbors = row(v, offsets, neighbors);
        let degree = offsets[v as usize + 1] - offsets[v as usize];
        let palette = uniform.palette_size(degree);
        let mut free = window(neighbors, color, palette, 0);
        let mut n_free = free.count_ones();
        let mut base = 32;
        while base < palette {
            n_free += window(neighbors, color, palette, base).count_ones();
            base += 32;
        }
        if n_free == 0 {
            *proposal = first_free_color(neighbors, color, palette);
            return;
        }
        let mut skip = hash(v, uniform.key) % n_free;
        base = 0;
        while skip >= free.count_ones() {
            skip -= free.count_ones();
            base += 32;
            free = window(neighbors, color, palette, base);
        }
        while skip > 0 {
            free &= free - 1;
            skip -= 1;
        }
        *proposal = base + free.trailing_zeros();
    }
}

/// The colors `base..base + 32` in the palette of a vertex with `neighbors`, as bits.
#[inline]
fn window(neighbors: &[u32], color: &[u32], palette: u32, base: u32) -> u32 {
    let offered = if palette - base < 32 { (1 << (palette - base)) - 1 } else { u32::MAX };
    offered & !used_colors(neighbors, color, base)
}
