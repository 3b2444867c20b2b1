//! A vertex that was colored leaves the degrees of its neighbors: what keeps the weights of Largest-Degree-First current.

use super::row;
use crate::{CountDown, HostViews, Kernel};

/// Takes one from the weight of every neighbor; reads (offsets, neighbors).
#[derive(Debug)]
pub struct LeaveNeighbors;

impl Kernel for LeaveNeighbors {
    const NAME: &'static str = "leave_neighbors";
    const WGSL: &'static [&'static str] = &[include_str!("leave_neighbors.wgsl")];
    type Uniform = ();
    type Inputs = (u32, u32);
}

impl CountDown for LeaveNeighbors {
    #[inline]
    fn targets<'a>(v: u32, (): &(), (offsets, neighbors): HostViews<'a, Self>) -> &'a [u32] {
        row(v, offsets, neighbors)
    }
}
