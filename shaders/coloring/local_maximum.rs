//! The independent set of Luby (1985), Jones and Plassmann (1993) and Welsh and Powell (1967): vertices heavier than every
//! contending neighbor.
//!
//! Most vertices lose to the same neighbor round after round, so each remembers to whom it lost last and looks there first: one
//! read instead of a row.

use bytemuck::{Pod, Zeroable};

use super::row;
use crate::pcg::{self, hash};
use crate::{HostViews, Kernel, Select};

/// The vertices of the list that are local maxima; reads (offsets, neighbors, weight) and remembers, in an array that began as
/// [`super::UNCOLORED`], to whom it lost. A weight of 0 does not contend.
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
    const WGSL: &'static [&'static str] = &[pcg::WGSL, include_str!("local_maximum.wgsl")];
    type Uniform = LocalMaximumUniform;
    type Inputs = (u32, u32, u32);
}

impl Select for LocalMaximum {
    type Output = u32;

    #[inline]
    fn select(
        v: u32,
        uniform: &Self::Uniform,
        (offsets, neighbors, weight): HostViews<'_, Self>,
        lost_to: &mut u32,
    ) -> bool {
        let mine = weight[v as usize];
        let heavier = |u: u32, other: u32| {
            other > mine || (other == mine && hash(u, uniform.key) > hash(v, uniform.key))
        };
        if weight.get(*lost_to as usize).is_some_and(|&other| heavier(*lost_to, other)) {
            return false;
        }
        for &u in row(v, offsets, neighbors) {
            if heavier(u, weight[u as usize]) {
                *lost_to = u;
                return false;
            }
        }
        true
    }
}
