//! Weight of Largest-Degree-First: the current degree, that is, the number of uncolored neighbors.

use super::{UNCOLORED, row};
use crate::{HostViews, Kernel, Map};

/// Weight (current degree + 1) of each vertex of the list; reads (offsets, neighbors, color).
#[derive(Debug)]
pub struct DegreeWeight;

impl Kernel for DegreeWeight {
    const NAME: &'static str = "degree_weight";
    type Uniform = ();
    type Inputs = (u32, u32, u32);
}

impl Map for DegreeWeight {
    type Output = u32;

    #[inline]
    fn map(v: u32, (): &(), (offsets, neighbors, color): HostViews<'_, Self>) -> u32 {
        let mut weight = 1;
        for &u in row(v, offsets, neighbors) {
            weight += u32::from(color[u as usize] == UNCOLORED);
        }
        weight
    }
}
