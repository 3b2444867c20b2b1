//! Algorithm 2, lines 8-12, and the Hungarian heuristic: a proposal stands unless a neighbor with higher priority drew the same.
//!
//! Only proposals are read and only colors are written, so nobody decides on what another has just committed. A colored neighbor's proposal is its color, which [`super::ProposeColor`] never draws: it cannot clash.

use bytemuck::{Pod, Zeroable};

use super::{UNCOLORED, row};
use crate::pcg::{self, hash};
use crate::{HostViews, Kernel, Map, Select};

/// The vertices of the list whose proposal stands, which becomes their color; reads (offsets, neighbors, proposal).
#[derive(Debug)]
pub struct AcceptColor;

/// Among neighbors that drew the same color, the largest hash of this round wins.
pub const CONFLICT_HASH: u32 = 0;
/// Among neighbors that drew the same color, the largest index wins: the paper's rule.
pub const CONFLICT_INDEX: u32 = 1;
/// Neighbors that drew the same color all lose: Algorithm 2 without the heuristic. Need not end.
pub const CONFLICT_NONE: u32 = 2;

/// Parameters of [`AcceptColor`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct AcceptColorUniform {
    /// Key of this round's priorities.
    pub key: u32,
    /// [`CONFLICT_HASH`], [`CONFLICT_INDEX`] or [`CONFLICT_NONE`].
    pub rule: u32,
}

impl Kernel for AcceptColor {
    const NAME: &'static str = "accept_color";
    const WGSL: &'static [&'static str] = &[pcg::WGSL, include_str!("accept_color.wgsl")];
    type Uniform = AcceptColorUniform;
    type Inputs = (u32, u32, u32);
}

impl Select for AcceptColor {
    type Output = u32;

    #[inline]
    fn select(
        v: u32,
        uniform: &Self::Uniform,
        (offsets, neighbors, proposal): HostViews<'_, Self>,
        color: &mut u32,
    ) -> bool {
        let mine = proposal[v as usize];
        for &u in row(v, offsets, neighbors) {
            if proposal[u as usize] == mine {
                let loses = match uniform.rule {
                    CONFLICT_HASH => hash(u, uniform.key) > hash(v, uniform.key),
                    CONFLICT_INDEX => u > v,
                    _ => true,
                };
                if loses {
                    return false;
                }
            }
        }
        *color = mine;
        true
    }
}

/// The same where colored vertices are in the list, too: nothing is taken out of it.
impl Map for AcceptColor {
    type Output = u32;

    #[inline]
    fn map(v: u32, uniform: &Self::Uniform, inputs: HostViews<'_, Self>, color: &mut u32) {
        if *color == UNCOLORED {
            Self::select(v, uniform, inputs, color);
        }
    }
}
