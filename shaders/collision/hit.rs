//! The guard: which pairs would pass.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use super::proximity::{self, EDGES, Motion, gap, is_clear};
use crate::{HostViews, Kernel, Lower};

/// When pair `i` comes nearer than the gap on its straight way: lowers the part of its way that each of its particles may go, as the
/// bits of a number from 0 to 1; marks each of them as held, and element `n` of the parts if there is any. Reads (pairs, from \[m\], to \[m\]).
///
/// Parts come first, one for each particle, then the mark, then one for each particle that is 0 once it was held.
#[derive(Debug)]
pub struct Hit;

/// Parameters of [`Hit`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct HitUniform {
    /// The gap that is left \[m\], or as part of the distance at the start, whichever is less.
    pub gap: f32,
    /// See `gap` \[1\].
    pub gap_of_start: f32,
    /// Pairs nearer than this at the start come no nearer at all \[m\]: `f32` would lose their side.
    pub floor: f32,
    /// Whether particles that hit stay where they are.
    pub stays: u32,
    /// How many particles there are.
    pub n: u32,
}

impl Kernel for Hit {
    const NAME: &'static str = "hit";
    const WGSL: &'static [&'static str] = &[proximity::WGSL, include_str!("hit.wgsl")];
    type Uniform = HitUniform;
    type Inputs = ([u32; 4], Vec4, Vec4);
}

/// Of a gap below the floor, what counts as kept.
const KEPT: f32 = 0.99;

fn time(uniform: &HitUniform, motion: &Motion) -> Option<f32> {
    if motion.speed == 0.0 || is_clear(motion.is_edges, &motion.start, &motion.end, uniform.gap) {
        return None;
    }
    let axis = motion.at(0.0).separation;
    let apart = axis.length();
    // What touches at the start has no side to be kept on.
    if apart <= 0.0 {
        return None;
    }
    if apart < uniform.floor {
        // Along the axis between them, the gap is a concave function of time.
        let [start, end] = [&motion.start, &motion.end].map(|x| gap(motion.is_edges, axis, x));
        return (end < KEPT * start).then_some(0.0);
    }
    let reach = uniform.gap.min(uniform.gap_of_start * apart);
    motion.first_within(reach, 0.0).map(|(time, _)| time)
}

impl Lower<9> for Hit {
    fn lower(
        i: u32,
        uniform: &HitUniform,
        (pairs, from, to): HostViews<'_, Self>,
    ) -> [Option<(u32, u32)>; 9] {
        let pair = pairs[i as usize];
        let Some(time) = time(uniform, &Motion::new(pair, from, to)) else { return [None; 9] };
        let part = if uniform.stays != 0 { 0 } else { time.to_bits() };
        let particles = [pair[0] & !EDGES, pair[1], pair[2], pair[3]];
        std::array::from_fn(|k| {
            Some(match k {
                0..4 => (particles[k], part),
                4..8 => (uniform.n + 1 + particles[k - 4], 0),
                _ => (uniform.n, 0),
            })
        })
    }
}
