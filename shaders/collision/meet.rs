//! Which boxes meet: down a tree, without a stack.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use super::{CHILDREN, EDGES};
use crate::{Expand, HostViews, Kernel};

/// Levels of a tree, at most: leaves have 32-bit numbers.
pub const LEVELS: usize = 12;

/// The pairs of primitive `i`, a vertex or an edge, whose boxes meet and which share no particle: a vertex with triangles, an edge with
/// edges that come after it; reads (primitives, boxes \[m\]).
///
/// Nothing is computed from boxes, so all devices find the same.
#[derive(Debug)]
pub struct Meet;

/// Parameters of [`Meet`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct MeetUniform {
    /// How many triangles there are.
    pub n_triangles: u32,
    /// How many edges.
    pub n_edges: u32,
    /// Fills up what WGSL aligns.
    pub padding: [u32; 2],
    /// Where the levels of both trees begin among the boxes: those of triangles, then those of edges, leaves first.
    pub levels: [[u32; LEVELS]; 2],
}

/// How many nodes a level has over `n` leaves.
fn level_len(n: u32, level: usize) -> u32 {
    ((n - 1) >> (CHILDREN.ilog2() as usize * level)) + 1
}

fn meets(one: &[Vec4; 2], other: &[Vec4; 2]) -> bool {
    let is_below = |a: Vec4, b: Vec4| a.truncate().cmple(b.truncate()).all();
    is_below(one[0], other[1]) && is_below(other[0], one[1])
}

/// Calls `found` with each leaf from `start` on that meets the box. The walk begins at node `start` of `level`, and goes on to the right and up.
fn walk(
    own: &[Vec4; 2],
    boxes: &[[Vec4; 2]],
    levels: &[u32; LEVELS],
    n: u32,
    [mut level, start]: [usize; 2],
    mut found: impl FnMut(u32),
) {
    #[expect(clippy::cast_possible_truncation, reason = "a node")]
    let mut at = start as u32;
    loop {
        if meets(own, &boxes[(levels[level] + at) as usize]) {
            if level > 0 {
                level -= 1;
                at *= CHILDREN;
                continue;
            }
            found(at);
        }
        while at % CHILDREN == CHILDREN - 1 || at + 1 == level_len(n, level) {
            if level_len(n, level) == 1 {
                return;
            }
            at /= CHILDREN;
            level += 1;
        }
        at += 1;
    }
}

impl Kernel for Meet {
    const NAME: &'static str = "meet";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("meet.wgsl")];
    type Uniform = MeetUniform;
    type Inputs = ([u32; 4], [Vec4; 2]);
}

impl Expand for Meet {
    type Item = [u32; 4];

    fn expand(
        i: u32,
        uniform: &MeetUniform,
        (primitives, boxes): HostViews<'_, Self>,
        emit: &mut impl FnMut([u32; 4]),
    ) {
        let MeetUniform { n_triangles, n_edges, levels, .. } = uniform;
        let (own, [a, b, ..]) = (&boxes[i as usize], primitives[i as usize]);
        if i < n_triangles + n_edges {
            // Itself is left out as all are that share a particle.
            let start = [0, (i - n_triangles) as usize];
            walk(own, boxes, &levels[1], *n_edges, start, |edge| {
                let [c, d, ..] = primitives[(n_triangles + edge) as usize];
                if a != c && a != d && b != c && b != d {
                    emit([a | EDGES, b, c, d]);
                }
            });
        } else if *n_triangles > 0 {
            let top = (0..LEVELS).find(|&level| level_len(*n_triangles, level) == 1).unwrap_or(0);
            walk(own, boxes, &levels[0], *n_triangles, [top, 0], |triangle| {
                let [b, c, d, _] = primitives[triangle as usize];
                if a != b && a != c && a != d {
                    emit([a, b, c, d]);
                }
            });
        }
    }
}
