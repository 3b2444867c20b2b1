//! The smallest color that no neighbor owns.

use super::{first_free_color, row};
use crate::{HostViews, Kernel, Update};

/// Color of each vertex of the list, which must be independent; reads (offsets, neighbors) and the colors.
#[derive(Debug)]
pub struct FirstFit;

impl Kernel for FirstFit {
    const NAME: &'static str = "first_fit";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("first_fit.wgsl")];
    type Uniform = ();
    type Inputs = (u32, u32);
}

impl Update for FirstFit {
    type State = u32;

    #[inline]
    fn update(v: u32, (): &(), (offsets, neighbors): HostViews<'_, Self>, color: &[u32]) -> u32 {
        first_free_color(row(v, offsets, neighbors), color, 0)
    }
}
