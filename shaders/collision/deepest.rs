//! The deepest contact.

use crate::{HostViews, Kernel, Lower};

/// Lowers element 0 to the bits of the depth of contact `i`, all of them turned: larger depths are lower. Reads (depths \[m\]).
#[derive(Debug)]
pub struct Deepest;

impl Kernel for Deepest {
    const NAME: &'static str = "deepest";
    const WGSL: &'static [&'static str] = &[include_str!("deepest.wgsl")];
    type Uniform = ();
    type Inputs = (f32,);
}

impl Lower<1> for Deepest {
    fn lower(i: u32, (): &(), (depths,): HostViews<'_, Self>) -> [Option<(u32, u32)>; 1] {
        [Some((0, !depths[i as usize].to_bits()))]
    }
}
