//! First fit in blocks: parallel, and the same answer on any number of threads.
//!
//! The vertices are cut into blocks of consecutive numbers, and [`LANES`] blocks at a time, a *group*, are colored in parallel,
//! each serially by first fit. A block sees its own colors and those of earlier groups, not the rest of its group. Two things make
//! up for that before the next group begins:
//!
//! - on regular meshes first fit lays a pattern, and two blocks may be out of step: a block's colors are exchanged for one another
//!   so that fewest clash with lower blocks (and blocks begin where the mesh begins a new row, if it has rows);
//! - where neighbors are still alike, the higher one is colored again, in ascending order.
//!
//! In the end the few vertices that this left with a color of their own join other classes where they can.
//!
//! Blocks depend on the graph alone, so threads do not show. (Speculation in supersteps: Bozdağ et al. 2008, where it does.)

use rayon::prelude::*;
use vivace_graph::ConstraintGraph;
use vivace_kernels::coloring::UNCOLORED;

use super::Palette;
use super::align::{Exchange, best_exchange};
use crate::Coloring;
use crate::certificate::index;
use crate::dissolve::without_crumbs;

/// Blocks that are colored at the same time, and so the most threads that are of use.
const LANES: usize = 8;
/// Vertices in a block where neighbors are near in the numbering: enough that few edges cross borders.
const BLOCK: std::ops::RangeInclusive<usize> = 2048..=65536;
/// Vertices in a block where the numbering says nothing of neighbors: just enough to be worth a thread's while.
const SCATTERED_BLOCK: usize = 512;

/// Colors a graph by first fit in blocks: colors at most degree + 1 at every vertex. O(n + m).
#[must_use]
pub fn blocked_first_fit(graph: &ConstraintGraph) -> Coloring {
    let starts = block_starts(graph);
    let mut colors = vec![UNCOLORED; graph.n_vertices()];
    let mut palette = Palette::new();
    let mut repaired = Vec::new();
    for group in (0..starts.len() - 1).step_by(LANES) {
        let starts = &starts[group..starts.len().min(group + LANES + 1)];
        color_group(graph, starts, &mut colors, &mut palette, &mut repaired);
    }
    without_crumbs(graph, colors, &repaired)
}

/// First vertex of each block, and the number of vertices at the end. A block begins where a vertex is no neighbor of the one
/// before, if there is such a place nearby: at the start of a row.
fn block_starts(graph: &ConstraintGraph) -> Vec<u32> {
    let n = graph.n_vertices();
    let len = block_len(graph);
    let starts_row = |v: &usize| !graph.neighbors(index(*v)).contains(&index(v - 1));
    let mut starts = vec![0];
    let mut nominal = len;
    while nominal + len / 2 < n {
        starts.push(index((nominal..nominal + len / 4).find(starts_row).unwrap_or(nominal)));
        nominal += len;
    }
    starts.push(index(n));
    starts
}

/// The more neighbors are far apart in the numbering, the smaller a group, so that few edges lie between blocks of one group.
fn block_len(graph: &ConstraintGraph) -> usize {
    const SAMPLES: usize = 512;
    let n = graph.n_vertices();
    let longest = n.div_ceil(LANES).clamp(*BLOCK.start(), *BLOCK.end());
    let (mut n_far, mut n_seen) = (0_u64, 0_u64);
    for v in (0..n).step_by(n.div_ceil(SAMPLES).max(1)).map(index) {
        // A hub says nothing of the numbering.
        for &u in graph.neighbors(v).iter().take(64) {
            n_far += u64::from(u.abs_diff(v) as usize > longest);
            n_seen += 1;
        }
    }
    // Of all edges, the share n_far / n_seen times LANES * len / n lies between blocks of a group: at most one in eight.
    let len = (n as u64 * n_seen).checked_div(8 * LANES as u64 * n_far);
    let len = len.and_then(|len| usize::try_from(len).ok()).unwrap_or(longest);
    len.clamp(SCATTERED_BLOCK.min(longest), longest)
}

/// Colors the blocks that begin at `starts`; the last entry is the end.
fn color_group(
    graph: &ConstraintGraph,
    starts: &[u32],
    colors: &mut [u32],
    palette: &mut Palette,
    repaired: &mut Vec<u32>,
) {
    let (done, group) = colors[..starts[starts.len() - 1] as usize].split_at_mut(starts[0] as usize);
    let mut blocks: Vec<Block<'_>> = Vec::with_capacity(LANES);
    let mut rest = group;
    for ends in starts.windows(2) {
        let (colors, after) = rest.split_at_mut((ends[1] - ends[0]) as usize);
        blocks.push(Block { graph, done, start: ends[0], colors, crossing: Vec::new(), outside: Vec::new() });
        rest = after;
    }
    if blocks.len() == 1 {
        blocks[0].color();
        return;
    }
    blocks.par_iter_mut().for_each(Block::color);
    align(&mut blocks);
    let crossing: Vec<Vec<u32>> = blocks.into_iter().map(|block| block.crossing).collect();
    repair(graph, &crossing, colors, palette, repaired);
}

