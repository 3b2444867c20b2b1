//! How far most particles go.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// Axis by axis, the median of the ways of some vertices \[m\]; reads (primitives, from \[m\], to \[m\]).
#[derive(Debug)]
pub struct Drift;

/// Parameters of [`Drift`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct DriftUniform {
    /// The first vertex among the primitives.
    pub first: u32,
    /// How many vertices there are; one at least.
    pub n: u32,
}

/// Vertices that are looked at.
const N_SAMPLES: u32 = 32;

impl Kernel for Drift {
    const NAME: &'static str = "drift";
    const WGSL: &'static [&'static str] = &[include_str!("drift.wgsl")];
    type Uniform = DriftUniform;
    type Inputs = ([u32; 4], Vec4, Vec4);
}

impl Map for Drift {
    type Output = Vec4;

    fn map(_: u32, uniform: &DriftUniform, (primitives, from, to): HostViews<'_, Self>, own: &mut Vec4) {
        let stride = uniform.n.div_ceil(N_SAMPLES);
        let n = uniform.n.div_ceil(stride);
        let mut ways = [Vec4::ZERO; N_SAMPLES as usize];
        for k in 0..n {
            let v = primitives[(uniform.first + k * stride) as usize][0] as usize;
            ways[k as usize] = to[v] - from[v];
        }
        let mut median = Vec4::ZERO;
        for axis in 0..3 {
            for k in 0..n {
                let way = ways[k as usize][axis];
                let comes_before = |j: &u32| (ways[*j as usize][axis], *j) < (way, k);
                if (0..n).filter(comes_before).count() == n as usize / 2 {
                    median[axis] = way;
                }
            }
        }
        *own = median;
    }
}
