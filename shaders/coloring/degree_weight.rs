//! Weight of Largest-Degree-First: degree and one, to be counted down by [`super::LeaveNeighbors`].

use crate::{HostViews, Kernel, Map};

/// Weight of each vertex of the list; reads (offsets).
#[derive(Debug)]
pub struct DegreeWeight;

impl Kernel for DegreeWeight {
    const NAME: &'static str = "degree_weight";
    const WGSL: &'static [&'static str] = &[include_str!("degree_weight.wgsl")];
    type Uniform = ();
    type Inputs = (u32,);
}

impl Map for DegreeWeight {
    type Output = u32;

    #[inline]
    fn map(v: u32, (): &(), (offsets,): HostViews<'_, Self>, weight: &mut u32) {
        *weight = offsets[v as usize + 1] - offsets[v as usize] + 1;
    }
}
