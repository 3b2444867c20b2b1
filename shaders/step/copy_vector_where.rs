//! A copy, if the safeguard has decided so.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use super::Watch;
use crate::{HostViews, Kernel, Map};

/// Element `i` of another array, where the last look has taken iterations back, or where it has not; reads (watch, from).
#[derive(Debug)]
pub struct CopyVectorWhere;

/// Parameters of [`CopyVectorWhere`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct CopyVectorWhereUniform {
    /// Copies where [`Watch::is_back`] is this.
    pub is_back: u32,
}

impl Kernel for CopyVectorWhere {
    const NAME: &'static str = "copy_vector_where";
    const WGSL: &'static [&'static str] = &[super::WATCH, include_str!("copy_vector_where.wgsl")];
    type Uniform = CopyVectorWhereUniform;
    type Inputs = (Watch, Vec4);
}

impl Map for CopyVectorWhere {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, uniform: &CopyVectorWhereUniform, (watch, from): HostViews<'_, Self>, own: &mut Vec4) {
        if watch[0].is_back == uniform.is_back {
            *own = from[i as usize];
        }
    }
}
