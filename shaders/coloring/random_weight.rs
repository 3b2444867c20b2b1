//! Random weights of Luby and of Jones and Plassmann: a permutation of the vertices, by hash.

use bytemuck::{Pod, Zeroable};

use crate::pcg::{self, hash};
use crate::{HostViews, Kernel, Map};

/// Weight of each vertex of the list, never 0; reads no array.
#[derive(Debug)]
pub struct RandomWeight;

/// Parameters of [`RandomWeight`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct RandomWeightUniform {
    /// Key of the hash.
    pub key: u32,
}

impl Kernel for RandomWeight {
    const NAME: &'static str = "random_weight";
    const WGSL: &'static [&'static str] = &[pcg::WGSL, include_str!("random_weight.wgsl")];
    type Uniform = RandomWeightUniform;
    type Inputs = ();
}

impl Map for RandomWeight {
    type Output = u32;

    #[inline]
    fn map(v: u32, uniform: &Self::Uniform, (): HostViews<'_, Self>, weight: &mut u32) {
        *weight = hash(v, uniform.key).max(1);
    }
}
