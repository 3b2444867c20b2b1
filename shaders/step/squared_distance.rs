//! How far vectors are apart.

use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// `‖a − b‖²`, w left aside; reads (a, b).
///
/// A device may fuse products with sums: three roundings.
#[derive(Debug)]
pub struct SquaredDistance;

impl Kernel for SquaredDistance {
    const NAME: &'static str = "squared_distance";
    const WGSL: &'static [&'static str] =
        &[include_str!("../common/vec3.wgsl"), include_str!("squared_distance.wgsl")];
    type Uniform = ();
    type Inputs = (Vec4, Vec4);
}

impl Map for SquaredDistance {
    type Output = f32;

    #[inline]
    fn map(i: u32, (): &(), (a, b): HostViews<'_, Self>, own: &mut f32) {
        *own = (a[i as usize].truncate() - b[i as usize].truncate()).length_squared();
    }
}