/// One block and what it may see.
struct Block<'a> {
    graph: &'a ConstraintGraph,
    /// Colors of all earlier groups.
    done: &'a [u32],
    /// First vertex.
    start: u32,
    /// Colors of the block.
    colors: &'a mut [u32],
    /// Vertices that may clash: with a lower neighbor in another block of the group, or with a color above their degree.
    crossing: Vec<u32>,
    /// Vertices with lower neighbors outside the block, while they are few.
    outside: Vec<u32>,
}

impl Block<'_> {
    /// Colors the block by first fit.
    fn color(&mut self) {
        let Self { graph, done, start, .. } = *self;
        let (offsets, neighbors) = (graph.csr().offsets(), graph.csr().items());
        let offsets = &offsets[start as usize..=start as usize + self.colors.len()];
        let colors = &mut *self.colors;
        let mut palette = Palette::new();
        for (k, ends) in offsets.windows(2).enumerate() {
            let v = start + index(k);
            let row = &neighbors[ends[0] as usize..ends[1] as usize];
            // Bits 0 to 63: the colors of lower neighbors, which come in order: done, unseen, in this block.
            let mut used = 0_u64;
            let mut highest = 0;
            let mut inside = row;
            if row.first().is_some_and(|&u| u < start) {
                let n_outside = row.iter().position(|&u| u >= start).unwrap_or(row.len());
                let mut n_done = 0;
                for &u in &row[..n_outside] {
                    let Some(&c) = done.get(u as usize) else { break };
                    used |= 1_u64.wrapping_shl(c);
                    highest |= c;
                    n_done += 1;
                }
                if n_outside > n_done {
                    self.crossing.push(v);
                }
                if self.outside.len() <= colors.len() / 4 {
                    self.outside.push(v);
                }
                inside = &row[n_outside..];
            }
            for &u in inside {
                if u >= v {
                    break;
                }
                let c = colors[(u - start) as usize];
                used |= 1_u64.wrapping_shl(c);
                highest |= c;
            }
            colors[k] = if highest < 64 && used != u64::MAX {
                used.trailing_ones()
            } else {
                let visible = |&u: &u32| match u.checked_sub(start) {
                    Some(u) => colors[u as usize],
                    None => done.get(u as usize).copied().unwrap_or(UNCOLORED),
                };
                palette.first_free_of(row.iter().take_while(|&&u| u < v).map(visible))
            };
        }
    }
}

/// Exchanges the colors of each block, in ascending order, so that fewest clash with the blocks below.
fn align(blocks: &mut [Block<'_>]) {
    let mut exchanges: Vec<Exchange> = vec![Exchange::none()];
    for b in 1..blocks.len() {
        let (below, block) = (&blocks[..b], &blocks[b]);
        let is_local = block.outside.len() <= block.colors.len() / 4;
        let color_below = |u: u32| {
            let lane = below.partition_point(|lower| lower.start <= u);
            match lane.checked_sub(1) {
                Some(lane) => exchanges[lane].apply(below[lane].colors[(u - below[lane].start) as usize]),
                None => block.done[u as usize],
            }
        };
        // A few hundred vertices show a pattern as well as all of them.
        let sample = block.outside.iter().step_by((block.outside.len() / 256).max(1));
        let clashes = sample.flat_map(|&v| {
            let own = block.colors[(v - block.start) as usize];
            block.graph.neighbors(v).iter().take_while(|&&u| u < block.start).map(move |&u| (u, own))
        });
        let clashes = clashes.map(|(u, own)| [color_below(u), own]);
        let n_colors = block.colors.iter().copied().max().map_or(0, |c| c + 1);
        let exchange = if is_local { best_exchange(clashes, n_colors) } else { Exchange::none() };
        exchanges.push(exchange);
    }
    if exchanges.iter().all(Exchange::is_none) {
        return;
    }
    blocks.par_iter_mut().zip(exchanges).filter(|(_, exchange)| !exchange.is_none()).for_each(
        |(block, exchange)| {
            for (color, v) in block.colors.iter_mut().zip(block.start..) {
                *color = exchange.apply(*color);
                if *color > block.graph.degree(v) {
                    block.crossing.push(v);
                }
            }
            block.crossing.append(&mut block.outside);
            block.crossing.sort_unstable();
            block.crossing.dedup();
        },
    );
}

/// Colors again, in ascending order, who has the color of a lower neighbor or one above its degree; they are added to `repaired`.
fn repair(
    graph: &ConstraintGraph,
    crossing: &[Vec<u32>],
    colors: &mut [u32],
    palette: &mut Palette,
    repaired: &mut Vec<u32>,
) {
    let clashes = |v: u32, colors: &[u32]| {
        let row = graph.neighbors(v);
        let own = colors[v as usize];
        own as usize > row.len() || row.iter().take_while(|&&u| u < v).any(|&u| colors[u as usize] == own)
    };
    let clashing: Vec<Vec<u32>> = crossing
        .par_iter()
        .map(|block| block.iter().copied().filter(|&v| clashes(v, colors)).collect())
        .collect();
    for v in clashing.into_iter().flatten() {
        if clashes(v, colors) {
            colors[v as usize] = palette.first_free(graph.neighbors(v), colors);
            repaired.push(v);
        }
    }
}
