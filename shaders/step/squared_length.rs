//! How long vectors are.

use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// `‖a‖²`, w left aside; reads (a).
///
/// A device may fuse products with sums: three roundings.
#[derive(Debug)]
pub struct SquaredLength;

impl Kernel for SquaredLength {
    const NAME: &'static str = "squared_length";
    const WGSL: &'static [&'static str] =
        &[include_str!("../common/vec3.wgsl"), include_str!("squared_length.wgsl")];
    type Uniform = ();
    type Inputs = (Vec4,);
}

impl Map for SquaredLength {
    type Output = f32;

    #[inline]
    fn map(i: u32, (): &(), (a,): HostViews<'_, Self>, own: &mut f32) {
        *own = a[i as usize].truncate().length_squared();
    }
}
