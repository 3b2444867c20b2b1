//! A copy.

use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// Element `i` of another array; reads (from).
#[derive(Debug)]
pub struct CopyVector;

impl Kernel for CopyVector {
    const NAME: &'static str = "copy_vector";
    const WGSL: &'static [&'static str] = &[include_str!("copy_vector.wgsl")];
    type Uniform = ();
    type Inputs = (Vec4,);
}

impl Map for CopyVector {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (from,): HostViews<'_, Self>, own: &mut Vec4) {
        *own = from[i as usize];
    }
}
