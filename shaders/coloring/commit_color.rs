//! Algorithm 2, line 11: an accepted proposal becomes the color.

use crate::{HostViews, Kernel, Map};

/// Color of each vertex of the list; reads (proposal).
#[derive(Debug)]
pub struct CommitColor;

impl Kernel for CommitColor {
    const NAME: &'static str = "commit_color";
    type Uniform = ();
    type Inputs = (u32,);
}

impl Map for CommitColor {
    type Output = u32;

    #[inline]
    fn map(v: u32, (): &(), (proposal,): HostViews<'_, Self>) -> u32 {
        proposal[v as usize]
    }
}
