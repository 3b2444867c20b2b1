//! Boxes around boxes: a level of a tree from the one below.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Update};

/// Children of a node.
pub const CHILDREN: u32 = 8;

/// The box of node `i` \[m\]: around those of its children.
#[derive(Debug)]
pub struct Bound;

/// Parameters of [`Bound`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct BoundUniform {
    /// The level's first node.
    pub first: u32,
    /// The first node of the level below.
    pub first_child: u32,
    /// How many nodes the level below has.
    pub n_children: u32,
}

impl Kernel for Bound {
    const NAME: &'static str = "bound";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("bound.wgsl")];
    type Uniform = BoundUniform;
    type Inputs = ();
}

impl Update for Bound {
    type State = [Vec4; 2];

    fn update(i: u32, uniform: &BoundUniform, (): HostViews<'_, Self>, boxes: &[[Vec4; 2]]) -> [Vec4; 2] {
        let begin = CHILDREN * (i - uniform.first);
        let end = uniform.n_children.min(begin + CHILDREN);
        let children = &boxes[(uniform.first_child + begin) as usize..(uniform.first_child + end) as usize];
        let around =
            |[least, greatest]: [Vec4; 2], child: &[Vec4; 2]| [least.min(child[0]), greatest.max(child[1])];
        children.iter().fold(children[0], around)
    }
}
