//! First fit in blocks: parallel, and the same answer on any number of threads.
//!
//! The vertices are cut into blocks of consecutive numbers, and [`LANES`] blocks at a time are colored in parallel, each serially by
//! first fit. A block sees its own colors and those of all earlier groups of blocks, but not those of its own group; where that
//! made neighbors alike, the higher one is colored again, in ascending order, before the next group begins. Blocks depend on the
//! number of vertices alone, so threads do not show. (Speculative coloring in supersteps: Bozdağ et al. 2008, whose
//! repair order depends on the threads.)

use rayon::prelude::*;
use vivace_graph::ConstraintGraph;
use vivace_kernels::coloring::UNCOLORED;

use super::Palette;
use crate::Coloring;
use crate::certificate::index;

/// Blocks that are colored at the same time, and so the most threads that are of use.
const LANES: usize = 8;
/// Vertices in a block: enough that meshes cross few borders, so few that a group is a small part of a large graph.
const BLOCK: std::ops::RangeInclusive<usize> = 512..=8192;

/// Colors a graph by first fit in blocks. O(n + m).
#[must_use]
pub fn blocked_first_fit(graph: &ConstraintGraph) -> Coloring {
    let n = graph.n_vertices();
    let block_len = n.div_ceil(LANES).clamp(*BLOCK.start(), *BLOCK.end());
    let mut colors = vec![UNCOLORED; n];
    let mut palette = Palette::new(63);
    for group_start in (0..n).step_by(LANES * block_len) {
        let group_end = n.min(group_start + LANES * block_len);
        let (done, group) = colors[..group_end].split_at_mut(group_start);
        let crossing: Vec<Vec<u32>> = group
            .par_chunks_mut(block_len)
            .enumerate()
            .map(|(lane, block)| {
                let block_start = group_start + lane * block_len;
                Block { graph, done, start: index(block_start) }.color(block)
            })
            .collect();
        repair(graph, &crossing, index(group_start), &mut colors, &mut palette);
    }
    Coloring::compacted(colors)
}

/// One block and what it may see.
struct Block<'a> {
    graph: &'a ConstraintGraph,
    /// Colors of all earlier groups.
    done: &'a [u32],
    /// First vertex.
    start: u32,
}

impl Block<'_> {
    /// Colors the block by first fit; returns the vertices with lower neighbors that it could not see.
    fn color(&self, block: &mut [u32]) -> Vec<u32> {
        let mut crossing = Vec::new();
        let mut palette = Palette::new(63);
        for k in 0..block.len() {
            let v = self.start + index(k);
            let row = self.graph.neighbors(v);
            let mut used = 0_u64;
            let mut beyond = false;
            let mut crosses = false;
            for &u in row {
                if u >= v {
                    break;
                }
                let c = if u >= self.start {
                    block[(u - self.start) as usize]
                } else if (u as usize) < self.done.len() {
                    self.done[u as usize]
                } else {
                    crosses = true;
                    continue;
                };
                used |= 1_u64.wrapping_shl(c);
                beyond |= c >= 64;
            }
            if crosses {
                crossing.push(v);
            }
            block[k] = if beyond || used == u64::MAX {
                let visible = row.iter().take_while(|&&u| u < v).map(|&u| self.visible(u, block));
                palette.first_free_of(visible)
            } else {
                used.trailing_ones()
            };
        }
        crossing
    }

    /// The color of an earlier vertex, as far as this block can see.
    fn visible(&self, u: u32, block: &[u32]) -> u32 {
        if u >= self.start {
            block[(u - self.start) as usize]
        } else {
            self.done.get(u as usize).copied().unwrap_or(UNCOLORED)
        }
    }
}

/// Colors again, in ascending order, who has the color of a lower neighbor in the same group.
fn repair(
    graph: &ConstraintGraph,
    crossing: &[Vec<u32>],
    group_start: u32,
    colors: &mut [u32],
    palette: &mut Palette,
) {
    let clashes = |v: u32, colors: &[u32]| {
        let row = graph.neighbors(v);
        row.iter().any(|&u| u >= group_start && u < v && colors[u as usize] == colors[v as usize])
    };
    let clashing: Vec<Vec<u32>> = crossing
        .par_iter()
        .map(|block| block.iter().copied().filter(|&v| clashes(v, colors)).collect())
        .collect();
    for v in clashing.into_iter().flatten() {
        if clashes(v, colors) {
            colors[v as usize] = palette.first_free(graph.neighbors(v), colors);
        }
    }
}
