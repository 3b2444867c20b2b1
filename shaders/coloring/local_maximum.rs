//! The independent set of Luby (1985), Jones and Plassmann (1993) and Welsh and Powell (1967): vertices heavier than every
//! contending neighbor.

use bytemuck::{Pod, Zeroable};

use super::row;
use crate::pcg::hash;
use crate::{HostViews, Kernel, Select};

/// The vertices of the list that are local maxima; reads (offsets, neighbors, weight). Weight 0: does not contend.
#[derive(Debug)]
pub struct LocalMaximum;

/// Parameters of [`LocalMaximum`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct LocalMaximumUniform {
    /// Key of the hash that decides between equal weights.
    pub key: u32,
}

impl Kernel for LocalMaximum {
    const NAME: &'static str = "local_maximum";
    type Uniform = LocalMaximumUniform;
    type Inputs = (u32, u32, u32);
}

impl Select for LocalMaximum {
    #[inline]
    fn select(v: u32, uniform: &Self::Uniform, (offsets, neighbors, weight): HostViews<'_, Self>) -> bool {
        let mine = weight[v as usize];
        for &u in row(v, offsets, neighbors) {
            let other = weight[u as usize];
            if other > mine || (other == mine && hash(u, uniform.key) > hash(v, uniform.key)) {
                return false;
            }
        }
        true
    }
}
