//! A level of substitution with the partitioned inverse of a Cholesky factor.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use crate::pd::{self, Row, Tap};
use crate::{HostViews, Kernel, Update};

/// `v_i = Σ weight · v[column]` over the entries of row `i − first`, none of whose columns is in the list; reads (rows, taps).
#[derive(Debug)]
pub struct Substitute;

/// Parameters of [`Substitute`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct SubstituteUniform {
    /// The element that has the first row.
    pub first: u32,
}

impl Kernel for Substitute {
    const NAME: &'static str = "substitute";
    const WGSL: &'static [&'static str] = &[pd::WGSL, include_str!("substitute.wgsl")];
    type Uniform = SubstituteUniform;
    type Inputs = (Row, Tap);
}

impl Update for Substitute {
    type State = Vec4;

    #[inline]
    fn update(i: u32, uniform: &SubstituteUniform, (rows, taps): HostViews<'_, Self>, v: &[Vec4]) -> Vec4 {
        let row = &rows[(i - uniform.first) as usize];
        let mut sum = Vec3::ZERO;
        for e in row.entries(0, row.n) {
            sum += v[taps[e].column as usize].truncate() * taps[e].weight;
        }
        sum.extend(0.0)
    }
}
