//! Leaves the uncolored vertices in the list.

use super::UNCOLORED;
use crate::{HostViews, Kernel, Select};

/// The vertices of the list that have a color; reads its own element of the colors only.
#[derive(Debug)]
pub struct IsColored;

impl Kernel for IsColored {
    const NAME: &'static str = "is_colored";
    const WGSL: &'static [&'static str] = &[include_str!("is_colored.wgsl")];
    type Uniform = ();
    type Inputs = ();
}

impl Select for IsColored {
    type Output = u32;

    #[inline]
    fn select(_: u32, (): &(), (): HostViews<'_, Self>, color: &mut u32) -> bool {
        *color != UNCOLORED
    }
}
