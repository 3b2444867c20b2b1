//! Kernels of the round-based graph colorings. One file each; `Csr` arrays come as (offsets, neighbors).

mod accept_color;
mod color_instead;
mod degree_weight;
mod first_fit;
mod is_colored;
mod lacks_color;
mod leave_neighbors;
mod local_maximum;
mod neighbor_has_color;
mod propose_color;
mod random_weight;
mod set_value;
mod take_color;

use crate::Shader;

pub use accept_color::{AcceptColor, AcceptColorUniform, CONFLICT_HASH, CONFLICT_INDEX, CONFLICT_NONE};
pub use color_instead::ColorInstead;
pub use degree_weight::DegreeWeight;
pub use first_fit::FirstFit;
pub use is_colored::IsColored;
pub use lacks_color::{LacksColor, LacksColorUniform};
pub use leave_neighbors::LeaveNeighbors;
pub use local_maximum::{LocalMaximum, LocalMaximumUniform};
pub use neighbor_has_color::{NeighborHasColor, NeighborHasColorUniform};
pub use propose_color::{ProposeColor, ProposeColorUniform};
pub use random_weight::{RandomWeight, RandomWeightUniform};
pub use set_value::{SetValue, SetValueUniform};
pub use take_color::{TakeColor, TakeColorUniform};

/// Every kernel of this module in every form that the colorings use.
pub const SHADERS: [Shader; 15] = [
    Shader::map::<AcceptColor>(),
    Shader::select::<AcceptColor>(),
    Shader::map::<ColorInstead>(),
    Shader::map::<DegreeWeight>(),
    Shader::update::<FirstFit>(),
    Shader::update_in_order::<FirstFit>(),
    Shader::select::<IsColored>(),
    Shader::count_down::<LacksColor>(),
    Shader::count_down::<LeaveNeighbors>(),
    Shader::select::<LocalMaximum>(),
    Shader::select::<NeighborHasColor>(),
    Shader::map::<ProposeColor>(),
    Shader::map::<RandomWeight>(),
    Shader::map::<SetValue>(),
    Shader::update_in_order::<TakeColor>(),
];

/// The functions of this module in WGSL, for kernels that bind `offsets`, `neighbors` and `color`.
const WGSL: &str = include_str!("mod.wgsl");

/// The color of a vertex that has none yet.
pub const UNCOLORED: u32 = u32::MAX;

/// The neighbors of `v`.
#[inline]
fn row<'a>(v: u32, offsets: &[u32], neighbors: &'a [u32]) -> &'a [u32] {
    &neighbors[offsets[v as usize] as usize..offsets[v as usize + 1] as usize]
}

/// The colors `base..base + 32` that `neighbors` own, as bits. An uncolored neighbor owns none.
#[inline]
fn used_colors(neighbors: &[u32], color: &[u32], base: u32) -> u32 {
    let mut used = 0;
    for &u in neighbors {
        let c = color[u as usize].wrapping_sub(base);
        used |= u32::from(c < 32) << (c & 31);
    }
    used
}

/// The smallest color not below `from` that no neighbor owns. At most `from` + degree.
#[inline]
fn first_free_color(neighbors: &[u32], color: &[u32], from: u32) -> u32 {
    let mut base = from;
    loop {
        let used = used_colors(neighbors, color, base);
        if used != u32::MAX {
            return base + used.trailing_ones();
        }
        base += 32;
    }
}
